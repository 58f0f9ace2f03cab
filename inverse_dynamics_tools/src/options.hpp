// SPDX-License-Identifier: Apache-2.0
/// @file
/// Option structs of C++ as classes of Python, from one list of their fields.
///
///     bindOptions<EstimatorOptions>(module, "EstimatorOptions", "Options of both estimators.",
///                                   "gain: 1/s; tracking: rad/s.",
///                                   Field{"gain", &EstimatorOptions::gain},
///                                   Field{"tracking", &EstimatorOptions::tracking});
///     // EstimatorOptions(gain, *, tracking=200.0), with these attributes
#pragma once

#include <pybind11/pybind11.h>

#include <type_traits>

#include "vectors.hpp"

namespace inverse_dynamics_tools {

template <class T, class Value>
struct Field {
  const char* name;
  Value T::*member;
};
template <class T, class Value>
Field(const char*, Value T::*) -> Field<T, Value>;

/// What Python gives and gets: vectors of dynamic size as arrays.
template <class Value>
using InPython =
    std::conditional_t<std::is_same_v<Value, chain_dynamics::OwnedVector>, Eigen::VectorXd, Value>;

/// An attribute for each field, and a constructor that takes the first, and the others by name.
template <class T, class First, class... Others>
void bindOptions(pybind11::module_& module, const char* name, const char* doc, const char* meanings,
                 Field<T, First> first, Field<T, Others>... others) {
  namespace py = pybind11;
  py::class_<T> options(module, name, doc);
  options.def(
      py::init([first, others...](const InPython<First>& value, const InPython<Others>&... values) {
        T made;
        made.*first.member = value;
        ((made.*others.member = values), ...);
        return made;
      }),
      py::arg(first.name), py::kw_only(),
      (py::arg(others.name) = InPython<Others>(T().*others.member))..., meanings);
  const auto attribute = [&options](const auto& field) {
    using Value = InPython<std::decay_t<decltype(T().*field.member)>>;
    options.def_property(
        field.name, [field](const T& t) -> Value { return t.*field.member; },
        [field](T& t, const Value& value) { t.*field.member = value; });
  };
  attribute(first);
  (attribute(others), ...);
}

}  // namespace inverse_dynamics_tools

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Objects whose `__init__` hasn't run (`Solver.__new__(Solver)`): an error instead of a crash.
///
///     INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(inverse_dynamics_tools::Solver)   // before
///     class_<Solver>
///
/// pybind11 passes memory without an object in it to the methods of such an object.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace inverse_dynamics_tools {

/// Loads arguments of class T, self included.
///
/// @throws pybind11::type_error  an object that isn't initialized.
template <class T>
class InitializedCaster : public pybind11::detail::type_caster_base<T> {
 public:
  bool load(pybind11::handle source, bool convert) {
    if (pybind11::isinstance<T>(source)) requireInit(source);
    return pybind11::detail::type_caster_base<T>::load(source, convert);
  }

 private:
  static void requireInit(pybind11::handle object) {
    auto* const instance = reinterpret_cast<pybind11::detail::instance*>(object.ptr());
    if (!instance->owned) return;  // a part of another object
    for (const auto& part : pybind11::detail::values_and_holders(instance)) {
      if (part.holder_constructed()) continue;
      const std::string name = pybind11::str(pybind11::type::of(object).attr("__name__"));
      throw pybind11::type_error(name + ": an object without __init__; make it by calling " + name);
    }
  }
};

}  // namespace inverse_dynamics_tools

/// For each class that is bound.
#define INVERSE_DYNAMICS_TOOLS_REQUIRE_INIT(T)                                     \
  namespace pybind11::detail {                                                     \
  template <>                                                                      \
  class type_caster<T> : public ::inverse_dynamics_tools::InitializedCaster<T> {}; \
  }

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Structs of C++ as classes of Python, each from one list of its fields.
///
///     bindRecord<Effort>(module, "Effort", "What recorded efforts mean.",
///                        Field{"meaning", &Effort::meaning, "one of EFFORT_MEANINGS"},
///                        Field{"verdict", &Effort::verdict, "of the data; None: not asked"});
///     // Effort(meaning="torque", verdict=None): frozen, with what dataclasses have
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chain_dynamics/owned.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "annotations.hpp"
#include "vectors.hpp"

namespace inverse_dynamics_tools {

/// The types that Python passes and receives for a value of C++.
template <class Value>
struct InPython {
  using Given = Value;
  using Got = Value;
  static Got of(const Value& value) { return value; }
};
template <>
struct InPython<chain_dynamics::OwnedVector> {
  using Given = Eigen::VectorXd;
  using Got = Eigen::VectorXd;
  static Got of(const chain_dynamics::OwnedVector& value) { return value; }
};
template <>
struct InPython<chain_dynamics::OwnedMatrix> {
  using Given = Eigen::MatrixXd;
  using Got = Eigen::MatrixXd;
  static Got of(const chain_dynamics::OwnedMatrix& value) { return value; }
};
template <>
struct InPython<std::vector<std::string>> {
  using Given = std::vector<std::string>;
  using Got = NameTuple;
  static Got of(const Given& names) { return tupleOf(names); }
};
template <>
struct InPython<std::vector<double>> {
  using Given = std::vector<double>;
  using Got = NumberTuple;
  static Got of(const Given& numbers) { return pybind11::tuple(pybind11::cast(numbers)); }
};
template <>
struct InPython<std::optional<std::array<double, 3>>> {
  using Given = std::optional<std::array<double, 3>>;
  using Got = Numbers3OrNone;
  static Got of(const Given& numbers) {
    if (!numbers) return pybind11::none();
    return pybind11::tuple(pybind11::cast(*numbers));
  }
};

/// A field of T: how it is read and set.
template <class T, class GotType, class GivenType>
struct Field {
  using Got = GotType;
  using Given = GivenType;

  template <class Base, class Value>
  Field(const char* of_name, Value Base::*member, const char* meaning = "")
      : name(of_name),
        get([member](const T& t) { return InPython<Value>::of(t.*member); }),
        set([member](T& t, const Given& value) { t.*member = value; }),
        doc(meaning) {}
  Field(const char* of_name, std::function<Got(const T&)> how_to_get,
        std::function<void(T&, const Given&)> how_to_set, const char* meaning = "")
      : name(of_name), get(std::move(how_to_get)), set(std::move(how_to_set)), doc(meaning) {}

  const char* name;
  std::function<Got(const T&)> get;
  std::function<void(T&, const Given&)> set;
  const char* doc;
};
template <class T, class Value>
Field(const char*, Value T::*, const char* = "")
    -> Field<T, typename InPython<Value>::Got, typename InPython<Value>::Given>;

/// A field that T has from a base.
template <class T, class Base, class Value>
auto inherited(const char* name, Value Base::*member, const char* doc = "") {
  return Field<T, typename InPython<Value>::Got, typename InPython<Value>::Given>(name, member,
                                                                                  doc);
}

/// A constructor of all fields; the first `Required` have no default. With more than five fields,
/// the others are keyword-only. `doc`: docstring of the constructor.
template <std::size_t Required, class T, class... Fields, std::size_t... I>
void defineConstructor(pybind11::class_<T>& of, const char* doc, std::index_sequence<I...> /*all*/,
                       const Fields&... fields) {
  namespace py = pybind11;
  constexpr std::size_t kPositional = sizeof...(Fields) > 5 ? Required : sizeof...(Fields);
  const auto argument = [](auto number, const auto& field) {
    constexpr std::size_t kNumber = decltype(number)::value;
    const auto usual = [&] {
      if constexpr (kNumber < Required) {
        return py::arg(field.name);
      } else {
        return py::arg(field.name) = field.get(T());
      }
    };
    if constexpr (kNumber == kPositional) {
      return std::tuple(py::kw_only(), usual());
    } else {
      return std::tuple(usual());
    }
  };
  const auto make = [fields...](const typename Fields::Given&... values) {
    T made;
    (fields.set(made, values), ...);
    return made;
  };
  std::apply([&](const auto&... arguments) { of.def(py::init(make), arguments..., doc); },
             std::tuple_cat(argument(std::integral_constant<std::size_t, I>(), fields)...));
}

/// A docstring of numpydoc's style: of a class, and of its fields that have one.
template <class... Fields>
std::string documented(const std::string& doc, const Fields&... fields) {
  std::string text;
  const auto add = [&text](const auto& field) {
    if (*field.doc != 0) text += std::string(field.name) + "\n    " + field.doc + "\n";
  };
  (add(fields), ...);
  if (text.empty()) return doc;
  const std::size_t end = std::min(doc.find("\n\nExamples\n"), doc.size());
  return doc.substr(0, end) + "\n\nParameters\n----------\n" + text + doc.substr(end);
}

/// Whether two values of a field are the same; arrays entry by entry.
inline bool areSame(const pybind11::handle& a, const pybind11::handle& b) {
  if (!pybind11::isinstance<pybind11::array>(a)) return a.equal(b);
  return pybind11::module_::import("numpy").attr("array_equal")(a, b).cast<bool>();
}

/// A value of a field as a constructor may take it, on one line.
inline std::string shown(const pybind11::handle& value) {
  const bool is_array = pybind11::isinstance<pybind11::array>(value);
  return pybind11::repr(is_array ? value.attr("tolist")()
                                 : pybind11::reinterpret_borrow<pybind11::object>(value));
}

/// Comparing, showing and pickling by fields.
template <class T, class... Fields>
void defineByFields(pybind11::class_<T>& of, const char* name, const Fields&... fields) {
  namespace py = pybind11;
  const auto dict_of = [fields...](const T& t) {
    py::dict found;
    ((found[fields.name] = fields.get(t)), ...);
    return found;
  };
  of.def(
        "__eq__",
        [=](const T& a, const T& b) {
          const py::dict others = dict_of(b);
          for (const auto& [key, value] : dict_of(a)) {
            if (!areSame(value, others[key])) return false;
          }
          return true;
        },
        py::is_operator())
      .def("__repr__",
           [=](const T& t) {
             std::string text;
             for (const auto& [key, value] : dict_of(t)) {
               text += (text.empty() ? "" : ", ") + std::string(py::str(key)) + "=" + shown(value);
             }
             return name + ("(" + text + ")");
           })
      .def(py::pickle(dict_of, [](const py::dict& values) {
        return py::type::of<T>()(**values).template cast<T>();
      }));
}

/// Options: attributes that can be set; compared, shown and pickled by them. `meanings`: of the
/// constructor.
template <std::size_t Required = 1, class T, class... Gots, class... Givens>
pybind11::class_<T> bindOptions(pybind11::module_& module, const char* name, const char* doc,
                                const char* meanings, const Field<T, Gots, Givens>&... fields) {
  pybind11::class_<T> options(module, name, documented(doc, fields...).c_str());
  defineConstructor<Required>(options, meanings, std::index_sequence_for<Gots...>(), fields...);
  (options.def_property(fields.name, fields.get, fields.set, fields.doc), ...);
  defineByFields(options, name, fields...);
  return options;
}

/// A record: attributes that can't be set; compared, shown and pickled by them, and a dataclass to
/// dataclasses.replace() and asdict().
template <std::size_t Required = 0, class T, class... Gots, class... Givens>
pybind11::class_<T> bindRecord(pybind11::module_& module, const char* name, const char* doc,
                               const Field<T, Gots, Givens>&... fields) {
  namespace py = pybind11;
  py::class_<T> record(module, name, documented(doc, fields...).c_str());
  defineConstructor<Required>(record, "", std::index_sequence_for<Gots...>(), fields...);
  (record.def_property_readonly(fields.name, fields.get, fields.doc), ...);
  defineByFields(record, name, fields...);
  // Made on demand, once: importing dataclasses takes 9 ms, and each making of a class 3 ms.
  const py::tuple names = py::make_tuple(fields.name...);
  record.def_property_readonly_static(
      "__dataclass_fields__", [=, made = std::make_shared<py::object>()](const py::object&) {
        if (!*made) {
          const auto dataclasses = py::module_::import("dataclasses");
          *made = dataclasses.attr("make_dataclass")(name, names).attr("__dataclass_fields__");
        }
        return *made;
      });
  return record;
}

}  // namespace inverse_dynamics_tools

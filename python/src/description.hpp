// SPDX-License-Identifier: Apache-2.0
/// @file
/// Paths, and robot descriptions as Python gives them: the text of a URDF, or the path of a file.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <utility>

namespace inverse_dynamics_tools {

/// An argument `urdf`. A path is read by readDescription(), .xacro files included.
struct Description {
  std::string text, path;  ///< path: empty where the text was given
};

/// A path, or a text of a file, in the bytes that it has there: those that aren't UTF-8 are lone
/// surrogates in Python.
struct PathText {
  std::string bytes;
};

/// A text of a file as a Python string, in the way of PathText.
inline pybind11::str textOf(const std::string& text) {
  PyObject* const made = PyUnicode_DecodeUTF8(
      text.data(), static_cast<pybind11::ssize_t>(text.size()), "surrogateescape");
  if (made == nullptr) throw pybind11::error_already_set();
  return pybind11::reinterpret_steal<pybind11::str>(made);
}

/// The description in a file, as read_description() of Python reads it.
///
/// @throws RobotError  of Python: the file can't be read.
inline std::string readDescription(const pybind11::object& path) {
  const auto descriptions = pybind11::module_::import("inverse_dynamics.robots.descriptions");
  const auto as_path = pybind11::module_::import("pathlib").attr("Path");
  return descriptions.attr("read_description")(as_path(path)).cast<std::string>();
}

/// Whether a text names a file: no URDF ends like this.
inline bool namesDescription(const std::string& text) {
  const auto ends = [&text](const std::string& ending) {
    return text.size() > ending.size() &&
           text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
  };
  return ends(".urdf") || ends(".xacro");
}

}  // namespace inverse_dynamics_tools

namespace pybind11::detail {

/// As os.fsencode(); what no path can be is escaped, for errors to show it.
template <>
struct type_caster<inverse_dynamics_tools::PathText> {
  PYBIND11_TYPE_CASTER(inverse_dynamics_tools::PathText, const_name("str | os.PathLike[str]"));

  bool load(handle source, bool) {
    auto path = reinterpret_steal<object>(PyOS_FSPath(source.ptr()));
    if (!path) {
      PyErr_Clear();
      return false;
    }
    for (const char* errors : {"surrogateescape", "backslashreplace"}) {
      if (isinstance<bytes>(path)) break;
      auto encoded =
          reinterpret_steal<object>(PyUnicode_AsEncodedString(path.ptr(), "utf-8", errors));
      if (encoded) path = std::move(encoded);
      PyErr_Clear();
    }
    value.bytes = path.cast<std::string>();
    return true;
  }
};

template <>
struct type_caster<inverse_dynamics_tools::Description> {
  PYBIND11_TYPE_CASTER(inverse_dynamics_tools::Description, const_name("str | pathlib.Path"));

  bool load(handle source, bool) {
    const bool is_text = isinstance<str>(source);
    if (!is_text && !hasattr(source, "__fspath__")) return false;
    if (is_text) value.text = source.cast<std::string>();
    if (is_text && !inverse_dynamics_tools::namesDescription(value.text)) return true;
    value.text = inverse_dynamics_tools::readDescription(reinterpret_borrow<object>(source));
    value.path = str(source).cast<std::string>();
    return true;
  }
};

}  // namespace pybind11::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot description as Python gives it: the text of a URDF, or the path of a file.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace inverse_dynamics_tools {

/// An argument `urdf`. A path is read as read_description() of Python does, .xacro files included.
struct Description {
  std::string text;
};

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

template <>
struct type_caster<inverse_dynamics_tools::Description> {
  PYBIND11_TYPE_CASTER(inverse_dynamics_tools::Description, const_name("str | Path"));

  /// @throws RobotError  of Python: the file can't be read.
  bool load(handle source, bool) {
    const bool is_text = isinstance<str>(source);
    if (!is_text && !hasattr(source, "__fspath__")) return false;
    if (is_text) value.text = source.cast<std::string>();
    if (is_text && !inverse_dynamics_tools::namesDescription(value.text)) return true;
    const object path = module_::import("pathlib").attr("Path")(source);
    const auto descriptions = module_::import("inverse_dynamics.robot.descriptions");
    value.text = descriptions.attr("read_description")(path).cast<std::string>();
    return true;
  }
};

}  // namespace pybind11::detail

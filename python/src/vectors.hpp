// SPDX-License-Identifier: Apache-2.0
/// @file
/// Eigen's vectors as arguments and results: pybind11/eigen.h by itself accepts texts as
/// numbers.
#pragma once

#include <pybind11/eigen.h>

#include <Eigen/Core>

#include "arrays.hpp"

namespace pybind11::detail {

/// From an array (n,) or (n, 1) of numbers, or a sequence of them.
template <>
class type_caster<Eigen::VectorXd> {
 public:
  using Props = EigenProps<Eigen::VectorXd>;
  PYBIND11_TYPE_CASTER(Eigen::VectorXd, Props::descriptor);

  bool load(handle source, bool convert) {
    make_caster<inverse_dynamics_tools::Array> numbers;
    if (!numbers.load(source, convert)) return false;
    const auto& array = static_cast<inverse_dynamics_tools::Array&>(numbers);
    if (array.ndim() != 1 && !(array.ndim() == 2 && array.shape(1) == 1)) return false;
    value = Eigen::Map<const Eigen::VectorXd>(array.data(), array.shape(0));
    return true;
  }

  static handle cast(const Eigen::VectorXd& vector, return_value_policy /*policy*/,
                     handle /*parent*/) {
    return eigen_array_cast<Props>(vector);
  }
};

}  // namespace pybind11::detail

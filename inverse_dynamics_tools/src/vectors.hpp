// SPDX-License-Identifier: Apache-2.0
/// @file
/// Eigen's vectors as arguments and results: instead of pybind11/eigen.h alone, which takes texts for
/// numbers.
#pragma once

#include <pybind11/eigen.h>

#include <Eigen/Core>
#include <memory>

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

  /// A copy; of a member, a view that can't be written to.
  static handle cast(const Eigen::VectorXd& vector, return_value_policy policy, handle parent) {
    if (policy == return_value_policy::reference_internal) {
      return eigen_ref_array<Props>(vector, parent);
    }
    return eigen_array_cast<Props>(vector);
  }
  static handle cast(Eigen::VectorXd&& vector, return_value_policy /*policy*/, handle /*parent*/) {
    return eigen_array_cast<Props>(vector);
  }
};

/// An argument alone: a view of a copy.
template <>
class type_caster<Eigen::Ref<const Eigen::VectorXd>> : public type_caster<Eigen::VectorXd> {
 public:
  using Type = Eigen::Ref<const Eigen::VectorXd>;

  bool load(handle source, bool convert) {
    if (!type_caster<Eigen::VectorXd>::load(source, convert)) return false;
    view_ = std::make_unique<Type>(value);
    return true;
  }
  operator Type*() { return view_.get(); }
  operator Type&() { return *view_; }

 private:
  std::unique_ptr<Type> view_;
};

}  // namespace pybind11::detail

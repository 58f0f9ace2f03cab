// SPDX-License-Identifier: Apache-2.0
/// @file
/// Pinocchio's models and data of chains, of versions that keep them in other headers.
///
/// Pinocchio's algorithms are templates over a collection of joint types. Compiled for all 25 of its
/// own collection they cost two to four minutes and up to 4 GB per source file; chains have two.
#pragma once

#if __has_include(<pinocchio/multibody.hpp>)
#include <pinocchio/multibody.hpp>
#else
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>
#endif
#include <pinocchio/config.hpp>

namespace pinocchio_inverse_dynamics_solver {
inline namespace v2 {

/// The joints of chains: about and along z.
template <typename Number, int Alignment>
struct ChainJoints {
  using Revolute = pinocchio::JointModelRevoluteTpl<Number, Alignment, 2>;
  using Prismatic = pinocchio::JointModelPrismaticTpl<Number, Alignment, 2>;

  // What Pinocchio asks of a collection, by its names.
  using Scalar = Number;
  static constexpr int Options = Alignment;  // NOLINT(readability-identifier-naming)
  using JointModelVariant = boost::variant<Revolute, Prismatic>;
  using JointDataVariant = boost::variant<pinocchio::JointDataRevoluteTpl<Number, Alignment, 2>,
                                          pinocchio::JointDataPrismaticTpl<Number, Alignment, 2>>;
};

/// Pinocchio's model and data, with such joints.
using Model = pinocchio::ModelTpl<double, 0, ChainJoints>;
using Data = pinocchio::DataTpl<double, 0, ChainJoints>;

}  // namespace v2
}  // namespace pinocchio_inverse_dynamics_solver

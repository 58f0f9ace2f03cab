// SPDX-License-Identifier: Apache-2.0
/// @file
/// The checks of a call, the same for every method of solvers and capabilities, and the threads that
/// share a batch.
///
///     MethodCall("getTipJacobian", solver).vector("q", q).matrix("J", J, 6, q.size());
///
///     const BatchCall call("getTipJacobianBatch", solver, q.count);
///     call.states("q", q).matrices("J", J, 6, q.joints);
///     call.share([this](const ConstStates& q, const StridedMatrices& J) { ... }, q, J);
#pragma once

#include <Eigen/Core>
#include <chain_dynamics/share_states.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "inverse_dynamics_solver/inverse_dynamics_solver.hpp"

namespace inverse_dynamics_solver {
inline namespace v2 {

/// A call for one state. Throwing functions are out of line, so that the checks are inlined.
class MethodCall {
 public:
  /// @throws UninitializedException
  MethodCall(const char* method, const InverseDynamicsSolver& solver)
      : method_(method), solver_(solver) {
    if (!solver.initialized_) throwUninitialized();
  }

  /// Number of joints.
  Eigen::Index joints() const { return static_cast<Eigen::Index>(jointNames().size()); }

  /// One number per joint.
  template <class Vector>
  const MethodCall& vector(const char* argument, const Vector& values) const {
    if (values.size() != joints()) throwMismatch(argument, values.size());
    return *this;
  }

  /// The same, or nothing.
  template <class Vector>
  const MethodCall& vectorOrNothing(const char* argument, const Vector& values) const {
    return values.size() == 0 ? *this : vector(argument, values);
  }

  template <class Matrix>
  const MethodCall& matrix(const char* argument, const Matrix& values, Eigen::Index rows,
                           Eigen::Index cols) const {
    if (values.rows() != rows || values.cols() != cols) {
      throwMismatch(argument, rows, cols, values.rows(), values.cols());
    }
    return *this;
  }

  /// @throws SizeMismatchException  no positions, but friction depends on them.
  const MethodCall& positionsOfFriction(Eigen::Index size) const {
    if (size == 0) requirePositions();
    return *this;
  }

  /// @throws Exception  inertiaIsPhysical() is false.
  const MethodCall& physicalInertia() const {
    if (!solver_.inertiaIsPhysicalImpl()) throwUnphysical();
    return *this;
  }

 protected:
  [[noreturn]] void throwMismatch(const char* argument, Eigen::Index rows, Eigen::Index cols,
                                  Eigen::Index got_rows, Eigen::Index got_cols) const;
  std::int64_t batchThreads() const { return solver_.batch_threads_; }
  /// Calls compute() with a robot that doesn't change meanwhile.
  void whileUnchanged(const std::function<void()>& compute) const;

 private:
  const std::vector<std::string>& jointNames() const { return solver_.info_.joint_names; }
  [[noreturn]] void throwUninitialized() const;
  [[noreturn]] void throwMismatch(const char* argument, Eigen::Index size) const;
  [[noreturn]] void throwMismatch(const char* argument, const std::string& expected,
                                  const std::string& got) const;
  [[noreturn]] void throwUnphysical() const;
  void requirePositions() const;

  const char* method_;
  const InverseDynamicsSolver& solver_;
};

/// A call for many states.
class BatchCall : public MethodCall {
 public:
  /// @param count  N, that of the first argument.
  BatchCall(const char* method, const InverseDynamicsSolver& solver, Eigen::Index count)
      : MethodCall(method, solver), count_(count) {}

  /// One number per joint and state.
  const BatchCall& states(const char* argument, const ConstStates& values) const {
    return rows(argument, values, joints());
  }

  /// `rows` numbers per state.
  const BatchCall& rows(const char* argument, const ConstStates& values, Eigen::Index rows) const {
    if (values.joints != rows || values.count != count_) {
      throwMismatch(argument, rows, count_, values.joints, values.count);
    }
    return *this;
  }

  /// A matrix per state.
  const BatchCall& matrices(const char* argument, const StridedMatrices& values, Eigen::Index rows,
                            Eigen::Index columns) const {
    const StridedMatrices given = values.withColumns(columns);
    if (given.rows != rows || given.columns != columns || given.cols != columns * count_) {
      throwMismatch(argument, rows, columns * count_, given.rows, given.cols);
    }
    return *this;
  }

  /// Calls compute() with parts of the views, on as many threads as `batch_threads` allows.
  template <class Compute, class... Views>
  void share(const Compute& compute, const Views&... views) const {
    const auto parts = [&] {
      chain_dynamics::shareStates(
          count_, batchThreads(),
          [&](Eigen::Index first, Eigen::Index size) { compute(views.middle(first, size)...); });
    };
    whileUnchanged(std::cref(parts));
  }

 private:
  Eigen::Index count_;
};

}  // namespace v2
}  // namespace inverse_dynamics_solver

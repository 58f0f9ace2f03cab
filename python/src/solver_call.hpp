// SPDX-License-Identifier: Apache-2.0
/// @file
/// One call of a solver on numpy arrays: arguments checked, nothing copied that needs no copy.
///
///     SolverCall call("gravity_vector", solver.jointNames());
///     call.input("q", q);
///     call.result("out", out, {n});  // the caller's array, or None: a new one
///     call.run([&] { solver.getGravityVectorBatch(call.in(0), call.states(0)); });
///     return call.array(0);
///
/// Doubles are computed from and into where they are, whatever their layout. Other types are
/// copied, and so are doubles at addresses that no array of doubles has (fields of a packed
/// record).
#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <cstddef>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_tools {

/// Shape of an array, or of a result's part for each state: {} a number, {n}, {6, n}.
using Shape = std::vector<pybind11::ssize_t>;

class SolverCall {
 public:
  /// @param method       its name in Python: errors begin with it.
  /// @param joint_names  must live as long.
  SolverCall(const char* method, const std::vector<std::string>& joint_names)
      : method_(method),
        joint_names_(joint_names),
        n_(static_cast<Eigen::Index>(joint_names.size())) {}

  /// An argument (n,) or (N, n), N the same for all that have it; (n,) among them is one state for
  /// all. Columns of a table that are named like the joints are taken by name.
  ///
  /// @throws SizeMismatchException           another shape.
  /// @throws InvalidParameterValueException  not real numbers.
  void input(const char* name, const pybind11::object& values);

  /// Six numbers for all states, (6,), or for each, (N, 6). Throws as input() does.
  void wrench(const char* name, const pybind11::object& values);

  /// A result of this shape for each state.
  ///
  /// @param out  None, or an array of doubles of any layout that shares no memory with others.
  /// @throws SizeMismatchException           another shape.
  /// @throws InvalidParameterValueException  an array that can't be written to as it is.
  void result(const std::string& name, const pybind11::object& out, const Shape& of_each);

  /// The i-th argument; the i-th result, of vectors or numbers, or of matrices.
  inverse_dynamics_solver::ConstStates in(std::size_t i) const;
  inverse_dynamics_solver::States states(std::size_t i) const;
  inverse_dynamics_solver::StridedMatrices matrices(std::size_t i) const;

  /// Calls compute() without the GIL.
  template <class Compute>
  void run(Compute compute) const {
    const pybind11::gil_scoped_release release;
    compute();
  }

  const char* method() const { return method_; }
  Eigen::Index count() const { return count_; }
  pybind11::object array(std::size_t i) const { return results_[i].array; }

 private:
  struct Argument {
    std::string name;
    pybind11::array array;
  };

  std::string place(const std::string& argument) const;
  pybind11::object byJoint(const char* name, const pybind11::object& values) const;
  pybind11::array numbersFrom(const char* name, const pybind11::object& values) const;
  Shape perState(const Shape& of_each) const;
  void requireShape(const char* name, const pybind11::array& array) const;
  pybind11::array outOf(const std::string& name, const pybind11::object& out,
                        const Shape& shape) const;
  void requireOwnMemory(const Argument& result) const;
  [[noreturn]] void refuse(const std::string& name, const std::string& expected,
                           const std::string& got) const;

  const char* method_;
  const std::vector<std::string>& joint_names_;
  Eigen::Index n_, count_ = 0;
  Shape shape_;         // of the first argument (N, n), else of the first
  std::string shaped_;  // its name
  std::vector<Argument> inputs_, results_;
};

/// Some states of a call: all, or those of one thread.
struct PartOfCall {
  const SolverCall& call;
  Eigen::Index first, size;

  auto in(std::size_t i) const { return call.in(i).middle(first, size); }
  auto states(std::size_t i) const { return call.states(i).middle(first, size); }
  auto matrices(std::size_t i) const { return call.matrices(i).middle(first, size); }
};

}  // namespace inverse_dynamics_tools

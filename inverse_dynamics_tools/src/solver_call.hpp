// SPDX-License-Identifier: Apache-2.0
/// @file
/// One call of a solver on numpy arrays: arguments checked, nothing copied that needs no copy.
///
///     SolverCall call("gravity_vector", solver);
///     call.input("q", q);
///     call.vectors("out", out);  // the caller's array, or None: a new one
///     call.run([&] { solver.getGravityVectorBatch(call.in(0), call.states(0)); });
///     return call.result(0);
///
/// Doubles are computed from and into where they are, whatever their layout. Other types are
/// copied, and so are doubles at addresses that no array of doubles has (fields of a packed
/// record).
#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_tools {

class SolverCall {
 public:
  /// @param method  its name in Python: errors begin with it.
  SolverCall(const char* method, const inverse_dynamics_solver::InverseDynamicsSolver& solver)
      : SolverCall(method, solver.jointNames()) {}

  /// Of a class that isn't a solver; joint_names must live as long.
  SolverCall(const char* method, const std::vector<std::string>& joint_names)
      : method_(method),
        joint_names_(joint_names),
        n_(static_cast<Eigen::Index>(joint_names.size())) {}

  /// An argument (n,) or (N, n); all have the shape of the first.
  ///
  /// @throws SizeMismatchException           another shape.
  /// @throws InvalidParameterValueException  not real numbers.
  void input(const char* name, const pybind11::object& values);

  /// Six numbers for all states, (6,), or for each, (N, 6).
  ///
  /// @throws SizeMismatchException           another shape.
  /// @throws InvalidParameterValueException  not real numbers.
  void wrench(const char* name, const pybind11::object& values);

  /// A result of n numbers per state, in the shape of the first argument, or of `rows`.
  ///
  /// @param out  None, or an array of doubles of any layout that shares no memory with others.
  /// @throws SizeMismatchException           another shape.
  /// @throws InvalidParameterValueException  an array that can't be written to as it is.
  void vectors(const std::string& name, const pybind11::object& out);
  void vectors(const std::string& name, const pybind11::object& out, Eigen::Index rows);

  /// A result of one number per state, () or (N,): as vectors().
  void numbers(const std::string& name, const pybind11::object& out);

  /// A result of a matrix per state: as vectors().
  void matrices(const std::string& name, const pybind11::object& out, Eigen::Index rows,
                Eigen::Index columns);

  /// The i-th argument; the wrenches; the i-th result, which is one of vectors, of numbers, of
  /// matrices.
  inverse_dynamics_solver::ConstStates in(std::size_t i) const;
  inverse_dynamics_solver::ConstStates wrenches() const;
  inverse_dynamics_solver::States states(std::size_t i) const;
  inverse_dynamics_solver::States numbersOf(std::size_t i) const;
  inverse_dynamics_solver::StridedMatrices matricesOf(std::size_t i) const;

  /// Calls compute() without the GIL.
  template <class Compute>
  void run(Compute compute) const {
    const pybind11::gil_scoped_release release;
    compute();
  }

  Eigen::Index count() const { return count_; }
  pybind11::object result(std::size_t i) const { return results_[i].array; }

 private:
  struct Argument {
    std::string name;
    pybind11::array array;
  };

  std::string place(const std::string& argument) const;
  pybind11::array numbersFrom(const char* name, const pybind11::object& values) const;
  std::vector<pybind11::ssize_t> perState(const std::vector<Eigen::Index>& of_each) const;
  void requireShape(const char* name, const pybind11::array& array) const;
  void addResult(const std::string& name, const pybind11::object& out,
                 const std::vector<pybind11::ssize_t>& shape);
  pybind11::array outOf(const std::string& name, const pybind11::object& out,
                        const std::vector<pybind11::ssize_t>& shape) const;
  void requireOwnMemory(const Argument& result) const;
  [[noreturn]] void refuse(const std::string& name, const std::string& expected,
                           const std::string& got) const;

  const char* method_;
  const std::vector<std::string>& joint_names_;
  Eigen::Index n_, count_ = 0;
  std::vector<pybind11::ssize_t> shape_;  // of the first argument
  std::vector<Argument> inputs_, results_;
  std::size_t wrench_ = 0;  // which input it is
};

}  // namespace inverse_dynamics_tools

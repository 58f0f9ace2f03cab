// SPDX-License-Identifier: Apache-2.0
/// @file
/// One call of a solver on numpy arrays: arguments checked, nothing copied that needs no copy.
///
///     SolverCall call("gravity_vector", solver);
///     call.input("q", q);
///     call.vectors("out", out);  // the caller's array, or None: a new one
///     call.run([&](const auto& in, auto& result) {
///       solver.getGravityVectorBatch(in[0], result[0]);
///     });
///     return call.result(0);
///
/// Doubles that stand row after row are computed from where they are. Other layouts (states as
/// columns, every tenth state) are copied a tile of states at a time; other types as a whole.
#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <algorithm>
#include <inverse_dynamics_solver/inverse_dynamics_solver.hpp>
#include <string>
#include <vector>

namespace inverse_dynamics_tools {

class SolverCall {
 public:
  using Inputs = std::vector<Eigen::Map<const Eigen::MatrixXd>>;
  using Results = std::vector<Eigen::Map<Eigen::MatrixXd>>;

  /// @param method  its name in Python: errors begin with it.
  SolverCall(const char* method, const inverse_dynamics_solver::InverseDynamicsSolver& solver)
      : method_(method), joint_names_(solver.jointNames()), n_(solver.jointCount()) {}

  /// An argument (n,) or (N, n); all have the shape of the first.
  ///
  /// @throws SizeMismatchException           another shape.
  /// @throws InvalidParameterValueException  not real numbers.
  void input(const char* name, const pybind11::object& values);

  /// A result of n numbers per state, in the shape of the first argument.
  ///
  /// @param out  None, or an array of doubles, row after row, that shares no memory with others.
  /// @throws SizeMismatchException           another shape.
  /// @throws InvalidParameterValueException  an array that can't be written to as it is.
  void vectors(const std::string& name, const pybind11::object& out);

  /// A result of n x n numbers per state: as vectors(). The matrices of `out` may stand row after
  /// row or column after column in memory; those of a new array stand column after column.
  void matrices(const std::string& name, const pybind11::object& out);

  /// Calls compute(Inputs, Results &) without the GIL, with one state a column: once, or a tile at
  /// a time if an argument isn't contiguous.
  template <class Compute>
  void run(Compute compute) {
    const pybind11::gil_scoped_release release;
    const Eigen::Index tile = isContiguous() ? count_ : std::min(count_, kTile);
    for (Eigen::Index first = 0; first < count_; first += tile) {
      const Eigen::Index count = std::min(tile, count_ - first);
      const Inputs inputs = inputsAt(first, count);
      Results results = resultsAt(first, count);
      compute(inputs, results);
    }
    turnMatrices();
  }

  pybind11::object result(std::size_t i) const { return results_[i].array; }

 private:
  /// States copied at a time: 3 arguments of 7 joints are 42 kB, which stays in the cache.
  static constexpr Eigen::Index kTile = 256;

  struct Input {
    const char* name;
    pybind11::array array;
    const char* data;
    Eigen::Index state_stride, joint_stride;  // bytes
    bool contiguous;
    Eigen::MatrixXd tile;
  };
  struct Result {
    std::string name;
    pybind11::array array;
    double* data;
    Eigen::Index columns;  // per state
    bool turned;           // matrices row after row: transposed when computed
  };

  std::string place(const std::string& argument) const;
  void requireShape(const char* name, const pybind11::array& array) const;
  void requireShapeOfResult(const std::string& name, const pybind11::array& array,
                            const std::vector<pybind11::ssize_t>& shape) const;
  pybind11::array outOf(const std::string& name, const pybind11::object& out,
                        const std::vector<pybind11::ssize_t>& shape) const;
  void requireOwnMemory(const Result& result) const;
  [[noreturn]] void refuse(const std::string& name, const std::string& expected,
                           const std::string& got) const;

  bool isContiguous() const;
  Inputs inputsAt(Eigen::Index first, Eigen::Index count);
  Results resultsAt(Eigen::Index first, Eigen::Index count);
  void turnMatrices();

  const char* method_;
  const std::vector<std::string>& joint_names_;
  Eigen::Index n_, count_ = 0;
  std::vector<pybind11::ssize_t> shape_;  // of the first argument
  std::vector<Input> inputs_;
  std::vector<Result> results_;
};

}  // namespace inverse_dynamics_tools

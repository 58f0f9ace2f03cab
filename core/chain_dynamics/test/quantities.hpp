// SPDX-License-Identifier: Apache-2.0

/// @file
/// Everything that is computed of a state, by the templates and by FastModel, of one state and of many: what
/// tests of values, unknown numbers, memory and stack go through.
///
///     OneState one(randomState(model.chain, 1));
///     for (const auto& [name, call] : one.callsOf(fast)) call();
///     const Quantities found = one.results();
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "chain_dynamics/fast_model.hpp"
#include "example_models.hpp"

namespace chain_dynamics::test {

/// Matrices by the names of the quantities.
using Quantities = std::map<std::string, Eigen::MatrixXd>;

/// Functions by name; each computes one quantity, or several.
using Calls = std::map<std::string, std::function<void()>>;

/// A state, and memory for what is computed of it. Torques to move by are numbers like its accelerations.
class OneState {
 public:
  explicit OneState(const State<double>& x);

  /// By the templates; accelerations are left out, as not every model has them.
  Calls callsOf(const Model& model);
  Calls callsOf(const FastModel& fast);
  Quantities results() const;

 private:
  State<double> x_;
  Eigen::MatrixXd H_, H_of_components_, C_, by_q_, by_qd_, by_qdd_, J_, dJ_, Y_;
  Eigen::VectorXd tau_, c_, g_, f_, c_of_components_, g_of_components_, qdd_;
  Matrix3<double> R_;
  Eigen::Vector3d p_;
};

/// Results of all calls; by the templates, accelerations that solve H qdd = tau - c - g - f.
Quantities plain(const Model& model, const State<double>& x);
Quantities single(const FastModel& fast, const State<double>& x);

/// From a row, a column and a matrix to the next one, in numbers, for `count` matrices.
struct Layout {
  std::string name;
  std::function<Eigen::Vector3<Index>(Index rows, Index columns, Index count)> steps;
};

/// As Eigen and as numpy have them, a state at a time or a joint at a time; with gaps; backwards.
std::vector<Layout> layouts();

/// Matrices in memory of some layout, all of it NaN to begin with.
class Numbers {
 public:
  Numbers(Index rows, Index columns, Index count, const Layout& layout);
  double& operator()(Index i, Index j, Index k);
  Eigen::MatrixXd of(Index k) const;
  /// Of one column each.
  States states() { return {first(), rows_, count_, steps_[0], steps_[2]}; }
  StridedMatrices matrices() {
    return {first(), rows_, columns_, count_, steps_[0], steps_[1], steps_[2]};
  }
  /// Whether what is between the numbers is still NaN.
  bool isNanBetween() const;

 private:
  double* first() { return memory_.data() + offset_; }
  Index rows_, columns_, count_;
  Eigen::Vector3<Index> steps_;
  Index offset_ = 0;
  Eigen::VectorXd memory_;
};

/// As OneState, for states of n joints in some layout.
class ManyStates {
 public:
  ManyStates(const std::vector<State<double>>& states, Index n, const Layout& layout);
  Calls callsOf(const FastModel& fast);
  Quantities results(Index k) const;
  bool isNanBetween() const;

 private:
  std::map<std::string, Numbers> numbers_;
};

/// Results of all calls, one per state.
std::vector<Quantities> batch(const FastModel& fast, const std::vector<State<double>>& states,
                              Index n, const Layout& layout);

/// Found and expected quantities agree, in proportion to the terms that they are added up from.
void expectEqual(const Quantities& found, const Quantities& expected, const Model& model,
                 const State<double>& x, double tolerance);

}  // namespace chain_dynamics::test

// SPDX-License-Identifier: Apache-2.0

#include "quantities.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "chain_dynamics/coriolis_matrix.hpp"
#include "chain_dynamics/regressor.hpp"
#include "chain_dynamics/tip_kinematics.hpp"

namespace chain_dynamics::test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNotWritten = 77;
const char* const kInputs[] = {"input q", "input qd", "input qdd"};

/// What lengths are added up from.
double reach(const Chain& chain, const VectorXd& q) {
  double length = 1 + chain.tip().p.norm() + q.cwiseAbs().sum();
  for (const Joint& joint : chain.joints()) length += joint.placement.p.norm();
  return length;
}

}  // namespace

// --- one state ---

OneState::OneState(const State<double>& x) : x_(x) {
  const Index n = x.q.size();
  // a row too many, to see that nothing is written between the columns
  H_ = MatrixXd::Constant(n + 1, n, kNotWritten);
  H_of_components_ = C_ = by_q_ = by_qd_ = by_qdd_ = H_;
  J_ = dJ_ = MatrixXd::Constant(7, n, kNotWritten);
  Y_ = MatrixXd::Constant(n + 1, 10 * n, kNotWritten);
  tau_ = c_ = g_ = f_ = c_of_components_ = g_of_components_ = qdd_ = VectorXd(n);
}

Calls OneState::callsOf(const Model& model) {
  const Index n = x_.q.size();
  return {
      {"tau",
       [this, &model] {
         torques(model, x_.q, x_.qd, x_.qdd, tau_);
         frictionVector(model, x_.q, x_.qd, qdd_);
         tau_ += qdd_;
       }},
      {"H", [this, &model, n] { inertiaMatrix(model, x_.q, H_.topRows(n)); }},
      {"c", [this, &model] { coriolisVector(model, x_.q, x_.qd, c_); }},
      {"g", [this, &model] { gravityVector(model, x_.q, g_); }},
      {"f", [this, &model] { frictionVector(model, x_.q, x_.qd, f_); }},
      {"components",
       [this, &model, n] {
         dynamicComponents(model, x_.q, x_.qd, H_of_components_.topRows(n), c_of_components_,
                           g_of_components_);
       }},
      {"derivatives",
       [this, &model, n] {
         torqueDerivatives(model, x_.q, x_.qd, x_.qdd, by_q_.topRows(n), by_qd_.topRows(n),
                           by_qdd_.topRows(n));
         addFrictionDerivatives(model, x_.q, x_.qd, by_q_.topRows(n), by_qd_.topRows(n));
       }},
      {"C", [this, &model, n] { coriolisMatrix(model, x_.q, x_.qd, C_.topRows(n)); }},
      {"regressor",
       [this, &model, n] { regressor(model.chain, x_.q, x_.qd, x_.qdd, Y_.topRows(n)); }},
      {"tip",
       [this, &model] {
         const Transform<double> tip = tipPose(model.chain, x_.q);
         R_ = tip.R;
         p_ = tip.p;
       }},
      {"J", [this, &model] { tipJacobian(model.chain, x_.q, J_.topRows(6)); }},
      {"dJ", [this, &model] { tipJacobianDerivative(model.chain, x_.q, x_.qd, dJ_.topRows(6)); }}};
}

Calls OneState::callsOf(const FastModel& fast) {
  const double *const q = x_.q.data(), *const qd = x_.qd.data(), *const qdd = x_.qdd.data();
  const Index step = x_.q.size() + 1;
  return {{"tau", [=, &fast] { fast.torques(q, qd, qdd, tau_.data()); }},
          {"H", [=, &fast] { fast.inertiaMatrix(q, H_.data(), step); }},
          {"c", [=, &fast] { fast.coriolisVector(q, qd, c_.data()); }},
          {"g", [=, &fast] { fast.gravityVector(q, g_.data()); }},
          {"f", [=, &fast] { fast.frictionVector(q, qd, f_.data()); }},
          {"components",
           [=, &fast] {
             fast.dynamicComponents(q, qd, H_of_components_.data(), step, c_of_components_.data(),
                                    g_of_components_.data());
           }},
          {"derivatives",
           [=, &fast] {
             fast.torqueDerivatives(q, qd, qdd, by_q_.data(), by_qd_.data(), by_qdd_.data(), step);
           }},
          {"C", [=, &fast] { fast.coriolisMatrix(q, qd, C_.data(), step); }},
          {"regressor", [=, &fast] { fast.regressor(q, qd, qdd, Y_.data(), step); }},
          {"tip", [=, &fast] { fast.tipPose(q, R_.data(), p_.data()); }},
          {"J", [=, &fast] { fast.tipJacobian(q, J_.data(), 7); }},
          {"dJ", [=, &fast] { fast.tipJacobianDerivative(q, qd, dJ_.data(), 7); }},
          {"forward dynamics", [=, &fast] { fast.forwardDynamics(q, qd, qdd, qdd_.data()); }}};
}

Quantities OneState::results() const {
  const Index n = x_.q.size();
  for (const MatrixXd* matrix :
       {&H_, &H_of_components_, &C_, &by_q_, &by_qd_, &by_qdd_, &J_, &dJ_, &Y_}) {
    EXPECT_TRUE((matrix->bottomRows(1).array() == kNotWritten).all()) << "written between columns";
  }
  return {{"tau", tau_},
          {"H", H_.topRows(n)},
          {"c", c_},
          {"g", g_},
          {"f", f_},
          {"H of components", H_of_components_.topRows(n)},
          {"c of components", c_of_components_},
          {"g of components", g_of_components_},
          {"by q", by_q_.topRows(n)},
          {"by qd", by_qd_.topRows(n)},
          {"by qdd", by_qdd_.topRows(n)},
          {"C", C_.topRows(n)},
          {"Y", Y_.topRows(n)},
          {"R", R_},
          {"p", p_},
          {"J", J_.topRows(6)},
          {"dJ", dJ_.topRows(6)},
          {"qdd", qdd_}};
}

Quantities plain(const Model& model, const State<double>& x) {
  OneState state(x);
  for (const auto& [name, call] : state.callsOf(model)) call();
  Quantities all = state.results();
  const VectorXd rest = x.qdd - all["c"] - all["g"] - all["f"];
  all["qdd"] = all["H"].partialPivLu().solve(rest);
  return all;
}

Quantities single(const FastModel& fast, const State<double>& x) {
  OneState state(x);
  for (const auto& [name, call] : state.callsOf(fast)) call();
  return state.results();
}

// --- many states ---

std::vector<Layout> layouts() {
  using Steps = Eigen::Vector3<Index>;
  return {{"columns", [](Index m, Index n, Index) { return Steps(1, m, m * n); }},
          {"rows", [](Index m, Index n, Index) { return Steps(n, 1, m * n); }},
          {"states side by side", [](Index m, Index, Index N) { return Steps(N, N * m, 1); }},
          {"gaps", [](Index m, Index n, Index) { return Steps(2, 2 * m, 2 * m * n + 3); }},
          {"backwards", [](Index m, Index n, Index) { return Steps(-1, -m, -m * n); }}};
}

Numbers::Numbers(Index rows, Index columns, Index count, const Layout& layout)
    : rows_(rows), columns_(columns), count_(count), steps_(layout.steps(rows, columns, count)) {
  offset_ = steps_.cwiseAbs().dot(Eigen::Vector3<Index>(rows, columns, count));
  memory_ = VectorXd::Constant(2 * offset_ + 1, std::numeric_limits<double>::quiet_NaN());
}

double& Numbers::operator()(Index i, Index j, Index k) {
  return memory_[offset_ + steps_.dot(Eigen::Vector3<Index>(i, j, k))];
}

MatrixXd Numbers::of(Index k) const {
  Numbers copy = *this;
  return MatrixXd::NullaryExpr(rows_, columns_, [&](Index i, Index j) { return copy(i, j, k); });
}

bool Numbers::isNanBetween() const {
  Numbers copy = *this;
  for (Index k = 0; k < count_; ++k) {
    for (Index j = 0; j < columns_; ++j) {
      for (Index i = 0; i < rows_; ++i) copy(i, j, k) = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return copy.memory_.array().isNaN().all();
}

ManyStates::ManyStates(const std::vector<State<double>>& states, Index n, const Layout& layout) {
  const auto count = static_cast<Index>(states.size());
  const auto add = [&](const std::string& name, Index rows, Index columns) -> Numbers& {
    return numbers_.emplace(name, Numbers(rows, columns, count, layout)).first->second;
  };
  for (const auto& [name, vector] :
       {std::pair(kInputs[0], &State<double>::q), std::pair(kInputs[1], &State<double>::qd),
        std::pair(kInputs[2], &State<double>::qdd)}) {
    Numbers& numbers = add(name, n, 1);
    for (Index k = 0; k < count; ++k) {
      for (Index j = 0; j < n; ++j) {
        numbers(j, 0, k) = (states[static_cast<std::size_t>(k)].*vector)[j];
      }
    }
  }
  for (const char* name : {"tau", "c", "g", "f", "c of components", "g of components", "qdd"}) {
    add(name, n, 1);
  }
  for (const char* name : {"H", "H of components", "by q", "by qd", "by qdd", "C"}) add(name, n, n);
  for (const char* name : {"J", "dJ"}) add(name, 6, n);
  add("Y", n, 10 * n);
  add("R", 3, 3);
  add("p", 3, 1);
}

Calls ManyStates::callsOf(const FastModel& fast) {
  const auto vectors = [this](const std::string& name) { return numbers_.at(name).states(); };
  const auto matrices = [this](const std::string& name) { return numbers_.at(name).matrices(); };
  const States q = vectors(kInputs[0]), qd = vectors(kInputs[1]), qdd = vectors(kInputs[2]);
  const States tau = vectors("tau"), c = vectors("c"), g = vectors("g"), f = vectors("f");
  const States c_of_components = vectors("c of components"), p = vectors("p");
  const States g_of_components = vectors("g of components"), accelerations = vectors("qdd");
  const StridedMatrices H = matrices("H"), C = matrices("C"), Y = matrices("Y");
  const StridedMatrices H_of_components = matrices("H of components"), R = matrices("R");
  const StridedMatrices by_q = matrices("by q"), by_qd = matrices("by qd");
  const StridedMatrices by_qdd = matrices("by qdd"), J = matrices("J"), dJ = matrices("dJ");
  return {
      {"tau", [=, &fast] { fast.torquesBatch(q, qd, qdd, tau); }},
      {"H", [=, &fast] { fast.inertiaMatrixBatch(q, H); }},
      {"c", [=, &fast] { fast.coriolisVectorBatch(q, qd, c); }},
      {"g", [=, &fast] { fast.gravityVectorBatch(q, g); }},
      {"f", [=, &fast] { fast.frictionVectorBatch(q, qd, f); }},
      {"components",
       [=, &fast] {
         fast.dynamicComponentsBatch(q, qd, H_of_components, c_of_components, g_of_components);
       }},
      {"derivatives", [=, &fast] { fast.torqueDerivativesBatch(q, qd, qdd, by_q, by_qd, by_qdd); }},
      {"C", [=, &fast] { fast.coriolisMatrixBatch(q, qd, C); }},
      {"regressor", [=, &fast] { fast.regressorBatch(q, qd, qdd, Y); }},
      {"tip", [=, &fast] { fast.tipPoseBatch(q, R, p); }},
      {"J", [=, &fast] { fast.tipJacobianBatch(q, J); }},
      {"dJ", [=, &fast] { fast.tipJacobianDerivativeBatch(q, qd, dJ); }},
      {"forward dynamics", [=, &fast] { fast.forwardDynamicsBatch(q, qd, qdd, accelerations); }}};
}

Quantities ManyStates::results(Index k) const {
  Quantities all;
  for (const auto& [name, numbers] : numbers_) all[name] = numbers.of(k);
  for (const char* name : kInputs) all.erase(name);
  return all;
}

bool ManyStates::isNanBetween() const {
  return std::all_of(numbers_.begin(), numbers_.end(),
                     [](const auto& entry) { return entry.second.isNanBetween(); });
}

std::vector<Quantities> batch(const FastModel& fast, const std::vector<State<double>>& states,
                              Index n, const Layout& layout) {
  ManyStates all(states, n, layout);
  for (const auto& [name, call] : all.callsOf(fast)) call();
  EXPECT_TRUE(all.isNanBetween()) << "written between the numbers";
  std::vector<Quantities> results;
  for (Index k = 0; k < static_cast<Index>(states.size()); ++k) results.push_back(all.results(k));
  return results;
}

// --- comparison ---

void expectEqual(const Quantities& found, const Quantities& expected, const Model& model,
                 const State<double>& x, double tolerance) {
  const auto size = [&](const std::string& name) { return largest(expected.at(name)); };
  const MatrixXd& H = expected.at("H");
  const double length = reach(model.chain, x.q);
  const double speed = std::max(1.0, largest(x.qd));
  const double all_speeds = std::max(1.0, x.qd.cwiseAbs().sum());
  const double coriolis = size("c") + largest(H) * std::max(1.0, x.qd.squaredNorm());
  const double rate = largest(H) * speed + size("by qd");
  const double torque = coriolis + std::max(1.0, size("g")) + std::max(1.0, size("f"));
  // how large the terms are that each quantity is added up from
  const std::map<std::string, double> scales = {
      {"H", largest(H)},
      {"H of components", largest(H)},
      {"c", coriolis},
      {"c of components", coriolis},
      {"g", std::max(1.0, size("g"))},
      {"g of components", std::max(1.0, size("g"))},
      {"f", std::max(1.0, size("f"))},
      {"tau", torque + largest(H.cwiseAbs() * x.qdd.cwiseAbs())},
      {"by q", size("by q") + rate * speed},
      {"by qd", rate},
      {"by qdd", largest(H)},
      {"C", size("C") + largest(H) * all_speeds},
      {"Y", size("Y")},
      {"R", 1},
      {"p", length},
      {"J", length},
      {"dJ", length * all_speeds}};
  for (const auto& [name, scale] : scales) {
    EXPECT_TRUE(agree(found.at(name), expected.at(name), scale, tolerance)) << name;
  }
  // accelerations that differ much have nearly the same torques where H is nearly singular
  const MatrixXd& qdd = expected.at("qdd");
  const MatrixXd difference = found.at("qdd") - qdd;
  const double terms = largest(H.cwiseAbs() * qdd.cwiseAbs()) + torque + largest(x.qdd);
  EXPECT_LE(largest(H * difference), tolerance * terms) << "accelerations";
}

}  // namespace chain_dynamics::test

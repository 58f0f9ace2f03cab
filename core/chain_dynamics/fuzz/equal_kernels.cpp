// SPDX-License-Identifier: Apache-2.0

#include "equal_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "chain_dynamics/fast_model.hpp"

namespace chain_dynamics::fuzz {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Each of n joints adds some hundred operations, each off by half a unit in the last place
/// (1.1e-16) of the largest term: 1e-14 per joint, where all errors go in one direction.
double rounding(const Model& model) {
  return 1e-14 * static_cast<double>(model.chain.jointCount() + 1);
}

/// largestTerm() of one parameter set; linear: how the root accelerates, with gravity.
double largestTerm(const Chain& chain, const std::vector<LinkParameters>& links, const State& x,
                   double linear) {
  const Index n = chain.jointCount();
  std::vector<double> force(static_cast<std::size_t>(n)), moment(force), arm(force);
  double w = 0, v = 0, angular = 0;
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Joint& joint = chain.joints()[k];
    const double speed = std::abs(x.qd[i]), change = std::abs(x.qdd[i]);
    arm[k] = joint.placement.p.norm();
    if (isPrismatic(joint)) arm[k] += std::abs(x.q[i]);
    linear += angular * arm[k];
    v += w * arm[k];
    if (isPrismatic(joint)) {
      linear += change + w * speed;
      v += speed;
    } else {
      linear += v * speed;
      angular += change + w * speed;
      w += speed;
    }
    // f = I a + v x* (I v)
    const double m = std::abs(links[k].mass), mc = links[k].first_moment.norm(),
                 I = links[k].inertia.norm();
    const double momentum = m * v + mc * w;
    force[k] = m * linear + mc * angular + w * momentum;
    moment[k] = mc * linear + I * angular + w * (mc * v + I * w) + v * momentum;
    moment[k] += joint.rotor_inertia * change;
  }
  double largest = 0, outer_force = 0, outer_moment = 0;
  for (Index i = n; i-- > 0;) {
    const auto k = static_cast<std::size_t>(i);
    outer_force += force[k];
    outer_moment += moment[k];
    largest = std::max({largest, outer_force, outer_moment});
    outer_moment += arm[k] * outer_force;
  }
  return largest;
}

/// load: the largest term of the gravity torques.
double largestFriction(const Model& model, const VectorXd& qd, double load) {
  const double speed = qd.cwiseAbs().maxCoeff();
  double largest = 0;
  for (const FrictionLaw& law : model.friction) {
    const FrictionForm form = formOf(law);
    // the rounding of the exponent, times the steepest slope of the step
    const double exponent = std::abs(form.alpha) * (speed + std::abs(form.shift));
    const double height = std::abs(form.A) + form.fl * load + form.fs;
    largest = std::max(largest, std::abs(form.fv) * speed + std::abs(form.fc) + std::abs(form.fo) +
                                    2 * height * (1 + exponent / 4));
  }
  return largest;
}

/// What a model gives, and how much of each may be rounding.
struct Terms {
  explicit Terms(Index n) : H(n, n), c(n), g(n), f(n), tau(n) {}
  MatrixXd H;
  VectorXd c, g, f, tau;
};

void require(const MatrixXd& fast, const MatrixXd& plain, double allowed, const std::string& what) {
  // entry by entry: the largest of numbers of which one is NaN may be any of them
  if (((fast - plain).array().abs() <= allowed).all()) return;
  const double largest = (fast - plain).cwiseAbs().maxCoeff();
  std::fprintf(stderr, "%s: differs by %g, expected at most %g\n", what.c_str(), largest, allowed);
  std::abort();
}

Terms plainTerms(const Model& model, const State& x) {
  Terms terms(x.q.size());
  dynamicComponents(model, x.q, x.qd, terms.H, terms.c, terms.g);
  frictionVector(model, x.q, x.qd, terms.f);
  torques(model, x.q, x.qd, x.qdd, terms.tau);
  terms.tau += terms.f;
  return terms;
}

Terms fastTerms(const FastModel& fast, const State& x) {
  Terms terms(x.q.size());
  fast.dynamicComponents(x.q.data(), x.qd.data(), terms.H.data(), x.q.size(), terms.c.data(),
                         terms.g.data());
  fast.frictionVector(x.q.data(), x.qd.data(), terms.f.data());
  fast.torques(x.q.data(), x.qd.data(), x.qdd.data(), terms.tau.data());
  return terms;
}

/// The state in the middle of a batch of others.
Terms batchTerms(const FastModel& fast, const State& x) {
  constexpr Index kStates = 11, kAt = 9;  // more than the widest pack has lanes
  const Index n = x.q.size();
  const auto states = [](const VectorXd& of_state) -> MatrixXd {
    MatrixXd all = of_state.replicate(1, kStates);
    all.leftCols(kAt) *= 0.5;
    return all;
  };
  MatrixXd H(n, n * kStates), c(n, kStates), g(c), f(c), tau(c);
  fast.dynamicComponentsBatch(states(x.q), states(x.qd), H, c, g);
  fast.frictionVectorBatch(states(x.q), states(x.qd), f);
  fast.torquesBatch(states(x.q), states(x.qd), states(x.qdd), tau);
  Terms terms(n);
  terms.H = H.middleCols(kAt * n, n);
  terms.c = c.col(kAt);
  terms.g = g.col(kAt);
  terms.f = f.col(kAt);
  terms.tau = tau.col(kAt);
  return terms;
}

}  // namespace

double largestTerm(const Model& model, const State& state, double gravity) {
  double largest = largestTerm(model.chain, model.chain.links(), state, gravity);
  for (const auto& links : model.row_parameters) {
    largest = std::max(largest, largestTerm(model.chain, links, state, gravity));
  }
  if (!model.gravity_parameters.empty()) {
    largest = std::max(largest, largestTerm(model.chain, model.gravity_parameters, state, gravity));
  }
  return largest;
}

void requireEqualKernels(const Model& model, const State& state) {
  const Index n = model.chain.jointCount();
  const VectorXd zero = VectorXd::Zero(n), one = VectorXd::Ones(n);
  const double unit = rounding(model), gravity = model.chain.gravity().norm();
  const double H = unit * largestTerm(model, {state.q, zero, one}, 0);
  const double c = unit * largestTerm(model, {state.q, state.qd, zero}, 0);
  const double g = unit * largestTerm(model, {state.q, zero, zero}, gravity);
  const double friction = unit * largestFriction(model, state.qd, g / unit);
  const double tau = friction + unit * largestTerm(model, state, gravity);

  const Terms plain = plainTerms(model, state);
  for (const std::string& set : FastModel::instructionSets()) {
    const FastModel fast(model, set);
    for (const bool batch : {false, true}) {
      const Terms terms = batch ? batchTerms(fast, state) : fastTerms(fast, state);
      const std::string of = set + (batch ? ", batch: " : ": ");
      require(terms.H, plain.H, H, of + "H");
      require(terms.c, plain.c, c, of + "c");
      require(terms.g, plain.g, g, of + "g");
      require(terms.f, plain.f, friction, of + "f");
      require(terms.tau, plain.tau, tau, of + "tau");
    }
  }
}

}  // namespace chain_dynamics::fuzz

// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/consistent_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <cmath>
#include <string>

#include "penalties.hpp"

namespace inverse_dynamics_identification {
inline namespace v2 {
namespace {

using chain_dynamics::ModelError;
using chain_dynamics::RegressorGram;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPathFactor = 8;         // of gamma, from one stage of the path to the next
constexpr double kStageTolerance = 1e-2;  // of the cost, relative to gamma
constexpr double kTolerance = 1e-9;       // of the cost, relative
constexpr int kMostSteps = 200;
constexpr double kSettledNoise = 1e-3;  // relative change of the noise that ends the iteration

void requireSize(const char* what, Index expected, Index got) {
  if (expected == got) return;
  throw ModelError("consistentFit", what, std::to_string(expected), std::to_string(got),
                   "give those of the same joints and columns");
}

/// The rows of all joints: what normalEquations() adds up, kept apart so that weights may change.
class Data {
 public:
  explicit Data(const RegressorGram& gram)
      : joints_(gram.joints()), own_(gram.ownColumns()), samples_(gram.samples()) {
    for (Index j = 0; j < joints_; ++j) {
      MatrixXd G(gram.rowSize(), gram.rowSize());
      gram.rowGram(j, G);
      if (!G.allFinite()) {
        throw ModelError("consistentFit: joint " + std::to_string(j + 1) +
                         ": expected sums of finite samples, got others");
      }
      grams_.push_back(std::move(G));
    }
    if (samples_ < 1) throw ModelError("consistentFit: expected samples, got none");
  }

  Index joints() const { return joints_; }
  Index ownColumns() const { return own_; }
  Index unknowns() const { return (kParameters + own_) * joints_; }

  /// Root mean square of the torques of each joint.
  VectorXd torques() const {
    VectorXd result(joints_);
    for (Index j = 0; j < joints_; ++j) result[j] = std::sqrt(grams_[at(j)](last(), last()));
    return result / std::sqrt(static_cast<double>(samples_));
  }

  /// Root mean square of the errors of each joint, not below a share of its torques.
  VectorXd noise(const VectorXd& x) const {
    VectorXd result(joints_);
    for (Index j = 0; j < joints_; ++j) {
      VectorXd row(last() + 1);  // e = -row . r
      row << x.head(kParameters * joints_), x.segment(kParameters * joints_ + own_ * j, own_), -1.0;
      result[j] = std::sqrt(std::max(0.0, row.dot(grams_[at(j)] * row)));
    }
    result /= std::sqrt(static_cast<double>(samples_));
    return result.cwiseMax(1e-9 * torques()).cwiseMax(1e-12);
  }

  /// The quadratic `x' A x - 2 b' x + c` of the weighted squares.
  void quadratic(const VectorXd& noise, MatrixXd& A, VectorXd& b, double& c) const {
    const Index rigid = kParameters * joints_;
    A.setZero(unknowns(), unknowns());
    b.setZero(unknowns());
    c = 0;
    for (Index j = 0; j < joints_; ++j) {
      const MatrixXd& G = grams_[at(j)];
      const double w = 1 / (noise[j] * noise[j]);
      const Index own = rigid + own_ * j;
      A.topLeftCorner(rigid, rigid) += w * G.topLeftCorner(rigid, rigid);
      A.block(0, own, rigid, own_) = w * G.block(0, rigid, rigid, own_);
      A.block(own, 0, own_, rigid) = w * G.block(rigid, 0, own_, rigid);
      A.block(own, own, own_, own_) = w * G.block(rigid, rigid, own_, own_);
      b.head(rigid) += w * G.col(last()).head(rigid);
      b.segment(own, own_) = w * G.col(last()).segment(rigid, own_);
      c += w * G(last(), last());
    }
  }

 private:
  static std::size_t at(Index j) { return static_cast<std::size_t>(j); }
  Index last() const { return kParameters * joints_ + own_; }

  Index joints_, own_, samples_;
  std::vector<MatrixXd> grams_;
};

/// The cost with given noise, and its minimum.
class Cost {
 public:
  Cost(const Data& data, const Penalties& penalties, const VectorXd& noise)
      : penalties_(penalties) {
    data.quadratic(noise, A_, b_, c_);
  }

  double value(double strength, const VectorXd& x) const {
    const double penalty = penalties_.value(strength, x);
    return std::isfinite(penalty) ? x.dot(A_ * x) - 2 * b_.dot(x) + c_ + penalty : penalty;
  }

  void derivatives(double strength, const VectorXd& x, VectorXd& gradient,
                   MatrixXd& hessian) const {
    gradient = 2 * (A_ * x - b_);
    hessian = 2 * A_;
    penalties_.addDerivatives(strength, x, gradient, hessian);
  }

  /// Damped Newton steps until the cost is within `tolerance` of its minimum. Counts them.
  void minimise(double strength, double tolerance, VectorXd& x, int& steps) const {
    VectorXd gradient(x.size());
    MatrixXd hessian(x.size(), x.size());
    double cost = value(strength, x);
    for (int k = 0; k < kMostSteps; ++k, ++steps) {
      derivatives(strength, x, gradient, hessian);
      const VectorXd step = newtonStep(gradient, hessian);
      const double decrease = -gradient.dot(step);  // twice what a full step promises
      if (!(decrease > 2 * (tolerance + kTolerance * std::abs(cost)))) return;
      double share = 1;
      double there = value(strength, x + step);
      while (!(there <= cost - 0.1 * share * decrease) && share > 1e-12) {
        share *= 0.5;
        there = value(strength, x + share * step);
      }
      if (!(there < cost)) return;  // rounding ends it
      x += share * step;
      cost = there;
    }
  }

  const MatrixXd& quadraticPart() const { return A_; }

 private:
  /// -H^-1 g, with unknowns of unit curvature: kilograms stand beside kg m^2. Where a link is about to
  /// lose a dimension, its curvatures differ by more than doubles can tell: a little more of each then.
  /// The matrix is scaled in place.
  static VectorXd newtonStep(const VectorXd& gradient, MatrixXd& hessian) {
    if (!(hessian.diagonal().minCoeff() > 0)) {
      throw ModelError(
          "consistentFit: own columns: expected samples that determine them, got a column of "
          "zeros; "
          "give it a deviation");
    }
    const VectorXd scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
    hessian.array().colwise() *= scale.array();
    hessian.array().rowwise() *= scale.transpose().array();
    Eigen::LLT<MatrixXd> factor(hessian);
    for (double more = 1e-14; factor.info() != Eigen::Success && more < 1; more *= 10) {
      hessian.diagonal().array() += more;
      factor.compute(hessian);
    }
    return -scale.cwiseProduct(factor.solve(scale.cwiseProduct(gradient)));
  }

  const Penalties& penalties_;
  MatrixXd A_;
  VectorXd b_;
  double c_ = 0;
};

VectorXd unknownsOf(const Fit& fit, const Data& data) {
  requireSize("parameters of the fit", kParameters * data.joints(), fit.parameters.size());
  requireSize("own columns of the fit", data.ownColumns() * data.joints(), fit.own.size());
  VectorXd x(data.unknowns());
  x << Eigen::Map<const VectorXd>(fit.parameters.data(), fit.parameters.size()),
      Eigen::Map<const VectorXd>(fit.own.data(), fit.own.size());
  return x;
}

Fit fitOf(const VectorXd& x, const Data& data) {
  const Index rigid = kParameters * data.joints();
  Fit fit;
  fit.parameters = Eigen::Map<const MatrixXd>(x.data(), kParameters, data.joints());
  fit.own = Eigen::Map<const MatrixXd>(x.data() + rigid, data.ownColumns(), data.joints());
  fit.noise = data.noise(x);
  return fit;
}

/// From the prior, along the path, or from a start that is a robot.
void solve(const Cost& cost, double strength, double first_strength, VectorXd& x, int& steps) {
  for (double gamma = first_strength; gamma > strength * kPathFactor; gamma /= kPathFactor) {
    cost.minimise(gamma, kStageTolerance * gamma, x, steps);
  }
  cost.minimise(strength, 0, x, steps);
}

void check(const Data& data, const Prior& prior, const FitOptions& options) {
  requireSize("links of the prior", data.joints(), static_cast<Index>(prior.links.size()));
  requireSize("own columns of the prior", data.ownColumns() * data.joints(),
              static_cast<Index>(prior.own.size()));
  if (options.noise.size() > 0) requireSize("noise", data.joints(), options.noise.size());
  if (!(options.prior_strength > 0) || !std::isfinite(options.prior_strength)) {
    throw ModelError("consistentFit", "prior_strength", "a number above zero",
                     std::to_string(options.prior_strength), "100 is usual");
  }
}

}  // namespace

Fit consistentFit(const RegressorGram& gram, const Prior& prior, const FitOptions& options,
                  const Fit* start) {
  const Data data(gram);
  check(data, prior, options);
  const Penalties penalties(prior);
  const double strength = options.prior_strength;
  VectorXd x = penalties.start();
  bool started = false;
  if (start != nullptr) {
    VectorXd given = unknownsOf(*start, data);
    penalties.limit(given);
    started = std::isfinite(penalties.value(strength, given));
    if (started) x = given;
  }
  VectorXd noise = 0.05 * data.torques().cwiseMax(1e-12);
  if (options.noise.size() > 0) noise = options.noise;
  int steps = 0;
  for (int k = 0; k < std::max(1, options.noise_iterations); ++k) {
    const Cost cost(data, penalties, noise);
    // where one unit of gamma outweighs the torques, the solution is the prior
    const double outweighs = (data.torques().array() / noise.array()).square().sum() *
                             static_cast<double>(gram.samples());
    solve(cost, strength, started ? strength : outweighs, x, steps);
    started = true;
    const VectorXd next = data.noise(x);
    const double change = (next.array() / noise.array() - 1).abs().maxCoeff();
    if (k + 1 >= options.noise_iterations || change < kSettledNoise) {
      Fit fit = fitOf(x, data);
      fit.weighed_by = noise;
      fit.cost = cost.value(strength, x);
      fit.newton_steps = steps;
      return fit;
    }
    noise = next;
  }
  return fitOf(x, data);
}

Information information(const RegressorGram& gram, const Prior& prior, const FitOptions& options,
                        const Fit& fit) {
  const Data data(gram);
  check(data, prior, options);
  requireSize("noise of the fit", data.joints(), fit.weighed_by.size());
  const Penalties penalties(prior);
  const VectorXd x = unknownsOf(fit, data);
  const Cost cost(data, penalties, fit.weighed_by);
  VectorXd gradient = VectorXd::Zero(x.size());
  MatrixXd hessian = MatrixXd::Zero(x.size(), x.size());
  penalties.addDerivatives(options.prior_strength, x, gradient, hessian);
  Information result;
  result.data = cost.quadraticPart();
  result.prior = 0.5 * hessian;
  return result;
}

}  // namespace v2
}  // namespace inverse_dynamics_identification

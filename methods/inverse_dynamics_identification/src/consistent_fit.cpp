// SPDX-License-Identifier: Apache-2.0
#include "inverse_dynamics_identification/consistent_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chain_dynamics/error.hpp>
#include <chain_dynamics/regressor_gram.hpp>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

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

/// Own unknowns that rows of joints have in common, and the numbers of links that none of these moves.
struct Group {
  std::vector<Index> unknowns;
  Index before;
};

/// The rows of all joints: what normalEquations() adds up, kept apart so that weights may change.
class Data {
 public:
  Data(const RegressorGram& gram, const Prior& prior)
      : joints_(gram.joints()),
        links_(kParameters * gram.links()),
        all_columns_(gram.ownColumns()),
        samples_(gram.samples()),
        columns_(prior.columns) {
    if (columns_.empty()) {
      for (Index c = 0; c < all_columns_; ++c) columns_.push_back(c);
    }
    number(gram);
    for (Index j = 0; j < joints_; ++j) {
      before_.push_back(kParameters * gram.firstLink(j));
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
  Index allColumns() const { return all_columns_; }
  const std::vector<Index>& columns() const { return columns_; }
  Index ownColumns() const { return static_cast<Index>(columns_.size()); }
  Index links() const { return links_; }  // their numbers
  Index unknowns() const { return links() + own_unknowns_; }
  /// That of the k-th of columns() of a joint, behind those of the links; -1: none.
  Index unknownOf(Index joint, Index k) const { return unknowns_(k, joint); }

  /// Each own unknown once, with those that are in a row with it.
  std::vector<Group> groups() const {
    std::vector<Group> groups;
    std::vector<std::size_t> group_of(at(own_unknowns_));  // that joins it, at last the last one
    std::iota(group_of.begin(), group_of.end(), std::size_t{0});
    const auto last_of = [&](std::size_t u) {
      while (group_of[u] != u) u = group_of[u];
      return u;
    };
    std::vector<Index> before(group_of.size(), links());
    for (Index j = 0; j < joints_; ++j) {
      std::size_t joined = group_of.size();
      for (Index k = 0; k < ownColumns(); ++k) {
        if (unknownOf(j, k) < 0) continue;
        const std::size_t u = last_of(at(unknownOf(j, k)));
        if (joined == group_of.size()) joined = u;
        before[joined] = std::min({before[joined], before[u], before_[at(j)]});
        group_of[u] = joined;
      }
    }
    std::vector<std::size_t> place(group_of.size(), group_of.size());
    for (std::size_t u = 0; u < group_of.size(); ++u) {
      const std::size_t joined = last_of(u);
      if (place[joined] == group_of.size()) {
        place[joined] = groups.size();
        groups.push_back({{}, before[joined]});
      }
      groups[place[joined]].unknowns.push_back(links() + static_cast<Index>(u));
    }
    return groups;
  }

  /// Priors of the unknowns, from those of all columns of all joints.
  Prior ofUnknowns(const Prior& prior) const {
    Prior result{prior.links, std::vector<OwnColumn>(at(own_unknowns_))};
    for (Index j = joints_ - 1; j >= 0; --j) {
      for (Index k = ownColumns() - 1; k >= 0; --k) {
        if (unknownOf(j, k) < 0) continue;
        result.own[at(unknownOf(j, k))] = prior.own[at(ownColumns() * j + k)];
      }
    }
    return result;
  }

  /// Root mean square of the torques of each joint.
  VectorXd torques() const {
    VectorXd result(joints_);
    for (Index j = 0; j < joints_; ++j) result[j] = std::sqrt(grams_[at(j)](last(), last()));
    return result / std::sqrt(static_cast<double>(samples_));
  }

  /// Root mean square of the errors of each joint, not below a share of its torques.
  VectorXd noise(const VectorXd& x) const {
    VectorXd result(joints_);
    VectorXd row = VectorXd::Zero(last() + 1);  // e = -row . r
    row.head(links()) = x.head(links());
    row[last()] = -1;
    for (Index j = 0; j < joints_; ++j) {
      for (Index c = 0; c < ownColumns(); ++c) {
        const Index u = unknownOf(j, c);
        row[links() + columns_[at(c)]] = u < 0 ? 0.0 : x[links() + u];
      }
      result[j] = std::sqrt(std::max(0.0, row.dot(grams_[at(j)] * row)));
    }
    result /= std::sqrt(static_cast<double>(samples_));
    return result.cwiseMax(1e-9 * torques()).cwiseMax(1e-12);
  }

  /// The quadratic `x' A x - 2 b' x + c` of the weighted squares.
  void quadratic(const VectorXd& noise, MatrixXd& A, VectorXd& b, double& c) const {
    A.setZero(unknowns(), unknowns());
    b.setZero(unknowns());
    c = 0;
    for (Index j = 0; j < joints_; ++j) {
      const double w = 1 / (noise[j] * noise[j]);
      const MatrixXd& G = grams_[at(j)];
      const Index before = before_[at(j)], moved = links() - before;
      A.block(before, before, moved, moved) += w * G.block(before, before, moved, moved);
      b.segment(before, moved) += w * G.col(last()).segment(before, moved);
      c += w * G(last(), last());
      for (Index k = 0; k < ownColumns(); ++k) {
        if (unknownOf(j, k) < 0) continue;
        const auto column = w * G.col(links() + columns_[at(k)]);
        const Index to = links() + unknownOf(j, k);
        A.col(to).segment(before, moved) += column.segment(before, moved);
        A.row(to).segment(before, moved) += column.segment(before, moved);
        for (Index i = 0; i < ownColumns(); ++i) {
          const Index u = unknownOf(j, i);
          if (u >= 0) A(links() + u, to) += column[links() + columns_[at(i)]];
        }
        b[to] += column[last()];
      }
    }
  }

 private:
  static std::size_t at(Index j) { return static_cast<std::size_t>(j); }
  Index last() const { return links() + all_columns_; }

  /// Counts the unknowns of the columns that there are, in the order of the gram's.
  void number(const RegressorGram& gram) {
    unknowns_.resize(ownColumns(), joints_);
    std::map<Index, Index> numbers;
    const auto of_gram = [&](Index k, Index j) { return gram.unknownOf(j, columns_[at(k)]); };
    for (Index j = 0; j < joints_; ++j) {
      for (Index k = 0; k < ownColumns(); ++k) numbers[of_gram(k, j)];
    }
    numbers.erase(-1);
    for (auto& [of, number] : numbers) number = own_unknowns_++;
    numbers[-1] = -1;
    for (Index j = 0; j < joints_; ++j) {
      for (Index k = 0; k < ownColumns(); ++k) unknowns_(k, j) = numbers.at(of_gram(k, j));
    }
  }

  Index joints_, links_, all_columns_, samples_, own_unknowns_ = 0;
  Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic> unknowns_;  // of columns_ x joints
  std::vector<Index> before_;
  std::vector<Index> columns_;  // of them all, those that there are unknowns for
  std::vector<MatrixXd> grams_;
};

/// Solves H x = b in place. First come the unknowns of the links; the own ones of a group meet those of no
/// other one, nor the numbers of links that it doesn't move, and are eliminated. False: H isn't positive
/// definite.
bool solveInPlace(const MatrixXd& H, Index rigid, const std::vector<Group>& groups, VectorXd& x) {
  MatrixXd rest = H.topLeftCorner(rigid, rigid);
  std::vector<Eigen::LLT<MatrixXd>> factors;
  std::vector<MatrixXd> couplings;
  std::vector<VectorXd> own_parts;
  for (const auto& [unknowns, before] : groups) {
    const Index moved = rigid - before;
    const Eigen::LLT<MatrixXd>& factor = factors.emplace_back(MatrixXd(H(unknowns, unknowns)));
    if (factor.info() != Eigen::Success) return false;
    MatrixXd& C = couplings.emplace_back(H(unknowns, Eigen::seqN(before, moved)));
    factor.matrixL().solveInPlace(C);
    VectorXd& own_part = own_parts.emplace_back(x(unknowns));
    factor.matrixL().solveInPlace(own_part);
    rest.bottomRightCorner(moved, moved)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(C.transpose(), -1);
    x.segment(before, moved).noalias() -= C.transpose() * own_part;
  }
  const Eigen::LLT<MatrixXd> factor(rest);
  if (factor.info() != Eigen::Success) return false;
  auto links = x.head(rigid);
  factor.solveInPlace(links);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    own_parts[g].noalias() -= couplings[g] * x.segment(groups[g].before, rigid - groups[g].before);
    factors[g].matrixU().solveInPlace(own_parts[g]);
    x(groups[g].unknowns) = own_parts[g];
  }
  return true;
}

/// The cost with given noise, and its minimum.
class Cost {
 public:
  Cost(const Data& data, const Penalties& penalties, const VectorXd& noise)
      : penalties_(penalties), links_(data.links()), groups_(data.groups()) {
    data.quadratic(noise, A_, b_, c_);
  }

  double value(double strength, const VectorXd& x) const { return value(strength, x, A_ * x); }

  /// Damped Newton steps until the cost is within `tolerance` of its minimum. Counts them.
  void minimise(double strength, double tolerance, VectorXd& x, int& steps) const {
    VectorXd Ax = A_ * x;
    double cost = value(strength, x, Ax);
    for (int k = 0; k < kMostSteps; ++k, ++steps) {
      VectorXd gradient = 2 * (Ax - b_);
      MatrixXd hessian = 2 * A_;
      penalties_.addDerivatives(strength, x, gradient, hessian);
      const VectorXd step = newtonStep(gradient, hessian);
      const double decrease = -gradient.dot(step);  // twice what a full step promises
      if (!(decrease > 2 * (tolerance + kTolerance * std::abs(cost)))) return;
      const VectorXd change = A_ * step;
      double share = 1;
      double there = value(strength, x + step, Ax + change);
      while (!(there <= cost - 0.1 * share * decrease) && share > 1e-12) {
        share *= 0.5;
        there = value(strength, x + share * step, Ax + share * change);
      }
      if (!(there < cost)) return;  // rounding ends it
      x += share * step;
      Ax += share * change;
      cost = there;
      // after a full step, Newton's decrement is at most twice its square [Boyd, Vandenberghe, 9.6]
      const double next = 4 * decrease * decrease / std::min(1.0, strength);
      if (share == 1 && next < tolerance + kTolerance * std::abs(cost)) return;
    }
  }

  const MatrixXd& quadraticPart() const { return A_; }

 private:
  double value(double strength, const VectorXd& x, const VectorXd& Ax) const {
    const double penalty = penalties_.value(strength, x);
    return std::isfinite(penalty) ? x.dot(Ax) - 2 * b_.dot(x) + c_ + penalty : penalty;
  }

  /// -H^-1 g, with unknowns of unit curvature: kilograms stand beside kg m^2. Where a link is about to
  /// lose a dimension, its curvatures differ by more than doubles can tell: a little more of each then.
  /// The matrix is scaled in place.
  VectorXd newtonStep(const VectorXd& gradient, MatrixXd& hessian) const {
    if (!(hessian.diagonal().minCoeff() > 0)) {
      throw ModelError(
          "consistentFit: own columns: expected samples that determine them, got a column of "
          "zeros; "
          "give it a deviation");
    }
    const VectorXd scale = hessian.diagonal().cwiseSqrt().cwiseInverse();
    for (Index c = 0; c < scale.size(); ++c) {  // the lower triangle is enough
      hessian.col(c).tail(scale.size() - c).array() *=
          scale[c] * scale.tail(scale.size() - c).array();
    }
    VectorXd step = -scale.cwiseProduct(gradient);
    VectorXd solved = step;
    for (double more = 1e-14; !solveInPlace(hessian, links_, groups_, solved) && more < 1;
         more *= 10) {
      hessian.diagonal().array() += more;
      solved = step;
    }
    return scale.cwiseProduct(solved);
  }

  const Penalties& penalties_;
  Index links_;
  std::vector<Group> groups_;
  MatrixXd A_;
  VectorXd b_;
  double c_ = 0;
};

/// of(c, joint, unknown) of each own column that has one.
template <class Of>
void forEachOwn(const Data& data, const Of& of) {
  for (Index j = 0; j < data.joints(); ++j) {
    for (Index k = 0; k < data.ownColumns(); ++k) {
      const Index unknown = data.unknownOf(j, k);
      if (unknown >= 0) of(data.columns()[static_cast<std::size_t>(k)], j, data.links() + unknown);
    }
  }
}

VectorXd unknownsOf(const Fit& fit, const Data& data) {
  requireSize("parameters of the fit", data.links(), fit.parameters.size());
  requireSize("own columns of the fit", data.allColumns() * data.joints(), fit.own.size());
  VectorXd x(data.unknowns());
  x.head(data.links()) = Eigen::Map<const VectorXd>(fit.parameters.data(), data.links());
  forEachOwn(data, [&](Index c, Index j, Index unknown) { x[unknown] = fit.own(c, j); });
  return x;
}

Fit fitOf(const VectorXd& x, const Data& data) {
  Fit fit;
  fit.parameters = Eigen::Map<const MatrixXd>(x.data(), kParameters, data.links() / kParameters);
  fit.own = MatrixXd::Zero(data.allColumns(), data.joints());
  forEachOwn(data, [&](Index c, Index j, Index unknown) { fit.own(c, j) = x[unknown]; });
  fit.noise = data.noise(x);
  return fit;
}

/// From the prior, along the path, or from a start that is a robot.
void solve(const Cost& cost, double strength, double first_strength, double tolerance, VectorXd& x,
           int& steps) {
  for (double gamma = first_strength; gamma > strength * kPathFactor; gamma /= kPathFactor) {
    cost.minimise(gamma, kStageTolerance * gamma, x, steps);
  }
  cost.minimise(strength, tolerance, x, steps);
}

void check(const Data& data, const Prior& prior, const FitOptions& options) {
  requireSize("links of the prior", data.links() / kParameters,
              static_cast<Index>(prior.links.size()));
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
  const Data data(gram, prior);
  check(data, prior, options);
  const Penalties penalties(data.ofUnknowns(prior));
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
    solve(cost, strength, started ? strength : outweighs, options.tolerance, x, steps);
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
  const Data data(gram, prior);
  check(data, prior, options);
  requireSize("noise of the fit", data.joints(), fit.weighed_by.size());
  const Penalties penalties(data.ofUnknowns(prior));
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

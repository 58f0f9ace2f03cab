// SPDX-License-Identifier: Apache-2.0
#include "path_dynamics.hpp"

#include <algorithm>
#include <chain_dynamics/owned.hpp>
#include <cmath>
#include <cstddef>
#include <inverse_dynamics_solver/exceptions.hpp>
#include <inverse_dynamics_solver/kinematics.hpp>
#include <inverse_dynamics_solver/torque_deviation.hpp>
#include <limits>
#include <string>
#include <vector>

namespace inverse_dynamics_timing {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
namespace ids = inverse_dynamics_solver;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of each tip of the robot.
std::vector<const ids::Kinematics*> tipsOf(const InverseDynamicsSolver& solver) {
  const auto& first = dynamic_cast<const ids::Kinematics&>(solver);
  std::vector<const ids::Kinematics*> tips{&first};
  const std::vector<std::string>& names = solver.tipNames();
  for (std::size_t i = 1; i < names.size(); ++i) tips.push_back(&first.kinematicsOf(names[i]));
  return tips;
}

/// Squared speed at which the fastest tip moves at its greatest speed, at each point.
VectorXd capOfTips(const InverseDynamicsSolver& solver, const MatrixXd& q, const MatrixXd& dq,
                   double tip_speed) {
  MatrixXd J(6, q.rows());
  VectorXd cap = VectorXd::Constant(q.cols(), kInfinity);
  for (const ids::Kinematics* const tip : tipsOf(solver)) {
    for (Index k = 0; k < q.cols(); ++k) {
      tip->getTipJacobian(q.col(k), J);
      const double greatest = tip_speed / (J.topRows(3) * dq.col(k)).norm();  // ds/dt
      cap[k] = std::min(cap[k], greatest * greatest);
    }
  }
  return cap;
}

[[noreturn]] void refuseOption(const std::string& where, const std::string& expected,
                               const std::string& got) {
  throw ids::InvalidParameterValueException("retime(): " + where, "", expected, got);
}

/// What a joint's torque may be at a velocity.
double torqueLimit(const MotionLimits& limits, const VectorXd& band, Index j, double velocity) {
  if (limits.knee_velocity.size() == 0) return limits.torque[j] - band[j];
  const double knee = limits.knee_velocity[j], none = limits.no_load_velocity[j];
  const double share = std::min((none - std::abs(velocity)) / (none - knee), 1.0);
  return limits.torque[j] * share - band[j];
}

/// Shares of an interval at which excess() looks, with q' at its ends.
template <class Column>
const std::vector<double>& between(const Column& here, const Column& next, bool rests) {
  static const std::vector<double> kMiddle{0.5}, kBent{0.25, 0.5, 0.75},
      kStepped{1.0 / 64, 1.0 / 16, 0.25, 0.5, 0.75, 15.0 / 16, 63.0 / 64};
  if (rests || (here.array().abs().min(next.array().abs()) < (next - here).array().abs()).any()) {
    return kStepped;
  }
  constexpr double kBend = 0.03;  // of q', relative
  return (next - here).squaredNorm() >= kBend * kBend * here.squaredNorm() ? kBent : kMiddle;
}

}  // namespace

inline namespace v2 {

chain_dynamics::OwnedVector torqueBand(const InverseDynamicsSolver& solver, double margin) {
  if (!(margin >= 0.0 && margin < 1.0)) {
    refuseOption("options.margin", "0 <= margin < 1", std::to_string(margin));
  }
  if (margin == 0.0) return VectorXd::Zero(solver.jointCount());
  const auto* deviation = dynamic_cast<const ids::TorqueDeviation*>(&solver);
  if (deviation == nullptr || !deviation->hasTorqueDeviation()) {
    refuseOption("options.margin", "0, or a model that states the deviation of its torques",
                 std::to_string(margin));
  }
  // The model states the band of 95 %. A normal distribution has the others: erf(x / sqrt 2) = margin.
  double x = 1.0;
  for (int step = 0; step < 60; ++step) {
    x += (margin - std::erf(x / std::sqrt(2.0))) * std::sqrt(M_PI / 2) * std::exp(x * x / 2);
  }
  return x / 1.959963984540054 * deviation->getTorqueDeviation();
}

}  // namespace v2

PathDynamics::PathDynamics(const InverseDynamicsSolver& solver, const Path& path, const VectorXd& s,
                           const MotionLimits& limits, double margin, FrictionState friction)
    : solver_(solver), limits_(limits), s_(s), band_(torqueBand(solver, margin)) {
  const Index n = path.jointCount(), count = s.size();
  const bool accelerations = limits.acceleration.size() > 0;
  const Index rows = accelerations ? 2 * n : n;
  q_.resize(n, count), dq_.resize(n, count), g_.resize(n, count), least_still_.resize(n, count);
  a_.resize(rows, count), b_.resize(rows, count);
  MatrixXd ddq(n, count);
  for (Index k = 0; k < count; ++k) {
    path.evaluate(s[k], q_.col(k), dq_.col(k), ddq.col(k), k + 1 == count);
  }

  // With f the friction: tau(q, 0, q') - tau(q, 0, 0) = H q'; tau(q, q', q'') = H q'' + C q' + f + g.
  const MatrixXd still = MatrixXd::Zero(n, count);
  MatrixXd part(n, count);
  solver.getGravityVectorBatch(q_, g_);
  solver.getFrictionVectorBatch(q_, still, least_still_);
  solver.getTorquesBatch(q_, still, dq_, part);
  a_.topRows(n) = part - g_ - least_still_;
  solver.getTorquesBatch(q_, dq_, ddq, part);
  b_.topRows(n) = part - g_;
  solver.getFrictionVectorBatch(q_, dq_, part);
  b_.topRows(n) -= part;
  if (accelerations) a_.bottomRows(n) = dq_, b_.bottomRows(n) = ddq;
  most_still_ = least_still_;
  for (Index k = 0; k < count && friction.remembers(); ++k) {
    friction.move(q_.col(k));
    friction.addRange(still.col(k), least_still_.col(k), most_still_.col(k));
    friction_.push_back(friction);
  }

  cap_ = std::isfinite(limits.tip_speed) ? capOfTips(solver, q_, dq_, limits.tip_speed)
                                         : VectorXd::Constant(count, kInfinity);
  const auto limit_by = [&](const chain_dynamics::OwnedVector& velocity) {
    for (Index k = 0; k < count && velocity.size() > 0; ++k) {
      cap_[k] = std::min(cap_[k], (velocity.array() / dq_.col(k).array()).square().minCoeff());
    }
  };
  limit_by(limits.velocity);
  limit_by(limits.no_load_velocity);
}

Room PathDynamics::emptyRoom() const {
  const VectorXd zero = VectorXd::Zero(rows());
  return {-1, 0.0, zero, zero, zero, zero};
}

void PathDynamics::room(Index k, double z, Room& room) const {
  const Index n = g_.rows();
  room.k = k, room.z = z;
  // The second state is beside the first one, for the slopes. Steps this small are exact to 1e-8.
  const double step = 1e-5 * z;
  Eigen::Matrix<double, Eigen::Dynamic, 2, 0, 64, 2> qd(n, 2), least(n, 2), most(n, 2);
  qd.col(0) = std::sqrt(z) * dq_.col(k);
  qd.col(1) = std::sqrt(z + step) * dq_.col(k);
  least.colwise() = least_still_.col(k), most.colwise() = most_still_.col(k);
  for (Index i = 0; i < 2 && z > 0.0; ++i) {
    solver_.getFrictionVector(q_.col(k), qd.col(i), least.col(i));
    most.col(i) = least.col(i);
    if (friction_.empty()) continue;
    friction_[static_cast<std::size_t>(k)].addRange(qd.col(i), least.col(i), most.col(i));
  }
  for (Index j = 0; j < n; ++j) {
    const double limit = torqueLimit(limits_, band_, j, qd(j, 0));
    const double slope = step > 0 ? (torqueLimit(limits_, band_, j, qd(j, 1)) - limit) / step : 0.0;
    room.up_slope[j] = step > 0 ? slope - (most(j, 1) - most(j, 0)) / step : slope;
    room.down_slope[j] = step > 0 ? slope + (least(j, 1) - least(j, 0)) / step : slope;
    room.up[j] = limit - g_(j, k) - most(j, 0) - room.up_slope[j] * z;
    room.down[j] = limit + g_(j, k) + least(j, 0) - room.down_slope[j] * z;
  }
  if (rows() > n) {
    room.up.tail(n) = room.down.tail(n) = limits_.acceleration;
    room.up_slope.tail(n).setZero(), room.down_slope.tail(n).setZero();
  }
}

Index PathDynamics::weakest(Index k, double& missing) const {
  Index joint = -1;
  double worst = 0.0;
  for (Index j = 0; j < g_.rows(); ++j) {
    const double limit = torqueLimit(limits_, band_, j, 0.0);
    const double lacks =
        std::max(g_(j, k) + most_still_(j, k), -g_(j, k) - least_still_(j, k)) - limit;
    if (lacks > worst * limits_.torque[j])
      worst = lacks / limits_.torque[j], joint = j, missing = lacks;
  }
  return joint;
}

VectorXd excess(const InverseDynamicsSolver& solver, const Path& path,
                const Eigen::Ref<const VectorXd>& s, const Eigen::Ref<const VectorXd>& z,
                const MotionLimits& limits, double margin, bool at_ends, FrictionState& friction) {
  struct Place {
    Index k;
    double share;
  };
  std::vector<Place> places;
  const Index n = path.jointCount(), points = s.size();
  places.reserve(static_cast<std::size_t>(4 * points));
  MatrixXd ends(n, 2);
  VectorXd position(n), bend(n);
  path.evaluate(s[0], position, ends.col(0), bend);
  for (Index k = 0; k + 1 < points; ++k) {
    const auto here = ends.col(k % 2);
    auto next = ends.col((k + 1) % 2);
    path.evaluate(s[k + 1], position, next, bend, k + 2 == points);
    if (at_ends) places.push_back({k, 0.0});
    for (const double share : between(here, next, z[k] == 0.0 || z[k + 1] == 0.0)) {
      places.push_back({k, share});
    }
    if (at_ends) places.push_back({k, 1.0});
  }
  const auto count = static_cast<Index>(places.size());
  MatrixXd q(n, count), qd(n, count), qdd(n, count), least(n, count);
  for (Index i = 0; i < count; ++i) {
    const auto [k, share] = places[static_cast<std::size_t>(i)];
    const double length = s[k + 1] - s[k], here = z[k] + share * (z[k + 1] - z[k]);
    path.evaluate(s[k] + share * length, q.col(i), qd.col(i), qdd.col(i), share == 1.0);
    qdd.col(i) = (z[k + 1] - z[k]) / (2 * length) * qd.col(i) + here * qdd.col(i);
    qd.col(i) *= std::sqrt(here);
  }
  solver.getTorquesBatch(q, qd, qdd, least);
  MatrixXd greatest = least;
  std::vector<const ids::Kinematics*> tips;
  if (std::isfinite(limits.tip_speed)) tips = tipsOf(solver);
  MatrixXd J(6, n);
  const VectorXd band = torqueBand(solver, margin);
  VectorXd most = VectorXd::Zero(points - 1);
  for (Index i = 0; i < count; ++i) {
    friction.move(q.col(i));
    friction.addRange(qd.col(i), least.col(i), greatest.col(i));
    double& worst = most[places[static_cast<std::size_t>(i)].k];
    const auto look = [&worst](const auto& values, const chain_dynamics::OwnedVector& limit) {
      if (limit.size() == 0) return;
      worst = std::max(worst, (values.array().abs() / limit.array()).maxCoeff() - 1.0);
    };
    look(qd.col(i), limits.velocity);
    look(qdd.col(i), limits.acceleration);
    for (const ids::Kinematics* const tip : tips) {
      tip->getTipJacobian(q.col(i), J);
      worst = std::max(worst, (J.topRows(3) * qd.col(i)).norm() / limits.tip_speed - 1.0);
    }
    for (Index j = 0; j < n; ++j) {
      const double limit = torqueLimit(limits, band, j, qd(j, i));
      worst = std::max(worst, (std::max(greatest(j, i), -least(j, i)) - limit) / limits.torque[j]);
    }
  }
  return most;
}

namespace {

void checkLimit(const InverseDynamicsSolver& solver, const char* name,
                const chain_dynamics::OwnedVector& limit) {
  if (limit.size() == 0) return;
  if (limit.size() != solver.jointCount()) {
    throw ids::SizeMismatchException(
        std::string("retime(): limits.") + name, "",
        std::to_string(solver.jointCount()) + " numbers, one per joint, or none",
        std::to_string(limit.size()));
  }
  for (Index j = 0; j < limit.size(); ++j) {
    if (!(limit[j] > 0.0) || !std::isfinite(limit[j])) {
      refuseOption(
          std::string("limits.") + name + " of " + solver.jointNames()[static_cast<std::size_t>(j)],
          "a finite number > 0", std::to_string(limit[j]));
    }
  }
}

}  // namespace

void check(const InverseDynamicsSolver& solver, const Path& path, const MotionLimits& limits,
           const RetimeOptions& options) {
  const Index n = solver.jointCount();
  if (path.jointCount() != n) {
    throw ids::SizeMismatchException("retime(): path", "",
                                     std::to_string(n) + " joints, as the solver has",
                                     std::to_string(path.jointCount()));
  }
  checkLimit(solver, "torque", limits.torque);
  checkLimit(solver, "velocity", limits.velocity);
  checkLimit(solver, "acceleration", limits.acceleration);
  checkLimit(solver, "jerk", limits.jerk);
  checkLimit(solver, "torque_rate", limits.torque_rate);
  checkLimit(solver, "knee_velocity", limits.knee_velocity);
  checkLimit(solver, "no_load_velocity", limits.no_load_velocity);
  const bool kinematics = dynamic_cast<const ids::Kinematics*>(&solver) != nullptr;
  const auto speed = [](double value) { return value >= 0.0 && std::isfinite(value); };
  const auto text = [](double value) { return std::to_string(value); };
  const struct {
    bool right;
    const char *where, *expected;
    std::string got;
  } rules[] = {
      {n <= 64, "solver", "at most 64 joints", std::to_string(n)},
      {limits.torque.size() == n, "limits.torque", "a limit of each joint, N m", "none"},
      {limits.knee_velocity.size() == limits.no_load_velocity.size(), "limits.knee_velocity",
       "with no_load_velocity, or neither", "only one of both"},
      {limits.knee_velocity.size() != limits.no_load_velocity.size() ||
           (limits.knee_velocity.array() < limits.no_load_velocity.array()).all(),
       "limits.knee_velocity", "for each joint less than no_load_velocity", "more"},
      {limits.tip_speed > 0.0, "limits.tip_speed", "> 0 m/s", text(limits.tip_speed)},
      {std::isinf(limits.tip_speed) || kinematics, "limits.tip_speed",
       "none, or a solver with the capability Kinematics", text(limits.tip_speed)},
      {options.points >= 2 && options.points <= 1000000, "options.points", "2 to 1000000",
       std::to_string(options.points)},
      {speed(options.start_speed), "options.start_speed", "finite, >= 0",
       text(options.start_speed)},
      {speed(options.end_speed), "options.end_speed", "finite, >= 0", text(options.end_speed)},
      {limits.jerk.size() + limits.torque_rate.size() == 0 ||
           options.start_speed + options.end_speed == 0.0,
       limits.jerk.size() > 0 ? "limits.jerk" : "limits.torque_rate",
       "none, or start and end at rest", text(options.start_speed + options.end_speed)},
  };
  for (const auto& rule : rules) {
    if (!rule.right) refuseOption(rule.where, rule.expected, rule.got);
  }
  const chain_dynamics::OwnedVector band = torqueBand(solver, options.margin);
  for (Index j = 0; j < n; ++j) {
    if (band[j] < limits.torque[j]) continue;
    refuseOption("options.margin", "a band narrower than the torque limit",
                 "for " + solver.jointNames()[static_cast<std::size_t>(j)] + " " +
                     std::to_string(band[j]) + " of " + std::to_string(limits.torque[j]) + " N m");
  }
}

}  // namespace inverse_dynamics_timing

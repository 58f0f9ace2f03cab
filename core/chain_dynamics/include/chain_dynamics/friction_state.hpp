// SPDX-License-Identifier: Apache-2.0

/// @file
/// Friction that remembers where the robot has come from.
///
///     FrictionState state(model);                  // knows nothing of the motion so far
///     state.move(q);                               // at every sample, in the order of time
///     frictionVector(model, q, qd, f);             // the limit without memory
///     state.addTo(qd, f);                          // friction after the motion so far
///
/// A gear yields before it slips: after a reversal, friction turns round over a distance d instead of
/// at once, and a joint that stands still keeps the friction of the motion before. Dahl's law says so
/// with one number z per joint, the part of the presliding friction p that acts, as it changes with
/// the joint's path s [Dahl 1968, A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1]:
///
///     dz = (sign(ds) - z) |ds| / d,      z in [-1, 1],      p = fm + fs exp(-(qd / vs)^2).
///
/// z depends on the path alone, not on time: it doesn't change while a joint stands still. s follows the
/// joint with a play of 0.05 mrad (prismatic 0.05 mm) on either side, so the noise of encoders adds
/// nothing to the path. The limit without memory [friction_laws/smooth_coulomb.hpp] has
/// tanh((qd + shift) / width) instead of z. Where z isn't known, at the beginning, the part u of it that
/// isn't takes that value: u falls from 1 as exp(-path / d). `(fm + fs) u` bounds the error at rest; in
/// motion it is up to twice that.
///
/// Real time: all functions but constructors: no allocation, lock, exception or system call.
/// Threads: each has its own state.

#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/friction.hpp"
#include "chain_dynamics/owned.hpp"
#include "chain_dynamics/states.hpp"

namespace chain_dynamics {
inline namespace v2 {

struct Model;

/// Dahl's law of one joint.
///
/// @tparam Number  double or a dual number.
template <typename Number>
struct Presliding {
  Number z = 0.0;        ///< part of the presliding friction that is known to act, in [-1, 1]
  Number unknown = 1.0;  ///< part that isn't known, in [0, 1]

  /// Goes on by `by` [rad; prismatic m]: exact for a step of any length in one direction.
  ///
  /// @param distance  d > 0; rad (prismatic m).
  void move(double by, const Number& distance) {
    using std::exp;
    slack_ += by;
    const double path = std::abs(slack_) - kPlay;
    if (!(path > 0)) return;
    const double sign = slack_ > 0 ? 1 : -1;
    const Number left = exp(-path / distance);
    slack_ = sign * kPlay;
    z = sign + (z - sign) * left;
    unknown = unknown * left;
  }

 private:
  static constexpr double kPlay = 5e-5;  // rad; prismatic m: half of what many encoders resolve
  double slack_ = 0.0;                   // of the joint from the middle of the play
};

/// What the friction of a robot remembers.
class FrictionState {
 public:
  /// Of a robot whose friction remembers nothing.
  FrictionState() = default;

  /// Of a robot whose motion so far isn't known.
  explicit FrictionState(const Model& model);

  /// Whether any law has a distance; where none has, the functions below do nothing.
  bool remembers() const noexcept { return laws_ != nullptr; }

  /// Forgets the motion so far.
  void reset() noexcept;

  /// Goes on to the position q (n; rad, prismatic m); the first time after reset(), starts there. Of
  /// continuous joints whole turns don't count. A position that isn't finite is left out.
  void move(const Eigen::Ref<const Eigen::VectorXd>& q) noexcept;

  /// Adds what the motion so far changes: `C' p (z + (u - 1) tanh((v + shift) / width))`.
  ///
  /// @param qd         n; rad/s (prismatic m/s): v = C qd, C = Model::coupling or 1.
  /// @param[in,out] f  n; frictionVector(), or torques that contain it; N m (prismatic N).
  void addTo(const Eigen::Ref<const Eigen::VectorXd>& qd,
             Eigen::Ref<Eigen::VectorXd> f) const noexcept;

  /// move() along N positions in the order of time.
  void moveAlong(const ConstStates& q) noexcept;

  /// move() and addTo() of N states in the order of time.
  void addAlong(const ConstStates& q, const ConstStates& qd, const States& f) noexcept;

  /// Adds the least and the greatest that addTo() would add, whatever the motion before was, if it
  /// left the joint in the middle of the play; else both may differ by 2 p times the play over d.
  ///
  /// @param qd                  as of addTo().
  /// @param[in,out] least,most  n each; frictionVector(), or torques that contain it; N m (prismatic N).
  void addRange(const Eigen::Ref<const Eigen::VectorXd>& qd, Eigen::Ref<Eigen::VectorXd> least,
                Eigen::Ref<Eigen::VectorXd> most) const noexcept;

  /// Adds half the width of what isn't known: `|C|' (fm + fs) u`.
  ///
  /// @param[in,out] half_width  n; N m (prismatic N).
  void addUnknown(Eigen::Ref<Eigen::VectorXd> half_width) const noexcept;

 private:
  struct Laws {
    std::vector<SmoothCoulomb> each;  // distance 0: remembers nothing
    OwnedMatrix coupling;             // empty: law j is that of joint j
    std::vector<JointType> types;
  };

  template <class At>
  void advance(const At& q) noexcept;
  template <class At, class Add>
  void add(const At& qd, const Add& add) const noexcept;
  template <class Action>
  void forEachJoint(std::size_t law, const Action& action) const noexcept;

  std::shared_ptr<const Laws> laws_;  // shared by copies; none: nothing is remembered
  std::vector<Presliding<double>> memory_;
  std::vector<double> last_;  // positions; NaN: none yet
};

}  // namespace v2
}  // namespace chain_dynamics

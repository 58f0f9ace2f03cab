// SPDX-License-Identifier: Apache-2.0

#include "regroup.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

constexpr double kRounding = 1e-13;  // rad: what products of rotations leave of a right angle
constexpr double kNoLength = 1e-14;  // of the lengths from the joint to the tip: likewise of a zero
constexpr double kSmall = 1e-8;      // rad: the square isn't seen in double precision
constexpr double kWellPosed = 0.1;   // sine by which a length may be divided

/// An angle as cosine and sine: a right angle is exact, and sums of right angles stay so.
struct Angle {
  double c = 1;
  double s = 0;

  static Angle of(double c, double s) {
    if (std::abs(s) < kSmall) return {std::copysign(1, c), std::abs(s) < kRounding ? 0 : s};
    if (std::abs(c) < kSmall) return {std::abs(c) < kRounding ? 0 : c, std::copysign(1, s)};
    const double length = std::hypot(c, s);
    return {c / length, s / length};
  }
  static Angle ofDirection(double x, double y) {
    const double length = std::hypot(x, y);
    return of(x / length, y / length);
  }

  friend Angle operator+(const Angle& a, const Angle& b) {
    return of(a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s);
  }
  Angle operator-() const { return {c, -s}; }
};

Matrix3<double> rotationAboutZ(const Angle& angle) {
  Matrix3<double> R;
  R << angle.c, -angle.s, 0, angle.s, angle.c, 0, 0, 0, 1;
  return R;
}

/// One joint on the way from the chain's own frames to those of robot.hpp, which are turned about
/// and moved along the same axes.
struct Step {
  Angle twist;           ///< from the axis before to this one, about their common normal
  Angle own_offset;      ///< angle at q = 0 from the new frame before to the own frame
  Vector3<double> p;     ///< origin of the own frame from that of the one before, in new axes
  Angle turn;            ///< of the new frame against the own
  double slide = 0;      ///< of the new frame's origin along the axis
  double no_length = 0;  ///< a length up to this counts as zero
};

/// How the frame before this joint turns: x along the common normal of the two axes.
Angle turnBefore(const Transform<double>& placement, const Step& before, const Angle& twist,
                 double no_length) {
  const Vector3<double> axis = placement.R.col(2);
  if (twist.s != 0) return Angle::ofDirection(-axis.y(), axis.x());
  const Vector3<double>& p = placement.p;
  if (std::hypot(p.x(), p.y()) > no_length) return Angle::ofDirection(p.x(), p.y());
  return -before.own_offset;  // one axis: the offset may vanish
}

/// From root to tip: how the frames turn.
std::vector<Step> turned(const std::vector<Joint>& joints) {
  std::vector<Step> steps(joints.size());
  steps[0].p.setZero();  // frame 0 is the first joint's own at q = 0
  double length = 0;
  for (std::size_t i = joints.size() - 1; i > 0; --i) {
    length += joints[i].placement.p.cwiseAbs().sum();
    steps[i].no_length = kNoLength * length;
  }
  for (std::size_t i = 1; i < joints.size(); ++i) {
    const Transform<double>& X = joints[i].placement;
    steps[i].twist = Angle::of(X.R(2, 2), std::hypot(X.R(0, 2), X.R(1, 2)));
    steps[i - 1].turn = turnBefore(X, steps[i - 1], steps[i].twist, steps[i].no_length);

    // RotZ(turn)' R = RotX(twist) RotZ(offset)
    const Matrix3<double> back = rotationAboutZ(-steps[i - 1].turn);
    const Matrix3<double> R = back * X.R;
    steps[i].own_offset = Angle::of(R(0, 0), -R(0, 1));
    steps[i].p = back * X.p;
  }
  steps.back().turn = -steps.back().own_offset;
  return steps;
}

/// From tip to root: how the frames slide, so that no z of p is left.
void slide(std::vector<Step>& steps) {
  Step& last = steps.back();
  if (last.twist.s > kWellPosed) last.slide = last.p.y() / last.twist.s;
  for (std::size_t i = steps.size() - 1; i > 0; --i) {
    steps[i - 1].slide = steps[i].p.z() + steps[i].slide * steps[i].twist.c;
  }
}

/// Splits an offset in quarter turns, returned, and the rest.
double splitOffset(const Angle& offset, Placement& X) {
  const bool quarter = offset.c == 0 || offset.s == 0;
  if (!quarter || X.prismatic) {
    X.offset_cos = offset.c;
    X.offset_sin = offset.s;
    return 0;
  }
  X.offset_cos = 1;
  X.offset_sin = 0;
  if (offset.s == 0) return offset.c > 0 ? 0 : 2;
  return offset.s > 0 ? 1 : 3;
}

/// Ten parameters with the second moment of mass in place of the inertia.
struct Matter {
  double m;
  Vector3<double> mc;
  Matrix3<double> S;
};

Matter matterOf(const LinkParameters& link) {
  const Matrix3<double>& I = link.inertia;
  return {link.mass, link.first_moment, 0.5 * I.trace() * Matrix3<double>::Identity() - I};
}

/// What joint i lets pass unchanged, taken out of its link.
Matter takeInvariant(const Placement& X, Matter& link) {
  Matter invariant{0, Vector3<double>::Zero(), Matrix3<double>::Zero()};
  if (X.prismatic) {
    invariant.S.swap(link.S);
    return invariant;
  }
  std::swap(invariant.m, link.m);
  std::swap(invariant.mc.z(), link.mc.z());
  std::swap(invariant.S(2, 2), link.S(2, 2));
  return invariant;
}

/// The same in the frame of the parent link, at the angle of the offset.
Matter moved(const Placement& X, const Matter& part) {
  Matrix3<double> R;
  R << 1, 0, 0, 0, X.cos_twist, -X.sin_twist, 0, X.sin_twist, X.cos_twist;
  if (X.prismatic) R = (R * rotationAboutZ(Angle{X.offset_cos, X.offset_sin})).eval();
  const Vector3<double> p(X.px, X.py, 0);
  const Vector3<double> mc = R * part.mc;
  const Matrix3<double> p_mc = p * mc.transpose();
  return {part.m, mc + part.m * p,
          R * part.S * R.transpose() + p_mc + p_mc.transpose() + part.m * p * p.transpose()};
}

FixedPose fixed(const Matrix3<double>& R, const Vector3<double>& p) {
  FixedPose pose{};
  Eigen::Map<Matrix3<double>>(pose.R) = R;
  Eigen::Map<Vector3<double>>(pose.p) = p;
  return pose;
}

}  // namespace

Frames framesOf(const Chain& chain) {
  std::vector<Step> steps = turned(chain.joints());
  slide(steps);

  Frames frames;
  frames.root = -(chain.joints().front().placement.R.transpose() * chain.gravity());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = steps[i];
    const auto length = [&](double value) { return std::abs(value) <= step.no_length ? 0 : value; };
    Placement X{};
    X.sin_twist = step.twist.s;
    X.cos_twist = step.twist.c;
    X.px = length(step.p.x());
    X.py = length(step.p.y() - step.slide * step.twist.s);
    X.rotor_inertia = chain.joints()[i].rotor_inertia;
    X.prismatic = isPrismatic(chain.joints()[i]);
    frames.quarter_turns.push_back(splitOffset(step.own_offset + step.turn, X));
    frames.general_offsets |= X.offset_sin != 0 && !X.prismatic;
    frames.placements.push_back(X);
    frames.moved.push_back({rotationAboutZ(-step.turn), {0, 0, -step.slide}});
  }
  return frames;
}

std::vector<Body> regrouped(const Frames& frames, const std::vector<LinkParameters>& links) {
  std::vector<Body> bodies(links.size());
  Matter from_next{0, Vector3<double>::Zero(), Matrix3<double>::Zero()};
  double mass_beyond = 0;
  for (std::size_t i = links.size(); i-- > 0;) {
    const Placement& X = frames.placements[i];
    Matter link = matterOf(frames.moved[i] * links[i]);
    link.m += from_next.m;
    link.mc += from_next.mc;
    link.S += from_next.S;
    from_next = moved(X, takeInvariant(X, link));
    mass_beyond += link.m;
    bodies[i] = {link.mc.x(),  link.mc.y(),  link.S(0, 0), link.S(0, 1), link.S(0, 2),
                 link.S(1, 1), link.S(1, 2), link.mc.z(),  link.m,       mass_beyond};
  }
  return bodies;
}

std::vector<OwnPlacement> ownPlacements(const Frames& frames, const Chain& chain) {
  std::vector<OwnPlacement> own(frames.placements.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    Angle offset{frames.placements[i].offset_cos, frames.placements[i].offset_sin};
    for (int turn = 0; turn < static_cast<int>(frames.quarter_turns[i]); ++turn) {
      offset = {-offset.s, offset.c};
    }
    // the root's placement is in the direction of gravity
    Transform<double> X = chain.joints()[i].placement;
    if (i == 0) X = Transform<double>::identity();
    Eigen::Map<Matrix3<double>>(own[i].R) = X.R * rotationAboutZ(-offset);
    Eigen::Map<Vector3<double>>(own[i].p) = X.p;
    own[i].prismatic = frames.placements[i].prismatic;
  }
  return own;
}

FixedPose baseOf(const Frames& frames, const Chain& chain) {
  // about the axis it turns with the angle, so all that is left is how far it is moved along it
  const Transform<double>& X = chain.joints().front().placement;
  return fixed(X.R, X.p - X.R * frames.moved.front().p);
}

FixedPose tipOf(const Frames& frames, const Chain& chain) {
  const Transform<double> X = frames.moved.back() * chain.tip();
  return fixed(X.R, X.p);
}

}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

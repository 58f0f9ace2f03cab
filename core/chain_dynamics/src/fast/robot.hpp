// SPDX-License-Identifier: Apache-2.0

/// @file
/// A robot as the fast kernels read it: plain numbers, nothing whose layout depends on compiler
/// flags.
///
/// Frames [Khalil and Kleinfinger 1986]: z of frame i is the axis of joint i, and x of frame i lies
/// along the common normal of this axis and the next one, so that
///
///     X_(i-1)i = RotX(twist_i) p_i RotZ(angle_i),   angle_i = q_i + offset_i
///
/// where z of p_i is zero (each frame may be moved along its axis), and so is x or y for most
/// robots; most twists are 0 or a right angle, and none is negative (x may point either way).

#pragma once

#include <cstddef>

#include "chain_dynamics/friction_laws/coefficients.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {

constexpr int kMaxJoints = 64;
constexpr int kMaxLaws = 128;  // of friction

/// One joint's place on its parent link. The first joint's is the root itself.
struct Placement {
  double sin_twist, cos_twist;
  double px, py;         ///< origin of frame i in frame i - 1 at q = 0, whose z is zero; m
  double rotor_inertia;  ///< adds to the diagonal of H
  double offset_cos;     ///< cosine of what the offset is beyond quarter turns
  double offset_sin;     ///< and sine; of all of it where the joint slides
  bool prismatic;
};

/// What is left of a link's ten parameters when those that torques don't depend on have been moved
/// to the parent link: seven for a joint that turns, four for one that slides; the others are zero.
///
/// S is the second moment of mass, `S = integral of r r' dm`, so that I = trace(S) 1 - S; Szz is
/// always zero.
template <typename Number>
struct BodyOf {
  Number mcx, mcy;                 ///< first moment
  Number Sxx, Sxy, Sxz, Syy, Syz;  ///< joints that turn only
  Number mcz, m;                   ///< joints that slide only
  Number mass_beyond;              ///< m of this link and all after it
};
using Body = BodyOf<double>;

/// How many numbers are of one body, of one friction law.
constexpr int kBodyNumbers = sizeof(Body) / sizeof(double);
constexpr int kFrictionNumbers = sizeof(FrictionNumbers<double>) / sizeof(double);

/// A joint's place in the frames of the robot's description, with the angles of Placement.
struct OwnPlacement {
  double R[9];  ///< of frame i in frame i - 1 where the angle is zero, column by column
  double p[3];  ///< origin; m
  bool prismatic;
};

/// A place that doesn't change.
struct FixedPose {
  double R[9];  ///< column by column
  double p[3];  ///< m
};

/// All of a robot. Pointers to arrays with one entry per joint, or null.
struct Robot {
  int joints;
  bool general_offsets;  ///< an offset isn't a number of quarter turns
  bool mixed;            ///< a joint slides
  double root[3];        ///< minus gravity, in the frame of the first joint at q = 0
  const Placement* placements;
  const OwnPlacement* own;      ///< the regressor's
  const double* quarter_turns;  ///< 0, 1, 2 or 3 per joint: part of the offset
  const Body* bodies;           ///< one set for all rows
  const Body* gravity_bodies;   ///< null: gravity has the same set
  const Body* const* rows;      ///< null: none; else joints sets of bodies: row j has set j
  const double* row_lanes;      ///< the same: [joint][number of Body][row]
  const double* friction;       ///< null: none; else [number of FrictionNumbers][law]
  const double* coupling;       ///< null: friction is of joints; else [law][joint]
  int laws;                     ///< of friction: joints, or more where there is coupling
  int law_stride;               ///< laws, and zeros to the end of a pack: rows of friction
  bool changing_steps;  ///< a step depends on load or (Stribeck) velocity, or there is coupling
  bool load_friction;   ///< on load
  int stride;           ///< joints, and zeros to the end of a pack: rows of row_lanes
  FixedPose base;       ///< of the first joint's frame at angle zero, in the root frame
  FixedPose tip;        ///< of the tip in the last frame
};

/// Numbers of many states: joint j of state k stands at data[j joint_step + k state_step].
struct Samples {
  double* data;
  std::ptrdiff_t joint_step, state_step;
};

/// Matrices of many states: entry (i, j) of state k stands at
/// data[i row_step + j column_step + k state_step].
struct Matrices {
  double* data;
  std::ptrdiff_t row_step, column_step, state_step;
};

/// Longest chain whose matrices of a pack of states fit on the stack: H, forward dynamics and
/// derivatives of many states are for these only.
constexpr int kPackedMatrixJoints = 16;

/// What goes into the Gram matrices of regressor_gram.hpp.
struct GramInputs {
  Samples q, qd, qdd, tau;
  const Samples* columns;  ///< a joint's own, beside those of the regressor
  int column_count;
  const Samples* weights;  ///< null: all one
  bool links;              ///< whether products of two numbers of links are wanted
  const double* rows;      ///< of links, for each kGramStates states; null: not made yet
};

/// States whose rows stand in memory at the same time.
constexpr int kGramStates = 32;

/// For each joint, one after the other: kGramStates rows, or sums of their products.
struct GramMemory {
  double* links;  ///< linksRow() numbers each; of no meaning where the rows are known
  bool keep;      ///< whether the rows of the next states go after these, not in their place
  double* own;    ///< ownRow() numbers each
  double* sums;   ///< matrices of ownRow() + linksRow(), of which the upper triangle is written
};

/// Numbers of a row with zeros to the end of a pack of any instruction set: those of the link of joint j
/// of so many and all after it; a joint's own columns and its torque.
constexpr std::ptrdiff_t linksRow(int joints, int j) {
  return (std::ptrdiff_t{10} * (joints - j) + 7) / 8 * 8;
}
constexpr std::ptrdiff_t ownRow(int column_count) {
  return std::ptrdiff_t{column_count + 1 + 7} / 8 * 8;
}
/// Numbers of the rows of links of all joints.
constexpr std::ptrdiff_t linksRows(int joints) {
  std::ptrdiff_t numbers = 0;
  for (int j = 0; j < joints; ++j) numbers += linksRow(joints, j);
  return numbers;
}

/// What one instruction set computes of one state. Vectors are written where nothing is read any
/// more: they may stand where an input does, as matrices may not.
struct Kernels {
  const char* name;

  /// Index of the structure compiled ahead of time that this robot has.
  int (*structure_of)(const Robot&);

  void (*torques)(const Robot&, int structure, const double* q, const double* qd, const double* qdd,
                  double* tau);
  void (*coriolis)(const Robot&, int structure, const double* q, const double* qd, double* c);
  void (*gravity)(const Robot&, int structure, const double* q, double* g);
  void (*inertia)(const Robot&, int structure, const double* q, Matrices H);
  void (*components)(const Robot&, int structure, const double* q, const double* qd, Matrices H,
                     double* c, double* g);
  /// q isn't read unless the robot has load_friction; likewise of many states.
  void (*friction)(const Robot&, int structure, const double* q, const double* qd, double* f);
  void (*forward_dynamics)(const Robot&, int structure, const double* q, const double* qd,
                           const double* tau, double* qdd);
  void (*regressor)(const Robot&, const double* q, const double* qd, const double* qdd, double* Y,
                    std::ptrdiff_t outer_step);
  /// The entries of a column stand side by side.
  void (*torque_derivatives)(const Robot&, int structure, const double* q, const double* qd,
                             const double* qdd, double* by_q, double* by_qd, double* by_qdd,
                             std::ptrdiff_t outer_step);
  void (*coriolis_matrix)(const Robot&, int structure, const double* q, const double* qd, double* C,
                          std::ptrdiff_t outer_step);
  /// R column by column, p.
  void (*tip_pose)(const Robot&, int structure, const double* q, double* R, double* p);
  /// The six entries of a column stand side by side.
  void (*tip_jacobian)(const Robot&, int structure, const double* q, double* J,
                       std::ptrdiff_t outer_step);
  void (*tip_jacobian_derivative)(const Robot&, int structure, const double* q, const double* qd,
                                  double* dJ, std::ptrdiff_t outer_step);
};

/// What it computes of many states, with the same structures. Inputs of Samples aren't written.
struct ManyKernels {
  void (*torques)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                  Samples qdd, Samples tau);
  void (*coriolis)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                   Samples c);
  void (*gravity)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Samples g);
  void (*inertia)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Matrices H);
  /// H is left out where its data are null.
  void (*components)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                     Matrices H, Samples c, Samples g);
  void (*friction)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                   Samples f);
  /// Of robots with one set of parameters for all rows.
  void (*forward_dynamics)(const Robot&, int structure, std::ptrdiff_t states, Samples q,
                           Samples qd, Samples tau, Samples qdd);
  void (*regressor)(const Robot&, std::ptrdiff_t states, Samples q, Samples qd, Samples qdd,
                    Matrices Y);
  void (*torque_derivatives)(const Robot&, int structure, std::ptrdiff_t states, Samples q,
                             Samples qd, Samples qdd, Matrices by_q, Matrices by_qd,
                             Matrices by_qdd);
  void (*coriolis_matrix)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Samples qd,
                          Matrices C);
  void (*tip_pose)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Matrices R,
                   Samples p);
  void (*tip_jacobian)(const Robot&, int structure, std::ptrdiff_t states, Samples q, Matrices J);
  void (*tip_jacobian_derivative)(const Robot&, int structure, std::ptrdiff_t states, Samples q,
                                  Samples qd, Matrices dJ);
  void (*gram)(const Robot&, std::ptrdiff_t states, const GramInputs& inputs, const GramMemory& to);

  /// For tests: sine and cosine of count angles plus quarter turns.
  void (*sine_cosine)(int count, const double* angle, const double* quarter_turns, double* sine,
                      double* cosine);
};

/// The tables of the instruction sets that this build has; of many states, for robots of so many
/// joints.
const Kernels& kernelsPortable();
const Kernels& kernelsV3();  // x86-64 only
const Kernels& kernelsV4();  // x86-64 only, with the option CHAIN_DYNAMICS_AVX512
const ManyKernels& manyKernelsPortable(int joints);
const ManyKernels& manyKernelsV3(int joints);  // x86-64 only
const ManyKernels& manyKernelsV4(int joints);  // x86-64 only, with that option

}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

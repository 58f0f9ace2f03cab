// SPDX-License-Identifier: Apache-2.0

/// @file
/// What is known of a robot when the kernels are compiled: number of joints, right angles, zeros.
///
/// Included by the kernels' two sources only [pack.hpp]. Lengths and inertias are always read at run
/// time; a structure saves the multiplications by zero and one, loops and branches.

#pragma once

#include "pack.hpp"
#include "robot.hpp"

namespace chain_dynamics {
inline namespace v2 {
namespace fast {
namespace {

/// Angle between the axes of two joints: zero, a right angle, a right angle within 1e-8, any.
enum class Twist { kNone, kRight, kAlmostRight, kAny };

/// An index that is a constant for the compiler.
template <int I>
struct Constant {
  constexpr operator int() const { return I; }  // NOLINT(google-explicit-constructor)
};

template <int I, int End, typename Step>
FAST_INLINE void countUp(const Step& step) {
  if constexpr (I < End) {
    step(Constant<I>());
    countUp<I + 1, End>(step);
  }
}
template <int I, typename Step>
FAST_INLINE void countDown(const Step& step) {
  if constexpr (I >= 0) {
    step(Constant<I>());
    countDown<I - 1>(step);
  }
}

/// Nothing is known but that there are at most so many joints.
template <int Most>
struct AnyOf {
  static constexpr bool kMixed = true;
  static constexpr bool kRows = true;
  static constexpr bool kAligned = false;
  static constexpr int kJoints = Most;
  static int count(const Robot& robot) { return robot.joints; }
  template <int I>
  static constexpr Twist twist(Constant<I>) {
    return Twist::kAny;
  }
  static constexpr Twist twist(int) { return Twist::kAny; }
  static constexpr bool px(int) { return true; }
  static constexpr bool py(int) { return true; }

  /// step(i) for i = first .. joints - 1, and back for i = joints - 1 .. first.
  template <typename Step>
  static FAST_INLINE void forwards(const Robot& robot, const Step& step) {
    for (int i = 0; i < robot.joints; ++i) step(i);
  }
  template <typename Step>
  static FAST_INLINE void backwards(const Robot& robot, int first, const Step& step) {
    for (int i = robot.joints - 1; i >= first; --i) step(i);
  }
  /// step(first) for first = 0, width, 2 width .. < joints.
  template <int Width, typename Step>
  static FAST_INLINE void inSteps(const Robot& robot, const Step& step) {
    for (int first = 0; first < robot.joints; first += Width) step(first);
  }

  /// step(j) for j = from .. 1.
  template <typename Step>
  static FAST_INLINE void backwardsFrom(int from, const Step& step) {
    for (int j = from; j > 0; --j) step(j);
  }
  static bool covers(const Robot& robot) { return robot.joints <= Most; }
};
using AnyStructure = AnyOf<kMaxJoints>;

/// Which kinds of joints and parameters a known structure has.
enum class Has { kTurns, kSlides, kRows };

/// What is known of the placements of N joints; nothing of the first one's, which is the root.
template <int N>
struct Geometry {
  Twist twist[N];
  bool px[N], py[N];  ///< whether px, py may differ from zero

  constexpr bool isAligned() const {
    for (const Twist angle : twist)
      if (angle == Twist::kAny) return false;
    return true;
  }
};

/// Joints that turn, or also such that slide (Has::kSlides). Has::kRows: each row may have its own
/// parameters.
template <int N, const Geometry<N>& Places, Has Kind = Has::kTurns>
struct Known {
  static constexpr bool kMixed = Kind == Has::kSlides;
  static constexpr bool kRows = Kind == Has::kRows;
  static constexpr bool kAligned = Places.isAligned();
  static constexpr int kJoints = N;
  static constexpr int count(const Robot&) { return N; }
  static constexpr Twist twist(int i) { return Places.twist[i]; }
  static constexpr bool px(int i) { return Places.px[i]; }
  static constexpr bool py(int i) { return Places.py[i]; }

  template <typename Step>
  static FAST_INLINE void forwards(const Robot&, const Step& step) {
    countUp<0, N>(step);
  }
  template <typename First, typename Step>
  static FAST_INLINE void backwards(const Robot&, First first, const Step& step) {
    countDown<N - 1>([&](auto i) FAST_LAMBDA {
      if (i >= first) step(i);
    });
  }
  template <int Width, typename Step>
  static FAST_INLINE void inSteps(const Robot&, const Step& step) {
    countUp<0, (N + Width - 1) / Width>(
        [&](auto k) FAST_LAMBDA { step(Constant<decltype(k)() * Width>()); });
  }
  template <int I, typename Step>
  static FAST_INLINE void backwardsFrom(Constant<I> from, const Step& step) {
    if constexpr (I > 0) {
      step(from);
      backwardsFrom(Constant<I - 1>(), step);
    }
  }

  /// Whether the robot has this structure, or one with more zeros.
  static bool covers(const Robot& robot) {
    if (robot.joints != N || (robot.mixed && !kMixed)) return false;
    if (robot.rows != nullptr && !kRows) return false;
    for (int i = 1; i < N; ++i) {
      const Placement& X = robot.placements[i];
      const bool fits = twist(i) == Twist::kNone          ? X.sin_twist == 0 && X.cos_twist == 1
                        : twist(i) == Twist::kRight       ? X.sin_twist == 1 && X.cos_twist == 0
                        : twist(i) == Twist::kAlmostRight ? X.sin_twist == 1
                                                          : true;
      if (!fits || (!px(i) && X.px != 0) || (!py(i) && X.py != 0)) return false;
    }
    return true;
  }
};

}  // namespace
}  // namespace fast
}  // namespace v2
}  // namespace chain_dynamics

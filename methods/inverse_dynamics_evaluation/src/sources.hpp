// SPDX-License-Identifier: Apache-2.0

/// @file
/// Samples and stamps that contradict the others: a second publisher, a clock that was set.
///
///     const SecondSource other = markSecondSource(table);
///     const std::vector<ClockStep> steps = undoClockSteps(table, 0.25);

#pragma once

#include <vector>

#include "inverse_dynamics_evaluation/samples.hpp"

namespace inverse_dynamics_evaluation {
inline namespace v2 {

/// Marks the samples of a second publisher, or of messages that are empty or garbled.
///
/// No arm's velocities are all exactly zero in one sample and not in the ones around it, in which joints go
/// on in the same direction. It is a second source if its efforts are zero, too, or its positions jump there
/// and back. A source that moves shows by positions that leave the motion around them, faster than velocities
/// allow, and return. The marks are those of repeats: such samples say nothing new.
///
/// @throws EvaluationError: more than one sample in ten belongs to a second source that moves.
SecondSource markSecondSource(SampleTable& table);

/// Marks samples beside several repeats that are late themselves: positions contradict the velocities on both sides, and
/// those of the samples around don't. Times are those of a clock that goes on.
void markLate(SampleTable& table);

/// Shifts the times behind each step of the clock, so that time goes on.
///
/// A clock stepped if stamps fall back and stay back, or go forward and stay there although positions and
/// velocities say that one period has passed. Where they confirm one period, the samples behind the step follow
/// one period later; else they follow behind a gap. A step forward that is longer stays: it is a gap.
///
/// @param gap  s; longer than any that is bridged.
std::vector<ClockStep> undoClockSteps(SampleTable& table, double gap);

}  // namespace v2
}  // namespace inverse_dynamics_evaluation

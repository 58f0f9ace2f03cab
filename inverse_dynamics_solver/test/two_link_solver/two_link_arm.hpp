// SPDX-License-Identifier: Apache-2.0
/// @file
/// The figures of the two-link arm.
#pragma once

namespace two_link_solver {

// Masses [kg] and lengths [m] of the two links.
constexpr double m1 = 3.0, m2 = 2.0, l1 = 0.7, l2 = 0.5;

}  // namespace two_link_solver

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which gravity an arm may stand in: far beyond what any vehicle or centrifuge does, and small enough
/// that no product of the numbers of a chain overflows.
#pragma once

namespace chain_dynamics {
inline namespace v2 {

/// Of each component, also of an acceleration of the base; m/s^2. About a hundred thousand times
/// that of the Earth.
constexpr double kGreatestGravity = 1e6;

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// From joint axes of any direction to the z axis that a Chain asks for.
///
/// U is the link frame of the file (URDF, model file), E that of the Chain: same origin, turned so
/// that z of E is the joint axis.

#pragma once

#include <string>

#include "chain_dynamics/chain.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// A rotation that turns z onto an axis; identity for z itself, half a turn about x for -z.
///
/// The smallest one for axes above the xy plane; after that half turn for those below.
/// @param axis  of unit length.
Matrix3<double> rotationFromZ(const Vector3<double>& axis);

/// URDF's roll, pitch, yaw [rad]: `RotZ(yaw) RotY(pitch) RotX(roll)`.
Matrix3<double> rotationFromRollPitchYaw(const Vector3<double>& rpy);

/// The inverse: pitch within a quarter turn.
Vector3<double> rollPitchYaw(const Matrix3<double>& R);

/// Parameters with the last bits of rounding removed that make a moved inertia asymmetric.
LinkParameters symmetric(const LinkParameters& link);

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// The geometry of a model file: Denavit-Hartenberg parameters, or placements as in a URDF.
///
///     const JointGeometry geometry = readDH(map.required("dh").map(), Geometry::kStandardDH);
///
/// The file's frame of a link is U, the chain's is E, whose z is the joint's axis.

#pragma once

#include <Eigen/Core>

#include "chain_dynamics/located_yaml.hpp"
#include "chain_dynamics/spatial.hpp"

namespace chain_dynamics {
inline namespace v2 {

enum class Geometry { kModifiedDH, kStandardDH, kPlacements };

/// Where a joint sits.
struct JointGeometry {
  Transform<double> placement = Transform<double>::identity();  // E in the previous link's U
  Transform<double> X_EU = Transform<double>::identity();       // differs from link to link
};

Eigen::Vector3d readVector(const LocatedValue& value);

/// The keys `xyz` [m] and `rpy` [rad].
Transform<double> readPose(LocatedMap& map);

/// Modified (Craig): U_i = E_i, and U_(i-1) to U_i is RotX(alpha) TransX(a) RotZ(q + offset)
/// TransZ(d). Standard: U_(i-1) to U_i is RotZ(q + offset) TransZ(d) TransX(a) RotX(alpha): the
/// joint turns about z of U_(i-1), and E_i stands after the first half.
JointGeometry readDH(LocatedMap map, Geometry geometry);

/// As in a URDF: U_i in U_(i-1) at q = 0, and the joint's axis in U_i.
JointGeometry readPlacement(LocatedMap map);

}  // namespace v2
}  // namespace chain_dynamics

// SPDX-License-Identifier: Apache-2.0

/// @file
/// What urdfdom lets pass or only prints is an error here, with the line.
///
///     const auto model = urdf::parseURDF(checkedUrdf(urdf_xml));
///
/// urdfdom (3.0) reads a malformed `<inertial>` as no mass, or a mass without inertia, after
/// printing a line; it accepts negative masses, zero axes, links with two parents and loops; and it
/// returns nothing but a null pointer where it does refuse. So the text is read twice: here for
/// being sound, there for its meaning.

#pragma once

#include <string>

namespace chain_dynamics {
inline namespace v2 {

/// The description without what a Chain doesn't use (looks, collision shapes, transmissions).
///
/// @param urdf_xml  text of a URDF.
/// @throws ModelError  `URDF:line: joint or link: what: expected ..., got ...; remedy`.
std::string checkedUrdf(const std::string& urdf_xml);

}  // namespace v2
}  // namespace chain_dynamics

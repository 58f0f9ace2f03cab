// SPDX-License-Identifier: Apache-2.0

/// @file
/// A proof that the inertia matrix of a chain is positive definite for every q.
///
/// Twice the kinetic energy, `qd' H(q) qd`, is the sum over the links of `V' I V` and over the
/// rotors of `rotor_inertia qd_i^2`. It is assumed of every link, and checked, that `V' I V` is
/// never negative. Then the energy vanishes only if each of these terms does.
///
/// **Joint by joint.** Let all joints before joint i be at rest. Link i then moves by `V = S qd_i`,
/// and if `rotor_inertia_i + S' I_i S > 0`, with the inertia of link i alone, joint i is at rest as
/// well. By induction from the root, no energy means no velocity: H is definite.
///
/// **Group by group.** Where link i has too little inertia (a multi-axis joint of massless links),
/// joints i to k are taken together: the same induction goes on behind joint k if the inertia
/// matrix G of these joints and their own links is definite for every position of joints i + 1 to
/// k; it doesn't depend on joint i. For the shortest groups that will do, this is necessary, too.
///
/// **Every position.** For a constant x, `p = x' G x` is a trigonometric polynomial of degree two
/// in each angle, since V is of degree one. Scale the joints so that the diagonal of G never
/// exceeds one: then 0 <= p <= r for |x| = 1 and r joints, and by Bernstein's inequality for
/// p - r / 2 all second derivatives are within 2 r. If G is singular somewhere, p = 0 is a minimum
/// for some x, so that its first derivatives vanish there, too, and at a distance of d_j in angle j
/// the least eigenvalue of G is at most `r (d_1 + ... + d_m)^2`. So a box of angles, of half widths
/// d_j, at whose center it is greater, contains no singular position; any other box is halved.
///
/// **Slides behind a turn** may be of any length, and p isn't bounded. Energy isn't less than that
/// of the links' turning about their centers of mass, which depends on angles only. If this has a
/// definite matrix, no energy means that no joint turns. What is left is the energy of the slides,
/// whose matrix depends on angles only, too.
///
/// **Branch by branch.** A mechanism's energy is the sum of those of its branches [mechanism.hpp]. If the
/// first has none, none of its joints moves. Then those of the second move as if the joints that both
/// share were held, and the same induction goes on. Joints at rest are coordinates at rest, because S has
/// full column rank.
///
/// All comparisons leave room for rounding: what is within 1e-11 of singular counts as singular.

#pragma once

#include <vector>

#include "chain_dynamics/chain.hpp"
#include "chain_dynamics/mechanism.hpp"

namespace chain_dynamics {
inline namespace v2 {

/// Whether H(q) is proved to be positive definite for every q; false where the proof fails or takes
/// too long (groups of more than six joints, or too near to a singular position).
bool inertiaIsDefinite(const Chain& chain);

/// The same of the mechanism that these are the branches of.
bool inertiaIsDefinite(const std::vector<Branch>& branches);

}  // namespace v2
}  // namespace chain_dynamics

# SPDX-License-Identifier: Apache-2.0
"""Motions that a search for an exciting one chooses from: waypoints, and slow reversals between rests.

    family = MotionFamily.of(joint_names, limits, duration=20.0, slow=4.0, moving=mask)
    trajectory = family.member(x)                     # x (family.size,), zeros: still in the middle of the range
    q, qd, qdd = family.states(x, family.basis(time))
    gradient = family.pulled_back((dq, dqd, dqdd), family.basis(time))

A motion begins and ends at rest in one pose. Where time is given to friction, the arm moves all joints slowly there and
back in that pose before it sets out, and once more in another pose half-way. The motion is linear in x, so that
derivatives by x cost nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.simulation.trajectory import WaypointTrajectory

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.simulation.limits import MotionLimits

    Basis = tuple[Floats, Floats, Floats]
    """Positions of all waypoints (K) to positions, velocities, accelerations at N times: (N, K) each."""

KNOTS = 0.5  # s between waypoints
SLOW_SPEED = 0.05  # part of the velocity limit, the greatest in slow reversals
_BUMP_SPEED = 1.12 * np.pi  # greatest speed of a slow motion there and back, of 1 rad in 1 s
_BUMP = np.array([0.0, 0.5, 1.0, 0.5, 0.0])  # waypoints of a slow motion there and back


@dataclass(frozen=True)
class MotionFamily:
    """Waypoint motions of n joints that start and end in the first pose."""

    joint_names: tuple[str, ...]
    times: Floats  # (K,) s
    rests: tuple[int, ...]
    pose_of: Floats  # (K, P): 1 where a waypoint is that free pose
    offsets: Floats  # (K, n) rad, what slow reversals add
    middle: Floats  # (n,) rad
    waves: Floats  # (P, P): free poses of waves in time, from a constant to the fastest
    amplitudes: Floats  # (P, n) rad, of waves that use up the limits; 0: of joints that don't move
    reversals: tuple[int, ...]  # waypoints at which all joints turn back slowly
    slow_poses: tuple[int, ...]  # the free poses that they belong to

    @classmethod
    def of(
        cls,
        joint_names: tuple[str, ...],
        limits: MotionLimits,
        *,
        duration: float,
        slow: float,
        moving: Mask,
    ) -> MotionFamily:
        """duration: s; slow: s of it, for two slow reversals; 0: none."""
        halves = 2 if slow else 1
        fast = (duration - slow) / halves
        count = max(2, round(fast / KNOTS))
        legs = []  # duration, poses and bumps of the waypoints of each part between rests
        for half in range(halves):
            begin, end = half * count, 0 if half == halves - 1 else (half + 1) * count
            if slow:
                legs.append((slow / 2, 4 * [begin], _BUMP[1:]))
            legs.append((fast, [*range(begin + 1, begin + count), end], np.zeros(count)))
        times, poses, bumps, rests = [0.0], [0], [0.0], []
        for seconds, ahead, bump in legs:
            times += list(times[-1] + seconds * np.arange(1, len(ahead) + 1) / len(ahead))
            poses += ahead
            bumps += list(bump)
            rests.append(len(times) - 1)
        lower, upper = limits.window()
        way = SLOW_SPEED * limits.velocity * (slow / 2) / _BUMP_SPEED
        reversals = tuple(np.flatnonzero(np.array(bumps) == _BUMP.max()).tolist())
        count = max(poses) + 1
        frequency = np.pi * np.arange(count)[:, None] / duration
        slowness = 2.0 / (upper - lower) + frequency / limits.velocity
        slowness = slowness + frequency**2 / limits.acceleration + frequency**3 / limits.jerk
        amplitudes = np.where((frequency == 0.0) | moving, 1.0 / slowness, 0.0)
        return cls(
            joint_names=joint_names,
            times=np.array(times),
            rests=tuple(rests[:-1]),
            pose_of=np.eye(count)[poses],
            offsets=np.outer(bumps, np.where(moving, way, 0.0)),
            middle=(lower + upper) / 2,
            waves=_waves(count),
            amplitudes=amplitudes,
            reversals=reversals,
            slow_poses=tuple(poses[k] for k in reversals),
        )

    @property
    def size(self) -> int:
        """How many free numbers there are."""
        return self.amplitudes.size

    def positions(self, x: Floats) -> Floats:
        """Waypoints (K, n) [rad]."""
        waves = self.waves @ (self.amplitudes * x.reshape(self.amplitudes.shape))
        return np.asarray(self.pose_of @ (self.middle + waves) + self.offsets)

    def member(self, x: Floats) -> WaypointTrajectory:
        """The motion of free numbers x (size,)."""
        return WaypointTrajectory.through(
            self.joint_names, self.times, self.positions(x), self.rests
        )

    def basis(self, time: Floats) -> Basis:
        """Matrices that turn positions of waypoints into the motion at those times."""
        unit = WaypointTrajectory.through((), self.times, np.eye(len(self.times)), self.rests)
        return unit.at(time)

    def states(self, x: Floats, basis: Basis) -> tuple[Floats, Floats, Floats]:
        """q, qd, qdd (N, n)."""
        positions = self.positions(x)
        return basis[0] @ positions, basis[1] @ positions, basis[2] @ positions

    def pulled_back(self, slopes: Sequence[Floats], basis: Basis) -> Floats:
        """Gradient by x (size,) of what has three gradients (N, n), by q, qd and qdd."""
        by_waypoint = sum(values.T @ slope for values, slope in zip(basis, slopes, strict=True))
        return self.of_poses(self.pose_of.T @ by_waypoint)

    def of_poses(self, gradient: Floats) -> Floats:
        """Gradient by x of what has this gradient (P, n) by the free poses."""
        return np.asarray((self.amplitudes * (self.waves.T @ gradient)).ravel())


def _waves(count: int) -> Floats:
    """Columns: cosines of 0, 1/2, 1, ... turns over `count` poses, of amplitude one."""
    at = (np.arange(count) + 0.5) / count
    return np.asarray(np.cos(np.pi * np.outer(at, np.arange(count))))

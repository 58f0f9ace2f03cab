# SPDX-License-Identifier: Apache-2.0
"""Limits of a robot, and the place where a trajectory exceeds them.

    check_trajectory(robot, trajectory, MotionLimits.of(robot), ContactChecker(robot))

raises a TrajectoryError that names joint, time, value and limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.simulation.errors import SimulationError, TrajectoryError

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.simulation.collision import ContactChecker
    from inverse_dynamics.simulation.model import SimulatedRobot
    from inverse_dynamics.simulation.trajectory import Trajectory
    from inverse_dynamics.simulation.urdf import UrdfChain

CHECK_STEP = 0.01
"""Trajectories are checked at points this far apart [s]."""

_ROUNDING = 1e-9  # a trajectory that fills its limits isn't beyond them


@dataclass(frozen=True)
class MotionLimits:
    """Greatest values of a motion, n each; infinite where there is none."""

    lower: Floats  # rad
    upper: Floats  # rad
    velocity: Floats  # rad/s
    acceleration: Floats  # rad/s^2
    effort: Floats  # N m
    jerk: Floats  # rad/s^3

    @classmethod
    def of(cls, robot: SimulatedRobot, time_to_full_speed: float = 0.0) -> MotionLimits:
        """The URDF's limits. Where it states none of accelerations, they are what the effort limits leave.

        time_to_full_speed: s; above zero, accelerations are limited to what reaches the velocity limit in this time.
        """
        chain = robot.chain
        acceleration = chain.acceleration
        if time_to_full_speed > 0:
            acceleration = np.minimum(acceleration, chain.velocity / time_to_full_speed)
        return cls(chain.lower, chain.upper, chain.velocity, acceleration, chain.effort, chain.jerk)

    def window(self) -> tuple[Floats, Floats]:
        """Lowest and highest positions (n,) of a motion: at most one turn."""
        return np.maximum(self.lower, -np.pi), np.minimum(self.upper, np.pi)

    def fraction(self, fraction: float) -> MotionLimits:
        """Limits with a margin: positions about the middle of their range."""
        width = self.upper - self.lower
        margin = np.where(np.isfinite(width), (1.0 - fraction) / 2 * width, 0.0)
        return MotionLimits(
            self.lower + margin,
            self.upper - margin,
            fraction * self.velocity,
            fraction * self.acceleration,
            fraction * self.effort,
            fraction * self.jerk,
        )


def require_limits(chain: UrdfChain, what: str) -> None:
    """Raises SimulationError where the description limits no velocity or effort; what: needs them."""
    for limit, values in (("a velocity", chain.velocity), ("an effort", chain.effort)):
        for joint, value in zip(chain.joint_names, values, strict=True):
            if not (np.isfinite(value) and value > 0):
                raise SimulationError(
                    f"robot description: joint {joint}: {what} needs {limit} limit, got {value:g}; "
                    f"add <limit {limit.split()[1]}=.../>"
                )


def check_trajectory(
    robot: SimulatedRobot,
    trajectory: Trajectory,
    limits: MotionLimits,
    checker: ContactChecker | None,
    step: float = CHECK_STEP,
) -> None:
    """Raises TrajectoryError naming joint, time, value and limit where a trajectory demands too much.

    Torques are those of the robot with its payload and gravity, friction included. checker None: contacts are allowed.
    step: s between the points that are checked, at most; contacts are looked for at most CHECK_STEP apart.
    """
    if trajectory.joint_names != robot.chain.joint_names:
        raise TrajectoryError(
            f"trajectory: expected joints {', '.join(robot.chain.joint_names)} in this order; "
            f"got {', '.join(trajectory.joint_names)}; is it for another robot?"
        )
    time = np.linspace(0.0, trajectory.duration, 1 + int(np.ceil(trajectory.duration / step)))
    q, qd, qdd = trajectory.at(time)
    tau = robot.torques(q, qd, qdd)
    if robot.friction is not None:
        tau = tau + robot.friction.torques(qd, q)
    for what, unit, values, least, greatest in (
        ("position", "rad", q, limits.lower, limits.upper),
        ("velocity", "rad/s", qd, -limits.velocity, limits.velocity),
        ("acceleration", "rad/s^2", qdd, -limits.acceleration, limits.acceleration),
        ("jerk", "rad/s^3", np.gradient(qdd, time, axis=0), -limits.jerk, limits.jerk),
        ("effort", "N m", tau, -limits.effort, limits.effort),
    ):
        rounding = _ROUNDING * (1.0 + np.abs(values))
        beyond = (values < least - rounding) | (values > greatest + rounding)
        for k, j in np.argwhere(beyond)[:1]:
            raise TrajectoryError(
                f"trajectory: joint {robot.chain.joint_names[j]}: {what} at {time[k]:.2f} s: expected "
                f"{least[j]:.4g} to {greatest[j]:.4g} {unit}, got {values[k, j]:.4g}; "
                "make the motion slower or smaller, or let --optimise find one"
            )
    if checker is not None:
        every = max(1, round(CHECK_STEP / step))
        _check_contacts(time[::every], q[::every], checker)


def _check_contacts(time: Floats, q: Floats, checker: ContactChecker) -> None:
    for k in np.flatnonzero(checker.violations(q) > 0)[:1]:
        distance, one, other = checker.closest_pair(q[k])
        raise TrajectoryError(
            f"trajectory: at {time[k]:.2f} s {one} and {other}: expected a distance of "
            f"at least {checker.clearance:g} m, got {distance:.3f} m; "
            "change the motion, or let --optimise find one"
        )

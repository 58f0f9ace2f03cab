# SPDX-License-Identifier: Apache-2.0
"""A joint trajectory controller as ros2_control users know it, with effort as command interface.

    controller = JointTrajectoryController(gains, desired, effort_limit, period=1 / 500)
    command = controller.update(k, q, qd)          # at tick k

    command = ff_velocity_scale qd_d + effort_d + p (q_d - q) + i integral(q_d - q) + d (qd_d - qd)

limited to what the actuator can give. `effort_d` is the `effort` of the trajectory's points, the feed-forward of
joint_trajectory_controller. The integral term stays within +-i_clamp, and doesn't grow while the command is at its
limit and the error would drive it further (conditional integration, as in control_toolbox).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.simulation.model import SimulatedRobot
    from inverse_dynamics.simulation.trajectory import Trajectory

FASTEST = 60.0
"""Greatest natural frequency of a joint's error with default gains [rad/s]."""

_STATES = 50  # of a trajectory, that default gains suit
_DAMPING_RATIO = 0.75  # of the default gains, where a joint is lightest
_SAMPLED_DAMPING = 1.2  # damping rate times period; a sampled velocity loop is unstable from 2 on
_UPRIGHT = 2.0  # stiffness over the slope of the toppling torque; 1 is marginally stable


def _toppling(robot: SimulatedRobot, q: Floats) -> Floats:
    """(n,) N m/rad, greatest slope of gravity that drives a joint away from states q (N, n)."""
    step, still = 1e-4, np.zeros_like(q)  # rad, m
    slopes = []
    for j, move in enumerate(step * np.eye(q.shape[1])):
        ahead, behind = (robot.torques(x, still, still)[:, j] for x in (q + move, q - move))
        slopes.append((behind - ahead).max() / (2 * step))
    return np.maximum(slopes, 0.0)


@dataclass(frozen=True)
class Gains:
    """Gains per joint, n each; names as in the parameters of joint_trajectory_controller."""

    p: Floats  # N m/rad
    i: Floats  # N m/(rad s)
    d: Floats  # N m s/rad
    i_clamp: Floats  # N m
    ff_velocity_scale: Floats  # N m s/rad


def default_gains(robot: SimulatedRobot, trajectory: Trajectory, rate: int) -> Gains:
    """Gains that suit a robot along a trajectory, for a controller with this rate [Hz].

    Well damped for the least inertia h_j each joint shows along the way while the others yield, 1 / (H^-1)_jj. All
    joints get one natural frequency w. The greatest eigenvalue of H^-1 diag(h) limits it: there the arm is lightest,
    and the sampled damping must be stable. The least eigenvalue, where the arm is heaviest, limits the integral. A
    joint that carries its load above its axis gets enough stiffness to keep the load there.
    """
    q = trajectory.at(np.linspace(0.0, trajectory.duration, _STATES))[0]
    inverses = np.linalg.inv([robot.inertia_matrix(x) for x in q])
    h = 1.0 / np.diagonal(inverses, axis1=1, axis2=2).max(axis=0)
    # H^-1 diag(h) has the eigenvalues of this symmetric matrix
    eigenvalues = np.linalg.eigvalsh(np.sqrt(h)[:, None] * inverses * np.sqrt(h))
    w = min(FASTEST, 0.5 * _SAMPLED_DAMPING / _DAMPING_RATIO * rate / eigenvalues.max())
    no_friction = np.zeros_like(h)
    return Gains(
        p=np.maximum(h * w**2, _UPRIGHT * _toppling(robot, q)),
        i=h * w**3 * eigenvalues.min() / 5,
        d=2 * _DAMPING_RATIO * h * w,
        i_clamp=np.where(np.isfinite(robot.chain.effort), 0.2 * robot.chain.effort, np.inf),
        ff_velocity_scale=no_friction if robot.friction is None else robot.friction.viscous,
    )


@dataclass(frozen=True)
class DesiredMotion:
    """Trajectory points at the ticks of the controller, (K, n) each."""

    q: Floats
    qd: Floats
    effort: Floats  # feed-forward, for the period that follows the tick


class JointTrajectoryController:
    """Follows desired points; one update per tick. Holds the integral of the error."""

    def __init__(
        self, gains: Gains, desired: DesiredMotion, effort_limit: Floats, period: float
    ) -> None:
        self._gains, self._desired = gains, desired
        self._limit, self._period = effort_limit, period
        self._feed_forward = desired.effort + gains.ff_velocity_scale * desired.qd
        self._integral = np.zeros_like(effort_limit)  # N m
        self._saturated = self._integral  # -1, 0, 1 per joint, at the last tick

    def update(self, k: int, q: Floats, qd: Floats) -> Floats:
        """Command (n,) at tick k for the measured state; within the effort limits."""
        gains = self._gains
        error = self._desired.q[k] - q
        grows = error * self._saturated > 0
        integral = self._integral + np.where(grows, 0.0, gains.i * error * self._period)
        self._integral = np.minimum(np.maximum(integral, -gains.i_clamp), gains.i_clamp)
        wanted = (
            self._feed_forward[k]
            + gains.p * error
            + self._integral
            + gains.d * (self._desired.qd[k] - qd)
        )
        command: Floats = np.minimum(np.maximum(wanted, -self._limit), self._limit)
        self._saturated = np.sign(wanted - command)
        return command

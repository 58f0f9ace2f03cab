# SPDX-License-Identifier: Apache-2.0
"""The robot under its controller, step by step: from a trajectory to a motion with its torques.

    motion = follow(robot, trajectory, rate=500, duration=20.0)
    motion.q, motion.effort, motion.qdd

The controller's command is held between its updates (zero-order hold); the actuator applies it. A sample is taken in
the middle of each period: there position, velocity, applied torque and MuJoCo's own acceleration belong to one instant,

    effort = H(q) qdd + C(q, qd) qd + g(q) + friction,

and the steps of the held torque lie half a period before and after it, so that differences of velocities are estimates
of that very acceleration. (At the ticks the acceleration jumps, and they would be late by half a period.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.installation.extras import lazily_imported
from inverse_dynamics.progress import no_progress
from inverse_dynamics.simulation.controller import (
    DesiredMotion,
    JointTrajectoryController,
    default_gains,
)
from inverse_dynamics.simulation.errors import SimulationError

if TYPE_CHECKING:
    import mujoco

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.simulation.controller import Gains
    from inverse_dynamics.simulation.model import SimulatedRobot
    from inverse_dynamics.simulation.trajectory import Trajectory
else:
    mujoco = lazily_imported("mujoco", "a simulation")

MOST_SAMPLES = 10_000_000  # of a simulation: some gigabytes
RATES = (125, 500, 1000)
"""Update rates of the controller [Hz]."""

LONGEST_STEP = 5e-4
"""Of the integrator (Runge-Kutta of fourth order) [s]."""

# rad (prismatic m) from the trajectory: where controllers of real arms usually stop.
_LOST = 0.2

_PROGRESS_EVERY = 500  # ticks


@dataclass(frozen=True)
class Response:
    """A robot under held commands: N samples of n joints, as they are, without any sensor's error."""

    time: Floats  # (N,) s since the start; likewise (N, n):
    q: Floats  # rad
    qd: Floats  # rad/s
    qdd: Floats  # rad/s^2, MuJoCo's
    effort: Floats  # N m, what the actuators applied
    friction: Floats  # N m, the part of effort that friction takes


@dataclass(frozen=True)
class Motion(Response):
    """The response of a robot that follows a trajectory."""

    q_desired: Floats  # rad
    gains: Gains


Command = Callable[[int, "Floats", "Floats"], "Floats"]
"""Torques (n,) [N m] for the period that begins at tick k, from k, q and qd (n,)."""


def check_rate(rate: int) -> None:
    """Raises SimulationError unless it is one of RATES."""
    if rate not in RATES:
        raise SimulationError(f"rate: expected one of {', '.join(map(str, RATES))} Hz, got {rate}")


def follow(
    robot: SimulatedRobot,
    trajectory: Trajectory,
    *,
    rate: int,
    duration: float,
    gains: Gains | None = None,
    progress: Progress = no_progress,
) -> Motion:
    """Motion of a robot that starts on a trajectory and follows it for `duration` seconds."""
    check_rate(rate)
    if not duration * rate <= MOST_SAMPLES:
        raise SimulationError(
            f"duration: expected at most {MOST_SAMPLES // rate} s at {rate} Hz, got {duration:g} s"
        )
    ticks = int(np.floor(duration * rate + 1e-9))
    if ticks < 2:
        raise SimulationError(
            f"duration: expected at least two periods of the controller ({2 / rate:g} s), got {duration:g} s"
        )
    time = np.arange(ticks) / rate
    middle = time + 0.5 / rate
    desired = _desired_motion(robot, trajectory, time, middle)
    gains = gains or default_gains(robot, trajectory, rate)
    controller = JointTrajectoryController(gains, desired, robot.chain.effort, 1.0 / rate)
    response = drive(
        robot,
        controller.update,
        desired.q[0],
        desired.qd[0],
        rate=rate,
        ticks=ticks,
        progress=progress,
    )
    return Motion(**vars(response), q_desired=trajectory.at(middle)[0], gains=gains)


def check_followed(motion: Motion, robot: SimulatedRobot) -> None:
    """Raise SimulationError where a motion has left its trajectory."""
    error = np.abs(motion.q - motion.q_desired)
    if not (error > _LOST).any():
        return
    k = int((error > _LOST).any(axis=1).argmax())
    j = int(error[k].argmax())
    raise SimulationError(
        f"joint {robot.chain.joint_names[j]} doesn't follow the trajectory: expected at most {_LOST:g} rad "
        f"(prismatic m) from it, got more from {motion.time[k]:.2f} s on, and {error[:, j].max():.3g} at worst; "
        "give a higher --rate, a slower motion, less --payload or friction, or `gains` under "
        "`simulation:` of the run configuration"
    )


def drive(
    robot: SimulatedRobot,
    command: Command,
    q_start: Floats,
    qd_start: Floats,
    *,
    rate: int,
    ticks: int,
    progress: Progress = no_progress,
) -> Response:
    """Response of a robot from a state to any controller, called `ticks` times."""
    model, data, dofs = robot.model, robot.new_data(), robot.dofs
    half = int(np.ceil(0.5 / rate / LONGEST_STEP))
    model.opt.timestep = 0.5 / rate / half
    data.qpos[:], data.qvel[:] = robot.S @ q_start + robot.s, robot.S @ qd_start
    if robot.friction is not None:
        robot.friction.restart()
    q, qd, qdd, effort, friction = (np.empty((ticks, len(dofs))) for _ in range(5))
    for k in range(ticks):
        effort[k] = command(k, data.qpos[dofs], data.qvel[dofs])
        data.qfrc_applied[dofs] = effort[k]
        _advance(robot, data, effort[k], half)
        # the acceleration that belongs to this state and this torque
        _hold_friction(robot, data, effort[k])
        mujoco.mj_forward(model, data)
        q[k], qd[k], qdd[k] = data.qpos[dofs], data.qvel[dofs], data.qacc[dofs]
        friction[k] = effort[k] - data.qfrc_applied[dofs] - data.qfrc_passive[dofs]
        _advance(robot, data, effort[k], half)
        if k % _PROGRESS_EVERY == 0 or k == ticks - 1:
            progress("simulating", k + 1, ticks)
    if not np.isfinite(qdd).all():
        raise SimulationError("the simulation became unstable: lower the controller's gains")
    return Response((np.arange(ticks) + 0.5) / rate, q, qd, qdd, effort, friction)


def _advance(robot: SimulatedRobot, data: mujoco.MjData, effort: Floats, steps: int) -> None:
    if robot.friction is None:
        mujoco.mj_step(robot.model, data, steps)
        return
    for _ in range(steps):
        _hold_friction(robot, data, effort)
        mujoco.mj_step(robot.model, data)


def _hold_friction(robot: SimulatedRobot, data: mujoco.MjData, effort: Floats) -> None:
    """Makes MuJoCo's linear damping, and a torque beside it, equal to friction at the present velocity.

    A line, held for one implicit step: stable however steep the law is, and exact at the beginning of the step, where
    samples are taken.
    """
    if robot.friction is not None:
        q, qd = data.qpos[robot.dofs], data.qvel[robot.dofs]
        slope, at_rest = robot.friction.line(qd, q)
        robot.model.dof_damping[robot.dofs] = slope
        data.qfrc_applied[robot.dofs] = effort - at_rest - robot.friction.remembered(qd, q)


def _desired_motion(
    robot: SimulatedRobot, trajectory: Trajectory, time: Floats, middle: Floats
) -> DesiredMotion:
    """Points of the trajectory; their effort is what the robot's model needs in the middle of the period."""
    q, qd, qdd = trajectory.at(middle)
    effort = robot.torques(q, qd, qdd)
    if robot.friction is not None:
        # the viscous part is what ff_velocity_scale is for
        effort = effort + robot.friction.torques(qd, q) - robot.friction.viscous * qd
    q, qd, _ = trajectory.at(time)
    return DesiredMotion(q, qd, effort)

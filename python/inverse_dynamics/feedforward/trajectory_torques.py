# SPDX-License-Identifier: Apache-2.0
"""Torques of planned trajectories, and where they pass a joint's effort limit.

    result = trajectory_torques("planned", "ur10_simulated")
    for load in result.loads:
        print(load.joint, load.peak, load.limit)
    write_trajectory_torques(result, "filled")

A trajectory controller adds the efforts of a trajectory to what its feedback gives.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import Solver, check_torques
from inverse_dynamics.diagnosis.plans import Plan, beyond_limits, contradictions
from inverse_dynamics.errors import BagError, SolverError
from inverse_dynamics.feedforward.tables import load_lines, load_numbers
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.csv_table import is_csv
from inverse_dynamics.recordings.joint_trajectories import (
    MESSAGE_TYPE,
    WRENCH_TYPE,
    JointTrajectory,
    read_joint_trajectories,
)
from inverse_dynamics.recordings.log_format import LogFormat
from inverse_dynamics.recordings.table_logs import add_derivatives, read_motion
from inverse_dynamics.recordings.tables import open_table
from inverse_dynamics.recordings.times import check_increasing, check_seconds
from inverse_dynamics.recordings.vocabulary import ACCELERATION, POSITION, VELOCITY
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.motion_energy import MotionEnergy
from inverse_dynamics.robots.robots import Robot, robot_of
from inverse_dynamics.show.result import Result
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats, Integers
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.tables import Table

_WHY = "torques can't be computed without them"

States = tuple[
    "Floats", "list[Floats]", Plan
]  # time; q, qd, qdd of torques; what of them is planned


@dataclass(frozen=True)
class JointLoad:
    """How much a joint is loaded. Times are those of the trajectory, s."""

    joint: str
    unit: str  # N m or N
    limit: float  # of the URDF; infinite where it states none
    peak: float  # the torque of the greatest size, with its sign
    peak_time: float
    peak_trajectory: int  # from 1 on
    passed_time: float | None = None  # when the limit is first passed
    passed_trajectory: int | None = None


@dataclass(frozen=True, repr=False)
class TrajectoryTorques(Result):
    """Torques of the trajectories of a file. n joints, in the order of the chain."""

    numbers, lines = load_numbers, load_lines

    path: Path
    robot: Robot
    joint_names: tuple[str, ...]  # as the file has them
    units: tuple[str, ...]
    limits: Floats  # (n,) N m; infinite: none
    times: tuple[Floats, ...]  # (N,) s, a trajectory each
    torques: tuple[Floats, ...]  # (N, n) N m, a trajectory each
    energy: MotionEnergy  # of all trajectories
    trajectories: tuple[JointTrajectory, ...] = ()  # of a bag
    topic: str = ""  # of a bag
    notes: tuple[str, ...] = ()

    @property
    def loads(self) -> tuple[JointLoad, ...]:
        """Of each joint, over all trajectories."""
        counts = [len(times) for times in self.times]
        trajectory = np.repeat(np.arange(1, len(counts) + 1), counts)
        time, torques = np.concatenate(self.times), np.concatenate(self.torques)
        return tuple(self._load(j, trajectory, time, torques[:, j]) for j in range(len(self.units)))

    def save(
        self, out: Path | str, *, overwrite: bool = False, progress: Progress = no_progress
    ) -> tuple[str, ...]:
        """A copy of the file with the efforts: see write_trajectory_torques()."""
        from inverse_dynamics.feedforward.files import write_trajectory_torques

        return write_trajectory_torques(self, out, overwrite=overwrite, progress=progress)

    def _load(self, j: int, trajectory: Integers, time: Floats, torque: Floats) -> JointLoad:
        most = int(np.abs(torque).argmax())
        load = JointLoad(
            self.joint_names[j],
            self.units[j],
            float(self.limits[j]),
            float(torque[most]),
            float(time[most]),
            int(trajectory[most]),
        )
        passed = np.flatnonzero(np.abs(torque) > self.limits[j])
        if not len(passed):
            return load
        first = int(passed[0])
        return replace(
            load, passed_time=float(time[first]), passed_trajectory=int(trajectory[first])
        )


def trajectory_torques(
    path: Path | str,
    robot: Robot | Solver | Path | str,
    *,
    topic: str = "",
    progress: Progress = no_progress,
) -> TrajectoryTorques:
    """Compute the torques of each point of each trajectory.

    Notes name velocities that contradict positions, zero velocities in a motion, jumps, and limits of the robot
    description that positions, velocities, accelerations or torques pass.

    Parameters
    ----------
    path
        A recording of trajectory_msgs/JointTrajectory or control_msgs/JointWrenchTrajectory, or a
        table; efforts aren't needed. Torques include those that exert the wrenches.
    robot
        As evaluate() takes it.
    topic
        By default the only one with trajectories.

    Raises
    ------
    UserError
        BagError, also for times that don't increase or aren't seconds; RobotError, SolverError.
    """
    path = Path(path)
    given = robot if isinstance(robot, Solver) else None
    robot = robot_of(robot)
    arm = Arm(robot, given)
    solver, joints = arm.solver, arm.recorded_names
    trajectories: list[JointTrajectory] = []
    notes: tuple[str, ...] = ()
    if is_csv(path):
        table = open_table(path, topic=topic)
        state, notes = _states_of_table(table, joints, LogFormat.of(robot), progress)
        states = [state]
    else:
        types = (MESSAGE_TYPE, WRENCH_TYPE)
        trajectories = read_joint_trajectories(path, topic, progress, types)
        states = [_states_of_message(trajectory, joints) for trajectory in trajectories]
    if not any(len(time) for time, *_ in states):
        raise BagError(f"{path}: expected points of a trajectory, got none")
    progress("computing", 0, len(states))
    torques = [
        solver.torques(*state) + solver.friction_state().along(*state[:2])
        if len(time)
        else state[0]
        for time, state, _ in states
    ]
    for k, trajectory in enumerate(trajectories):
        _add_wrenches(trajectory, solver, states[k][1][0], torques[k])
    for number, computed in enumerate(torques, 1):
        where = f"{path}, trajectory {number}"
        check_torques(where, list(solver.joint_names), list(arm.units), computed)
    progress("computing", len(states), len(states))
    return TrajectoryTorques(
        path=path,
        robot=robot,
        joint_names=joints,
        units=arm.units,
        limits=arm.limit("effort", np.inf),
        times=tuple(time for time, *_ in states),
        torques=tuple(torques),
        energy=MotionEnergy.together(
            MotionEnergy.of(solver, time, state[0], state[1], computed)
            for (time, state, _), computed in zip(states, torques, strict=True)
            if len(time)
        ),
        trajectories=tuple(trajectories),
        topic=trajectories[0].topic if trajectories else "",
        notes=(
            *notes,
            *_findings(states, torques, arm),
            *filter(None, [arm.guess]),
            *solver.warnings,
        ),
    )


def _findings(states: Sequence[States], torques: Sequence[Floats], arm: Arm) -> list[str]:
    """Of each kind that of the first trajectory, and how many others have such."""
    found: dict[str, list[str]] = {}
    for number, ((time, _, plan), computed) in enumerate(zip(states, torques, strict=True), 1):
        if not len(time):
            continue
        plan = replace(plan, torques=computed)
        of_plan = f"trajectory {number}: " if len(states) > 1 else ""
        for kind, text in {**contradictions(plan, arm), **beyond_limits(plan, arm)}.items():
            found.setdefault(kind, []).append(f"{of_plan}{text}")
    return [
        texts[0] + (f"; likewise in {counted(len(texts) - 1, 'other')}" if texts[1:] else "")
        for texts in found.values()
    ]


def _states_of_table(
    table: Table, joints: Sequence[str], form: LogFormat, progress: Progress
) -> tuple[States, tuple[str, ...]]:
    motion = read_motion(table, joints, form, (POSITION,), progress)
    if table.incomplete:
        raise BagError(
            f"{table.path}: expected a number in every field, got {counted(table.incomplete, 'row')} with "
            "an empty one; fill it in, or leave out the row"
        )
    check_increasing(f"{table.path}", motion.time)
    kinds, numbers = (VELOCITY, ACCELERATION), dict(motion.numbers)
    if not numbers.keys() >= {*kinds}:  # positions of points far apart don't determine the motion
        wanted = "seconds in steps below 0.5, or columns of velocity and acceleration"
        check_seconds(f"{table.path}", motion.time, wanted)
    notes = add_derivatives(motion.time, numbers, kinds)
    planned = Plan(
        f"{table.path}",
        "row",
        numbers[POSITION],
        motion.time,
        *(motion.numbers.get(kind) for kind in kinds),
    )
    return (motion.time, [numbers[kind] for kind in (POSITION, *kinds)], planned), notes


def _states_of_message(trajectory: JointTrajectory, joints: Sequence[str]) -> States:
    if others := [name for name in trajectory.joint_names if name not in joints]:
        raise BagError(
            f"{trajectory.where}: expected the joints {', '.join(joints)}, got also "
            f"{', '.join(others)}, whose efforts aren't known; give them a trajectory of their own, "
            "or give the trajectory's names with --joints, in the order of the chain"
        )
    state = [
        trajectory.numbers(field, joints, _WHY)
        for field in ("positions", "velocities", "accelerations")
    ]
    time = trajectory.time_from_start.astype(np.float64) * 1e-9
    check_increasing(trajectory.where, time, "point")
    if len(time) and time[0] < 0:
        raise BagError(
            f"{trajectory.where}, point 1: time_from_start: expected 0 s or more, got {time[0]:g}; "
            "count from the start of the trajectory"
        )
    q, qd, qdd = state
    return time, state, Plan(trajectory.where, "point", q, time, qd, qdd)


def _add_wrenches(trajectory: JointTrajectory, solver: Solver, q: Floats, torques: Floats) -> None:
    """Add to torques (N, n) those that exert the wrenches of a trajectory.

    A wrench acts on the link in whose frame it is, at its origin; in a frame that doesn't move, on the tip.
    """
    frames, wrenches = trajectory.wrenches()
    for frame in set(frames) - {""}:
        at = [k for k, of_point in enumerate(frames) if of_point == frame]
        try:
            J, (R, p) = solver.jacobian(q[at], frame=frame), solver.pose(q[at], frame=frame)
        except SolverError as error:
            raise BagError(f"{trajectory.where}, point {at[0] + 1}: wrench: {error}") from error
        force, torque = (np.einsum("kij,kj->ki", R, w) for w in np.split(wrenches[at], 2, axis=1))
        if not J.any():
            J = solver.jacobian(q[at])
            torque += np.cross(p - solver.pose(q[at])[1], force)
        torques[at] += np.einsum("kij,ki->kj", J, np.hstack([force, torque]))

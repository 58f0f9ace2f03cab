# SPDX-License-Identifier: Apache-2.0
"""Waypoints of an array or a file as a path that the joints can follow."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from inverse_dynamics._core import JointPath
from inverse_dynamics.arrays import by_joint
from inverse_dynamics.diagnosis.plans import Plan, contradictions
from inverse_dynamics.errors import BagError, UserError
from inverse_dynamics.recordings.columns import stated_columns
from inverse_dynamics.recordings.csv_table import is_csv
from inverse_dynamics.recordings.joint_trajectories import of_one_motion, read_joint_trajectories
from inverse_dynamics.recordings.log_format import LogFormat
from inverse_dynamics.recordings.table_logs import read_motion
from inverse_dynamics.recordings.tables import open_table
from inverse_dynamics.recordings.times import check_increasing, time_columns
from inverse_dynamics.recordings.vocabulary import ACCELERATION, POSITION, TIME, VELOCITY
from inverse_dynamics.robots.located_yaml import read_mapping
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.robots.arm import Arm

_CLOSE = 0.5  # rad, between the samples of a recorded path
_ROUNDING = 1e-6  # rad


class PathShape(TypedDict, total=False):
    """How waypoints become a path.

    topic: of a recording. deviation: straight lines whose corners the path passes by at most this distance [rad]; by
    default a cubic spline through all waypoints. stops: numbers of waypoints, from 0, to stand still at.
    """

    topic: str
    deviation: float | None
    stops: Sequence[int]


def check_positions(path: JointPath, arm: Arm) -> None:
    """Raise UserError where the path leaves the joints' ranges."""
    ranges = path.position_ranges
    lower, upper = arm.limit("lower", -np.inf), arm.limit("upper", np.inf)
    for j, joint in enumerate(arm.joint_names):
        least, most = ranges[:, j]
        if least < lower[j] - _ROUNDING or most > upper[j] + _ROUNDING:
            raise UserError(
                f"path: joint {joint}: expected positions from {lower[j]:g} to {upper[j]:g}, the limits in "
                f"{arm.robot.urdf or arm.robot.model}, got {least:.4g} to {most:.4g}; change the path, and if "
                "waypoints are in degrees, convert them (of a table: --scale q=deg)"
            )


def joint_path(
    source: Path | str | ArrayLike, arm: Arm, **shape: Unpack[PathShape]
) -> tuple[JointPath, list[str]]:
    """The path, and notes."""
    plan = _waypoints_of(source, arm, shape.get("topic", ""))
    notes: list[str] = []
    if isinstance(source, Path | str) and is_csv(Path(source)):
        waypoints, notes = _unwrapped(plan.q, arm)
        plan = replace(plan, q=waypoints)
    waypoints, found = plan.q, contradictions(plan, arm)
    notes += [text for kind, text in found.items() if kind not in ("rest", "acceleration")]
    stops, deviation = list(shape.get("stops", ())), shape.get("deviation")
    if deviation is None:
        return JointPath.spline(waypoints, stops), notes
    return JointPath.lines(waypoints, deviation, stops), notes


def _waypoints_of(path: Path | str | ArrayLike, arm: Arm, topic: str) -> Plan:
    """Waypoints, and what else a file has of the motion. Raises UserError."""
    if not isinstance(path, Path | str):
        table = by_joint(path, arm.recorded_names, "path")
        if np.ma.is_masked(table):
            raise UserError("path: expected a number in each place, got an array with masked ones")
        waypoints = np.asarray(table, dtype=np.float64)
        if waypoints.ndim != 2 or waypoints.shape[1] != len(arm.joint_names):
            raise UserError(
                f"path: expected waypoints (m, {len(arm.joint_names)}), one per row, got an array "
                f"{waypoints.shape}"
            )
        return Plan("path", "waypoint", waypoints)
    path = Path(path)
    found = _waypoints_of_file(path, arm, topic)
    if len(found.q) < 2:
        raise BagError(f"{path}: expected two waypoints at least, got {len(found.q)}")
    if found.time is None or not np.ptp(found.time):  # a path that nobody has timed yet
        return replace(found, time=None)
    check_increasing(found.where, found.time, found.point)
    return found


def _waypoints_of_file(path: Path, arm: Arm, topic: str) -> Plan:
    if path.suffix in (".yaml", ".yml"):
        return _waypoints_of_yaml(path, arm.joint_names)
    if is_csv(path):
        table, form = open_table(path, topic=topic), LogFormat.of(arm.robot)
        stated = [kind for kind, _ in stated_columns(form.columns, f"{path}")]
        if POSITION not in stated and set(arm.recorded_names) <= set(table.names):  # of a path
            form = replace(form, columns=",".join(filter(None, (form.columns, "position=*"))))
        timed = TIME in stated or bool(time_columns(table.names))
        form = form if timed else replace(form, rate=1.0)
        motion = read_motion(table, arm.recorded_names, form, (POSITION,))
        if table.incomplete:
            raise BagError(
                f"{path}: expected a number for each joint in each row, got {table.incomplete} of "
                f"{table.incomplete + len(motion.time)} rows without; complete or remove them"
            )
        q, qd, qdd = (motion.numbers.get(kind) for kind in (POSITION, VELOCITY, ACCELERATION))
        assert q is not None
        return Plan(f"{path}", "row", q, motion.time if timed else None, qd, qdd)
    trajectories = of_one_motion(read_joint_trajectories(path, topic), "record the path alone")
    points = [point for trajectory in trajectories for point in trajectory.points]

    def joined(field: str) -> Floats:
        return np.concatenate([t.numbers(field, arm.recorded_names) for t in trajectories])

    time = np.concatenate([t.stamp + t.time_from_start for t in trajectories])
    velocities = joined("velocities") if all(len(point.velocities) for point in points) else None
    since_start = (time - time[0]) * 1e-9
    return Plan(trajectories[0].where, "point", joined("positions"), since_start, velocities)


def _waypoints_of_yaml(path: Path, joints: Sequence[str]) -> Plan:
    top = read_mapping(path, BagError)
    top.expect(("joints", "positions"))
    names = [entry.text() for entry in top.required("joints").entries()]
    if sorted(names) != sorted(joints):
        raise BagError(
            f"{path}: joints: expected {', '.join(joints)}, got {', '.join(names)}; name the joints of the chain"
        )
    positions = top.required("positions")
    if (kind := top.optional("kind")) is not None:
        kind.text(("waypoints",))
    for ignored in ("schema", "source", "rests"):
        top.optional(ignored)
    times = top.optional("times")
    top.reject_others()
    rows = [[x.number() for x in row.entries(len(names))] for row in positions.entries()]
    q = np.array(rows).reshape(-1, len(names))[:, [names.index(joint) for joint in joints]]
    if times is None or not rows:
        return Plan(f"{path}", "waypoint", q)
    time = np.array([x.number() for x in times.entries(len(rows))])
    return Plan(f"{path}", "waypoint", q, time)


def _unwrapped(waypoints: Floats, arm: Arm) -> tuple[Floats, list[str]]:
    """Recorded positions of continuous joints beyond the seam of a driver that reports them within one turn.

    Recorded samples lie close together, but for a step of nearly a whole turn at the seam.
    """
    found, notes = waypoints.copy(), []
    for j, kind in enumerate(arm.solver.joint_types):
        q = waypoints[:, j]
        steps = np.abs(np.diff(q))
        seams = np.abs(steps - 2 * np.pi) < _CLOSE
        recorded = np.ptp(q) < 2 * np.pi + _ROUNDING and ((steps < _CLOSE) | seams).all()
        if kind == "continuous" and recorded and 0 < 2 * seams.sum() < len(steps):
            found[:, j] = np.unwrap(q)
            notes.append(
                f"{arm.joint_names[j]} goes on over the seam of its turn in {counted(int(seams.sum()), 'place')}"
            )
    return found, notes

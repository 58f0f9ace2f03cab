# SPDX-License-Identifier: Apache-2.0
"""Trajectories as YAML files, to give to `ids simulate --trajectory` and stored with each simulated recording.

A Fourier series (see trajectory.py for the formula), all joints of the chain in any order:

    schema: 1
    kind: fourier
    source: in words                                  # optional
    joints: [joint_1, joint_2]
    period: 20.0                                      # s
    center: [0.0, -1.57]                              # rad
    sine: [[0.1, -0.1], [0.3, -0.3]]                  # rad/s, a row per joint, an entry per harmonic
    cosine: [[0.2, -0.1], [0.0, 0.0]]

or waypoints, passed smoothly, at rest at both ends:

    schema: 1
    kind: waypoints
    joints: [joint_1, joint_2]
    times: [0.0, 1.5, 3.0]                            # s, from 0
    positions: [[0.0, 0.0], [0.5, -0.5], [0.0, 0.0]]  # rad, a row per time
    rests: [1]                                        # optional: waypoints, counted from 0, where all joints stop
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.base.extras import lazily_imported
from inverse_dynamics.base.located_yaml import read_mapping
from inverse_dynamics.simulation.errors import TrajectoryError
from inverse_dynamics.simulation.trajectory import FourierTrajectory, WaypointTrajectory

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.located_yaml import Mapping, Value
    from inverse_dynamics.simulation.trajectory import Trajectory

yaml = lazily_imported("yaml", "a file of a trajectory")

SCHEMA = 1


def read_trajectory(file: Path, joint_names: Sequence[str]) -> tuple[Trajectory, str]:
    """The trajectory of a file, its joints in the order of `joint_names`, and its source in words.

    Raises TrajectoryError.
    """
    top = read_mapping(file, TrajectoryError)
    schema = top.required("schema")
    if schema.integer() != SCHEMA:
        schema.fail(f"{SCHEMA}", "it was written for another version of this command")
    kind = top.required("kind").text(("fourier", "waypoints"))
    source = top.optional("source")
    words = f"From the file {file.name}." if source is None else source.text().strip()
    order = _order(top.required("joints"), joint_names)
    read = _fourier if kind == "fourier" else _waypoints
    trajectory = read(top, tuple(joint_names), order)
    top.reject_others()
    return trajectory, words


def _fourier(top: Mapping, names: tuple[str, ...], order: list[int]) -> FourierTrajectory:
    period = top.required("period")
    if period.number() <= 0:
        period.fail("a time in s above zero")
    center = _row(top.required("center"), len(names))
    sine = _table(top.required("sine"), rows=len(names))
    cosine = _table(top.required("cosine"), rows=len(names), columns=sine.shape[1])
    return FourierTrajectory(names, period.number(), center[order], sine[order], cosine[order])


def _waypoints(top: Mapping, names: tuple[str, ...], order: list[int]) -> WaypointTrajectory:
    times_value = top.required("times")
    times = _row(times_value)
    if len(times) < 2 or times[0] != 0.0 or not (np.diff(times) > 0).all():
        times_value.fail("at least two times that increase from 0")
    positions = _table(top.required("positions"), rows=len(times), columns=len(names))
    rests_value = top.optional("rests")
    rests = () if rests_value is None else tuple(rest.integer() for rest in rests_value.entries())
    if rests_value is not None and not (np.diff((0, *rests, len(times) - 1)) > 0).all():
        rests_value.fail("waypoints between the first and the last, counted from 0, that increase")
    return WaypointTrajectory.through(names, times, positions[:, order], rests)


def trajectory_text(trajectory: Trajectory, source: str) -> str:
    """The file of a trajectory; all digits are kept."""
    if isinstance(trajectory, FourierTrajectory):
        kind, names = "fourier", ["period", "center", "sine", "cosine"]
    else:
        kind, names = "waypoints", ["times", "positions", *(["rests"] if trajectory.rests else [])]
    content: dict[str, Any] = {"schema": SCHEMA, "kind": kind, "source": " ".join(source.split())}
    content["joints"] = list(trajectory.joint_names)
    content |= {name: np.asarray(getattr(trajectory, name)).tolist() for name in names}
    text = yaml.safe_dump(content, sort_keys=False, width=120, default_flow_style=None)
    return f"# SPDX-License-Identifier: Apache-2.0\n{text}"


def _order(value: Value, joint_names: Sequence[str]) -> list[int]:
    """Where each joint of the chain stands in the file."""
    there = [entry.text() for entry in value.entries()]
    if sorted(there) != sorted(joint_names):
        raise TrajectoryError(
            f"{value.where}: expected the joints {', '.join(joint_names)}, got {', '.join(there)}; "
            "is the trajectory for another robot?"
        )
    return [there.index(name) for name in joint_names]


def _row(value: Value, length: int | None = None) -> Floats:
    return np.array([entry.number() for entry in value.entries(length)])


def _table(value: Value, rows: int, columns: int | None = None) -> Floats:
    lists = value.entries(rows)
    columns = columns or max(1, len(lists[0].entries()))
    return np.array([_row(entry, columns) for entry in lists])

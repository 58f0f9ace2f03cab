# SPDX-License-Identifier: Apache-2.0
"""The torques of a trajectory as numbers, lines and a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from inverse_dynamics.show.tables import ReportTable
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from inverse_dynamics.feedforward.trajectory_torques import TrajectoryTorques
    from inverse_dynamics.show.result import Line


def load_numbers(result: TrajectoryTorques) -> dict[str, Any]:
    """Solver, energy, and load of each joint, for JSON; a missing limit is null."""
    robot = result.robot
    return {
        "schema": 1,
        "bag": str(result.path),
        "topic": result.topic,
        "robot": robot.name,
        "plugin": robot.plugin,
        "friction": robot.friction,
        "gravity": robot.gravity,
        **result.energy.numbers,
        "joints": result.loads,
        "notes": result.notes,
    }


def load_lines(result: TrajectoryTorques) -> list[Line]:
    """What the screen shows."""
    robot, points = result.robot, counted(sum(map(len, result.times)), "point")
    return [
        ("", robot.description or robot.name),
        ("solver", f"{robot.plugin}{'' if robot.friction else ', friction left out'}"),
        ("trajectories", f"{len(result.times)}, with {points} together"),
        ("energy", str(result.energy)),
        ("note", result.notes),
        load_table(result),
    ]


def load_table(result: TrajectoryTorques) -> ReportTable:
    """Greatest torque of each joint and, where it exceeds the limit, when it first does."""

    def moment(time: float, trajectory: int | None) -> str:
        return f"{time:.3f} s" + (f" of trajectory {trajectory}" if len(result.times) > 1 else "")

    rows = []
    for load in result.loads:
        limited = math.isfinite(load.limit)
        passed = "-" if limited else "not known"
        if load.passed_time is not None:
            passed = f"first at {moment(load.passed_time, load.passed_trajectory)}"
        limit = f"{load.limit:g} {load.unit}" if limited else "-"
        peak = f"{load.peak:.3f} {load.unit}"
        rows.append((load.joint, peak, moment(load.peak_time, load.peak_trajectory), limit, passed))
    return ReportTable("", ("joint", "peak", "at", "limit", "passes its limit"), rows)

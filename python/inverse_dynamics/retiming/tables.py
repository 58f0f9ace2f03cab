# SPDX-License-Identifier: Apache-2.0
"""A timed path as numbers, lines and a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.outputs.plain import objects_of_joints
from inverse_dynamics.show.tables import ReportTable, of_joints

if TYPE_CHECKING:
    from inverse_dynamics.retiming.retiming import Retimed
    from inverse_dynamics.show.result import Line


def retime_numbers(result: Retimed) -> dict[str, Any]:
    """Durations, limits and loads, for JSON."""
    peak = np.abs(result.greatest).argmax(axis=0)
    columns = {
        "limit": result.limits.torque,
        "band": result.band,
        "peak": np.take_along_axis(result.greatest, peak[None], axis=0)[0],
        "peak_time": result.time[peak],
        "peak_velocity": np.abs(result.qd).max(axis=0),
        "at_limit": result.at_limit,
    }
    return {
        "schema": 1,
        "robot": result.robot.name,
        "plugin": result.robot.plugin,
        "duration": result.duration,
        "duration_by_acceleration": result.duration + result.seconds_saved,
        "acceleration": result.acceleration,
        **result.energy.numbers,
        "joints": objects_of_joints(result.joint_names, result.units, columns),
        "notes": result.notes,
    }


def retime_lines(result: Retimed) -> list[Line]:
    """What the screen shows."""
    by_acceleration = [
        f"{other.duration:.3f} s with at most {result.acceleration:.3g} rad/s^2 in each joint, torques within "
        "limits"
        for other in (result.by_acceleration,)
        if other is not None
    ]
    return [
        ("", result.robot.description or result.robot.name),
        ("duration", f"{result.duration:.3f} s"),
        ("by acceleration", by_acceleration),
        ("energy", str(result.energy)),
        ("note", result.notes),
        retime_table(result),
    ]


def retime_table(result: Retimed) -> ReportTable:
    """Of each joint: its greatest torque and velocity, and how long it is at its torque limit."""
    columns = {
        "peak": np.abs(result.greatest).max(axis=0),
        "limit": result.limits.torque,
        "at limit [% of time]": 100 * result.at_limit,
        "velocity [rad/s, m/s]": np.abs(result.qd).max(axis=0),
    }
    return of_joints("Load of each joint", result.joint_names, result.units, columns)

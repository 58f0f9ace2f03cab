# SPDX-License-Identifier: Apache-2.0
"""A motion to record as numbers, lines and a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.outputs.plain import objects_of_joints
from inverse_dynamics.show.tables import of_joints

if TYPE_CHECKING:
    from inverse_dynamics.excitation.excite import ExcitationResult
    from inverse_dynamics.show.result import Line
    from inverse_dynamics.show.tables import ReportTable

_AFTER = {"description": "before", "given": "given", "stored": "stored", "motion": "after"}


def excitation_numbers(result: ExcitationResult) -> dict[str, Any]:
    """Motion of each joint and uncertainty after it, for JSON."""
    names = ("velocity_share", "acceleration_share", "torque_share")
    deviations = zip(*result.deviation.values(), strict=True)
    columns = {
        **dict(zip(("lower", "upper"), result.travel.T, strict=True)),
        **dict(zip(names, result.greatest, strict=True)),
        "noise": result.noise,
        "deviation": [
            dict(zip(result.deviation, of_joint, strict=True)) for of_joint in deviations
        ],
    }
    return {
        "robot": result.robot.name,
        "duration": result.excitation.trajectory.duration,
        "condition_number": result.excitation.condition_number,
        "noise_source": result.noise_source,
        "joints": objects_of_joints(result.joint_names, result.units, columns),
        "notes": result.notes,
    }


def excitation_lines(result: ExcitationResult) -> list[Line]:
    """What the screen shows."""
    found = result.excitation
    motion = f"{found.trajectory.duration:g} s"
    if not result.options.payload:  # else most of the arm rests
        motion += f", condition number of the base regressor {found.condition_number:.1f}"
    return [
        ("", result.robot.description or result.robot.name),
        ("note", result.notes),
        ("motion", motion),
        ("noise", result.noise_source),
        excitation_table(result),
    ]


def excitation_table(result: ExcitationResult) -> ReportTable:
    """Motion of each joint, and uncertainty of its predicted torque before and after."""
    speed, acceleration, torque = np.rint(100 * result.greatest).astype(int)
    columns = {"from": result.travel[:, 0], "to": result.travel[:, 1]}
    columns |= {"speed": speed, "acc.": acceleration, "torque": torque}
    columns |= {_AFTER[name]: values for name, values in result.deviation.items()}
    note = (
        "speed, acceleration (acc.), torque: greatest values in % of their limits; then the standard "
        "deviation of predicted torques, mean over random states within the limits: before any recording"
        + (", after the given recordings" if "given" in result.deviation else "")
        + (", after the stored motion for the same time" if "stored" in result.deviation else "")
        + ", after this motion"
    )
    return of_joints("", result.joint_names, result.units, columns, note)

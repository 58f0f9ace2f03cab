# SPDX-License-Identifier: Apache-2.0
"""A load, and the errors without and with it, as numbers, lines and tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.evaluation.tables import heading
from inverse_dynamics.outputs.plain import objects_of_joints
from inverse_dynamics.payload.files import upper
from inverse_dynamics.show.tables import ReportTable, number, of_joints

if TYPE_CHECKING:
    from inverse_dynamics.payload.payload import Payload
    from inverse_dynamics.show.result import Line


def payload_numbers(payload: Payload) -> dict[str, Any]:
    """All numbers, for JSON."""
    found, evaluation = payload.estimate, payload.evaluation
    known = found.inertia_is_known
    columns = {
        "rmse_before": payload.rmse_before,
        "rmse_after": payload.rmse_after,
        "offset": found.offset,
        "white_noise": payload.noise.white,
        "correlated_noise": payload.noise.correlated,
    }
    return {
        "schema": 1,
        "bag": evaluation.bag,
        "empty": payload.empty,
        "topic": evaluation.log.topic,
        "robot": evaluation.robot.name,
        "plugin": evaluation.robot.plugin,
        "mass": found.mass,
        "mass_half_width": found.mass_half_width,
        "frame": payload.frame,
        "center_of_mass": payload.center_of_mass,
        "center_of_mass_half_width": payload.center_of_mass_half_width,
        "inertia": upper(found.inertia) if known else None,
        "inertia_half_width": upper(found.inertia_half_width) if known else None,
        "covariance": found.covariance,
        "confidence": 0.95,
        "blocks": found.blocks,
        "duration": found.duration,
        "samples": len(payload.time),
        "rounds": payload.rounds,
        "correlation_time": payload.noise.correlation_time,
        "joints": objects_of_joints(payload.joint_names, evaluation.units, columns),
        "notes": payload.notes,
    }


def payload_lines(payload: Payload) -> list[Line]:
    """What the screen shows."""
    return [
        *heading(payload.evaluation, len(payload.time), payload.estimate.duration),
        ("without load", [payload.empty] if payload.empty else []),
        ("note", payload.notes),
        payload_table(payload),
        residual_table(payload),
    ]


def payload_table(payload: Payload) -> ReportTable:
    """Mass, center of mass, inertia."""
    found, center = payload.estimate, payload.center_of_mass
    half = payload.center_of_mass_half_width
    rows = [("mass", "kg", found.mass, found.mass_half_width)]
    rows += [
        (f"center of mass, {axis}", "mm", 1e3 * center[i], 1e3 * half[i])
        for i, axis in enumerate("xyz")
    ]
    if found.inertia_is_known:
        rows += [
            (f"inertia {'xyz'[i]}{'xyz'[j]}", "kg m²", found.inertia[i, j], found.inertia_half_width[i, j])
            for i, j in zip(*np.triu_indices(3), strict=True)
        ]  # fmt: skip
    return ReportTable(
        f"Load: {number(found.mass)} kg",
        ("number", "unit", "value", "± (95 %)"),
        rows,
        note=f"In addition to what the robot carries already; in the frame of {payload.frame}.",
    )


def residual_table(payload: Payload) -> ReportTable:
    """Measured minus computed torques without and with the load."""
    columns = {
        "RMSE without load": payload.rmse_before,
        "RMSE with load": payload.rmse_after,
        "offset": payload.estimate.offset,
    }
    title = "Errors without and with the load"
    return of_joints(title, payload.joint_names, payload.evaluation.units, columns)

# SPDX-License-Identifier: Apache-2.0
"""A load, and the errors without and with it, as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.show.tables import ReportTable, number, of_joints

if TYPE_CHECKING:
    from inverse_dynamics.payload.payload import Payload


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

# SPDX-License-Identifier: Apache-2.0
"""Errors of several runs as numbers and as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from inverse_dynamics.show.tables import ReportTable, of_joints

if TYPE_CHECKING:
    from inverse_dynamics.comparison.comparison import Comparison


def comparison_numbers(comparison: Comparison) -> dict[str, Any]:
    """Errors of each run, for JSON."""
    first = comparison.evaluations[0]
    return {
        "schema": 1,
        "bag": first.bag,
        "joints": comparison.joint_names,
        "units": first.units,
        "runs": [
            {"label": label, "plugin": evaluation.robot.plugin, "rmse": rmse}
            for label, evaluation, rmse in zip(
                comparison.labels, comparison.evaluations, comparison.rmse, strict=True
            )
        ],
    }


def comparison_table(comparison: Comparison) -> ReportTable:
    """Root mean square errors, one column per run."""
    title = f"RMSE of {' and '.join(comparison.labels)}"
    columns = dict(zip(comparison.labels, comparison.rmse, strict=True))
    units = comparison.evaluations[0].units
    return of_joints(title, comparison.joint_names, units, columns, means=columns)

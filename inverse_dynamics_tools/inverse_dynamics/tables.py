# SPDX-License-Identifier: Apache-2.0
"""Results as tables on the screen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

if TYPE_CHECKING:
    from inverse_dynamics.evaluation import Evaluation


def error_table(evaluation: Evaluation) -> Table:
    """Errors of the computed torques, a joint a row.

    Where samples don't count, errors without them stand beside those over all samples.
    """
    left_out = evaluation.samples.left_out
    count = len(evaluation.log)
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left")
    table.add_column("joint")
    table.add_column("unit")
    for heading in ("MAE", "RMSE", "NRMSE", "bias", "R²"):
        table.add_column(heading, justify="right")
    if left_out:
        table.add_column("RMSE*", justify="right")
        table.caption = f"* over the {count - left_out} of {count} samples that count"
    for error, kept in zip(evaluation.errors, evaluation.errors_of_kept, strict=True):
        table.add_row(
            error.joint,
            error.unit,
            f"{error.mae:.3f}",
            f"{error.rmse:.3f}",
            _percent(error.nrmse),
            f"{error.bias:+.3f}",
            _number(error.r2),
            *([f"{kept.rmse:.3f}"] if left_out else []),
        )
    if len(set(evaluation.units)) == 1 and len(evaluation.errors) > 1:
        table.add_section()
        table.add_row(
            "mean",
            evaluation.units[0],
            f"{_mean([e.mae for e in evaluation.errors]):.3f}",
            f"{evaluation.mean_rmse:.3f}",
            "",
            "",
            "",
            *([f"{_mean([e.rmse for e in evaluation.errors_of_kept]):.3f}"] if left_out else []),
        )
    return table


def _mean(numbers: list[float]) -> float:
    return sum(numbers) / len(numbers)


def _percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{100 * share:.2f} %"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.4f}"

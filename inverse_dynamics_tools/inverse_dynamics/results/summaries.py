# SPDX-License-Identifier: Apache-2.0
"""Errors of many evaluations as one table: a row per recording and joint, for pandas, polars, DuckDB.

recording           name of the recording among the others, and of the directory with its result
bag                 path of the recording
robot plugin        the run configuration and its solver
joint unit          a joint, and the unit of its errors
start duration      s: stamp of the first sample, and time from it to the last
window_from window_to    s since the recording's first sample, where a part was asked for
samples             how many there are
mae rmse nrmse bias r2 max_abs    over all samples: see docs/notation.md; empty where undefined
kept_samples kept_rmse            over the valid samples: without a start transient, for example
accelerations cutoff              how they were estimated; Hz
effort              what recorded efforts mean: torque, current, torque_without_gravity
"""

from __future__ import annotations

import csv
import math
from typing import TYPE_CHECKING, Any

from inverse_dynamics.base.wording import printable

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from inverse_dynamics.evaluation.summary import EvaluationSummary

Row = dict[str, Any]

COLUMNS = (
    *("recording", "bag", "robot", "plugin", "joint", "unit"),
    *("start", "duration", "window_from", "window_to", "samples"),
    *("mae", "rmse", "nrmse", "bias", "r2", "max_abs", "kept_samples", "kept_rmse"),
    *("accelerations", "cutoff", "effort"),
)


def summary_rows(summaries: Iterable[EvaluationSummary]) -> list[Row]:
    """The table, row by row; None where a value is undefined."""
    rows = []
    for summary in summaries:
        of_all = {
            **vars(summary),
            "recording": summary.name,
            "bag": str(summary.bag),
            "window_from": summary.window.start,
            "window_to": summary.window.end,
            "accelerations": summary.accelerations.method,
            "cutoff": summary.accelerations.cutoff,
        }
        for error, kept in zip(summary.errors, summary.errors_of_kept, strict=True):
            row = {**of_all, **vars(error), "kept_rmse": kept.rmse}
            rows.append({name: _defined(row[name]) for name in COLUMNS})
    return rows


def write_summary_csv(file: Path, rows: Iterable[Row]) -> None:
    """Every digit is kept; an undefined value is empty; names that aren't UTF-8 become escapes."""
    with file.open("w", encoding="utf-8", newline="") as sink:
        writer = csv.DictWriter(sink, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: printable(v) if isinstance(v, str) else v for k, v in row.items()})


def _defined(value: object) -> object:
    return None if isinstance(value, float) and math.isnan(value) else value

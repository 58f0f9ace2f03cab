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

# What the columns hold, in their order.
COLUMNS: dict[str, type] = {
    **dict.fromkeys(("recording", "bag", "robot", "plugin", "joint", "unit"), str),
    **dict.fromkeys(("start", "duration", "window_from", "window_to"), float),
    "samples": int,
    **dict.fromkeys(("mae", "rmse", "nrmse", "bias", "r2", "max_abs"), float),
    "kept_samples": int,
    "kept_rmse": float,
    "accelerations": str,
    "cutoff": float,
    "effort": str,
}


def summary_rows(summaries: Iterable[EvaluationSummary]) -> list[Row]:
    """The table, row by row; None where a figure is undefined."""
    rows = []
    for summary in summaries:
        of_all = {
            "recording": summary.name,
            "bag": str(summary.bag),
            "robot": summary.robot,
            "plugin": summary.plugin,
            "start": summary.start,
            "duration": summary.duration,
            "window_from": summary.window.start,
            "window_to": summary.window.end,
            "samples": summary.samples,
            "kept_samples": summary.kept_samples,
            "accelerations": summary.accelerations.method,
            "cutoff": summary.accelerations.cutoff,
            "effort": summary.effort,
        }
        for error, kept in zip(summary.errors, summary.errors_of_kept, strict=True):
            row = {**of_all, **vars(error), "kept_rmse": kept.rmse}
            rows.append({name: _defined(row[name]) for name in COLUMNS})
    return rows


def write_summary_csv(file: Path, rows: Iterable[Row]) -> None:
    """Every digit is kept; an undefined figure is empty."""
    with file.open("w", encoding="utf-8", errors="backslashreplace", newline="") as sink:
        writer = csv.DictWriter(sink, tuple(COLUMNS), lineterminator="\n")
        writer.writeheader()
        writer.writerows({k: _text(v) for k, v in row.items()} for row in rows)


def write_summary_parquet(file: Path, rows: list[Row]) -> bool:
    """The same with types; false where pyarrow isn't installed."""
    try:
        import pyarrow as pa
        from pyarrow.parquet import write_table
    except ImportError:
        return False
    types = {str: pa.string(), float: pa.float64(), int: pa.int64()}
    schema = pa.schema([(name, types[kind]) for name, kind in COLUMNS.items()])
    columns = [[_text(row[name]) for row in rows] for name in COLUMNS]
    write_table(pa.table(columns, schema=schema), file, compression="zstd")
    return True


def _defined(value: object) -> object:
    return None if isinstance(value, float) and math.isnan(value) else value


def _text(value: object) -> object:
    """Names of files that aren't UTF-8 become escapes."""
    return printable(value) if isinstance(value, str) else value

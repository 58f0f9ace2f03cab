# SPDX-License-Identifier: Apache-2.0
"""`ids export`: all series of evaluations as tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import Options

if TYPE_CHECKING:
    import argparse

PLACE = ("share", 2)
SUMMARY = "write all series of evaluations as tables: CSV, Parquet"
EPILOG = """\
examples:
  ids export result                            result/series.csv
  ids export ur10 panda --format parquet       ur10/series.parquet, panda/series.parquet
  ids export result --out torques.csv          one table, in a file of your choice

columns (J: a joint, as the recording names it), one row per sample:
  time                                    s since the first sample
  position.J velocity.J acceleration.J    the motion; accelerations as estimated
  effort.J                                as recorded; current.J [A] where these are motor currents
  measured.J computed.J error.J           torques; error = computed - measured
  repeated non_increasing start_transient isolated kept
                                          findings about a sample (true, false)

All digits are kept. A Parquet file states the unit of each column; a CSV file has rad, rad/s, rad/s^2, N m
(prismatic: m, m/s, m/s^2, N). `ids evaluate` reads such a CSV file as a recording.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.runs()
    options.add(
        "--format",
        "format of the table (default: by the ending of --out, else csv)",
        choices=("csv", "parquet"),
    )
    options.output("FILE", "the table of one RUN (default: RUN/series.csv or RUN/series.parquet)")


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.evaluation.exports import export_series
    from inverse_dynamics.evaluation.files import read_evaluation
    from inverse_dynamics.installation.extras import require
    from inverse_dynamics.outputs.files import check_output_file
    from inverse_dynamics.terminal.screen import Screen, progress_bar

    require("a table", "pyarrow")
    files, overwrite = _files(arguments), arguments.overwrite
    for file in files:  # before the work
        check_output_file(
            file, overwrite=overwrite, inputs=arguments.runs, results=Evaluation.contents
        )
    with progress_bar() as progress:
        for directory, file in zip(arguments.runs, files, strict=True):
            evaluation = read_evaluation(directory)
            export_series(evaluation, file, overwrite=overwrite, progress=progress)
    for file in files:
        Screen().print(str(file))


def _files(arguments: argparse.Namespace) -> list[Path]:
    """The tables to write."""
    from inverse_dynamics.errors import UserError

    out: Path | None = arguments.out
    if out is None:
        suffix = arguments.format or "csv"
        return [directory / f"series.{suffix}" for directory in arguments.runs]
    if len(arguments.runs) != 1:
        raise UserError(
            f"--out: names the table of one RUN, got {len(arguments.runs)} RUNs; leave it out, and each "
            "table goes into its RUN"
        )
    if arguments.format and out.suffix.lower() != f".{arguments.format}":
        raise UserError(
            f"--out: expected a name ending in .{arguments.format}, as --format says, got '{out}'"
        )
    return [out]

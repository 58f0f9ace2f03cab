# SPDX-License-Identifier: Apache-2.0
"""All series of an evaluation as one table, a row per sample.

    export_series(read_evaluation("result"), Path("series.parquet"))

Columns, J being a joint as the recording names it:

recording                             its name among others, where one is given
time                                  s since the first sample
position.J velocity.J acceleration.J  of the motion; the acceleration is the estimated one
effort.J                              as recorded; current.J in its place where it is a current
measured.J computed.J error.J         torques; error = computed - measured
band.J                                half the width of the model's 95 % band, where it is known
repeated ... kept                     what was found in a sample, true or false: see samples.py

Every digit is kept. Parquet knows the unit of each column (key `unit` of its metadata).
"""

from __future__ import annotations

import csv
import io
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from inverse_dynamics.errors import OutputError
from inverse_dynamics.evaluation.samples import MASKS
from inverse_dynamics.installation.extras import require
from inverse_dynamics.outputs.files import check_output_file, files_written_whole
from inverse_dynamics.progress import no_progress
from inverse_dynamics.wording import printable

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.progress import Progress

_ROWS = 65536  # written together


class Column(NamedTuple):
    """A series: N values of a unit; none for what is true or false."""

    name: str
    unit: str
    values: Floats | Mask


def series_columns(evaluation: Evaluation) -> list[Column]:
    """Columns of an Evaluation, in the order of the module's text."""
    columns = [Column("time", "s", evaluation.time)]
    log = evaluation.log
    error = evaluation.computed - evaluation.measured
    currents = evaluation.effort.meaning == "current"
    for j, joint in enumerate(log.joint_names):
        torque = evaluation.units[j]
        angle = "m" if torque == "N" else "rad"
        series = (
            ("position", angle, log.q),
            ("velocity", f"{angle}/s", log.qd),
            ("acceleration", f"{angle}/s^2", evaluation.qdd),
            ("current", "A", log.effort) if currents else ("effort", torque, log.effort),
            ("measured", torque, evaluation.measured),
            ("computed", torque, evaluation.computed),
            ("error", torque, error),
            *([] if evaluation.band is None else [("band", torque, evaluation.band)]),
        )
        columns += [Column(f"{name}.{joint}", unit, rows[:, j]) for name, unit, rows in series]
    columns += [Column(mask, "", getattr(evaluation.samples, mask)) for mask in MASKS]
    return columns


def export_series(
    evaluation: Evaluation,
    file: Path,
    *,
    recording: str = "",
    overwrite: bool = False,
    progress: Progress = no_progress,
) -> None:
    """Write the samples as a table, CSV or Parquet by the file's ending, or nothing.

    Parameters
    ----------
    file
        To write, .csv or .parquet.
    recording
        A name that a first column of that title repeats, so that the tables of several recordings are
        one; "": no such column.
    overwrite
        Replace an older file.

    Raises
    ------
    UserError
        OutputError: the ending is another one, the file is there or can't be written, pyarrow isn't
        installed.

    Examples
    --------
    >>> from pathlib import Path
    >>> from inverse_dynamics import evaluate, export_series
    >>> from inverse_dynamics.demo.demo import stored_recording
    >>> result = evaluate(stored_recording("ur10_simulated"), "ur10_simulated")
    >>> export_series(result, Path("samples.csv"))
    >>> Path("samples.csv").read_text()[:32]
    'time,position.shoulder_pan_joint'
    """
    file_format = file.suffix.removeprefix(".").lower()
    if file_format not in ("csv", "parquet"):
        raise OutputError(f"{file}: expected a name ending in .csv or .parquet")
    check_output_file(file, overwrite=overwrite)
    require("a table", "pyarrow")
    import pyarrow as pa

    columns = series_columns(evaluation)
    fields = [
        pa.field(c.name, pa.float64() if c.unit else pa.bool_(), metadata=_metadata(unit=c.unit))
        for c in columns
    ]
    if recording:
        fields.insert(0, pa.field("recording", pa.string()))
    about = _metadata(
        robot=evaluation.robot.name,
        plugin=evaluation.robot.plugin,
        recording=str(evaluation.bag),
        accelerations=evaluation.accelerations.summary,
    )
    schema = pa.schema(fields, metadata=about)
    total = len(evaluation.log)
    with files_written_whole([file]) as (work,), _writer(work, schema, file_format) as writer:
        for begin in range(0, total, _ROWS):
            arrays = [pa.array(c.values[begin : begin + _ROWS]) for c in columns]
            if recording:
                arrays.insert(0, pa.repeat(printable(recording), len(arrays[0])))
            writer.write_batch(pa.record_batch(arrays, schema=schema))
            progress(f"writing {file_format}", min(begin + _ROWS, total), total)


def _metadata(**texts: str) -> dict[str, str]:
    return {key: printable(text) for key, text in texts.items() if text}


@contextmanager
def _writer(file: Path, schema: Any, file_format: str) -> Iterator[Any]:
    """A writer of batches, of CSV or Parquet."""
    if file_format == "parquet":
        from pyarrow.parquet import ParquetWriter

        with ParquetWriter(file, schema, compression="zstd") as writer:
            yield writer
        return
    from pyarrow.csv import CSVWriter, WriteOptions

    # pyarrow puts every name into quotation marks, which simple readers take for part of it.
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(schema.names)
    with file.open("wb") as sink:
        sink.write(header.getvalue().encode())
        with CSVWriter(sink, schema, write_options=WriteOptions(include_header=False)) as writer:
            yield writer

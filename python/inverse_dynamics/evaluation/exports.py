# SPDX-License-Identifier: Apache-2.0
"""All series of an evaluation as one table, a row per sample: `ids export --help` lists the columns.

export_series(read_evaluation("result"), Path("series.parquet"))

Its columns: evaluation/series.py. Every digit is kept. Parquet knows the unit of each column (key
`unit` of its metadata).
"""

from __future__ import annotations

import csv
import io
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import OutputError
from inverse_dynamics.evaluation.series import series_columns
from inverse_dynamics.installation.extras import require
from inverse_dynamics.outputs.files import check_output_file, files_written_whole
from inverse_dynamics.progress import no_progress
from inverse_dynamics.wording import printable

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.progress import Progress

_ROWS = 65536  # written together


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

# SPDX-License-Identifier: Apache-2.0
"""An evaluation as people and files have it: text, HTML, figure, table, numbers, samples."""

from __future__ import annotations

from dataclasses import fields
from html import escape
from importlib import import_module
from typing import TYPE_CHECKING, Any

from inverse_dynamics.evaluation.accelerations import MASKS
from inverse_dynamics.evaluation.series import series_columns
from inverse_dynamics.evaluation.tables import evaluation_table, heading
from inverse_dynamics.installation.extras import require
from inverse_dynamics.outputs.files import write_text
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.recordings.bags import write_torques
from inverse_dynamics.show.result import PAGE, SERIES, ResultDirectory, files_of

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.arrays import DataFrame
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Storage
    from inverse_dynamics.show.result import Line

SCHEMA = 4
RECORDED = ("header_stamps", "receive_stamps", "q", "qd", "effort")

_MOST_JOINTS = 12  # of a text on one screen
_HEAD = ("joint", "unit", "MAE", "RMSE", "NRMSE", "bias", "R2")


class Views(ResultDirectory):
    """What Evaluation shows of itself."""

    contents = files_of(
        "evaluation.json",
        "torques",
        "metrics.json",
        SERIES,
        "bag/metadata.yaml",
        "bag/bag.db3*",
        "bag/bag.mcap",
        added=("series.csv", "series.parquet", PAGE),  # by `ids export` and `ids report`, for one
    )
    data = "metrics.json"

    def numbers(self: Any) -> dict[str, Any]:
        """For people and scripts: errors, what was evaluated, notes and the likely cause of the errors; for JSON."""
        found = self.explained
        return {
            "robot": found.robot.name,
            "plugin": found.robot.plugin,
            "friction": found.robot.friction,
            "bag": found.bag,
            "samples": len(found.log),
            "accelerations": found.accelerations,
            "effort": found.effort,
            "joints": found.errors,
            "mean_rmse": found.mean_rmse if len(set(found.units)) == 1 else None,
            **({} if found.band is None else {"in_band": found.coverage}),
            "kept": {
                "samples": len(found.log) - found.samples.left_out,
                "joints": found.errors_of_kept,
            },
            "notes": found.notes,
            "diagnosis": [{**vars(c), "reference": c.reference} for c in found.diagnosis],
        }

    def lines(self: Any) -> list[Line]:
        """What the screen shows."""
        return [
            *heading(self),
            ("accelerations", self.accelerations.summary),
            ("effort means", self.effort.summary),
            ("note", self.notes),
            evaluation_table(self),
        ]

    def inputs(self: Any) -> tuple[Path | None, ...]:
        """The recording and the robot's files."""
        return self.bag, *self.robot.files

    def arrays(self: Any) -> dict[str, Any]:
        """Samples, not copied: as recorded, computed, masks."""
        computed = ["time", "qdd", "measured", "computed"]
        computed += [] if self.band is None else ["band"]
        return {
            **{name: getattr(self.log, name) for name in RECORDED},
            **{name: getattr(self, name) for name in computed},
            **{name: getattr(self.samples, name) for name in MASKS},
        }

    def write_more(self: Any, directory: Path, storage: Storage | None, progress: Progress) -> None:
        """Write the recording, and evaluation.json: all that the other files lack."""
        found = self.explained
        log, torques = found.log, (found.computed, found.measured)
        write_torques(
            directory / "bag", storage or log.storage, "/torques", log, torques, progress=progress
        )
        names = ("robot", "bag", "joint_names", "units", "accelerations", "effort", "notes")
        recording = ("joint_names", "frame_id", "clock", "topic", "storage", "effort_is", "notes")
        about = {
            "schema": SCHEMA,
            **{name: getattr(found, name) for name in names},
            "samples": len(log),
            "duration": log.duration,
            "sampling": {"period": found.samples.period, "jitter": found.samples.jitter},
            "recording": {name: getattr(log, name) for name in recording},
        }
        write_text(directory / self.contents.mark, json_text(about))

    def __getstate__(self: Any) -> dict[str, Any]:
        """All that files hold: a copy has no run, whose solver can't be copied."""
        found = self.explained
        return {field.name: getattr(found, field.name) for field in fields(found)} | {"run": None}

    def __repr__(self: Any) -> str:
        rows = [_HEAD, *self._rows()]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [
            f"Evaluation of {self.bag.name} as {self.robot.name}: {len(self.log)} samples, "
            f"{self.log.duration:.1f} s, mean RMSE {self.mean_rmse:.4g}",
            *("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows[: _MOST_JOINTS + 1]),
        ]
        if len(rows) > _MOST_JOINTS + 1:
            lines.append(f"... and {len(rows) - _MOST_JOINTS - 1} more joints")
        return "\n".join([*lines, *self.explained.notes[-1:]])

    def _repr_html_(self: Any) -> str:
        """For notebooks."""
        head = "".join(f"<th>{name}</th>" for name in _HEAD)
        body = "".join(
            f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>"
            for row in self._rows()
        )
        notes = "".join(f"<li>{escape(note)}</li>" for note in self.explained.notes)
        title = f"{self.bag.name}, {self.robot.name}: mean RMSE {self.mean_rmse:.4g}"
        return f"<b>{escape(title)}</b><table><tr>{head}</tr>{body}</table>" + (
            notes and f"<ul>{notes}</ul>"
        )

    def _rows(self: Any) -> list[tuple[str, ...]]:
        return [
            (e.joint, e.unit, *numbers[:2], f"{100 * e.nrmse:.3g} %", *numbers[2:])
            for e in self.errors
            for numbers in [[f"{x:.4g}" for x in (e.mae, e.rmse, e.bias, e.r2)]]
        ]

    def plot(self) -> Any:
        """Measured and computed torque and the error of each joint, as a figure of matplotlib.

        Raises MissingPackageError.
        """
        require("a figure", "matplotlib")
        from inverse_dynamics.evaluation.figure import torque_figure

        return torque_figure(self)  # type: ignore[arg-type]

    def to_pandas(self) -> DataFrame:
        """All series as a pandas.DataFrame, a row per sample; columns: evaluation/series.py.

        Raises MissingPackageError.
        """
        return _frame("pandas", self)

    def to_polars(self) -> DataFrame:
        """The same as a polars.DataFrame."""
        return _frame("polars", self)


def _frame(library: str, evaluation: Any) -> DataFrame:
    require("a data frame", library)
    columns = {column.name: column.values for column in series_columns(evaluation)}
    return import_module(library).DataFrame(columns)

# SPDX-License-Identifier: Apache-2.0
"""An evaluation as people look at it: text, HTML, figure, table."""

from __future__ import annotations

from html import escape
from importlib import import_module
from typing import TYPE_CHECKING, Any

from inverse_dynamics.evaluation.series import series_columns
from inverse_dynamics.installation.extras import require

if TYPE_CHECKING:
    from inverse_dynamics.arrays import DataFrame

_MOST_JOINTS = 12  # of a text on one screen
_HEAD = ("joint", "unit", "MAE", "RMSE", "NRMSE", "bias", "R2")


class Views:
    """What Evaluation shows of itself."""

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

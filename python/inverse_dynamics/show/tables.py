# SPDX-License-Identifier: Apache-2.0
"""Tables of results: pages and the screen show the same ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from inverse_dynamics._core import JointError
    from inverse_dynamics.arrays import Floats


IN_BAND = "in 95 % band [%]"


@dataclass(frozen=True)
class ReportTable:
    """A table: rows of texts and numbers, NaN where there is no number; total: the last row sums the others up."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str | float]]
    note: str = ""
    total: bool = False

    @property
    def cells(self) -> list[tuple[str, ...]]:
        """The rows as texts, numbers aligned in each column."""
        return list(zip(*(aligned(column) for column in zip(*self.rows, strict=True)), strict=True))


def of_joints(
    title: str,
    joints: Sequence[str],
    units: Sequence[str],
    columns: Mapping[str, Floats],
    note: str = "",
    means: Collection[str] = (),
) -> ReportTable:
    """A row per joint, of columns (n,) by heading. means: columns whose means the last row has, if units are one."""
    values = [column.tolist() for column in columns.values()]
    rows = list(zip(joints, units, *values, strict=True))
    total = bool(means) and len(set(units)) == 1 and len(units) > 1
    if total:
        last = (float(v.mean()) if name in means else math.nan for name, v in columns.items())
        rows.append(("mean", units[0], *last))
    return ReportTable(title, ("joint", "unit", *columns), rows, note, total)


def joint_table(title: str, errors: Sequence[JointError]) -> ReportTable:
    """Errors of each joint."""
    return of_joints(
        title, [e.joint for e in errors], [e.unit for e in errors], error_columns(errors)
    )


def error_columns(errors: Sequence[JointError]) -> dict[str, Floats]:
    """Columns (n,) of the errors of each joint, by heading."""
    values = np.array([(e.mae, e.rmse, 100 * e.nrmse, e.bias, e.r2) for e in errors])
    return dict(zip(("MAE", "RMSE", "NRMSE [%]", "bias", "R²"), values.T, strict=True))


_LEAST_PLAIN = 1e-3  # a smaller number has a power of ten
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_FIGURE_SPACE, _PUNCTUATION_SPACE = "\N{FIGURE SPACE}", "\N{PUNCTUATION SPACE}"


def number(value: float) -> str:
    """Three significant digits, as people write them; a dash where there is no number."""
    if not math.isfinite(value):
        return "\N{EN DASH}"
    mantissa, _, exponent = f"{value:.2e}".partition("e")  # of the rounded number: 0.9999 is 1.00
    if 0 < abs(value) < _LEAST_PLAIN:
        return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPTS)}"
    return f"{value:.{max(0, 2 - int(exponent))}f}" if value else "0"


def aligned(values: Sequence[str | float]) -> list[str]:
    """The numbers of a column, their decimal points below each other. Texts stay."""
    texts = [value if isinstance(value, str) else number(value) for value in values]
    plain = [not isinstance(v, str) and t[-1].isascii() for v, t in zip(values, texts, strict=True)]
    decimals = [len(text.partition(".")[2]) for text in texts]
    longest = max((d for d, is_plain in zip(decimals, plain, strict=True) if is_plain), default=0)
    return [
        _padded(text, longest) if is_plain else text
        for text, is_plain in zip(texts, plain, strict=True)
    ]


def _padded(text: str, decimals: int) -> str:
    """With spaces as wide as the decimals that other numbers have, which no page may escape."""
    from markupsafe import Markup

    own = len(text.partition(".")[2])
    point = _PUNCTUATION_SPACE if decimals and not own else ""
    return Markup(text + point + _FIGURE_SPACE * (decimals - own))

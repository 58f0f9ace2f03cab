# SPDX-License-Identifier: Apache-2.0
"""Tables of results on the screen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

if TYPE_CHECKING:
    from inverse_dynamics.show.tables import ReportTable


def on_screen(table: ReportTable) -> Table:
    """A table whose names stay whole; numbers are aligned to the right."""
    shown = Table(
        box=box.SIMPLE_HEAD,
        title=table.title or None,
        title_justify="left",
        caption=table.note or None,
        caption_justify="left",
        collapse_padding=True,
    )
    for heading, column in zip(table.headings, zip(*table.rows, strict=True), strict=True):
        texts = isinstance(column[0], str)
        shown.add_column(heading, justify="left" if texts else "right", overflow="fold")
    for row in table.rows:
        if table.total and row is table.rows[-1]:
            shown.add_section()
        cells = (rounded(value) if isinstance(value, float) else f"{value}" for value in row)
        shown.add_row(*cells)
    return shown


def rounded(value: float) -> str:
    """Three decimals, or three significant digits of small numbers."""
    if not math.isfinite(value):
        return "-"
    return f"{value:.3f}" if abs(value) >= 0.1 or value == 0 else f"{value:.3g}"

# SPDX-License-Identifier: Apache-2.0
"""The style of figures, and their parts: panels, titles, legends, shades."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import OutputError
from inverse_dynamics.installation.extras import require
from inverse_dynamics.show import palette
from inverse_dynamics.wording import printable, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path
    from typing import Any

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


MEASURED: dict[str, Any] = {"color": palette.MEASURED, "linewidth": 1.5}
COMPUTED: dict[str, Any] = {"color": palette.COMPUTED, "linewidth": 0.9}
ERROR: dict[str, Any] = {"color": palette.ERROR, "linewidth": 0.7}
LIMIT: dict[str, Any] = {"color": "black", "linestyle": (0, (3.0, 1.6)), "linewidth": 0.8}
LEFT_OUT: dict[str, Any] = {"color": palette.LEFT_OUT, "linewidth": 0, "zorder": 0.5}
_MUTED = palette.MUTED

FORMATS = ("png", "svg", "pdf")

STYLE: Any = {
    "font.size": 8.5,
    "font.family": "sans-serif",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#999999",
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.titley": 1.0,  # else every panel is laid out again to look for a better place
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "xtick.color": _MUTED,
    "ytick.color": _MUTED,
    "svg.fonttype": "none",
    "svg.hashsalt": "inverse_dynamics",
    "pdf.fonttype": 42,
    "text.parse_math": False,  # a name may hold $
    "path.simplify": True,
    "path.simplify_threshold": 0.3,
}


def check_formats(figures: Sequence[str]) -> None:
    """Raise OutputError, or MissingPackageError, unless figures can be saved in these formats."""
    for wrong in (f for f in figures if f not in FORMATS):
        raise OutputError(f"figures: expected some of {', '.join(FORMATS)}, got {shown(wrong)}")
    if figures:
        require("a figure", "matplotlib")


def save_figure(make: Callable[[], Figure], *files: Path) -> None:
    """Save what `make` draws, in the common style. The same figure, the same bytes."""
    if not files:
        return
    import matplotlib as mpl

    with mpl.rc_context(STYLE):
        figure = make()
        make_printable(figure)
        for file in files:
            metadata = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(file.suffix)
            figure.savefig(file, dpi=160, metadata=metadata)


def make_printable(figure: Figure) -> None:
    """Replace characters that the font, or XML, can't show by escapes."""
    from matplotlib.font_manager import findfont, get_font
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        shown = printable(text.get_text())
        if not shown.isascii():
            font = get_font(findfont(text.get_fontproperties()))
            shown = "".join(
                c if c.isspace() or font.get_char_index(ord(c)) else ascii(c)[1:-1] for c in shown
            )
        text.set_text(shown)


def panels(
    rows: int, each: float, top: float, ratios: Sequence[float] = (1.0,)
) -> tuple[Figure, NDArray[np.object_]]:
    """A figure and its axes (rows, columns) over one time. each: inches of a row; top: inches left above them."""
    from matplotlib.figure import Figure

    height = each * rows + top + 0.38
    figure = Figure(figsize=(11.0, height))
    axes = figure.subplots(rows, len(ratios), sharex=True, squeeze=False, width_ratios=ratios)
    figure.subplots_adjust(
        left=0.065,
        right=0.985,
        top=1 - top / height,
        bottom=0.5 / height,
        hspace=0.42,
        wspace=0.13,
    )
    for axis in axes[-1]:
        axis.set_xlabel("time [s]", color=_MUTED)
    return figure, axes


def write_title(axes: Axes, title: str, **more: Any) -> None:
    """The title of a panel."""
    axes.set_title(title, loc="left", fontsize=9, pad=3, **more)


def write_heading(figure: Figure, title: str, *lines: str) -> None:
    """A title, and lines below it."""
    height = figure.get_figheight()
    size = min(13.0, 13.0 * 100 / len(title))  # long ones on one line too
    figure.text(0.012, 1 - 0.3 / height, title, fontsize=size, fontweight="bold")
    for k, text in enumerate(lines):
        figure.text(0.012, 1 - (0.52 + 0.18 * k) / height, text, color=_MUTED)


def write_legend(figure: Figure, handles: Sequence[Artist], left: float, inches: float) -> None:
    """A legend in one row, at this distance from the top."""
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(left, 1 - inches / figure.get_figheight()),
        borderaxespad=0,
        borderpad=0,
        ncols=len(handles),
        frameon=False,
        fontsize=9,
    )


def shade(
    axes: Axes, spans: Sequence[tuple[float, float]], least: float, style: dict[str, Any]
) -> None:
    """Spans of time [s], each as wide as that part of the axis at least, so that it can be seen.

    A few samples that were left out are a mark on the axis: many of them would look like a grid.
    """
    low, high = axes.get_xlim()
    width = least * (high - low)
    for begin, end in spans:
        top = 0.08 if style is LEFT_OUT and end - begin < width else 1.0
        axes.axvspan(begin, max(end, begin + width), ymax=top, **style)

# SPDX-License-Identifier: Apache-2.0
"""Figures of an evaluation: measured torques below computed ones, and their difference (palette.py)."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.extras import require
from inverse_dynamics.base.wording import printable, shown
from inverse_dynamics.errors import OutputError
from inverse_dynamics.figures import palette
from inverse_dynamics.figures.thinning import error_limit, line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path
    from typing import Any

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from inverse_dynamics.evaluation.comparison import Comparison
    from inverse_dynamics.evaluation.evaluation import Evaluation

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


def save_torque_figure(evaluation: Evaluation, *files: Path) -> None:
    """Save torque_figure(); formats are those of the suffixes. The same evaluation, the same bytes."""
    save_figure(lambda: torque_figure(evaluation), *files)


def save_figure(make: Callable[[], Figure], *files: Path) -> None:
    """Save what `make` draws, in the common style. The same figure, the same bytes."""
    if not files:
        return
    with _styled(make) as figure:
        for file in files:
            metadata = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(file.suffix)
            figure.savefig(file, dpi=160, metadata=metadata)


@contextmanager
def _styled(make: Callable[[], Figure]) -> Iterator[Figure]:
    import matplotlib as mpl

    settings: Any = {**STYLE, "svg.hashsalt": "inverse_dynamics"}
    with mpl.rc_context(settings):
        figure = make()
        make_printable(figure)
        yield figure


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


def torque_figure(evaluation: Evaluation) -> Figure:
    """Measured and computed torque over time, and the error, one row per joint."""
    robot = evaluation.robot
    friction = "" if robot.friction else ", friction left out"
    heading = (
        robot.description or robot.name,
        f"{robot.name}   ·   solver {robot.plugin}{friction}",
        f"{evaluation.bag.name}, {len(evaluation.log)} samples, {evaluation.log.duration:.1f} s   ·   "
        f"accelerations: {evaluation.accelerations.summary}",
    )
    return _figure([evaluation], ("computed torque",), [ERROR], heading)


def comparison_figure(comparison: Comparison) -> Figure:
    """Measured torque and that of each run over time, and the runs' errors, one row per joint."""
    first, labels = comparison.evaluations[0], comparison.labels
    styles = [{"color": _color(k), "linewidth": 0.9} for k in range(len(labels))]
    heading = (f"{first.bag.name}: {' against '.join(labels)}",)
    return _figure(comparison.evaluations, labels, styles, heading)


def _color(run: int) -> str:
    return palette.RUNS[run % len(palette.RUNS)]


def _figure(
    runs: Sequence[Evaluation],
    labels: Sequence[str],
    error_styles: Sequence[dict[str, Any]],
    heading: Sequence[str],
) -> Figure:
    """Torques of runs of one recording, and their errors."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    first = runs[0]
    figure, axes = panels(len(first.joint_names), 1.25, 1.32, (1.7, 1.0))
    left_out = first.samples.left_out_spans(first.log)
    for j, (left, right) in enumerate(axes):
        _draw_torques(left, runs, j)
        _draw_errors(right, runs, error_styles, j)
        for axis in (left, right):
            shade(axis, left_out, 0.004, LEFT_OUT)
    for axis in axes[-1]:
        axis.set_xlim(first.time[0], first.time[-1])
    write_heading(figure, *heading)
    torques: list[Line2D | Patch] = [Line2D([], [], label="measured torque", **MEASURED)]
    torques += [
        Line2D([], [], label=label, color=_color(k), linewidth=COMPUTED["linewidth"])
        for k, label in enumerate(labels)
    ]
    if left_out:
        torques.append(Patch(label="samples left out", **LEFT_OUT))
    error = Line2D([], [], label="error: computed - measured", **error_styles[0])
    torque_place, error_place = (axis.get_position().x0 for axis in axes[0])
    write_legend(figure, torques, torque_place, 0.87)
    write_legend(figure, [error], error_place, 0.87)
    return figure


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


def _draw_torques(axes: Axes, runs: Sequence[Evaluation], j: int) -> None:
    first = runs[0]
    axes.plot(*line(first.time, first.measured[:, j]), **MEASURED)
    for k, run in enumerate(runs):
        axes.plot(*line(run.time, run.computed[:, j]), **{**COMPUTED, "color": _color(k)})
    write_title(axes, f"{first.joint_names[j]} [{first.units[j]}]")
    axes.margins(y=0.08)


def _draw_errors(
    axes: Axes, runs: Sequence[Evaluation], styles: Sequence[dict[str, Any]], j: int
) -> None:
    from matplotlib.ticker import EngFormatter

    errors = [run.computed[:, j] - run.measured[:, j] for run in runs]
    kept = runs[0].samples.kept
    largest = 1.1 * (max(error_limit(error[kept]) for error in errors) or 1.0)
    peak = max(np.abs(error).max() for error in errors)
    axes.axhline(0, color="#999999", linewidth=0.6)
    for run, error, style in zip(runs, errors, styles, strict=True):
        axes.plot(*line(run.time, error), **style)
    axes.set_ylim(-largest, largest)
    if largest < 0.01:
        axes.yaxis.set_major_formatter(EngFormatter(sep=""))  # 200µ instead of 0.0002
    of_joint = [run.errors[j] for run in runs]
    title = f"RMSE {' / '.join(f'{e.rmse:.3g}' for e in of_joint)} {of_joint[0].unit}"
    if len(runs) == 1 and not np.isnan(of_joint[0].nrmse):
        title += f", {100 * of_joint[0].nrmse:.2g} % of range"
    if peak > largest:
        title += f", cut: peak {peak:.3g}"
    write_title(axes, title, color=_MUTED)

# SPDX-License-Identifier: Apache-2.0
"""Figures of an evaluation: measured torques below computed ones, and their difference (palette.py)."""

from __future__ import annotations

from contextlib import contextmanager
from io import StringIO
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from inverse_dynamics.base.extras import require
from inverse_dynamics.base.wording import printable, shown
from inverse_dynamics.errors import OutputError
from inverse_dynamics.figures import palette
from inverse_dynamics.figures.thinning import error_limit, line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from inverse_dynamics.evaluation.comparison import Comparison
    from inverse_dynamics.evaluation.evaluation import Evaluation

MEASURED: dict[str, Any] = {"color": palette.MEASURED, "linewidth": 1.5}
COMPUTED: dict[str, Any] = {"color": palette.COMPUTED, "linewidth": 0.9}
ERROR: dict[str, Any] = {"color": palette.ERROR, "linewidth": 0.7}
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


def svg_of(make: Callable[[], Figure], **style: Any) -> str:
    """What `make` draws as SVG, in the common style with these changes. The same figure, the same text."""
    text = StringIO()
    with _styled(make, **style) as figure:
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


@contextmanager
def _styled(make: Callable[[], Figure], **style: Any) -> Iterator[Figure]:
    import matplotlib as mpl

    settings: Any = {**STYLE, "svg.hashsalt": "inverse_dynamics", **style}
    with mpl.rc_context(settings):
        figure = make()
        make_printable(figure)
        yield figure


def make_printable(figure: Figure) -> None:
    """Names that the font, or XML, can't show become escapes."""
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
    from matplotlib.figure import Figure

    n = len(evaluation.joint_names)
    figure = Figure(figsize=(11.0, 1.25 * n + 1.7))
    axes = _panels(figure, n, top=1.32, bottom=0.5)
    left_out = evaluation.samples.left_out_spans(evaluation.log)
    error_style = {"label": "error: computed - measured", **ERROR}
    runs = [_Run(evaluation, "computed torque", COMPUTED, error_style)]
    for j, (left, right) in enumerate(axes):
        _draw_torques(left, runs, j)
        error = evaluation.errors[j]
        share = "" if np.isnan(error.nrmse) else f", {100 * error.nrmse:.2g} % of measured range"
        _draw_errors(right, runs, j, f"RMSE {error.rmse:.3g} {error.unit}{share}")
        shade(left, left_out, 0.004, LEFT_OUT, label="samples left out")
        shade(right, left_out, 0.004, LEFT_OUT)
    _label_time(axes, evaluation)
    robot = evaluation.robot
    friction = "" if robot.friction else ", friction left out"
    write_heading(
        figure,
        robot.description or robot.name,
        f"{robot.name}   ·   solver {robot.plugin}{friction}",
        f"{evaluation.bag.name}, {len(evaluation.log)} samples, {evaluation.log.duration:.1f} s   ·   "
        f"accelerations: {evaluation.accelerations.summary}",
    )
    for axis in axes[0]:
        write_legend(figure, axis, axis.get_position().x0, 0.87)
    return figure


def write_heading(figure: Figure, title: str, *lines: str) -> None:
    """A title, and lines below it."""
    height = figure.get_figheight()
    size = min(13.0, 13.0 * 100 / len(title))  # long ones on one line too
    figure.text(0.012, 1 - 0.3 / height, title, fontsize=size, fontweight="bold")
    for k, text in enumerate(lines):
        figure.text(0.012, 1 - (0.52 + 0.18 * k) / height, text, color=_MUTED)


def write_legend(figure: Figure, axes: Axes, left: float, inches: float) -> None:
    """What is drawn in the axes, in one row at this distance from the top."""
    handles, labels = axes.get_legend_handles_labels()
    named = dict(zip(labels, handles, strict=True))
    figure.legend(
        named.values(),
        named.keys(),
        loc="upper left",
        bbox_to_anchor=(left, 1 - inches / figure.get_figheight()),
        borderaxespad=0,
        borderpad=0,
        ncols=len(named),
        frameon=False,
        fontsize=9,
    )


def shade(
    axes: Axes,
    spans: Sequence[tuple[float, float]],
    least: float,
    style: dict[str, Any],
    label: str = "",
) -> None:
    """Spans of time [s], each as wide as that part of the axis at least, so that it can be seen."""
    low, high = axes.get_xlim()
    for begin, end in spans:
        axes.axvspan(begin, max(end, begin + least * (high - low)), label=label, **style)


def comparison_figure(comparison: Comparison) -> Figure:
    """Measured torque and that of each run over time, and the runs' errors, one row per joint."""
    from matplotlib.figure import Figure

    first = comparison.evaluations[0]
    n = len(comparison.joint_names)
    height = 1.25 * n + 1.2
    figure = Figure(figsize=(11.0, height))
    figure.suptitle(
        f"{first.bag.name}: {' against '.join(comparison.labels)}",
        y=1 - 0.1 / height,
        fontsize=12,
        fontweight="bold",
    )
    axes = _panels(figure, n, top=0.55, bottom=0.8)
    runs = []
    for k, (run, label) in enumerate(zip(comparison.evaluations, comparison.labels, strict=True)):
        style = {"color": palette.RUNS[k % len(palette.RUNS)], "linewidth": 0.9}
        runs.append(_Run(run, label, style, style))
    for j, (left, right) in enumerate(axes):
        _draw_torques(left, runs, j)
        rmse = " / ".join(f"{value:.3g}" for value in comparison.rmse[:, j])
        _draw_errors(right, runs, j, f"error: RMSE {rmse} {first.units[j]}")
    _label_time(axes, first)
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=len(labels), frameon=False)
    return figure


def _label_time(axes: NDArray[np.object_], evaluation: Evaluation) -> None:
    for axis in axes[-1]:
        axis.set_xlabel("time [s]", color=_MUTED)
        axis.set_xlim(evaluation.time[0], evaluation.time[-1])


class _Run(NamedTuple):
    """An evaluation, and how its computed torques and errors are drawn."""

    evaluation: Evaluation
    label: str
    style: dict[str, Any]
    error_style: dict[str, Any]


def _panels(figure: Figure, n: int, *, top: float, bottom: float) -> NDArray[np.object_]:
    """Axes (n, 2) at fixed places, torques and errors; `top` and `bottom` inches are left to others."""
    axes = figure.subplots(n, 2, sharex=True, squeeze=False, width_ratios=(1.7, 1.0))
    height = figure.get_figheight()
    figure.subplots_adjust(
        left=0.065,
        right=0.985,
        top=1 - top / height,
        bottom=bottom / height,
        hspace=0.42,
        wspace=0.13,
    )
    return axes


def _draw_torques(axes: Axes, runs: Sequence[_Run], j: int) -> None:
    """Measured torques of a joint, below those that each run computes."""
    first = runs[0].evaluation
    axes.plot(*line(first.time, first.measured[:, j]), label="measured torque", **MEASURED)
    for run in runs:
        computed = line(run.evaluation.time, run.evaluation.computed[:, j])
        axes.plot(*computed, label=run.label, **run.style)
    axes.set_title(f"{first.joint_names[j]} [{first.units[j]}]", loc="left", fontsize=9, pad=3)
    axes.margins(y=0.08)


def _draw_errors(axes: Axes, runs: Sequence[_Run], j: int, text: str) -> None:
    """Computed minus measured torques of a joint on an axis about zero; text: how large they are."""
    from matplotlib.ticker import EngFormatter

    axes.axhline(0, color="#999999", linewidth=0.6)
    largest = peak = 0.0
    for run in runs:
        difference = run.evaluation.computed[:, j] - run.evaluation.measured[:, j]
        largest = max(largest, 1.1 * error_limit(difference[run.evaluation.samples.kept]))
        peak = max(peak, np.abs(difference).max())
        time, drawn = line(run.evaluation.time, difference)
        if len(runs) == 1:
            axes.fill_between(time, 0, drawn, color=ERROR["color"], alpha=0.15, linewidth=0)
        axes.plot(time, drawn, **run.error_style)
    largest = largest or 1.0
    axes.set_ylim(-largest, largest)
    if largest < 0.01:
        axes.yaxis.set_major_formatter(EngFormatter(sep=""))  # 200µ instead of 0.0002
    cut = f", cut: peak {peak:.3g}" if peak > largest else ""
    axes.set_title(f"{text}{cut}", loc="left", fontsize=9, pad=3, color=_MUTED)

# SPDX-License-Identifier: Apache-2.0
"""Where the errors of an evaluation are: how large, and at which frequencies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.extras import how_to_install, is_installed
from inverse_dynamics.base.wording import printable
from inverse_dynamics.figures import palette
from inverse_dynamics.figures.plots import svg_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import Evaluation

_MUTED, _GRID = palette.MUTED, palette.GRID


def error_figure(evaluation: Evaluation) -> str:
    """Distribution and spectrum of the errors, as SVG text. The same evaluation, the same text."""
    if not is_installed("matplotlib"):
        return not_drawn()
    return svg_of(lambda: _error_figure(evaluation), **{"font.size": 9, "axes.grid": False})


def _error_figure(evaluation: Evaluation) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    measured, error = _shares(evaluation)
    _draw_distribution(left, tuple(map(printable, evaluation.joint_names)), error)
    _draw_spectra(right, evaluation, measured, error)
    return figure


def not_drawn() -> str:
    """The text in place of a figure where matplotlib isn't installed."""
    return f"<p>Not drawn: a figure needs matplotlib: {how_to_install('matplotlib')}</p>"


def _shares(evaluation: Evaluation) -> tuple[Floats, Floats]:
    """Measured torque and error, (N, n), in percent of each joint's measured range."""
    span = np.ptp(evaluation.measured, axis=0)
    unit = np.where(span > 0, span, 1.0) / 100
    return evaluation.measured / unit, (evaluation.computed - evaluation.measured) / unit


def _draw_distribution(axes: Axes, names: tuple[str, ...], error: Floats) -> None:
    boxes = axes.boxplot(
        list(error.T[::-1]),
        orientation="horizontal",
        whis=(5, 95),
        showfliers=False,
        widths=0.55,
        patch_artist=True,
        medianprops={"color": "black"},
    )
    for box in boxes["boxes"]:
        box.set(facecolor=palette.ERROR, alpha=0.45)
    axes.set_yticks(range(1, len(names) + 1), names[::-1])
    axes.axvline(0, color=palette.MEASURED, linewidth=0.8)
    axes.grid(axis="x", color=_GRID)
    axes.set_xlabel("computed - measured [% of measured range]", color=_MUTED)


def _draw_spectra(axes: Axes, evaluation: Evaluation, measured: Floats, error: Floats) -> None:
    from matplotlib.ticker import LogLocator

    period = float(evaluation.time[-1]) / (len(evaluation.time) - 1)
    for values, color, width, label in (
        (measured, palette.MEASURED, 2.0, "measured torque"),
        (error, palette.ERROR, 1.1, "error"),
    ):
        frequency, amplitude = _spectrum(values, period)
        axes.loglog(frequency, amplitude, color=color, linewidth=width, label=label)
    if evaluation.accelerations.cutoff is not None:
        axes.axvline(
            evaluation.accelerations.cutoff, color=palette.CUTOFF, linewidth=1.3, label="cut-off"
        )
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))  # also where a decade is all there is
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    axes.grid(color=_GRID)
    axes.legend(frameon=False)
    axes.set_xlabel("frequency [Hz]", color=_MUTED)
    axes.set_ylabel("% of range / √Hz", color=_MUTED)


def _spectrum(values: Floats, period: float) -> tuple[Floats, Floats]:
    """Amplitude spectral density of (N, n) samples, mean over the columns, by Welch's method (Hann, half overlap)."""
    from matplotlib.mlab import detrend_mean, psd

    length = max(2, min(len(values), 2 ** int(np.log2(max(4, len(values) / 4)))))
    window, overlap = np.hanning(length + 1)[:-1], length // 2
    frequency: Floats = np.arange(length // 2 + 1) / (length * period)
    power = [psd(c, length, 1 / period, detrend_mean, window, overlap)[0] for c in values.T]
    density: Floats = np.sqrt(np.mean(np.array(power), axis=0))
    return frequency[1:], density[1:]

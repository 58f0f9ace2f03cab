# SPDX-License-Identifier: Apache-2.0
"""Figures of evaluations: measured torques below computed ones, and their difference (palette.py)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.show import palette
from inverse_dynamics.show.plots import (
    COMPUTED,
    ERROR,
    LEFT_OUT,
    MEASURED,
    panels,
    save_figure,
    shade,
    write_heading,
    write_legend,
    write_title,
)
from inverse_dynamics.show.thinning import error_limit, line

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from typing import Any

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inverse_dynamics.evaluation.evaluation import Evaluation


def save_torque_figure(evaluation: Evaluation, *files: Path) -> None:
    """Save torque_figure(); formats are those of the suffixes. The same evaluation, the same bytes."""
    save_figure(lambda: torque_figure(evaluation), *files)


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
    return runs_figure([evaluation], ("computed torque",), [ERROR], heading)


def run_color(run: int) -> str:
    """Of the torques of a run among others."""
    return palette.RUNS[run % len(palette.RUNS)]


def runs_figure(
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
        Line2D([], [], label=label, color=run_color(k), linewidth=COMPUTED["linewidth"])
        for k, label in enumerate(labels)
    ]
    if left_out:
        torques.append(Patch(label="samples left out", **LEFT_OUT))
    error = Line2D([], [], label="error: computed - measured", **error_styles[0])
    torque_place, error_place = (axis.get_position().x0 for axis in axes[0])
    write_legend(figure, torques, torque_place, 0.87)
    write_legend(figure, [error], error_place, 0.87)
    return figure


def _draw_torques(axes: Axes, runs: Sequence[Evaluation], j: int) -> None:
    first = runs[0]
    axes.plot(*line(first.time, first.measured[:, j]), **MEASURED)
    for k, run in enumerate(runs):
        axes.plot(*line(run.time, run.computed[:, j]), **{**COMPUTED, "color": run_color(k)})
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
    write_title(axes, title, color=palette.MUTED)

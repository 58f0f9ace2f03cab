# SPDX-License-Identifier: Apache-2.0
"""Figure of a comparison: measured torques, and those of each run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.evaluation.figure import run_color, runs_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from inverse_dynamics.comparison.comparison import Comparison


def comparison_figure(comparison: Comparison) -> Figure:
    """Measured torque and that of each run over time, and the runs' errors, one row per joint."""
    labels = comparison.labels
    styles = [{"color": run_color(k), "linewidth": 0.9} for k in range(len(labels))]
    return runs_figure(comparison.evaluations, labels, styles, (comparison.title,))

# SPDX-License-Identifier: Apache-2.0
"""Figure of what a load explains: torques without and with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.show import palette
from inverse_dynamics.show.plots import panels, write_heading, write_legend, write_title
from inverse_dynamics.show.thinning import line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from inverse_dynamics.payload.payload import Payload


def payload_figure(payload: Payload) -> Figure:
    """Residual torques over time, one joint per row."""
    from matplotlib.lines import Line2D

    names, units = payload.joint_names, payload.evaluation.units
    figure, axes = panels(len(names), 1.15, 0.95)
    kinds = (
        ("without load", payload.before, palette.RUNS[1]),
        ("with load and offsets", payload.after, palette.ERROR),
    )
    for j, axis in enumerate(axes[:, 0]):
        for _, values, color in kinds:
            axis.plot(*line(payload.time, values[:, j]), color=color, linewidth=0.8)
        axis.axhline(0.0, color=palette.MUTED, linewidth=0.5)
        write_title(axis, f"{names[j]} [{units[j]}]")
    write_heading(figure, "Measured minus computed torques")
    handles = [Line2D([], [], color=color, label=name) for name, _, color in kinds]
    write_legend(figure, handles, 0.012, 0.45)
    return figure

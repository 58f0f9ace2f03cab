# SPDX-License-Identifier: Apache-2.0
"""Figure of what a load explains: measured minus computed torques without it and with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.figures import palette
from inverse_dynamics.figures.plots import save_figure
from inverse_dynamics.figures.thinning import peaks

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from inverse_dynamics.identification.payload import Payload

_MOST_POINTS = 6000
_BEFORE, _AFTER, _MUTED = palette.BEFORE, palette.ERROR, palette.MUTED


def save_payload_figure(payload: Payload, *files: Path) -> None:
    """Save payload_figure(); formats are those of the suffixes."""
    save_figure(lambda: payload_figure(payload), *files)


def payload_figure(payload: Payload) -> Figure:
    """Residual torques over time, one joint per row."""
    from matplotlib.figure import Figure

    names, units = payload.joint_names, payload.evaluation.units
    figure = Figure(figsize=(11.0, 1.15 * len(names) + 1.2), layout="constrained")
    axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for j, axis in enumerate(axes):
        for values, color in ((payload.before[:, j], _BEFORE), (payload.after[:, j], _AFTER)):
            shown = peaks(values, _MOST_POINTS)
            axis.plot(payload.time[shown], values[shown], color=color, linewidth=0.8)
        axis.axhline(0.0, color=_MUTED, linewidth=0.5)
        axis.set_ylabel(f"{names[j]}\n[{units[j]}]", color=_MUTED)
    axes[-1].set_xlabel("time [s]", color=_MUTED)
    figure.suptitle(
        "Measured minus computed torques: without the load (orange), with it and the offsets (blue)"
    )
    return figure

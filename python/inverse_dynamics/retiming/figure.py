# SPDX-License-Identifier: Apache-2.0
"""Figure of a timed path: speed below its limit, each joint's torque within its own, which joint limits where."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.show import palette
from inverse_dynamics.show.plots import COMPUTED, LIMIT, MEASURED, write_title

if TYPE_CHECKING:
    from typing import Any

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inverse_dynamics.retiming.retiming import Retimed

_BAND: dict[str, Any] = {"color": palette.COMPUTED, "alpha": 0.2, "linewidth": 0}
JOINT_COLORS = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#882255",
    "#7A4A12",
)


def retime_figure(result: Retimed) -> Figure:
    """Path speed over its limit curve; over time a strip of joints at their limits, and torques."""
    from matplotlib.figure import Figure

    joints = len(result.joint_names)
    height = 3.6 + 1.15 * joints
    figure = Figure(figsize=(11.0, height))
    ratios = (2.2, 0.5, *(1.0 for _ in range(joints)))
    axes = figure.subplots(joints + 2, 1, gridspec_kw={"height_ratios": ratios})
    figure.subplots_adjust(
        left=0.07, right=0.985, top=1 - 0.75 / height, bottom=0.5 / height, hspace=0.62
    )
    _draw_speed(axes[0], result)
    _draw_strip(axes[1], result)
    for j, axis in enumerate(axes[2:]):
        _draw_torque(axis, result, j)
    axes[-1].set_xlabel("time [s]", color=palette.MUTED)
    saved = result.seconds_saved
    text = f"{result.robot.name}: {result.duration:.3f} s"
    if np.isfinite(saved):
        text += (
            f", {saved:.3f} s less than with the best constant acceleration limit "
            f"({result.acceleration:.3g} rad/s$^2$)".replace("$^2$", "²")
        )
    figure.suptitle(text, x=0.07, ha="left", fontsize=11, y=1 - 0.18 / height)
    return figure


def _draw_speed(axis: Axes, result: Retimed) -> None:
    timed = result.timed
    top = 1.25 * float(timed.speed.max())
    limit = np.where(np.isfinite(result.speed_limit), result.speed_limit, 0.0)
    axis.fill_between(
        timed.s, np.minimum(limit, top), top, color=palette.LEFT_OUT, alpha=0.3, linewidth=0
    )
    if result.by_acceleration is not None:
        other = result.by_acceleration
        axis.plot(other.s, other.speed, **MEASURED, label="constant acceleration limit")
    axis.plot(timed.s, timed.speed, **COMPUTED, label="within torque limits")
    axis.set_xlim(timed.s[0], timed.s[-1])
    axis.set_ylim(0.0, top)
    axis.legend(loc="lower right", fontsize=8, frameon=False)
    axis.set_xlabel("way along the path [rad]", color=palette.MUTED, labelpad=1)
    write_title(axis, "speed along the path [rad/s]; grey: beyond what limits allow")


def _draw_strip(axis: Axes, result: Retimed) -> None:
    """Colours over time, a row each for torque and velocity: the joint nearest to its limit, where it is at it."""
    from matplotlib.patches import Patch

    rows = {"velocity": result.limiting_velocity, "torque": result.limiting}
    shown = []
    for j, joint in enumerate(result.joint_names):
        color = JOINT_COLORS[j % len(JOINT_COLORS)]
        for row, limiting in enumerate(rows.values()):
            axis.fill_between(
                result.time, row, row + 1, where=limiting == j, color=color, linewidth=0, step="mid"
            )
        if any((limiting == j).any() for limiting in rows.values()):
            shown.append(Patch(color=color, label=joint))
    axis.axhline(1.0, color=palette.MUTED, linewidth=0.5)
    axis.set_xlim(result.time[0], result.time[-1])
    axis.set_ylim(0.0, len(rows))
    axis.set_yticks([0.5, 1.5], list(rows), fontsize=8)
    axis.grid(visible=False)
    write_title(axis, "joint at its limit")
    if shown:
        axis.legend(
            handles=shown,
            loc="lower right",
            bbox_to_anchor=(1.0, 0.95),
            ncols=len(shown),
            fontsize=8,
            frameon=False,
            borderpad=0.1,
            handlelength=1.0,
        )


def _draw_torque(axis: Axes, result: Retimed, j: int) -> None:
    limit, band, torque = result.limits.torque[j], result.band[j], result.efforts[:, j]
    if band > 0.0:
        axis.fill_between(result.time, torque - band, torque + band, **_BAND)
    axis.plot(result.time, torque, **COMPUTED)
    for sign in (-1, 1):
        axis.plot(result.time, sign * result.torque_limit[:, j], **LIMIT)
    axis.set_xlim(result.time[0], result.time[-1])
    axis.set_ylim(-1.15 * limit, 1.15 * limit)
    write_title(
        axis,
        f"{result.joint_names[j]} [{result.units[j]}], limit {limit:g} {result.units[j]}, at it "
        f"{100 * result.at_limit[j]:.0f} % of the time",
    )

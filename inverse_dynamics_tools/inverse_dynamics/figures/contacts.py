# SPDX-License-Identifier: Apache-2.0
"""Figures of torques beyond the model's: contacts with their thresholds, and what a load explains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.wording import counted
from inverse_dynamics.figures import palette
from inverse_dynamics.figures.plots import shade, write_heading, write_legend
from inverse_dynamics.figures.thinning import line, peaks

if TYPE_CHECKING:
    from typing import Any

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.contacts import Contacts
    from inverse_dynamics.identification.payload import Payload

_MOST_POINTS = 6000
_LINE: dict[str, Any] = {"color": palette.ERROR, "linewidth": 0.8}
_THRESHOLD: dict[str, Any] = {"color": "black", "linestyle": (0, (3.0, 1.6)), "linewidth": 0.8}
_CONTACT: dict[str, Any] = {"color": palette.CONTACT, "alpha": 0.35, "linewidth": 0}
_QUIET: dict[str, Any] = {"color": palette.QUIET, "alpha": 0.1, "linewidth": 0}
_UNKNOWN: dict[str, Any] = {
    "facecolor": "none",
    "edgecolor": "#888888",
    "hatch": "////",
    "linewidth": 0,
}
_MUTED = palette.MUTED
_MARK = 0.002  # of the time shown: a shorter contact would be no pixel


def contact_figure(contacts: Contacts) -> Figure:
    """External torques over time, one row per joint, and the force at the tip; contacts are shaded."""
    from matplotlib.figure import Figure

    evaluation, thresholds = contacts.evaluation, contacts.thresholds.torques
    rows = len(evaluation.joint_names) + (contacts.wrenches is not None)
    height = 1.2 * rows + 1.55
    figure = Figure(figsize=(11.0, height))
    axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    figure.subplots_adjust(
        left=0.06, right=0.985, top=1 - 1.17 / height, bottom=0.45 / height, hspace=0.42
    )
    for j, axis in enumerate(axes[: len(evaluation.joint_names)]):
        _draw(axis, contacts, contacts.torques[:, j])
        for sign in (-1, 1):
            axis.axhline(sign * thresholds[j], **_THRESHOLD)
        unit = evaluation.units[j]
        title = f"{evaluation.joint_names[j]} [{unit}], threshold {thresholds[j]:.3g} {unit}"
        axis.set_title(title, loc="left", fontsize=9, pad=3)
    if contacts.wrenches is not None:
        _draw(axes[-1], contacts, np.linalg.norm(contacts.wrenches[:, :3], axis=1))
        axes[-1].set_title(
            "force at the tip, if nothing else is touched [N]", loc="left", fontsize=9, pad=3
        )
    axes[-1].set_xlabel("time [s]", color=_MUTED)
    _write_heading(figure, contacts)
    return figure


def _draw(axis: Axes, contacts: Contacts, values: Floats) -> None:
    shown = peaks(values, _MOST_POINTS)
    known = np.where(contacts.valid, values, np.nan)  # else zeros were drawn
    axis.plot(contacts.time[shown], known[shown], **_LINE)
    axis.set_xlim(contacts.time[0], contacts.time[-1])
    if contacts.quiet_part is not None:
        axis.axvspan(*contacts.quiet_part, **_QUIET)
    shade(axis, contacts.interruptions, 0.0, _UNKNOWN)
    shade(axis, [(contact.begin, contact.end) for contact in contacts.contacts], _MARK, _CONTACT)


def _write_heading(figure: Figure, contacts: Contacts) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    evaluation, rate = contacts.evaluation, contacts.thresholds.false_alarms_per_hour
    robot = evaluation.robot
    write_heading(
        figure,
        f"{robot.description or robot.name}: {counted(len(contacts.contacts), 'contact')}",
        f"{evaluation.bag.name}   ·   {contacts.estimator}, {contacts.gain:g} 1/s   ·   thresholds for "
        f"{rate:g} false alarm{'' if rate == 1 else 's'} per hour",
    )
    handles: list[Line2D | Patch] = [
        Line2D([], [], label="external torque", **_LINE),
        Line2D([], [], label="threshold", **_THRESHOLD),
        Patch(label="contact", **_CONTACT),
    ]
    if contacts.quiet_part is not None:
        handles.append(Patch(label="part used for the thresholds", **_QUIET))
    if contacts.interruptions:
        handles.append(Patch(label="no estimate", **_UNKNOWN))
    write_legend(figure, handles, 0.012, 0.66)


def payload_figure(payload: Payload) -> Figure:
    """Residual torques over time, one joint per row."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    names, units = payload.joint_names, payload.evaluation.units
    height = 1.15 * len(names) + 1.2
    figure = Figure(figsize=(11.0, height))
    axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    figure.subplots_adjust(
        left=0.06, right=0.985, top=1 - 0.95 / height, bottom=0.45 / height, hspace=0.42
    )
    kinds = (
        ("without load", payload.before, palette.RUNS[1]),
        ("with load and offsets", payload.after, palette.ERROR),
    )
    for j, axis in enumerate(axes):
        for _, values, color in kinds:
            axis.plot(*line(payload.time, values[:, j]), color=color, linewidth=0.8)
        axis.axhline(0.0, color=_MUTED, linewidth=0.5)
        axis.set_title(f"{names[j]} [{units[j]}]", loc="left", fontsize=9, pad=3)
    axes[-1].set_xlabel("time [s]", color=_MUTED)
    write_heading(figure, "Measured minus computed torques")
    handles = [Line2D([], [], color=color, label=name) for name, _, color in kinds]
    write_legend(figure, handles, 0.012, 0.45)
    return figure

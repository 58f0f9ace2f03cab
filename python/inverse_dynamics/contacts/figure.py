# SPDX-License-Identifier: Apache-2.0
"""Figures of torques beyond the model's: contacts with their thresholds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.show import palette
from inverse_dynamics.show.plots import (
    ERROR,
    LIMIT,
    panels,
    shade,
    write_heading,
    write_legend,
    write_title,
)
from inverse_dynamics.show.thinning import peaks
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from typing import Any

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.contacts.contacts import Contacts

_MOST_POINTS = 6000
_CONTACT: dict[str, Any] = {"color": palette.CONTACT, "alpha": 0.35, "linewidth": 0}
_QUIET: dict[str, Any] = {"color": palette.QUIET, "alpha": 0.1, "linewidth": 0}
_UNKNOWN: dict[str, Any] = {
    "facecolor": "none",
    "edgecolor": "#888888",
    "hatch": "////",
    "linewidth": 0,
}
_MARK = 0.002  # of the time shown: a shorter contact would be no pixel


def contact_figure(contacts: Contacts) -> Figure:
    """External torques over time, one row per joint, and the force at the tip; contacts are shaded."""
    evaluation, thresholds = contacts.evaluation, contacts.thresholds.torques
    rows = len(evaluation.joint_names) + (contacts.wrenches is not None)
    figure, axes = panels(rows, 1.2, 1.17)
    axes = axes[:, 0]
    for j, axis in enumerate(axes[: len(evaluation.joint_names)]):
        _draw(axis, contacts, contacts.torques[:, j])
        for sign in (-1, 1):
            axis.axhline(sign * thresholds[j], **LIMIT)
        unit = evaluation.units[j]
        title = f"{evaluation.joint_names[j]} [{unit}], threshold {thresholds[j]:.3g} {unit}"
        write_title(axis, title)
    if contacts.wrenches is not None:
        _draw(axes[-1], contacts, np.linalg.norm(contacts.wrenches[:, :3], axis=1))
        write_title(axes[-1], "force at the tip, if nothing else is touched [N]")
    _write_heading(figure, contacts)
    return figure


def _draw(axis: Axes, contacts: Contacts, values: Floats) -> None:
    shown = peaks(values, _MOST_POINTS)
    known = np.where(contacts.valid, values, np.nan)  # else zeros were drawn
    axis.plot(contacts.time[shown], known[shown], **ERROR)
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
        Line2D([], [], label="external torque", **ERROR),
        Line2D([], [], label="threshold", **LIMIT),
        Patch(label="contact", **_CONTACT),
    ]
    if contacts.quiet_part is not None:
        handles.append(Patch(label="part used for the thresholds", **_QUIET))
    if contacts.interruptions:
        handles.append(Patch(label="no estimate", **_UNKNOWN))
    write_legend(figure, handles, 0.012, 0.66)

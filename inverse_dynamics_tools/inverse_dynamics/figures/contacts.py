# SPDX-License-Identifier: Apache-2.0
"""Figure of external torques, their thresholds and the contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.figures.plots import save_figure
from inverse_dynamics.figures.thinning import peaks

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.contacts import Contacts

_MOST_POINTS = 6000
_LINE, _THRESHOLD, _CONTACT = "#2c5f9e", "black", "#E69F00"
_MUTED = "#555555"


def save_contact_figure(contacts: Contacts, *files: Path) -> None:
    """Save contact_figure(); formats are those of the suffixes. The same contacts, the same bytes."""
    save_figure(lambda: contact_figure(contacts), *files)


def contact_figure(contacts: Contacts) -> Figure:
    """External torques over time, a joint a row, and the force at the tip; contacts are shaded."""
    from matplotlib.figure import Figure

    names, units = contacts.evaluation.joint_names, contacts.evaluation.units
    force = contacts.wrenches is not None
    rows = len(names) + force
    figure = Figure(figsize=(11.0, 1.15 * rows + 1.2), layout="constrained")
    axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    for j, axis in enumerate(axes[: len(names)]):
        _draw(axis, contacts, contacts.torques[:, j])
        for sign in (-1, 1):
            level = sign * contacts.thresholds.torques[j]
            axis.axhline(level, color=_THRESHOLD, linestyle=(0, (3.0, 1.6)), linewidth=0.8)
        axis.set_ylabel(f"{names[j]}\n[{units[j]}]", color=_MUTED)
    if contacts.wrenches is not None:
        _draw(axes[-1], contacts, np.linalg.norm(contacts.wrenches[:, :3], axis=1))
        axes[-1].set_ylabel("force at tip\n[N]", color=_MUTED)
    axes[-1].set_xlabel("time [s]", color=_MUTED)
    figure.suptitle(
        f"External torques (blue), thresholds of {contacts.thresholds.false_alarms_per_hour:g} false "
        "alarms per hour (dashed), contacts (shaded)"
    )
    return figure


def _draw(axis: Axes, contacts: Contacts, values: Floats) -> None:
    shown = peaks(values, _MOST_POINTS)
    axis.plot(contacts.time[shown], values[shown], color=_LINE, linewidth=0.8)
    for contact in contacts.contacts:
        axis.axvspan(contact.begin, contact.end, color=_CONTACT, alpha=0.3, linewidth=0)

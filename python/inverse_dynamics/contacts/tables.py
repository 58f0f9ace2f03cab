# SPDX-License-Identifier: Apache-2.0
"""Contacts and their thresholds as tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from inverse_dynamics.show.tables import ReportTable, of_joints
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from inverse_dynamics.contacts.contacts import Contact, Contacts


def contact_table(contacts: Contacts) -> ReportTable:
    """One row per contact."""
    has_force = contacts.wrenches is not None
    interrupted = any(c.unknown for c in contacts.contacts)
    force = ("mean force [N]", "peak force [N]", "direction", "unseen directions") * has_force
    rows: list[tuple[str | float, ...]] = [
        (
            f"{c.begin:.2f} to {c.end:.2f}",
            *(f"{c.unknown:.2f}",) * interrupted,
            c.joint,
            c.torque,
            c.unit,
            *(_force(c) if has_force else ()),
        )
        for c in contacts.contacts
    ]
    title = counted(len(rows), "contact") if rows else "No contacts"
    note = (
        "Torque: the greatest of the joint. Force: at the tip, if nothing else is touched; its direction in "
        "the axes of the root."
    )
    headings = ("time [s]", *("unknown [s]",) * interrupted, "joint", "torque", "unit", *force)
    return ReportTable(title, headings, rows, note if has_force and rows else "")


def _force(contact: Contact) -> tuple[str | float, ...]:
    mean, greatest = contact.force or math.nan, contact.greatest_force or math.nan
    direction = "  ".join(f"{x:+.1f}" for x in contact.force_direction or ())
    return mean, greatest, direction, str(contact.unseen)


def threshold_table(contacts: Contacts) -> ReportTable:
    """External torques that are a contact."""
    evaluation, found = contacts.evaluation, contacts.thresholds
    columns = {"noise": found.noise, "threshold": found.torques, "peaks": found.peaks.astype(int)}
    rate = found.false_alarms_per_hour
    note = f"thresholds for {rate:g} false alarm{'' if rate == 1 else 's'} per hour"
    title = "Thresholds of each joint"
    return of_joints(title, evaluation.joint_names, evaluation.units, columns, note)

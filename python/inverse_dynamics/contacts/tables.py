# SPDX-License-Identifier: Apache-2.0
"""Contacts and their thresholds as numbers, lines and tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from inverse_dynamics.evaluation.tables import heading
from inverse_dynamics.outputs.plain import objects_of_joints
from inverse_dynamics.show.tables import ReportTable, of_joints
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from inverse_dynamics.contacts.contacts import Contact, Contacts
    from inverse_dynamics.show.result import Line


def contact_numbers(contacts: Contacts) -> dict[str, Any]:
    """Contacts, thresholds and how they came about, for JSON."""
    evaluation, thresholds = contacts.evaluation, contacts.thresholds
    names = ("torques", "noise", "correlation_time", "peaks", "level", "scale", "shape")
    columns = {name: getattr(thresholds, name) for name in names}
    return {
        "schema": 1,
        "bag": evaluation.bag,
        "topic": evaluation.log.topic,
        "robot": evaluation.robot.name,
        "plugin": evaluation.robot.plugin,
        "estimator": contacts.estimator,
        "gain": contacts.gain,
        "tracking": contacts.tracking,
        "measured_velocities": contacts.measured_velocities,
        "friction_band": contacts.friction_band,
        "effort": evaluation.effort.meaning,
        "quiet": contacts.quiet,
        "false_alarms_per_hour": thresholds.false_alarms_per_hour,
        "joints": objects_of_joints(evaluation.joint_names, evaluation.units, columns),
        "contacts": contacts.contacts,
        "interruptions": contacts.interruptions,
        "blind": contacts.blind,
        "notes": contacts.notes,
    }


def contact_lines(contacts: Contacts) -> list[Line]:
    """What the screen shows."""
    none = "none"
    if contacts.blind:
        none += f", but {listed([*contacts.blind])} can't tell: thresholds exceed effort limits"
    return [
        *heading(contacts.evaluation),
        ("effort means", contacts.evaluation.effort.summary),
        ("estimator", f"{contacts.estimator}, {contacts.gain:.3g} 1/s"),
        ("quiet", contacts.quiet),
        ("note", contacts.notes),
        threshold_table(contacts),
        contact_table(contacts) if contacts.contacts else ("contacts", none),
    ]


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

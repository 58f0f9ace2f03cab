# SPDX-License-Identifier: Apache-2.0
"""What touched a robot, and what it carried, as pages: external torques, and torques with and without the load."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.wording import counted
from inverse_dynamics.evaluation.evaluation import joint_errors
from inverse_dynamics.report.evaluations import report_run
from inverse_dynamics.report.page import Band, ReportSummary, ReportTable, number, render_page

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.contacts import Contact, Contacts
    from inverse_dynamics.identification.payload import Payload


def render_contacts(contacts: Contacts) -> str:
    """The page as text: external torques between their thresholds."""
    evaluation, thresholds, time = contacts.evaluation, contacts.thresholds, contacts.time

    def then(values: Floats) -> Floats:
        columns = [np.interp(time, evaluation.time, column) for column in values.T]
        return np.stack(columns, axis=1)

    run = replace(
        report_run(evaluation, "External torques"),
        time=time,
        q=then(evaluation.log.q),
        measured=then(evaluation.measured),
        computed=then(evaluation.computed),
        error=contacts.torques,
        error_name="external torque",
        bands=[Band(float(time[0]), float(time[-1]), thresholds.torques)],
        band_name="threshold",
        contacts=[(contact.begin, contact.end) for contact in contacts.contacts],
        left_out=contacts.interruptions,
        tables=(),
        notes=(),
        cause="",
    )
    rate = thresholds.false_alarms_per_hour
    facts = [
        ("estimator", f"{contacts.estimator}, {contacts.gain:.3g} 1/s"),
        ("without contact", contacts.quiet),
        ("thresholds for", f"{rate:g} false alarm{'' if rate == 1 else 's'} per hour"),
        ("effort means", evaluation.effort.summary),
    ]
    notes = list(contacts.notes)
    more = [_thresholds(contacts)]
    found = ReportSummary(_contacts(contacts), "How contacts were found", facts, notes, more)
    title = f"{evaluation.robot.description or evaluation.robot.name}: what touched it"
    return render_page(title, [run], summary=found)


def _contacts(contacts: Contacts) -> ReportTable:
    """One row per contact."""
    has_force = contacts.wrenches is not None
    force = ("mean force [N]", "peak force [N]", "direction", "unseen directions") * has_force
    rows = [
        (
            f"{c.begin:.2f} to {c.end:.2f}",
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
    headings = ("time [s]", "joint", "torque", "unit", *force)
    return ReportTable(title, headings, rows, note if has_force and rows else "")


def _force(contact: Contact) -> tuple[str | float, ...]:
    mean, greatest = contact.force or math.nan, contact.greatest_force or math.nan
    direction = "  ".join(f"{x:+.1f}" for x in contact.force_direction or ())
    return mean, greatest, direction, str(contact.unseen)


def _thresholds(contacts: Contacts) -> ReportTable:
    evaluation, thresholds = contacts.evaluation, contacts.thresholds
    columns = (thresholds.noise, thresholds.torques, thresholds.peaks)
    rows = zip(
        evaluation.joint_names, *(c.tolist() for c in columns), evaluation.units, strict=True
    )
    headings = ("joint", "noise", "threshold", "peaks", "unit of torques")
    return ReportTable("Thresholds of each joint", headings, list(rows))


def render_payload(payload: Payload) -> str:
    """The page as text: torques with the load, and without it to choose."""
    evaluation, samples = payload.evaluation, payload.evaluation.samples
    measured = evaluation.measured[samples.kept]
    names, units = evaluation.joint_names, evaluation.units
    computed = measured - payload.after
    run = replace(
        report_run(evaluation, "Torques with the load"),
        time=payload.time,
        q=evaluation.log.q[samples.kept],
        measured=measured,
        computed=computed,
        name="with load and offsets",
        others={"without load": measured - payload.before},
        others_shown=True,
        table=joint_errors(names, units, computed, measured),
        tables=(),
        left_out=(),
        notes=(),
        cause="",
    )
    rows = zip(
        names,
        payload.rmse_before.tolist(),
        payload.rmse_after.tolist(),
        payload.estimate.offset.tolist(),
        units,
        strict=True,
    )
    headings = ("joint", "RMSE without load", "RMSE with load", "offset", "unit")
    errors = ReportTable("Errors without and with the load", headings, list(rows))
    duration = f"{payload.estimate.duration:.1f} s, {len(payload.time):,} samples"
    facts = [
        ("frame", payload.frame),
        ("recording", f"{evaluation.bag.name}, {duration}"),
        ("without load", "no recording" if payload.empty is None else payload.empty.name),
        ("effort means", evaluation.effort.summary),
    ]
    found = ReportSummary(_load(payload), "How it was found", facts, payload.notes, [errors])
    title = f"{evaluation.robot.description or evaluation.robot.name}: what it carries"
    return render_page(title, [run], summary=found)


def _load(payload: Payload) -> ReportTable:
    """Mass, center of mass, inertia."""
    found, center, half = (
        payload.estimate,
        payload.center_of_mass,
        payload.center_of_mass_half_width,
    )
    rows = [("mass", found.mass, found.mass_half_width, "kg")]
    rows += [
        (f"center of mass, {axis}", 1e3 * center[i], 1e3 * half[i], "mm")
        for i, axis in enumerate("xyz")
    ]
    if found.inertia_is_known:
        rows += [
            (f"inertia {a}{b}", found.inertia[i, j], found.inertia_half_width[i, j], "kg m²")
            for i, a in enumerate("xyz")
            for j, b in enumerate("xyz")
            if j >= i
        ]
    return ReportTable(
        f"Load: {number(found.mass)} kg",
        ("number", "value", "± (95 %)", "unit"),
        rows,
        note=f"In addition to what the robot carries already; in the frame of {payload.frame}.",
    )

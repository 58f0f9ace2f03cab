# SPDX-License-Identifier: Apache-2.0
"""What touched a robot, and what it carried, as pages: external torques, and torques with and without the load."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.evaluation import joint_errors
from inverse_dynamics.report.evaluations import report_run
from inverse_dynamics.report.page import Band, ReportSummary, render_page
from inverse_dynamics.report.tables import (
    contact_table,
    payload_table,
    residual_table,
    threshold_table,
)

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.contacts import Contacts
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
    facts = [
        ("estimator", f"{contacts.estimator}, {contacts.gain:.3g} 1/s"),
        ("without contact", contacts.quiet),
        ("effort means", evaluation.effort.summary),
    ]
    notes = list(contacts.notes)
    more = [threshold_table(contacts)]
    found = ReportSummary(contact_table(contacts), "How contacts were found", facts, notes, more)
    title = f"{evaluation.robot.description or evaluation.robot.name}: what touched it"
    return render_page(title, [run], summary=found)


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
    duration = f"{payload.estimate.duration:.1f} s, {len(payload.time):,} samples"
    facts = [
        ("frame", payload.frame),
        ("recording", f"{evaluation.bag.name}, {duration}"),
        ("without load", "no recording" if payload.empty is None else payload.empty.name),
        ("effort means", evaluation.effort.summary),
    ]
    found = ReportSummary(
        payload_table(payload), "How it was found", facts, payload.notes, [residual_table(payload)]
    )
    title = f"{evaluation.robot.description or evaluation.robot.name}: what it carries"
    return render_page(title, [run], summary=found)

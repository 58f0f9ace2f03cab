# SPDX-License-Identifier: Apache-2.0
"""What touched a robot, as a page: external torques between their thresholds."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.contacts.tables import contact_table, threshold_table
from inverse_dynamics.evaluation.page import report_run
from inverse_dynamics.show.page import Band, ReportSummary, render_page

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.contacts.contacts import Contacts


def contact_page(contacts: Contacts) -> str:
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
        judged=False,
    )
    facts = [
        ("estimator", f"{contacts.estimator}, {contacts.gain:.3g} 1/s"),
        ("without contact", contacts.quiet),
        ("effort means", evaluation.effort.summary),
    ]
    found = ReportSummary(
        contact_table(contacts),
        "How contacts were found",
        facts,
        contacts.notes,
        below=[threshold_table(contacts)],
    )
    title = f"{evaluation.robot.description or evaluation.robot.name}: what touched it"
    return render_page(title, [run], summary=found)

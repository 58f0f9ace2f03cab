# SPDX-License-Identifier: Apache-2.0
"""What a robot carried, as a page: torques with the load, and without it to choose."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from inverse_dynamics._core import joint_errors
from inverse_dynamics.evaluation.page import report_run
from inverse_dynamics.payload.tables import payload_table, residual_table
from inverse_dynamics.show.page import ReportSummary, render_page

if TYPE_CHECKING:
    from inverse_dynamics.payload.payload import Payload


def payload_page(payload: Payload) -> str:
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
        payload_table(payload),
        "How it was found",
        facts,
        payload.notes,
        below=[residual_table(payload)],
    )
    title = f"{evaluation.robot.description or evaluation.robot.name}: what it carries"
    return render_page(title, [run], summary=found)

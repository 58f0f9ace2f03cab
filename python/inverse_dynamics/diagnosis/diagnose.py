# SPDX-License-Identifier: Apache-2.0
"""Explains an evaluation: likely causes of its errors, for whoever shows them.

for cause in diagnose(evaluate_run(open_run("recording", "ur10_real"))).diagnosis:
    print(cause.text)
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from inverse_dynamics.arguments import checked
from inverse_dynamics.diagnosis.arm import arm_model
from inverse_dynamics.diagnosis.compare import compare, meaning_of_efforts
from inverse_dynamics.diagnosis.pieces import pieces_of
from inverse_dynamics.evaluation.evaluation import CAUSE

if TYPE_CHECKING:
    from inverse_dynamics._core import Verdict
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.diagnosis.pieces import Pieces
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.evaluation.run import Run


@checked
def diagnose(evaluation: Evaluation) -> Evaluation:
    """The same with the likely causes of its errors, the last of its notes; efforts are doubted with them.

    Of a motion in which joints beside the chain move, which the model holds at one position, no cause is stated.
    """
    run = evaluation.run
    if run is None or run.posture_changes:
        return replace(evaluation, causes=())
    without_gravity = evaluation.effort.meaning == "torque_without_gravity"
    found = compare(
        _pieces(run, evaluation.measured), arm_model(run.arm, without_gravity=without_gravity)
    )
    notes = evaluation.notes
    if found.text:
        note = f"{CAUSE}{found.text}" if found.causes else found.text
        notes = (*(other for other in notes if found.text not in other), note)
    effort = found.doubting(evaluation.effort)
    return replace(evaluation, effort=effort, causes=found.causes, notes=notes)


def verdict_of(run: Run, recorded: Floats) -> Verdict:
    """What the data say recorded efforts (N, n) mean."""
    gains = run.options.effort.drive_gains
    return meaning_of_efforts(_pieces(run, recorded), arm_model(run.arm), gains)


def _pieces(run: Run, efforts: Floats) -> Pieces | None:
    states = (run.log.q, run.log.qd, run.qdd)
    return pieces_of(run.arm.joint_names, run.time, states, efforts, run.samples.kept)

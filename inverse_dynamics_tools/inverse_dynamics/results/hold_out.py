# SPDX-License-Identifier: Apache-2.0
"""Errors of an identified model on a recording that nothing was fitted to or chosen on.

test = hold_out(found, Path("wednesday"))
print(test.rmse["identified"])
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.evaluation.evaluation import evaluate
from inverse_dynamics.identification.baselines import RefittedFriction, solver_of
from inverse_dynamics.identification.result import IdentificationError
from inverse_dynamics.results.model_files import model_file_text
from inverse_dynamics.robot.robots import RIGID_BODY, with_changes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.result import Identification


@dataclass(frozen=True)
class HoldOut:
    """Errors on a recording, over the valid samples: RMSE (n,) by name of COLUMNS, and coverage (n,)."""

    recording: Path
    rmse: Mapping[str, Floats]
    coverage: Floats  # share of the samples within the model's 95 % band
    notes: tuple[str, ...]  # of its evaluation with the identified model


def hold_out(
    found: Identification,
    recording: Path | str,
    *,
    progress: Progress = no_progress,
    **options: Any,
) -> HoldOut:
    """Evaluate the identified model, the description, and the present model if there is one.

    With its friction refitted, too: to the blocks that the identified model was fitted to.

    options: those of evaluate(). Raises UserError.
    """
    recording = Path(recording)
    if recording.resolve() in [path.resolve() for path in found.recordings]:
        raise IdentificationError(
            f"--hold-out {recording}: expected a recording that nothing was fitted to, got one of those "
            "that were; give another"
        )
    robot, gains = found.robot, found.model.drive_gains
    if gains is not None:
        robot = replace(robot, drive_gains=tuple(gains.tolist()))
    described = replace(robot, plugin=RIGID_BODY, model=None, friction=False, parameters={})
    robots = {"urdf": with_changes(described)}
    if "present" in found.held_out:
        robots["present"] = robot
    with tempfile.TemporaryDirectory() as directory:
        model = Path(directory) / "model.yaml"
        model.write_text(model_file_text(found, "identified"), encoding="utf-8")
        robots["identified"] = replace(
            robot, plugin=RIGID_BODY, model=model, friction=True, parameters={}
        )
        results = {
            column: evaluate(recording, robot, progress=progress, **options)
            for column, robot in robots.items()
        }
    errors = {column: _errors(result) for column, result in results.items()}
    if "present" in results:
        errors["present_refitted"] = _refitted_errors(found, results["present"])
    return HoldOut(
        recording=recording,
        rmse={column: np.sqrt((error**2).mean(axis=0)) for column, error in errors.items()},
        coverage=(np.abs(errors["identified"]) <= found.model.torque_deviation).mean(axis=0),
        notes=results["identified"].notes,
    )


def _errors(result: Evaluation) -> Floats:
    """(M, n) of the valid samples."""
    kept = result.samples.kept
    return np.asarray((result.computed - result.measured)[kept])


def _refitted_errors(found: Identification, present: Evaluation) -> Floats:
    """(M, n) of the present model with friction and offset fitted to the identification's blocks."""
    fitted = [
        (b.q[b.counts], b.qd[b.counts], b.computed["present"][b.counts], b.measured[b.counts])
        for b in found.blocks
    ]
    refitted = RefittedFriction(solver_of(present.robot), fitted)
    torques = refitted.torques(present.log.q, present.log.qd, present.computed)
    return np.asarray((torques - present.measured)[present.samples.kept])

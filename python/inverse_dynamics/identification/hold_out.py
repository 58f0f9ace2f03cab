# SPDX-License-Identifier: Apache-2.0
"""Errors of an identified model on a recording that nothing was fitted to or chosen on.

test = hold_out(found, Path("wednesday"))
print(test.rmse["identified"])
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.evaluation import evaluate, torques_with_gravity
from inverse_dynamics.evaluation.run import RunOptions
from inverse_dynamics.identification.baselines import baseline_torques, baselines
from inverse_dynamics.identification.files import model_file_text
from inverse_dynamics.identification.result import IdentificationError, urdf_of, valid_samples
from inverse_dynamics.identification.uncertainty import uncertainty_text
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.model_errors import model_errors_file
from inverse_dynamics.robots.robots import RIGID_BODY

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import Unpack

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Recorded


@dataclass(frozen=True)
class HoldOut:
    """Errors on a recording, over the valid samples: RMSE (n,) by name of COLUMNS, and coverage (n,)."""

    recording: Path
    rmse: Mapping[str, Floats]
    coverage: Floats  # share of the samples within the model's 95 % band
    notes: tuple[str, ...]  # of its evaluation with the identified model


def hold_out(
    found: Identification,
    recording: Recorded,
    *,
    progress: Progress = no_progress,
    **options: Unpack[RunOptions],
) -> HoldOut:
    """Evaluate the identified model, the description, and the present model if there is one.

    With its friction refitted, too: to the blocks that the identified model was fitted to.

    options: those of evaluate(). Raises UserError.
    """
    robot, gains = found.robot, found.model.drive_gains
    if gains is not None:
        robot = replace(robot, drive_gains=tuple(gains.tolist()))
    with tempfile.TemporaryDirectory() as directory:
        model = Path(directory) / "model.yaml"
        text = model_file_text(found, "identified")
        model.write_text(text, encoding="utf-8")
        model_errors_file(model).write_text(uncertainty_text(found, text), encoding="utf-8")
        identified = replace(robot, plugin=RIGID_BODY, model=model, friction=True, parameters={})
        result = evaluate(recording, identified, progress=progress, **options)
    if result.fitted:
        raise IdentificationError(
            f"--hold-out {result.bag}: expected a recording that nothing was fitted to, got samples of those "
            "that were; give another"
        )
    measured = torques_with_gravity(result)
    kept = result.samples.kept
    solvers = baselines(robot, read_description(urdf_of(found)))
    if "present" not in found.held_out:
        solvers.pop("present", None)
    motion = result.log.q[kept], result.log.qd[kept], result.qdd[kept]
    fitted = []
    if "present" in solvers:
        q, qd, present, own = valid_samples(found.blocks, "q", "qd", "present", "measured")
        fitted = [(q, qd, present, own)]
    computed = baseline_torques(solvers, motion, fitted)
    computed["identified"] = (measured + result.computed - result.measured)[kept]
    return HoldOut(
        recording=result.bag,
        rmse={
            column: np.sqrt(((torques - measured[kept]) ** 2).mean(0))
            for column, torques in computed.items()
        },
        coverage=np.asarray(result.coverage),
        notes=result.notes,
    )

# SPDX-License-Identifier: Apache-2.0
"""An evaluation without its samples: a few numbers per joint."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.recordings.time_window import TimeWindow

if TYPE_CHECKING:
    from inverse_dynamics._core import Accelerations, JointError
    from inverse_dynamics.evaluation.evaluation import Evaluation

EVERYTHING = TimeWindow()


@dataclass(frozen=True)
class EvaluationSummary:
    """An evaluation without its samples, and the name that its recording has among others."""

    name: str
    bag: Path
    robot: str
    plugin: str
    start: float  # s: stamp of the first sample
    duration: float  # s
    window: TimeWindow  # the requested one
    samples: int
    kept_samples: int  # those of errors_of_kept
    accelerations: Accelerations
    effort: str  # what recorded efforts mean: torque, current, torque_without_gravity
    errors: tuple[JointError, ...]
    errors_of_kept: tuple[JointError, ...]
    notes: tuple[str, ...] = ()

    @property
    def mean_rmse(self) -> float:
        """Mean over the joints of the root mean square errors."""
        return sum(error.rmse for error in self.errors) / len(self.errors)


def summary_of(
    evaluation: Evaluation, name: str, window: TimeWindow = EVERYTHING
) -> EvaluationSummary:
    """The summary of an evaluation. window: of the recording, that was evaluated."""
    samples = len(evaluation.log)
    return EvaluationSummary(
        name=name,
        bag=evaluation.bag,
        robot=evaluation.robot.name,
        plugin=evaluation.robot.plugin,
        start=float(evaluation.log.stamps[0]) * 1e-9,
        duration=evaluation.log.duration,
        window=window,
        samples=samples,
        kept_samples=samples - evaluation.samples.left_out,
        accelerations=evaluation.accelerations,
        effort=evaluation.effort.meaning,
        errors=evaluation.errors,
        errors_of_kept=evaluation.errors_of_kept,
        notes=evaluation.explained.notes,
    )

# SPDX-License-Identifier: Apache-2.0
"""Evaluations side by side: solvers or models on the same recording.

comparison = compare([read_evaluation("urdf"), read_evaluation("identified")])
comparison.rmse          # (runs, n) N m
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.comparison.figure import comparison_figure
from inverse_dynamics.comparison.page import comparison_page
from inverse_dynamics.comparison.tables import comparison_numbers, comparison_table
from inverse_dynamics.errors import UserError
from inverse_dynamics.show.result import PAGE, ResultDirectory, files_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.show.result import Line


@dataclass(frozen=True, repr=False)
class Comparison(ResultDirectory):
    """Evaluations of one recording, and their labels."""

    contents = files_of("comparison.json", "comparison", PAGE)
    numbers, plot, page = comparison_numbers, comparison_figure, comparison_page

    evaluations: tuple[Evaluation, ...]
    labels: tuple[str, ...]  # one per evaluation, all different

    def inputs(self) -> list[Path | None]:
        """The recordings and the robots' files."""
        return [path for e in self.evaluations for path in (e.bag, *e.robot.files)]

    def lines(self) -> list[Line]:
        """The table."""
        return [comparison_table(self)]

    @property
    def title(self) -> str:
        """Recording and labels."""
        return f"{self.evaluations[0].bag.name}: {' against '.join(self.labels)}"

    @property
    def rmse(self) -> Floats:
        """(runs, n) N m or N: root mean square errors over all samples."""
        return np.array([[error.rmse for error in e.errors] for e in self.evaluations])

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the first evaluation's joints; the others' correspond in order."""
        return self.evaluations[0].joint_names


def compare(evaluations: Sequence[Evaluation], labels: Sequence[str] = ()) -> Comparison:
    """Put evaluations of the same recording side by side.

    labels: what to call them; empty: by what differs (solver, robot, friction, accelerations).
    Raises UserError: fewer than two, other recordings, other meanings of their efforts, other
    numbers of labels, or labels that are the same.
    """
    if len(evaluations) < 2:
        raise UserError(f"compare: expected two evaluations or more, got {len(evaluations)}")
    first = evaluations[0]
    for other in evaluations[1:]:
        _check_same_recording(first, other)
    if labels and len(labels) != len(evaluations):
        raise UserError(f"compare: expected {len(evaluations)} labels, got {len(labels)}")
    if twice := [label for label in labels if list(labels).count(label) > 1]:
        raise UserError(f"compare: expected a label of its own for each run, got twice: {twice[0]}")
    return Comparison(tuple(evaluations), tuple(labels) or _labels(evaluations))


def _check_same_recording(first: Evaluation, other: Evaluation) -> None:
    if len(other.log) == len(first.log) and np.array_equal(other.measured, first.measured):
        return
    if np.array_equal(other.log.effort, first.log.effort):
        raise UserError(
            f"compare: {first.bag}: expected evaluations with one meaning of its efforts, got "
            f"'{first.effort.summary}' and '{other.effort.summary}', so measured torques differ; "
            "evaluate again with the same --effort-is and drive gains (`ids evaluate --effort-is "
            "auto` finds the meaning that fits)"
        )
    raise UserError(
        f"compare: expected evaluations of one recording, got {first.bag} ({len(first.log)} samples) "
        f"and {other.bag} ({len(other.log)} samples, other measured torques); evaluate the same "
        "recording with each solver"
    )


def _labels(evaluations: Sequence[Evaluation]) -> tuple[str, ...]:
    """Of each evaluation, what isn't the same in all of them."""
    facets = [_facets(evaluation) for evaluation in evaluations]
    telling = [key for key in facets[0] if len({f[key] for f in facets}) > 1]
    labels = [", ".join(f[key] for key in telling if f[key]) for f in facets]
    if len(set(labels)) < len(labels):
        labels = [f"{i + 1}: {label}".rstrip(": ") for i, label in enumerate(labels)]
    return tuple(labels)


def _facets(evaluation: Evaluation) -> dict[str, str]:
    robot = evaluation.robot
    model = robot.model or robot.urdf
    return {
        "solver": robot.plugin.partition("/")[2],
        "model": "" if model is None else model.name,
        "friction": "" if robot.friction else "without friction",
        "accelerations": evaluation.accelerations.summary,
        "effort": "" if robot.effort == "torque" else f"effort is {robot.effort}",
        "gravity": str(robot.gravity),
        "chain": f"{robot.root} to {robot.tip}",
    }

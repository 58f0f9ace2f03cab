# SPDX-License-Identifier: Apache-2.0
"""Evaluations side by side: solvers or models on the same recording.

comparison = ids.compare([read_evaluation("urdf"), read_evaluation("identified")])
comparison.rmse          # (runs, n) N m
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.arguments import checked
from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation.figure import run_color, runs_figure
from inverse_dynamics.evaluation.page import assumptions, report_run
from inverse_dynamics.evaluation.tables import FITTED
from inverse_dynamics.show.page import ReportSummary, render_page
from inverse_dynamics.show.result import PAGE, ResultDirectory, files_of
from inverse_dynamics.show.tables import ReportTable, of_joints
from inverse_dynamics.wording import solver_name

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.show.page import ReportRun
    from inverse_dynamics.show.result import Line


@dataclass(frozen=True, repr=False)
class Comparison(ResultDirectory):
    """Evaluations of one recording, and their labels."""

    contents = files_of("comparison.json", "comparison", PAGE)

    evaluations: tuple[Evaluation, ...]
    labels: tuple[str, ...]  # one per evaluation, all different

    def inputs(self) -> list[Path | None]:
        """The recordings and the robots' files."""
        return [path for e in self.evaluations for path in (e.bag, *e.robot.files)]

    def numbers(self) -> dict[str, Any]:
        """Errors of each run, for JSON."""
        first = self.evaluations[0]
        runs = [
            {
                "label": label,
                "plugin": evaluation.robot.plugin,
                "rmse": rmse,
                "fitted": evaluation.fitted,
            }
            for label, evaluation, rmse in zip(
                self.labels, self.evaluations, self.rmse, strict=True
            )
        ]
        return {
            "schema": 1,
            "bag": first.bag,
            "joints": self.joint_names,
            "units": first.units,
            "runs": runs,
        }

    def lines(self) -> list[Line]:
        """The table."""
        return [self.table()]

    def table(self) -> ReportTable:
        """Root mean square errors, one column per run."""
        headings = [
            f"{label} *" if e.fitted else label
            for label, e in zip(self.labels, self.evaluations, strict=True)
        ]
        columns = dict(zip(headings, self.rmse, strict=True))
        note = f"* {FITTED}" if any(e.fitted for e in self.evaluations) else ""
        units = self.evaluations[0].units
        return of_joints(
            "RMSE of each joint", self.joint_names, units, columns, note, means=columns
        )

    def plot(self) -> Figure:
        """Measured torque and that of each run over time, and the runs' errors, one row per joint."""
        styles = [{"color": run_color(k), "linewidth": 0.9} for k in range(len(self.labels))]
        return runs_figure(self.evaluations, self.labels, styles, (self.title,))

    def page(self) -> str:
        """The page as text: the table, then torques of all runs."""
        run = self.report_run("Torques")
        run = replace(run, tables=(), notes=(), assumptions=(), judged=False)
        notes = dict.fromkeys(note for e in self.evaluations for note in e.explained.notes)
        found = ReportSummary(self.table(), "What was assumed", self._facts(), list(notes))
        return render_page(self.title, [run], summary=found)

    def report_run(self, title: str, *, shown: bool = True) -> ReportRun:
        """The first evaluation on a page, with the torques of the others to choose; shown: they are at first."""
        first, *others = self.evaluations
        name, *labels = self.labels
        run = report_run(first, title)
        return replace(
            run,
            name=name,
            others={label: e.computed for label, e in zip(labels, others, strict=True)},
            others_shown=shown,
            tables=[self.table(), *run.tables],
            assumptions=self._facts(),
        )

    def _facts(self) -> list[tuple[str, str]]:
        """What was assumed: once what all runs have in common."""
        facts = [dict(assumptions(evaluation)) for evaluation in self.evaluations]
        rows: list[tuple[str, str]] = []
        for name in dict.fromkeys(name for of_run in facts for name in of_run):
            texts = [of_run.get(name, "none") for of_run in facts]
            runs = zip(self.labels, texts, strict=True)
            same = len(set(texts)) == 1
            rows += [(name, texts[0])] if same else [(f"{name}, {run}", text) for run, text in runs]
        return rows

    @property
    def title(self) -> str:
        """Robot, and how many runs."""
        return f"{self.evaluations[0].robot.name}: {len(self.labels)} runs compared"

    @property
    def rmse(self) -> Floats:
        """(runs, n) N m or N: root mean square errors over all samples."""
        return np.array([[error.rmse for error in e.errors] for e in self.evaluations])

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the first evaluation's joints; the others' correspond in order."""
        return self.evaluations[0].joint_names


@checked
def compare(evaluations: Sequence[Evaluation], labels: Sequence[str] = ()) -> Comparison:
    """Put evaluations of the same recording side by side.

    labels: what to call them; empty: by what differs (solver, robot, friction, accelerations).
    Raises UserError: fewer than two, other recordings, other meanings of their efforts, other
    numbers of labels, or labels that are the same.

    Examples
    --------
    >>> from inverse_dynamics import compare, evaluate
    >>> from inverse_dynamics.demo.demo import stored_recording
    >>> urdf, real = (evaluate(stored_recording("ur10_simulated"), name) for name in ("ur10_simulated", "ur10_real"))
    >>> compare([urdf, real]).rmse.shape  # runs, joints
    (2, 6)
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
        "solver": solver_name(robot.plugin),
        "model": "" if model is None else model.name,
        "friction": "" if robot.friction else "without friction",
        "accelerations": evaluation.accelerations.summary,
        "effort": "" if robot.effort == "torque" else f"effort is {robot.effort}",
        "gravity": str(robot.gravity),
        "chain": f"{robot.root} to {robot.tip}",
    }

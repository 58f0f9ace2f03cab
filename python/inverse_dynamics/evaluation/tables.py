# SPDX-License-Identifier: Apache-2.0
"""Evaluations as lines and tables."""

from __future__ import annotations

import math
from statistics import fmean
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.show.tables import IN_BAND, ReportTable, error_columns, of_joints
from inverse_dynamics.wording import solver_name

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.evaluation.many_evaluations import EvaluationSummary
    from inverse_dynamics.show.result import Line


FITTED = (
    "the model was fitted to this recording, so its errors on other recordings are larger: see the held-out errors of "
    "`ids identify`"
)
"""Note of an evaluation of what the model was fitted to."""


def heading(
    evaluation: Evaluation, samples: int | None = None, duration: float | None = None
) -> list[Line]:
    """Robot, solver and recording. samples, duration [s]: those that are used; None: all."""
    robot, log = evaluation.robot, evaluation.log
    samples = len(log) if samples is None else samples
    duration = log.duration if duration is None else duration
    source = ", ".join(filter(None, (str(evaluation.bag), log.topic)))
    return [
        ("", robot.description or robot.name),
        ("solver", f"{robot.plugin}{'' if robot.friction else ', friction left out'}"),
        ("recording", f"{source}: {samples} samples, {duration:.1f} s"),
    ]


def evaluation_table(evaluation: Evaluation) -> ReportTable:
    """Errors of each joint; where samples are invalid, those over the valid ones, too."""
    left_out, total = evaluation.samples.left_out, len(evaluation.log)
    columns, note = error_columns(evaluation.errors), ""
    if left_out:
        columns["RMSE*"] = np.array([error.rmse for error in evaluation.errors_of_kept])
        note = f"* over the {total - left_out} valid samples of {total}"
    if evaluation.coverage is not None:
        columns[IN_BAND] = 100 * evaluation.coverage
    joints = [error.joint for error in evaluation.errors]
    return of_joints("", joints, evaluation.units, columns, note, ("MAE", "RMSE", "RMSE*", IN_BAND))


def robots_table(evaluations: Mapping[str, Evaluation]) -> ReportTable:
    """Mean over the joints of the root mean square errors, one row per robot."""
    rows = []
    for title, evaluation in evaluations.items():
        units = set(evaluation.units)
        mean = evaluation.mean_rmse if len(units) == 1 else math.nan
        shares = [100 * e.nrmse for e in evaluation.errors if not math.isnan(e.nrmse)]
        share = fmean(shares) if shares else math.nan
        solver = solver_name(evaluation.robot.plugin)
        rows.append((title, solver, len(evaluation.log), mean, units.pop(), share))
    headings = ("robot", "solver", "samples", "mean RMSE", "unit", "mean NRMSE [%]")
    return ReportTable("", headings, rows)


def recordings_table(summaries: Sequence[EvaluationSummary]) -> ReportTable:
    """Root mean square errors, one row per recording, one column per joint."""
    first = summaries[0].errors
    one_unit = len({error.unit for error in first}) == 1
    units = [""] * len(first) if one_unit else [f" [{error.unit}]" for error in first]
    columns = [error.joint + unit for error, unit in zip(first, units, strict=True)]
    means = one_unit and len(first) > 1
    marks = [" *" * (FITTED in summary.notes) for summary in summaries]
    rows: list[tuple[str | float, ...]] = [
        (
            f"{summary.name}{mark}",
            *(error.rmse for error in summary.errors),
            *[summary.mean_rmse] * means,
        )
        for summary, mark in zip(summaries, marks, strict=True)
    ]
    title = f"RMSE [{first[0].unit}]" if one_unit else "RMSE"
    note = f"* {FITTED}" * any(marks)
    return ReportTable(title, ("recording", *columns, *["mean"] * means), rows, note)

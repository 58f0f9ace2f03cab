# SPDX-License-Identifier: Apache-2.0
"""Results as tables on the screen."""

from __future__ import annotations

import math
from statistics import fmean
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from inverse_dynamics.base.wording import solver_name

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.evaluation.summary import EvaluationSummary
    from inverse_dynamics.evaluation.trajectory_torques import TrajectoryTorques
    from inverse_dynamics.report.tables import ReportTable
    from inverse_dynamics.results.excitations import ExcitationResult


def _table(*values: str, text: Sequence[str] = ("joint", "unit"), title: str = "") -> Table:
    """Columns of text, whose words stay whole, then columns of numbers."""
    table = Table(
        box=box.SIMPLE_HEAD,
        title=title or None,
        title_justify="left",
        caption_justify="left",
        collapse_padding=True,
    )
    for heading in text:
        table.add_column(heading, overflow="fold")
    for heading in values:
        table.add_column(heading, justify="right", overflow="fold")
    return table


def on_screen(table: ReportTable) -> Table:
    """A table that pages show too."""
    columns = list(zip(*table.rows, strict=True))
    shown = _table(text=(), title=table.title)
    for heading, column in zip(table.headings, columns, strict=True):
        texts = isinstance(column[0], str)
        shown.add_column(heading, justify="left" if texts else "right", overflow="fold")
    for row in table.rows:
        if table.total and row is table.rows[-1]:
            shown.add_section()
        shown.add_row(
            *(rounded(value) if isinstance(value, float) else f"{value}" for value in row)
        )
    shown.caption = table.note or None
    return shown


def _have_one_unit(units: Sequence[str]) -> bool:
    """Whether the mean over the joints is defined."""
    return len(set(units)) == 1 and len(units) > 1


def error_table(evaluation: Evaluation) -> Table:
    """Errors of the computed torques, one row per joint.

    Where samples are invalid, a column has the errors over the valid ones.
    """
    left_out, total = evaluation.samples.left_out, len(evaluation.log)
    errors, kept = evaluation.errors, evaluation.errors_of_kept
    last = ["RMSE*"] if left_out else []
    within = [] if evaluation.coverage is None else evaluation.coverage.tolist()
    last += ["in\n95 %\nband"] if within else []
    table = _table("MAE", "RMSE", "NRMSE", "bias", "R²", *last)
    if left_out:
        table.caption = f"* over the {total - left_out} valid samples of {total}"
    for j, (error, of_kept) in enumerate(zip(errors, kept, strict=True)):
        of_valid = [rounded(of_kept.rmse)] if left_out else []
        table.add_row(
            error.joint,
            error.unit,
            rounded(error.mae),
            rounded(error.rmse),
            _percent(error.nrmse),
            f"{error.bias:+.3g}" if abs(error.bias) < 0.1 else f"{error.bias:+.3f}",
            _number(error.r2),
            *of_valid,
            *(f"{100 * share:.1f} %" for share in within[j : j + 1]),
        )
    if _have_one_unit(evaluation.units):
        mae, rmse = fmean(e.mae for e in errors), evaluation.mean_rmse
        means = [rounded(mae), rounded(rmse), "", "", ""]
        means += [rounded(fmean(e.rmse for e in kept))] if left_out else []
        means += [f"{100 * fmean(within):.1f} %"] if within else []
        table.add_section()
        table.add_row(
            "mean",
            evaluation.units[0],
            *means,
        )
    return table


def mean_table(evaluations: Mapping[str, Evaluation]) -> Table:
    """Mean over the joints of the root mean square errors, one row per robot."""
    table = _table("samples", "mean RMSE", "mean NRMSE", text=("robot", "solver"))
    for title, evaluation in evaluations.items():
        units = set(evaluation.units)
        mean = f"{rounded(evaluation.mean_rmse)} {units.pop()}" if len(units) == 1 else "-"
        shares = [e.nrmse for e in evaluation.errors if not math.isnan(e.nrmse)]
        share = _percent(fmean(shares)) if shares else "-"
        solver = solver_name(evaluation.robot.plugin)
        table.add_row(title, solver, str(len(evaluation.log)), mean, share)
    return table


def recordings_table(summaries: Sequence[EvaluationSummary]) -> Table:
    """Root mean square errors, one row per recording, one column per joint."""
    first = summaries[0].errors
    # A name in lines, so that columns are narrow.
    columns = [f"{error.joint}_{error.unit}".replace("_", "\n") for error in first]
    one_unit = _have_one_unit([error.unit for error in first])
    if one_unit:
        columns.append(f"mean\n{first[0].unit}")
    table = _table(*columns, text=("recording",), title="RMSE")
    for summary in summaries:
        mean = [rounded(summary.mean_rmse)] if one_unit else []
        table.add_row(summary.name, *(rounded(error.rmse) for error in summary.errors), *mean)
    return table


def load_table(result: TrajectoryTorques) -> Table:
    """Greatest torque of each joint and, where it exceeds the limit, when it first does."""
    several = len(result.times) > 1
    table = _table("peak", "at", "limit", text=("joint",))
    table.add_column("passes its limit")
    for load in result.loads:
        limited = math.isfinite(load.limit)
        passed = "-" if limited else "not known"
        if load.passed_time is not None:
            passed = "first at " + _moment(load.passed_time, load.passed_trajectory, several)
        table.add_row(
            load.joint,
            f"{load.peak:.3f} {load.unit}",
            _moment(load.peak_time, load.peak_trajectory, several),
            f"{load.limit:g} {load.unit}" if limited else "-",
            passed,
        )
    return table


_AFTER = {"description": "before", "given": "given", "stored": "stored", "motion": "after"}


def excitation_table(result: ExcitationResult) -> Table:
    """Motion of each joint, and uncertainty of its predicted torque before and after."""
    after = [_AFTER[name] for name in result.deviation]
    columns = ("from", "to", "speed", "acc.", "torque", *after)
    table = _table(*columns, text=("joint",))
    table.add_column("unit")
    for column in table.columns[1:]:
        column.no_wrap = True
    for j, (joint, unit) in enumerate(zip(result.joint_names, result.units, strict=True)):
        table.add_row(
            joint,
            *(f"{position:.2f}" for position in result.travel[j]),
            *(f"{100 * share:.0f} %" for share in result.greatest[:, j]),
            *(rounded(float(values[j])) for values in result.deviation.values()),
            unit,
        )
    table.caption = (
        "speed, acceleration (acc.), torque: greatest values as shares of their limits; then the standard "
        "deviation of predicted torques, mean over random states within the limits: before any recording"
        + (", after the given recordings" if "given" in result.deviation else "")
        + (", after the stored motion for the same time" if "stored" in result.deviation else "")
        + ", after this motion"
    )
    return table


def _moment(time: float, trajectory: int | None, several: bool) -> str:
    return f"{time:.3f} s" + (f" of trajectory {trajectory}" if several else "")


def rounded(value: float) -> str:
    """Three decimals, or three significant digits where that says nothing."""
    if not math.isfinite(value):
        return "-"
    return f"{value:.3f}" if abs(value) >= 0.1 or value == 0 else f"{value:.3g}"


def _percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{100 * share:.2f} %"


def _number(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:.4f}" if abs(value) < 1000 else f"{value:.3g}"

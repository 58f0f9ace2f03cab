# SPDX-License-Identifier: Apache-2.0
"""Results as tables on the screen."""

from __future__ import annotations

import math
from statistics import fmean
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from inverse_dynamics.base.wording import solver_name
from inverse_dynamics.identification.summary import headings

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.evaluation.comparison import Comparison
    from inverse_dynamics.evaluation.contacts import Contacts
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.evaluation.retiming import Retimed
    from inverse_dynamics.evaluation.summary import EvaluationSummary
    from inverse_dynamics.evaluation.trajectory_torques import TrajectoryTorques
    from inverse_dynamics.identification.payload import Payload
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.identification.summary import HeldOutRow
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


def identification_table(found: Identification, rows: Sequence[HeldOutRow], title: str) -> Table:
    """Errors of held-out data, one row per joint, one column per model."""
    columns = (heading.replace(" ", "\n") for heading in headings(found))
    table = _table(*columns, "in\n95 %\nband", title=title)
    for row in rows:
        if row.joint == "mean":
            table.add_section()
        values = ("-" if math.isnan(value) else rounded(value) for value in row.rmse)
        table.add_row(row.joint, row.unit, *values, f"{100 * row.coverage:.1f} %")
    return table


def threshold_table(contacts: Contacts) -> Table:
    """External torques that are a contact, one row per joint."""
    thresholds, evaluation = contacts.thresholds, contacts.evaluation
    table = _table("noise", "threshold", "peaks")
    for j, (joint, unit) in enumerate(zip(evaluation.joint_names, evaluation.units, strict=True)):
        noise, threshold = float(thresholds.noise[j]), float(thresholds.torques[j])
        table.add_row(joint, unit, rounded(noise), rounded(threshold), f"{thresholds.peaks[j]:.0f}")
    rate = thresholds.false_alarms_per_hour
    table.caption = f"thresholds for {rate:g} false alarm{'' if rate == 1 else 's'} per hour"
    return table


def contact_table(contacts: Contacts) -> Table:
    """One row per contact."""
    force = contacts.wrenches is not None
    columns = ["torque", *(["force [N]\nmean, peak", "direction"] if force else [])]
    table = _table(*columns, text=("contact [s]", "joint"))
    if force:
        table.columns[-1].no_wrap = True
        table.caption = (
            "force: on the assumption that only the tip is touched; direction of its mean in the axes of "
            "the root; * some directions can't be observed there"
        )
    for contact in contacts.contacts:
        row = [
            f"{contact.begin:.2f} to {contact.end:.2f}"
            + (f"\nunknown: {contact.unknown:.2f} s" if contact.unknown else ""),
            contact.joint,
            f"{contact.torque:+.3g} {contact.unit}",
        ]
        mean, greatest = contact.force, contact.greatest_force
        if mean is not None and greatest is not None and contact.force_direction is not None:
            x, y, z = (round(part, 1) + 0.0 for part in contact.force_direction)  # no -0.0
            row += [
                f"{mean:.3g}{'*' if contact.unseen else ''}, {greatest:.3g}",
                f"{x:+.1f} {y:+.1f} {z:+.1f}",
            ]
        table.add_row(*row)
    return table


def payload_table(payload: Payload) -> Table:
    """The load with its intervals, one number per row."""
    found = payload.estimate
    name = f"load, in the frame of {payload.frame}"
    table = _table("estimate", "95 % interval", text=(name, "unit"))

    def add(name: str, unit: str, value: float, half: float) -> None:
        interval = f"+- {half:.2g}" if math.isfinite(half) else "any"
        table.add_row(name, unit, f"{value:.4g}", interval)

    add("mass", "kg", found.mass, found.mass_half_width)
    for i, axis in enumerate("xyz"):
        center, half = payload.center_of_mass[i], payload.center_of_mass_half_width[i]
        add(f"center of mass, {axis}", "mm", 1e3 * center, 1e3 * half)
    if found.inertia_is_known:
        for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            name = f"inertia {'xyz'[i]}{'xyz'[j]}"
            add(name, "kg m²", found.inertia[i, j], found.inertia_half_width[i, j])
    return table


def residual_table(payload: Payload) -> Table:
    """Measured minus computed torques without and with the load, one joint per row."""
    table = _table("RMSE without load", "RMSE with load", "offset")
    for j, name in enumerate(payload.joint_names):
        before, after = rounded(payload.rmse_before[j]), rounded(payload.rmse_after[j])
        offset = f"{payload.estimate.offset[j]:+.3f}"
        table.add_row(name, payload.evaluation.units[j], before, after, offset)
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


def comparison_table(comparison: Comparison) -> Table:
    """Root mean square errors, one column per run."""
    table = _table(*comparison.labels, title="RMSE")
    units = comparison.evaluations[0].units
    for joint, unit, row in zip(comparison.joint_names, units, comparison.rmse.T, strict=True):
        table.add_row(joint, unit, *map(rounded, row))
    if _have_one_unit(units):
        table.add_section()
        table.add_row("mean", units[0], *map(rounded, comparison.rmse.mean(axis=1)))
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


def retime_table(result: Retimed) -> Table:
    """Of each joint: its greatest torque and velocity, and how long it is at its torque limit."""
    table = _table("peak", "limit", "at limit", "velocity", text=("joint",))
    for j, joint in enumerate(result.joint_names):
        unit, speed = result.units[j], "rad/s" if result.units[j] == "N m" else "m/s"
        table.add_row(
            joint,
            f"{max(result.efforts[:, j], key=abs):.3f} {unit}",
            f"{result.limits.torque[j]:g} {unit}",
            f"{100 * result.at_limit[j]:.0f} %",
            f"{abs(result.qd[:, j]).max():.2f} {speed}",
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
    return f"{value:.3f}" if abs(value) >= 0.1 or value == 0 else f"{value:.3g}"


def _percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{100 * share:.2f} %"


def _number(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:.4f}" if abs(value) < 1000 else f"{value:.3g}"

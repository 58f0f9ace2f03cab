# SPDX-License-Identifier: Apache-2.0
"""Results as tables on the screen."""

from __future__ import annotations

import math
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
    from inverse_dynamics.evaluation.summary import EvaluationSummary
    from inverse_dynamics.evaluation.trajectory_torques import TrajectoryTorques
    from inverse_dynamics.identification.payload import Payload
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.identification.summary import HeldOutRow
    from inverse_dynamics.results.excitations import ExcitationResult


def error_table(evaluation: Evaluation) -> Table:
    """Errors of the computed torques, one row per joint.

    Where samples are invalid, a column has the errors over the valid ones.
    """
    left_out = evaluation.samples.left_out
    count = len(evaluation.log)
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", collapse_padding=True)
    table.add_column("joint", overflow="fold")  # names whole
    table.add_column("unit")
    for heading in ("MAE", "RMSE", "NRMSE", "bias", "R²"):
        table.add_column(heading, justify="right")
    if left_out:
        table.add_column("RMSE*", justify="right")
        table.caption = f"* over the {count - left_out} valid samples of {count}"
    for error, kept in zip(evaluation.errors, evaluation.errors_of_kept, strict=True):
        table.add_row(
            error.joint,
            error.unit,
            figure(error.mae),
            figure(error.rmse),
            _percent(error.nrmse),
            f"{error.bias:+.3g}" if abs(error.bias) < 0.1 else f"{error.bias:+.3f}",
            _number(error.r2),
            *([figure(kept.rmse)] if left_out else []),
        )
    if len(set(evaluation.units)) == 1 and len(evaluation.errors) > 1:
        table.add_section()
        table.add_row(
            "mean",
            evaluation.units[0],
            figure(_mean([e.mae for e in evaluation.errors])),
            figure(evaluation.mean_rmse),
            "",
            "",
            "",
            *([figure(_mean([e.rmse for e in evaluation.errors_of_kept]))] if left_out else []),
        )
    return table


def identification_table(found: Identification, rows: Sequence[HeldOutRow], title: str) -> Table:
    """Errors of held-out data, one row per joint, one column per model."""
    table = Table(
        box=box.SIMPLE_HEAD,
        title=title,
        title_justify="left",
        collapse_padding=True,
    )
    table.add_column("joint", overflow="fold")
    table.add_column("unit")
    for heading in (*headings(found), "in 95 % band"):
        table.add_column(heading.replace(" ", "\n").replace("95\n%", "95 %"), justify="right")
    for row in rows:
        if row.joint == "mean":
            table.add_section()
        figures = ("-" if math.isnan(value) else figure(value) for value in row.rmse)
        table.add_row(row.joint, row.unit, *figures, f"{100 * row.coverage:.1f} %")
    return table


def threshold_table(contacts: Contacts) -> Table:
    """External torques that are a contact, one row per joint."""
    thresholds, evaluation = contacts.thresholds, contacts.evaluation
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", collapse_padding=True)
    table.add_column("joint", overflow="fold")
    table.add_column("unit")
    for heading in ("noise", "threshold", "peaks"):
        table.add_column(heading, justify="right")
    for j, (joint, unit) in enumerate(zip(evaluation.joint_names, evaluation.units, strict=True)):
        table.add_row(
            joint,
            unit,
            figure(float(thresholds.noise[j])),
            figure(float(thresholds.torques[j])),
            f"{thresholds.peaks[j]:.0f}",
        )
    rate = thresholds.false_alarms_per_hour
    alarms = f"{rate:g} false alarm{'' if rate == 1 else 's'} per hour"
    table.caption = f"thresholds for {alarms}"
    return table


def contact_table(contacts: Contacts) -> Table:
    """One row per contact."""
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", collapse_padding=True)
    table.add_column("contact [s]")
    table.add_column("joint", overflow="fold")
    table.add_column("torque", justify="right")
    force = contacts.wrenches is not None
    if force:
        table.add_column("force [N]\nmean, peak", justify="right")
        table.add_column("direction", justify="right", no_wrap=True)
        table.caption = (
            "force: on the assumption that only the tip is touched; direction of its mean in the axes of the root; "
            "* some directions can't be observed there"
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
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", collapse_padding=True)
    table.add_column(f"load, in the frame of {payload.frame}", overflow="fold")
    table.add_column("unit")
    table.add_column("estimate", justify="right")
    table.add_column("95 % interval", justify="right")

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
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", collapse_padding=True)
    table.add_column("joint", overflow="fold")
    table.add_column("unit")
    for heading in ("RMSE without load", "RMSE with load", "offset"):
        table.add_column(heading, justify="right")
    before, after = payload.rmse_before, payload.rmse_after
    for j, name in enumerate(payload.joint_names):
        table.add_row(
            name,
            payload.evaluation.units[j],
            figure(before[j]),
            figure(after[j]),
            f"{payload.estimate.offset[j]:+.3f}",
        )
    return table


def mean_table(evaluations: Mapping[str, Evaluation]) -> Table:
    """Mean over the joints of the root mean square errors, one row per robot."""
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("robot")
    table.add_column("solver")
    for heading in ("samples", "mean RMSE", "mean NRMSE"):
        table.add_column(heading, justify="right")
    for title, evaluation in evaluations.items():
        units = set(evaluation.units)
        mean = f"{figure(evaluation.mean_rmse)} {units.pop()}" if len(units) == 1 else "-"
        shares = [e.nrmse for e in evaluation.errors if not math.isnan(e.nrmse)]
        table.add_row(
            title,
            solver_name(evaluation.robot.plugin),
            str(len(evaluation.log)),
            mean,
            _percent(_mean(shares)) if shares else "-",
        )
    return table


def recordings_table(summaries: Sequence[EvaluationSummary]) -> Table:
    """Root mean square errors, one row per recording, one column per joint."""
    first = summaries[0].errors
    table = Table(box=box.SIMPLE_HEAD, title="RMSE", title_justify="left", collapse_padding=True)
    table.add_column("recording", overflow="fold")
    for error in first:  # a name in lines, so that columns are narrow
        name = error.joint.replace("_", "\n")
        table.add_column(f"{name}\n{error.unit}", justify="right", overflow="fold")
    one_unit = len({error.unit for error in first}) == 1 and len(first) > 1
    if one_unit:
        table.add_column(f"mean\n{first[0].unit}", justify="right")
    for summary in summaries:
        table.add_row(
            summary.name,
            *(figure(error.rmse) for error in summary.errors),
            *([figure(summary.mean_rmse)] if one_unit else []),
        )
    return table


def comparison_table(comparison: Comparison) -> Table:
    """Root mean square errors, one column per run."""
    table = Table(box=box.SIMPLE_HEAD, title="RMSE", title_justify="left")
    table.add_column("joint")
    table.add_column("unit")
    for label in comparison.labels:
        table.add_column(label, justify="right", overflow="fold")
    units = comparison.evaluations[0].units
    for joint, unit, row in zip(comparison.joint_names, units, comparison.rmse.T, strict=True):
        table.add_row(joint, unit, *(figure(value) for value in row))
    if len(set(units)) == 1 and len(units) > 1:
        table.add_section()
        means = comparison.rmse.mean(axis=1)
        table.add_row("mean", units[0], *(figure(value) for value in means))
    return table


def load_table(result: TrajectoryTorques) -> Table:
    """Greatest torque of each joint and, where it is too much, when it is first."""
    several = len(result.times) > 1
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("joint")
    for heading in ("peak", "at", "limit"):
        table.add_column(heading, justify="right")
    table.add_column("passes its limit")
    for load in result.loads:
        passed = "-" if math.isfinite(load.limit) else "not known"
        if load.passed_time is not None:
            passed = "first at " + _moment(load.passed_time, load.passed_trajectory, several)
        table.add_row(
            load.joint,
            f"{load.peak:.3f} {load.unit}",
            _moment(load.peak_time, load.peak_trajectory, several),
            f"{load.limit:g} {load.unit}" if math.isfinite(load.limit) else "-",
            passed,
        )
    return table


_AFTER = {"description": "before", "given": "given", "stored": "stored", "motion": "after"}


def excitation_table(result: ExcitationResult) -> Table:
    """How each joint moves, and how uncertain its predicted torque is before and after."""
    table = Table(box=box.SIMPLE_HEAD, caption_justify="left", collapse_padding=True)
    table.add_column("joint", overflow="fold")
    for heading in ("from", "to", "speed", "accel.", "torque"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name in result.deviation:
        table.add_column(_AFTER[name], justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for j, (joint, unit) in enumerate(zip(result.joint_names, result.units, strict=True)):
        table.add_row(
            joint,
            *(f"{position:.2f}" for position in result.travel[j]),
            *(f"{100 * share:.0f} %" for share in result.greatest[:, j]),
            *(figure(float(values[j])) for values in result.deviation.values()),
            unit,
        )
    table.caption = (
        "speed, acceleration, torque: greatest values as shares of their limits; then the standard "
        "deviation of predicted torques, mean over random states within the limits: before any recording"
        + (", after the given recordings" if "given" in result.deviation else "")
        + (", after the stored motion for the same time" if "stored" in result.deviation else "")
        + ", after this motion"
    )
    return table


def _moment(time: float, trajectory: int | None, several: bool) -> str:
    return f"{time:.3f} s" + (f" of trajectory {trajectory}" if several else "")


def figure(value: float) -> str:
    """Three decimals, or three significant digits where that says nothing."""
    return f"{value:.3f}" if abs(value) >= 0.1 or value == 0 else f"{value:.3g}"


def _mean(numbers: list[float]) -> float:
    return sum(numbers) / len(numbers)


def _percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{100 * share:.2f} %"


def _number(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:.4f}" if abs(value) < 1000 else f"{value:.3g}"

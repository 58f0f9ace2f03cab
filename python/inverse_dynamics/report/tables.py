# SPDX-License-Identifier: Apache-2.0
"""Tables of results: pages and the screen show the same ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.wording import counted, solver_name
from inverse_dynamics.identification.result import COLUMNS

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.comparison import Comparison
    from inverse_dynamics.evaluation.contacts import Contact, Contacts
    from inverse_dynamics.evaluation.evaluation import Evaluation, JointError
    from inverse_dynamics.evaluation.retiming import Retimed
    from inverse_dynamics.evaluation.summary import EvaluationSummary
    from inverse_dynamics.evaluation.trajectory_torques import TrajectoryTorques
    from inverse_dynamics.identification.payload import Payload
    from inverse_dynamics.identification.result import Identification


_IN_BAND = "in 95 % band [%]"


@dataclass(frozen=True)
class ReportTable:
    """A table: rows of texts and numbers, NaN where there is no number; total: the last row sums the others up."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str | float]]
    note: str = ""
    total: bool = False

    @property
    def cells(self) -> list[tuple[str, ...]]:
        """The rows as texts, numbers aligned in each column."""
        return list(zip(*(aligned(column) for column in zip(*self.rows, strict=True)), strict=True))


def of_joints(
    title: str,
    joints: Sequence[str],
    units: Sequence[str],
    columns: Mapping[str, Floats],
    note: str = "",
    means: Collection[str] = (),
) -> ReportTable:
    """A row per joint, of columns (n,) by heading. means: columns whose means the last row has, if units are one."""
    values = [column.tolist() for column in columns.values()]
    rows = list(zip(joints, units, *values, strict=True))
    total = bool(means) and len(set(units)) == 1 and len(units) > 1
    if total:
        last = (float(v.mean()) if name in means else math.nan for name, v in columns.items())
        rows.append(("mean", units[0], *last))
    return ReportTable(title, ("joint", "unit", *columns), rows, note, total)


def joint_table(title: str, errors: Sequence[JointError]) -> ReportTable:
    """Errors of each joint."""
    return of_joints(title, [e.joint for e in errors], [e.unit for e in errors], _errors(errors))


def _errors(errors: Sequence[JointError]) -> dict[str, Floats]:
    values = np.array([(e.mae, e.rmse, 100 * e.nrmse, e.bias, e.r2) for e in errors])
    return dict(zip(("MAE", "RMSE", "NRMSE [%]", "bias", "R²"), values.T, strict=True))


def evaluation_table(evaluation: Evaluation) -> ReportTable:
    """Errors of each joint; where samples are invalid, those over the valid ones, too."""
    left_out, total = evaluation.samples.left_out, len(evaluation.log)
    columns, note = _errors(evaluation.errors), ""
    if left_out:
        columns["RMSE*"] = np.array([error.rmse for error in evaluation.errors_of_kept])
        note = f"* over the {total - left_out} valid samples of {total}"
    if evaluation.coverage is not None:
        columns[_IN_BAND] = 100 * evaluation.coverage
    joints = [error.joint for error in evaluation.errors]
    return of_joints(
        "", joints, evaluation.units, columns, note, ("MAE", "RMSE", "RMSE*", _IN_BAND)
    )


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
    # A name in lines, so that columns are narrow.
    columns = [f"{error.joint}_{error.unit}".replace("_", "\n") for error in first]
    one_unit = len({error.unit for error in first}) == 1 and len(first) > 1
    columns += [f"mean\n{first[0].unit}"] if one_unit else []
    rows: list[tuple[str | float, ...]] = [
        (summary.name, *(error.rmse for error in summary.errors), *[summary.mean_rmse] * one_unit)
        for summary in summaries
    ]
    return ReportTable("RMSE", ("recording", *columns), rows)


def load_table(result: TrajectoryTorques) -> ReportTable:
    """Greatest torque of each joint and, where it exceeds the limit, when it first does."""

    def moment(time: float, trajectory: int | None) -> str:
        return f"{time:.3f} s" + (f" of trajectory {trajectory}" if len(result.times) > 1 else "")

    rows = []
    for load in result.loads:
        limited = math.isfinite(load.limit)
        passed = "-" if limited else "not known"
        if load.passed_time is not None:
            passed = f"first at {moment(load.passed_time, load.passed_trajectory)}"
        limit = f"{load.limit:g} {load.unit}" if limited else "-"
        peak = f"{load.peak:.3f} {load.unit}"
        rows.append((load.joint, peak, moment(load.peak_time, load.peak_trajectory), limit, passed))
    return ReportTable("", ("joint", "peak", "at", "limit", "passes its limit"), rows)


def comparison_table(comparison: Comparison) -> ReportTable:
    """Root mean square errors, one column per run."""
    title = f"RMSE of {' and '.join(comparison.labels)}"
    columns = dict(zip(comparison.labels, comparison.rmse, strict=True))
    units = comparison.evaluations[0].units
    return of_joints(title, comparison.joint_names, units, columns, means=columns)


def held_out_table(
    found: Identification,
    title: str = "Held-out error",
    note: str = "",
    *,
    rmse: Mapping[str, Floats] | None = None,
    coverage: Floats | None = None,
) -> ReportTable:
    """Errors of each joint by each model, and the share within the band. rmse, coverage: of other data."""
    rmse = found.held_out if rmse is None else rmse
    none = np.full(len(found.joints), np.nan)
    columns = {
        heading: rmse.get(column, none)
        for column, heading in COLUMNS.items()
        if column in found.held_out
    }
    columns[_IN_BAND] = 100 * (found.coverage if coverage is None else coverage)
    return of_joints(title, found.joints, found.units, columns, note, means=columns)


def contact_table(contacts: Contacts) -> ReportTable:
    """One row per contact."""
    has_force = contacts.wrenches is not None
    interrupted = any(c.unknown for c in contacts.contacts)
    force = ("mean force [N]", "peak force [N]", "direction", "unseen directions") * has_force
    rows: list[tuple[str | float, ...]] = [
        (
            f"{c.begin:.2f} to {c.end:.2f}",
            *(f"{c.unknown:.2f}",) * interrupted,
            c.joint,
            c.torque,
            c.unit,
            *(_force(c) if has_force else ()),
        )
        for c in contacts.contacts
    ]
    title = counted(len(rows), "contact") if rows else "No contacts"
    note = (
        "Torque: the greatest of the joint. Force: at the tip, if nothing else is touched; its direction in "
        "the axes of the root."
    )
    headings = ("time [s]", *("unknown [s]",) * interrupted, "joint", "torque", "unit", *force)
    return ReportTable(title, headings, rows, note if has_force and rows else "")


def _force(contact: Contact) -> tuple[str | float, ...]:
    mean, greatest = contact.force or math.nan, contact.greatest_force or math.nan
    direction = "  ".join(f"{x:+.1f}" for x in contact.force_direction or ())
    return mean, greatest, direction, str(contact.unseen)


def threshold_table(contacts: Contacts) -> ReportTable:
    """External torques that are a contact."""
    evaluation, found = contacts.evaluation, contacts.thresholds
    columns = {"noise": found.noise, "threshold": found.torques, "peaks": found.peaks.astype(int)}
    rate = found.false_alarms_per_hour
    note = f"thresholds for {rate:g} false alarm{'' if rate == 1 else 's'} per hour"
    title = "Thresholds of each joint"
    return of_joints(title, evaluation.joint_names, evaluation.units, columns, note)


def payload_table(payload: Payload) -> ReportTable:
    """Mass, center of mass, inertia."""
    found, center = payload.estimate, payload.center_of_mass
    half = payload.center_of_mass_half_width
    rows = [("mass", "kg", found.mass, found.mass_half_width)]
    rows += [
        (f"center of mass, {axis}", "mm", 1e3 * center[i], 1e3 * half[i])
        for i, axis in enumerate("xyz")
    ]
    if found.inertia_is_known:
        rows += [
            (f"inertia {'xyz'[i]}{'xyz'[j]}", "kg m²", found.inertia[i, j], found.inertia_half_width[i, j])
            for i, j in zip(*np.triu_indices(3), strict=True)
        ]  # fmt: skip
    return ReportTable(
        f"Load: {number(found.mass)} kg",
        ("number", "unit", "value", "± (95 %)"),
        rows,
        note=f"In addition to what the robot carries already; in the frame of {payload.frame}.",
    )


def residual_table(payload: Payload) -> ReportTable:
    """Measured minus computed torques without and with the load."""
    columns = {
        "RMSE without load": payload.rmse_before,
        "RMSE with load": payload.rmse_after,
        "offset": payload.estimate.offset,
    }
    title = "Errors without and with the load"
    return of_joints(title, payload.joint_names, payload.evaluation.units, columns)


def retime_table(result: Retimed) -> ReportTable:
    """Of each joint: its greatest torque and velocity, and how long it is at its torque limit."""
    columns = {
        "peak": np.abs(result.efforts).max(axis=0),
        "limit": result.limits.torque,
        "at limit [% of time]": 100 * result.at_limit,
        "velocity [rad/s, m/s]": np.abs(result.qd).max(axis=0),
    }
    return of_joints("Load of each joint", result.joint_names, result.units, columns)


_LEAST_PLAIN = 1e-3  # a smaller number has a power of ten
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_FIGURE_SPACE, _PUNCTUATION_SPACE = "\N{FIGURE SPACE}", "\N{PUNCTUATION SPACE}"


def number(value: float) -> str:
    """Three significant digits, as people write them; a dash where there is no number."""
    if not math.isfinite(value):
        return "\N{EN DASH}"
    mantissa, _, exponent = f"{value:.2e}".partition("e")  # of the rounded number: 0.9999 is 1.00
    if 0 < abs(value) < _LEAST_PLAIN:
        return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPTS)}"
    return f"{value:.{max(0, 2 - int(exponent))}f}" if value else "0"


def aligned(values: Sequence[str | float]) -> list[str]:
    """The numbers of a column, their decimal points below each other. Texts stay."""
    texts = [value if isinstance(value, str) else number(value) for value in values]
    plain = [not isinstance(v, str) and t[-1].isascii() for v, t in zip(values, texts, strict=True)]
    decimals = [len(text.partition(".")[2]) for text in texts]
    longest = max((d for d, is_plain in zip(decimals, plain, strict=True) if is_plain), default=0)
    return [
        _padded(text, longest) if is_plain else text
        for text, is_plain in zip(texts, plain, strict=True)
    ]


def _padded(text: str, decimals: int) -> str:
    """With spaces as wide as the decimals that other numbers have, which no page may escape."""
    from markupsafe import Markup

    own = len(text.partition(".")[2])
    point = _PUNCTUATION_SPACE if decimals and not own else ""
    return Markup(text + point + _FIGURE_SPACE * (decimals - own))

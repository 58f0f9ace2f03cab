# SPDX-License-Identifier: Apache-2.0
"""The series of an evaluation as columns of one table.

A row per sample. Columns, J being a joint as the recording names it:

recording                             its name among others, where one is given
time                                  s since the first sample
position.J velocity.J acceleration.J  of the motion; the acceleration is the estimated one
effort.J                              as recorded; current.J in its place where it is a current
measured.J computed.J error.J         torques; error = computed - measured
band.J                                half the width of the model's 95 % band, where it is known
repeated ... kept                     what was found in a sample, true or false: see Samples
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from inverse_dynamics.evaluation.accelerations import MASKS

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Mask


class Column(NamedTuple):
    """A series: N values of a unit; none for what is true or false."""

    name: str
    unit: str
    values: Floats | Mask


def series_columns(evaluation: Any) -> list[Column]:
    """Columns of an Evaluation, in the order of the module's text."""
    columns = [Column("time", "s", evaluation.time)]
    log = evaluation.log
    error = evaluation.computed - evaluation.measured
    currents = evaluation.effort.meaning == "current"
    for j, joint in enumerate(log.joint_names):
        torque = evaluation.units[j]
        angle = "m" if torque == "N" else "rad"
        series = (
            ("position", angle, log.q),
            ("velocity", f"{angle}/s", log.qd),
            ("acceleration", f"{angle}/s^2", evaluation.qdd),
            ("current", "A", log.effort) if currents else ("effort", torque, log.effort),
            ("measured", torque, evaluation.measured),
            ("computed", torque, evaluation.computed),
            ("error", torque, error),
            *([] if evaluation.band is None else [("band", torque, evaluation.band)]),
        )
        columns += [Column(f"{name}.{joint}", unit, rows[:, j]) for name, unit, rows in series]
    columns += [Column(mask, "", getattr(evaluation.samples, mask)) for mask in MASKS]
    return columns

# SPDX-License-Identifier: Apache-2.0
"""Pictures of docs/why_dont_my_torques_match.md, from the results of the commands on that page.

python3 docs/pictures/make_why_pictures.py out/why docs/pictures
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from inverse_dynamics import read_evaluation
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.solvers import open_solver
from inverse_dynamics.show.plots import COMPUTED, ERROR, MEASURED, STYLE

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes

    from inverse_dynamics import Evaluation

PAN, LIFT, ELBOW, WRIST_1, _, WRIST_3 = range(6)


def measured_over_computed(axes: Axes, e: Evaluation, j: int) -> None:
    """Slope 1 where all is well."""
    _line(axes, 1)
    axes.plot(e.computed[:, j], e.measured[:, j], **DOTS)
    axes.set(xlabel="computed [N m]", ylabel="measured")


def error_over_gravity(axes: Axes, e: Evaluation, j: int) -> None:
    """Slope 1 where the error is gravity's torque."""
    assert e.robot.urdf is not None
    gravity = open_solver(e.robot, read_description(e.robot.urdf)).gravity_vector(e.log.q)
    _line(axes, 1)
    axes.plot(gravity[:, j], e.computed[:, j] - e.measured[:, j], **DOTS)
    axes.set(xlabel="torque of gravity, computed [N m]", ylabel="error")


def error_over_velocity(axes: Axes, e: Evaluation, j: int) -> None:
    """A step at zero where friction is missing."""
    axes.plot(e.log.qd[:, j], e.computed[:, j] - e.measured[:, j], **DOTS)
    axes.set(xlabel="velocity [rad/s]", ylabel="error [N m]")


def slope_over_velocity(axes: Axes, e: Evaluation, j: int) -> None:
    """Slope 1 where clock and velocities agree."""
    _line(axes, 1)
    axes.plot(e.log.qd[:, j], np.gradient(e.log.q[:, j], e.time), **DOTS)
    axes.set(xlabel="velocity [rad/s]", ylabel="slope of position")


def error_over_time(axes: Axes, e: Evaluation, j: int) -> None:
    """As `ids evaluate` draws it."""
    axes.axhline(0, color="#999999", linewidth=0.6)
    error = e.computed[:, j] - e.measured[:, j]
    axes.plot(e.time, error, **ERROR)
    height = max(1.1 * np.abs(error).max(), 0.1 * np.ptp(e.measured[:, j]))
    axes.set(xlabel="time [s]", ylabel="error [N m]", ylim=(-height, height))


def position_over_time(axes: Axes, e: Evaluation, j: int) -> None:
    """Beyond the full turn of the grey lines where radians aren't radians."""
    for turn in (-2 * np.pi, 2 * np.pi):
        axes.axhline(turn, color="#999999", linewidth=0.8)
    axes.plot(e.time, e.log.q[:, j], **ERROR)
    axes.set(xlabel="time [s]", ylabel='position ["rad"]')


def one_second(axes: Axes, e: Evaluation, j: int) -> None:
    """Accelerations, sample by sample."""
    shown = (e.time > 2) & (e.time < 3)
    axes.plot(e.time[shown], e.qdd[shown, j], marker=".", markersize=2, **ERROR)
    axes.set(xlabel="time [s]", ylabel="acceleration")


DOTS = {"color": ERROR["color"], "linestyle": "none", "marker": ".", "markersize": 1.8}


@dataclass(frozen=True)
class Picture:
    """What the picture why_NAME.png shows of the result NAME."""

    title: str
    joints: tuple[int, ...]
    right: Callable[[Axes, Evaluation, int], None]


PICTURES = {
    "right": Picture("As it should be", (PAN, LIFT), error_over_time),
    "currents": Picture("Efforts are motor currents", (LIFT, WRIST_1), measured_over_computed),
    "without_gravity": Picture("Efforts without gravity", (LIFT, ELBOW), error_over_gravity),
    "ceiling": Picture("Robot on the ceiling", (PAN, LIFT), measured_over_computed),
    "wall": Picture("Robot on a wall", (PAN, ELBOW), error_over_time),
    "payload": Picture("A payload of 5 kg", (LIFT, WRIST_3), error_over_time),
    "tool": Picture("A tool the description lacks", (LIFT, WRIST_3), error_over_time),
    "friction": Picture("Friction", (PAN, WRIST_1), error_over_velocity),
    "order": Picture("Joints in another order", (PAN, ELBOW), error_over_time),
    "direction": Picture("The elbow's effort reversed", (LIFT, ELBOW), measured_over_computed),
    "degrees": Picture("Degrees", (LIFT, ELBOW), position_over_time),
    "clock": Picture("A clock at half speed", (PAN, LIFT), slope_over_velocity),
    "stamps": Picture("Jitter and repeated samples, no filter", (PAN, LIFT), one_second),
}


def draw(picture: Picture, evaluation: Evaluation) -> Figure:
    """Torques over time, one row per joint; beside them what reveals the mistake."""
    figure = Figure(figsize=(8.2, 3.5), layout="constrained")
    figure.suptitle(picture.title, x=0.01, ha="left", fontsize=10, fontweight="bold")
    rows = figure.subplots(len(picture.joints), 2, squeeze=False, width_ratios=(1.9, 1.0))
    for (left, right), j in zip(rows, picture.joints, strict=True):
        left.plot(evaluation.time, evaluation.measured[:, j], **MEASURED, label="measured")
        left.plot(evaluation.time, evaluation.computed[:, j], **COMPUTED, label="computed")
        left.set_title(f"{evaluation.joint_names[j]} [N m]", loc="left", fontsize=9)
        left.set_xlim(evaluation.time[0], evaluation.time[-1])
        picture.right(right, evaluation, j)
    rows[-1][0].set_xlabel("time [s]")
    for axes in rows[:-1].ravel():
        axes.set_xlabel("")
    handles, labels = rows[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper right", ncols=2, frameon=False)
    return figure


def make_pictures(results: Path, out: Path) -> None:
    """All of them. The same results, the same bytes."""
    with mpl.rc_context(STYLE):
        for name, picture in PICTURES.items():
            figure = draw(picture, read_evaluation(results / name))
            figure.savefig(out / f"why_{name}.png", dpi=110, metadata={"Software": None})


def _line(axes: Axes, slope: float) -> None:
    """Where points belong if all is well."""
    axes.axline((0, 0), slope=slope, color="#999999", linewidth=0.8)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, help="where the commands of the page wrote")
    parser.add_argument("out", type=Path)
    given = parser.parse_args()
    make_pictures(given.results, given.out)

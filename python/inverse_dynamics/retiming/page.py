# SPDX-License-Identifier: Apache-2.0
"""The page of a timed path: the robot beside itself, timed by an acceleration limit; speed, torques, limits.

text = retime(path, "ur10_real").page()
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import sample_times
from inverse_dynamics.arrays import stretches
from inverse_dynamics.evaluation.page import model_facts
from inverse_dynamics.retiming.figure import JOINT_COLORS
from inverse_dynamics.retiming.tables import retime_table
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.show.page import motion_data, render_players, series_data
from inverse_dynamics.show.scene import Scene, read_scene

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.retiming.retiming import Retimed

RATE = 250.0  # Hz, of what is drawn
MOST_DRAWN = 100_000  # samples
_FASTEST, _OTHER = ("fastest", "computed"), ("constant acceleration", "error")  # names, colours


def retime_page(result: Retimed) -> str:
    """The page as text."""
    robot, arm = result.robot, Arm(result.robot, result.solver)
    scene = Scene() if robot.urdf is None else read_scene(robot.urdf, arm.joint_names)
    motions = [(_FASTEST, result.time, result.q, result.efforts)]
    if (other := result.by_acceleration) is not None:
        time = sample_times(other.duration, min(RATE, MOST_DRAWN / other.duration))
        states = other.states(time)
        remembered = arm.solver.friction_state().along(*states[:2])
        motions.append((_OTHER, time, states[0], arm.solver.torques(*states) + remembered))
    plots = [
        _speed_plot(result),
        *(_torque_plot(result, j, motions) for j in range(len(arm.units))),
    ]
    data = {
        "id": "main",
        "links": scene.links,
        "motions": [motion_data(time, q) for _, time, q, _ in motions],
        "plots": plots,
    }
    return render_players(
        "retimed.html",
        [data],
        title=f"{robot.name}: the fastest motion along a path",
        key=_key(result),
        motions=[
            {"name": name, "style": style, "duration": f"{time[-1]:.3f} s"}
            for (name, style), time, _, _ in motions
        ],
        drawn=bool(scene.links),
        banded=bool(result.band.any()),
        strip=_strip(result, max(time[-1] for _, time, _, _ in motions)),
        plots=plots,
        table=retime_table(result),
        assumptions=_assumptions(result),
        notes=[*result.notes, *scene.notes],
    )


def _key(result: Retimed) -> list[tuple[str, str]]:
    energy = result.energy
    rows = [("duration", f"{result.duration:.3f} s")]
    if result.by_acceleration is not None:
        rows += [
            ("with constant acceleration", f"{result.by_acceleration.duration:.3f} s"),
            ("saved", f"{result.seconds_saved:.3f} s"),
        ]
    return [
        *rows,
        ("energy", f"{energy.driven:.1f} J"),
        ("of it friction", f"{energy.friction:.1f} J"),
        ("peak power", f"{energy.peak_power:.0f} W"),
    ]


def _speed_plot(result: Retimed) -> dict[str, Any]:
    """Speeds of both motions over time; the limit is that of the place which the fastest one passes."""
    timed, other = result.timed, result.by_acceleration
    limit = np.nan_to_num(result.speed_limit, nan=0.0)
    shown = np.minimum(limit, 1.25 * timed.speed.max())
    series = [series_data("limit", "measured", timed.time, shown)]
    if other is not None:
        series.append(series_data(*_OTHER, other.time, other.speed))
    series.append(series_data(*_FASTEST, timed.time, timed.speed))
    return {"label": "speed along the path", "unit": "rad/s", "series": series}


def _torque_plot(
    result: Retimed, j: int, motions: list[tuple[tuple[str, str], Floats, Floats, Floats]]
) -> dict[str, Any]:
    ends = np.append(result.time, max(time[-1] for _, time, _, _ in motions))
    limit = np.append(result.torque_limit[:, j], result.torque_limit[-1, j])
    series = [series_data("limit", "measured", ends, sign * limit) for sign in (1, -1)]
    for (name, style), time, _, torques in reversed(motions):
        series.append(series_data(name, style, time, torques[:, j]))
    half = float(result.band[j])
    return {
        "label": result.joint_names[j],
        "unit": result.units[j],
        "series": series,
        "band": [{"from": 0.0, "to": result.duration, "half": half}] if half else [],
        "left_out": spans(result.time, result.limiting == j),
    }


def spans(place: Floats, flags: Mask) -> list[tuple[float, float]]:
    """Where flags of samples hold: from, to; half way to their neighbours."""
    borders = np.concatenate(([place[0]], (place[1:] + place[:-1]) / 2, [place[-1]]))
    return list(zip(*(borders[edges].tolist() for edges in stretches(flags)), strict=True))


def _strip(result: Retimed, longest: float) -> dict[str, Any]:
    """Colours of the joints at their limits: rows of torque and velocity over time, longest = 1."""
    rows = []
    for name, limiting in (("torque", result.limiting), ("velocity", result.limiting_velocity)):
        found = [
            {"start": f"{a:.5f}", "width": f"{b - a:.5f}", "color": color}
            for j, color in enumerate(_colors(result))
            for a, b in spans(result.time / longest, limiting == j)
        ]
        names = ", ".join(result.joint_names[j] for j in np.unique(limiting) if j >= 0)
        rows.append({"name": name, "spans": found, "joints": names})
    seen = np.union1d(result.limiting, result.limiting_velocity)
    joints = [(result.joint_names[j], _colors(result)[j]) for j in seen if j >= 0]
    return {"rows": rows, "joints": joints}


def _colors(result: Retimed) -> list[str]:
    return [JOINT_COLORS[j % len(JOINT_COLORS)] for j in range(len(result.joint_names))]


def _assumptions(result: Retimed) -> list[tuple[str, str]]:
    limits = result.limits
    rows = [
        *model_facts(result.robot),
        *(
            (
                f"limits of {name.replace('_', ' ')}",
                ", ".join(f"{value:g}" for value in getattr(limits, name)),
            )
            for name in ("velocity", "acceleration", "jerk", "torque_rate")
        ),
        ("speed of the tip", f"{limits.tip_speed:g} m/s" if np.isfinite(limits.tip_speed) else ""),
        (
            "constant acceleration",
            f"{result.acceleration:.3g} rad/s² in each joint" if result.by_acceleration else "",
        ),
    ]
    return [(name, text) for name, text in rows if text]

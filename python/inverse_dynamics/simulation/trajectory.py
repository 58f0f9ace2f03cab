# SPDX-License-Identifier: Apache-2.0
"""Desired motions: joint positions, velocities and accelerations at any time.

    trajectory = FourierTrajectory(joint_names, period=20.0, center=q0, sine=a, cosine=b)
    q, qd, qdd = trajectory.at(np.linspace(0.0, trajectory.duration, 1000))

A finite Fourier series [Swevers et al., IEEE T-RA 13(5), 1997] with w = 2 pi / period, harmonics l = 1..L:

    q(t)  = center + sum_l  sine_l / (w l) sin(w l t) - cosine_l / (w l) cos(w l t)
    qd(t) =          sum_l  sine_l cos(w l t) + cosine_l sin(w l t)

It is band-limited, so the acceleration can be had from samples without loss, and it repeats, so measurements can be
averaged. It starts and ends at rest, with zero acceleration, where sum_l sine_l = 0 and sum_l l cosine_l = 0.

`ids simulate --trajectory` reads files, and stores one with each recording. A Fourier series, all joints in any order:

    schema: 1
    kind: fourier
    source: in words                                  # optional
    joints: [joint_1, joint_2]
    period: 20.0                                      # s
    center: [0.0, -1.57]                              # rad
    sine: [[0.1, -0.1], [0.3, -0.3]]                  # rad/s, a row per joint, an entry per harmonic
    cosine: [[0.2, -0.1], [0.0, 0.0]]

or waypoints, passed smoothly, at rest at both ends:

    schema: 1
    kind: waypoints
    joints: [joint_1, joint_2]
    times: [0.0, 1.5, 3.0]                            # s, from 0
    positions: [[0.0, 0.0], [0.5, -0.5], [0.0, 0.0]]  # rad, a row per time
    rests: [1]                                        # optional: waypoints, counted from 0, where all joints stop
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.installation.extras import lazily_imported
from inverse_dynamics.robots.located_yaml import read_mapping
from inverse_dynamics.simulation.errors import TrajectoryError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.robots.located_yaml import Mapping, Value

yaml = lazily_imported("yaml", "a file of a trajectory")

SCHEMA = 1


@dataclass(frozen=True)
class FourierTrajectory:
    """Periodic motion: a finite Fourier series per joint."""

    joint_names: tuple[str, ...]
    period: float  # s
    center: Floats  # (n,) rad
    sine: Floats  # (n, L) rad/s
    cosine: Floats  # (n, L) rad/s

    @property
    def duration(self) -> float:
        """One period [s]."""
        return self.period

    def later(self, seconds: float) -> FourierTrajectory:
        """The same motion, started later in its period by this time."""
        angle = 2.0 * np.pi * seconds / self.period * np.arange(1, self.sine.shape[1] + 1)
        return replace(
            self,
            sine=self.sine * np.cos(angle) + self.cosine * np.sin(angle),
            cosine=self.cosine * np.cos(angle) - self.sine * np.sin(angle),
        )

    def at(self, time: Floats) -> tuple[Floats, Floats, Floats]:
        """q, qd, qdd (N, n) at times (N,) s; any time, since it repeats."""
        w = 2.0 * np.pi / self.period * np.arange(1, self.sine.shape[1] + 1)
        sines, cosines = np.sin(np.outer(time, w)), np.cos(np.outer(time, w))
        q = self.center + sines @ (self.sine / w).T - cosines @ (self.cosine / w).T
        qd = cosines @ self.sine.T + sines @ self.cosine.T
        qdd = cosines @ (self.cosine * w).T - sines @ (self.sine * w).T
        return q, qd, qdd


@dataclass(frozen=True)
class WaypointTrajectory:
    """Motion through waypoints, smooth up to the jerk; at rest, with zero acceleration, at both ends.

    Quintic pieces: the waypoints' velocities and accelerations are those that make jerk and its rate continuous. At
    `rests` all joints stop, with zero acceleration.
    """

    joint_names: tuple[str, ...]
    times: Floats  # (K,) s, from zero, increasing
    positions: Floats  # (K, n) rad
    velocities: Floats  # (K, n) rad/s
    accelerations: Floats  # (K, n) rad/s^2
    rests: tuple[int, ...] = ()  # waypoints between the ends, counted from 0, increasing

    @classmethod
    def through(
        cls,
        joint_names: tuple[str, ...],
        times: Floats,
        positions: Floats,
        rests: tuple[int, ...] = (),
    ) -> WaypointTrajectory:
        """The smooth motion that is at `positions[k]` at `times[k]`."""
        times = np.asarray(times, dtype=np.float64)
        if len(times) < 2 or times[0] != 0.0 or not (np.diff(times) > 0).all():
            raise TrajectoryError(
                "waypoints: expected at least two times, increasing from 0 s; "
                f"got {', '.join(f'{t:g}' for t in times)}"
            )
        ends = (0, *rests, len(times) - 1)
        if not (np.diff(ends) > 0).all():
            raise TrajectoryError(
                "waypoints: rests: expected waypoints between the first and the last, counted from 0, "
                f"increasing; got {', '.join(map(str, rests))}"
            )
        velocities, accelerations = np.zeros_like(positions), np.zeros_like(positions)
        for first, last in pairwise(ends):
            part = slice(first, last + 1)
            velocities[part], accelerations[part] = _smooth_derivatives(
                times[part], positions[part]
            )
        return cls(joint_names, times, positions, velocities, accelerations, tuple(rests))

    @property
    def duration(self) -> float:
        """Time of the last waypoint [s]."""
        return float(self.times[-1])

    def at(self, time: Floats) -> tuple[Floats, Floats, Floats]:
        """q, qd, qdd (N, n) at times (N,) s; before and after the motion: at rest at its ends."""
        time = np.clip(time, 0.0, self.duration)
        k = np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(self.times) - 2)
        h = (self.times[k + 1] - self.times[k])[:, None]
        s = (time[:, None] - self.times[k, None]) / h
        ends = [
            scale * values[side]
            for side in (k, k + 1)
            for scale, values in (
                (1.0, self.positions),
                (h, self.velocities),
                (h * h, self.accelerations),
            )
        ]
        q, qd, qdd = (
            sum(np.polyval(np.polyder(p, d), s) * e for p, e in zip(_QUINTICS, ends, strict=True))
            for d in range(3)
        )
        return np.asarray(q), np.asarray(qd) / h, np.asarray(qdd) / h**2


Trajectory = FourierTrajectory | WaypointTrajectory
"""A desired motion of n joints over `duration` seconds."""


def read_trajectory(file: Path, joint_names: Sequence[str]) -> tuple[Trajectory, str]:
    """The trajectory of a file, its joints in the order of `joint_names`, and its source in words.

    Raises TrajectoryError.
    """
    top = read_mapping(file, TrajectoryError)
    top.expect(("schema", "kind", "joints"))
    schema = top.required("schema")
    if schema.integer() != SCHEMA:
        schema.fail(f"{SCHEMA}", "it was written for another version of this command")
    kind = top.required("kind").text(("fourier", "waypoints"))
    source = top.optional("source")
    words = f"From the file {file.name}." if source is None else source.text().strip()
    order = _order(top.required("joints"), joint_names)
    read = _fourier if kind == "fourier" else _waypoints
    trajectory = read(top, tuple(joint_names), order)
    top.reject_others()
    return trajectory, words


def _fourier(top: Mapping, names: tuple[str, ...], order: list[int]) -> FourierTrajectory:
    top.expect(("period", "center", "sine", "cosine"))
    period = top.required("period")
    if period.number() <= 0:
        period.fail("a time in s above zero")
    center = _row(top.required("center"), len(names))
    sine = _table(top.required("sine"), rows=len(names))
    cosine = _table(top.required("cosine"), rows=len(names), columns=sine.shape[1])
    return FourierTrajectory(names, period.number(), center[order], sine[order], cosine[order])


def _waypoints(top: Mapping, names: tuple[str, ...], order: list[int]) -> WaypointTrajectory:
    top.expect(("times", "positions"))
    times_value = top.required("times")
    times = _row(times_value)
    if len(times) < 2 or times[0] != 0.0 or not (np.diff(times) > 0).all():
        times_value.fail("at least two times that increase from 0")
    positions = _table(top.required("positions"), rows=len(times), columns=len(names))
    rests_value = top.optional("rests")
    rests = () if rests_value is None else tuple(rest.integer() for rest in rests_value.entries())
    if rests_value is not None and not (np.diff((0, *rests, len(times) - 1)) > 0).all():
        rests_value.fail("waypoints between the first and the last, counted from 0, that increase")
    return WaypointTrajectory.through(names, times, positions[:, order], rests)


def trajectory_text(trajectory: Trajectory, source: str) -> str:
    """The file of a trajectory; all digits are kept."""
    if isinstance(trajectory, FourierTrajectory):
        kind, names = "fourier", ["period", "center", "sine", "cosine"]
    else:
        kind, names = "waypoints", ["times", "positions", *(["rests"] if trajectory.rests else [])]
    content: dict[str, Any] = {"schema": SCHEMA, "kind": kind, "source": " ".join(source.split())}
    content["joints"] = list(trajectory.joint_names)
    content |= {name: np.asarray(getattr(trajectory, name)).tolist() for name in names}
    text = yaml.safe_dump(content, sort_keys=False, width=120, default_flow_style=None)
    return f"# SPDX-License-Identifier: Apache-2.0\n{text}"


def _order(value: Value, joint_names: Sequence[str]) -> list[int]:
    """Where each joint of the chain stands in the file."""
    there = [entry.text() for entry in value.entries()]
    if sorted(there) != sorted(joint_names):
        raise TrajectoryError(
            f"{value.where}: expected the joints {', '.join(joint_names)}, got {', '.join(there)}; "
            "is the trajectory for another robot?"
        )
    return [there.index(name) for name in joint_names]


def _row(value: Value, length: int | None = None) -> Floats:
    return np.array([entry.number() for entry in value.entries(length)])


def _table(value: Value, rows: int, columns: int | None = None) -> Floats:
    lists = value.entries(rows)
    columns = columns or max(1, len(lists[0].entries()))
    return np.array([_row(entry, columns) for entry in lists])


# Quintic Hermite polynomials on [0, 1], highest power first: value 1 of position, velocity or acceleration
# at the left end, then at the right end; the five others are zero.
_QUINTICS = (
    (-6.0, 15.0, -10.0, 0.0, 0.0, 1.0),
    (-3.0, 8.0, -6.0, 0.0, 1.0, 0.0),
    (-0.5, 1.5, -1.5, 0.5, 0.0, 0.0),
    (6.0, -15.0, 10.0, 0.0, 0.0, 0.0),
    (-3.0, 7.0, -4.0, 0.0, 0.0, 0.0),
    (0.5, -1.0, 0.5, 0.0, 0.0, 0.0),
)


def _smooth_derivatives(times: Floats, positions: Floats) -> tuple[Floats, Floats]:
    """Velocities and accelerations (K, n) of the waypoints that make third and fourth derivatives continuous."""
    count, joints = positions.shape
    # unknowns: velocity and acceleration of each waypoint
    matrix = np.zeros((2 * count, 2 * count))
    right = np.zeros((2 * count, joints))
    # at rest at both ends
    for row, unknown in enumerate((0, 1, 2 * count - 2, 2 * count - 1)):
        matrix[row, unknown] = 1.0
    # derivative d of piece k at its end equals that of piece k + 1 at its beginning
    row = 4
    for k in range(1, count - 1):
        for d in (3, 4):
            for piece, s, sign in ((k - 1, 1.0, 1.0), (k, 0.0, -1.0)):
                h = times[piece + 1] - times[piece]
                factors = [sign * np.polyval(np.polyder(p, d), s) / h**d for p in _QUINTICS]
                for side in (0, 1):
                    unknown = 2 * (piece + side)
                    matrix[row, unknown] += factors[3 * side + 1] * h
                    matrix[row, unknown + 1] += factors[3 * side + 2] * h**2
                    right[row] -= factors[3 * side] * positions[piece + side]
            row += 1
    solution = np.linalg.solve(matrix, right)
    return solution[0::2], solution[1::2]

# SPDX-License-Identifier: Apache-2.0
"""How far measured torques may be from an identified model's: half the width of a 95 % band, at each state.

    half^2 = 1.96^2 (noise^2 + variance + level^2 + (share f)^2 + (fv beyond / 2)^2) + (0.95 h r (1 + s))^2

noise     of held-out data while the joint moves
variance  of the torques by the covariance of the model's parameters
level     of offsets from day to day, N m
share     by which friction f differs from day to day: temperature, wear
beyond    velocity above the greatest one seen: half of the viscous friction fv that the law extrapolates
h r       at rest friction is anything between -h and h, the height of its step; r = exp(-(qd / v)^2)
s         |tanh(qd / width)|: a joint that creeps may still have the friction of the motion before
"""

from __future__ import annotations

from dataclasses import dataclass, field
from tempfile import TemporaryFile
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.robots.model_errors import (
    MoreFriction,
    model_errors_file,
    read_model_errors,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import Floats

NORMAL = 1.96  # half the interval that holds 95 % of a normal distribution, in standard deviations
UNIFORM = 0.95  # the same of a uniform distribution, by its greatest value

LEVEL = 0.0075
"""Of the range of torques: standard deviation of offsets from day to day and from robot to robot. Sensors of torque
and current have an accuracy of 1 to 2 % of their range."""

SHARE = 0.12
"""Of friction, from day to day: standard deviation of what is anywhere from 0.8 to 1.2, as friction of an arm that
warms up falls by a third."""

_REST = 0.02  # of the greatest velocity: friction has its law's value from about twice that on
_REST_WIDTHS = 1.5  # the same in widths of the step
_ROWS = 50_000  # samples in memory at a time


@dataclass(frozen=True)
class TorqueBand:
    """The band of a model with n joints. n numbers each: N m (prismatic N), shares, rad/s (m/s)."""

    factor: Floats  # (m, K) deviations of the m unknowns: their covariance is factor factor'
    # smooth_coulomb of each joint, by the model file's keys
    friction: Sequence[dict[str, float]]
    noise: Floats  # standard deviation while the joint moves
    level: Floats  # of offsets from day to day
    share: Floats  # of friction, from day to day
    seen: Floats  # greatest velocity of the data of identification
    more: MoreFriction = field(default_factory=MoreFriction)

    def half_widths(self, solver: Solver, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """(N, n) at states (N, n). solver: of the model."""
        friction = solver.friction_vector(qd, q=q)
        gravity = np.abs(solver.gravity_vector(q))
        fv, fc, fl, fs, width = (
            np.array([law.get(key, 0.0) for law in self.friction])
            for key in ("fv", "fc", "fl", "fs", "width")
        )
        extrapolated = 0.5 * fv * np.maximum(np.abs(qd) - self.seen, 0.0)
        variance = (
            self.noise**2
            + self.more.uncertainty(self.friction, self.factor).variances(solver, (q, qd, qdd))
            + self.level**2
            + (self.share * friction) ** 2
            + extrapolated**2
        )
        at_rest = (fc + fl * gravity + fs) * rest_share(qd, self.friction, self.seen)
        at_rest *= 1 + np.abs(np.tanh(qd / width))
        return np.asarray(np.sqrt(NORMAL**2 * variance + (UNIFORM * at_rest) ** 2))

    def of_recording(self, solver: Solver, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """(N, n), as half_widths(), in a mapped file: a recording may be larger than the memory."""
        with TemporaryFile() as file:
            found = np.memmap(file, dtype=float, shape=q.shape)
        for first in range(0, len(q), _ROWS):
            rows = slice(first, first + _ROWS)
            found[rows] = self.half_widths(solver, q[rows], qd[rows], qdd[rows])
        return np.asarray(found)


def rest_share(qd: Floats, friction: Sequence[Mapping[str, float]], seen: Floats) -> Floats:
    """(N, n): 1 where a joint is at rest, 0 where it moves."""
    widths = np.array([law["width"] for law in friction])
    settled = np.maximum(_REST * seen, _REST_WIDTHS * widths)
    return np.asarray(np.exp(-((qd / settled) ** 2)))


def read_band(model: Path | None, solver: Solver) -> tuple[TorqueBand | None, str, Sequence[str]]:
    """The band of a model file, if there is one; why the file beside it isn't used; the sketch of what it is fitted to.

    Raises RobotError: a file that isn't one of `ids identify`.
    """
    if model is None or solver.seen is None or not model_errors_file(model).is_file():
        return None, "", ()
    content, why = read_model_errors(model)
    if content is None or "band" not in content:
        return None, why, ()
    factor, friction = np.array(content["deviations"], dtype=float).T, content["friction"]
    seen = np.abs(solver.seen[1]).max(axis=1)
    numbers = {key: np.array(values) for key, values in content["band"].items()}
    band = TorqueBand(factor, friction, seen=seen, more=MoreFriction.read(content), **numbers)
    return band, "", content["fitted_to"]

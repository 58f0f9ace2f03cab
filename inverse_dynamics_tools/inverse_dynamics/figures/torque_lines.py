# SPDX-License-Identifier: Apache-2.0
"""What a figure of torques shows, gathered from samples as they come.

lines = TorqueLines(10_000_000, 6)
while ...:
    lines.add(time, computed, measured)
lines.computed(0)  # (time, torque) of the first joint: at most 6000 points, with all peaks
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.figures.thinning import PeaksOfRows

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import Evaluation

MOST_POINTS = 6000  # of a line
_MOST_MAGNITUDES = 65536  # of errors, for their quantile
_ROWS = 65536  # looked at together: temporary arrays stay small


class TorqueLines:
    """Computed and measured torques and errors over time, of `count` samples of n joints."""

    def __init__(self, count: int, joints: int) -> None:
        self._joints = joints
        self._peaks = PeaksOfRows(count, MOST_POINTS)
        self._step = -(-count // _MOST_MAGNITUDES)
        self._magnitudes: list[Floats] = []  # of every step-th sample
        self._largest = np.zeros(joints)
        self._added = 0
        self.begin = 0.0  # s
        self.end = 0.0

    @classmethod
    def of(cls, evaluation: Evaluation) -> TorqueLines:
        """Those of an evaluation, looked at some samples at a time."""
        time, computed, measured = evaluation.time, evaluation.computed, evaluation.measured
        lines = cls(*computed.shape)
        for begin in range(0, len(time), _ROWS):
            rows = slice(begin, begin + _ROWS)
            lines.add(time[rows], computed[rows], measured[rows])
        return lines

    def add(self, time: Floats, computed: Floats, measured: Floats) -> None:
        """The next samples: (N,) s, (N, n) N m."""
        error = computed - measured
        self._peaks.add(time, np.hstack([computed, measured, error]))
        magnitude = np.abs(error)
        self._largest = np.maximum(self._largest, magnitude.max(axis=0))
        self._magnitudes.append(magnitude[-self._added % self._step :: self._step].copy())
        self.begin = float(time[0]) if self._added == 0 else self.begin
        self.end = float(time[-1])
        self._added += len(time)

    def computed(self, j: int) -> tuple[Floats, Floats]:
        """Time and torque of a joint."""
        return self._peaks.line(j)

    def measured(self, j: int) -> tuple[Floats, Floats]:
        """Time and torque of a joint."""
        return self._peaks.line(self._joints + j)

    def error(self, j: int) -> tuple[Floats, Floats]:
        """Time and difference of a joint."""
        return self._peaks.line(2 * self._joints + j)

    def error_limit(self, j: int) -> float:
        """What an axis of errors must show: all of them, but for spikes that would flatten the rest.

        A spike is beyond one and a half times the 99.5 % quantile of the magnitudes, of which 32,768
        to 65,536 are looked at in longer recordings.
        """
        quantile = np.quantile(np.concatenate([m[:, j] for m in self._magnitudes]), 0.995)
        return float(min(self._largest[j], 1.5 * quantile or np.inf))

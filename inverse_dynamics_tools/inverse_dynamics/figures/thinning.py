# SPDX-License-Identifier: Apache-2.0
"""Fewer samples of a long series for drawing, without losing a peak.

shown = peaks(tau, 6000)
axes.plot(time[shown], tau[shown])
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats, Integers


class PeaksOfRows:
    """What peaks() shows of each of k series, gathered from rows as they come."""

    def __init__(self, count: int, most: int) -> None:
        self._count = count
        self._stretch = 1 if count <= most else _stretch(count, most)
        self._time: list[Floats] = []  # of each stretch: lowest and highest, (2, k)
        self._values: list[Floats] = []  # likewise
        self._index: list[Integers] = []  # likewise
        self._rest = np.empty((0, 0))  # rows of a stretch that hasn't ended: time and k values
        self._done = 0  # rows of stretches that have
        self._last = np.empty(0)

    def add(self, time: Floats, values: Floats) -> None:
        """The next rows: (N,) and (N, k)."""
        rows = np.column_stack([time, values])
        if self._done == 0 and not len(self._rest):
            self._keep(rows[:1].T[:, None, :])  # the first one
        self._last = rows[-1]
        if len(self._rest):
            rows = np.vstack([self._rest, rows])
        whole = len(rows) // self._stretch * self._stretch
        if whole:
            self._keep(
                np.ascontiguousarray(rows[:whole].T).reshape(rows.shape[1], -1, self._stretch)
            )
            self._done += whole
        self._rest = rows[whole:]

    def line(self, i: int) -> tuple[Floats, Floats]:
        """Time and values of a series, after the last row."""
        if len(self._rest):
            self._keep(self._rest.T[:, None, :])
            self._done += len(self._rest)
            self._rest = self._rest[:0]
        index = np.concatenate([part[i].ravel() for part in self._index])
        time = np.concatenate([part[i].ravel() for part in self._time])
        values = np.concatenate([part[i].ravel() for part in self._values])
        index, first = np.unique(np.append(index, self._count - 1), return_index=True)
        last = self._last
        return (np.append(time, last[0])[first], np.append(values, last[1 + i])[first])

    def _keep(self, stretches: Floats) -> None:
        """The lowest and the highest of each stretch: (1 + k, stretches, rows)."""
        time, values = stretches[0], stretches[1:]
        at = np.stack([values.argmin(axis=2), values.argmax(axis=2)], axis=-1)
        number = np.arange(time.shape[0])[None, :, None]
        self._values.append(np.take_along_axis(values, at, axis=2))
        self._time.append(time[number, at])
        self._index.append(self._done + number * stretches.shape[2] + at)


def _stretch(count: int, most: int) -> int:
    """How many of so many values two points stand for."""
    return -(-2 * count // (most - 2))


def peaks(values: Floats, most: int) -> Integers:
    """Indices, increasing, of at most `most` of N values (N,): the first, the last, and all peaks.

    Of each of at most `most` / 2 - 1 stretches of equal length, the lowest and the highest.
    """
    n = len(values)
    if n <= most:
        return np.arange(n)
    stretch = _stretch(n, most)
    starts = np.arange(0, n, stretch)
    padded = np.pad(values, (0, len(starts) * stretch - n), mode="edge").reshape(-1, stretch)
    lowest, highest = starts + padded.argmin(axis=1), starts + padded.argmax(axis=1)
    return np.unique(np.concatenate([[0], lowest, highest, [n - 1]]))

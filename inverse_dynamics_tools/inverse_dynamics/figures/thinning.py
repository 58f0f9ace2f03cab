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


def peaks(values: Floats, most: int) -> Integers:
    """Indices, increasing, of at most `most` of N values (N,): the first, the last, and all peaks.

    Of each of at most `most` / 2 - 1 stretches of equal length, the lowest and the highest.
    """
    n = len(values)
    if n <= most:
        return np.arange(n)
    stretch = -(-2 * n // (most - 2))
    starts = np.arange(0, n, stretch)
    padded = np.pad(values, (0, len(starts) * stretch - n), mode="edge").reshape(-1, stretch)
    lowest, highest = starts + padded.argmin(axis=1), starts + padded.argmax(axis=1)
    return np.unique(np.concatenate([[0], lowest, highest, [n - 1]]))

# SPDX-License-Identifier: Apache-2.0
"""Fewer samples of a long series for drawing, without losing a peak.

shown = peaks(tau, 6000)
axes.plot(time[shown], tau[shown])
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Integers


MOST_POINTS = 6000  # of a line in a figure
_MOST_MAGNITUDES = 65536  # of errors, for their quantile


def line(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Time and values (N,) of at most MOST_POINTS samples, with all peaks."""
    shown = peaks(values, MOST_POINTS)
    return time[shown], values[shown]


def error_limit(error: Floats) -> float:
    """Limit of an axis of errors (N,) of valid samples: their greatest size, but for spikes that would flatten them.

    A spike is beyond one and a half times the 99 % quantile of the magnitudes, of which 32,768 to
    65,536 are looked at in longer recordings. Without samples: 0.
    """
    if not len(error):
        return 0.0
    quantile = np.quantile(np.abs(error[:: -(-len(error) // _MOST_MAGNITUDES)]), 0.99)
    return float(min(max(error.max(), -error.min()), 1.5 * quantile or np.inf))


def peaks(values: Floats, most: int) -> Integers:
    """Indices, increasing, of at most `most` of N values (N,): the first, the last, and all peaks.

    Of each of at most `most` / 2 - 1 stretches of equal length, the lowest and the highest.
    """
    n = len(values)
    if n <= most:
        return np.arange(n)
    stretch = -(-2 * n // (most - 2))  # how many values two points stand for
    whole = n // stretch * stretch
    kept = [np.array([0, n - 1])]
    for begin, part in ((0, values[:whole].reshape(-1, stretch)), (whole, values[None, whole:])):
        if part.size:
            starts = begin + stretch * np.arange(len(part))
            kept += [starts + part.argmin(axis=1), starts + part.argmax(axis=1)]
    return np.unique(np.concatenate(kept))

# SPDX-License-Identifier: Apache-2.0
"""Minimisation with gradients that needn't be smooth: Adam.

    best = minimise(cost, start, iterations=500)      # cost(x, done) gives the gradient

Steps go along a running mean of the gradients, each coordinate divided by the root of a running mean of their squares
[Kingma and Ba, Adam: a method for stochastic optimization, arXiv 1412.6980, algorithm 1], and become shorter towards
the end [cosine: Loshchilov and Hutter, arXiv 1608.03983]. There is no line search, which kinks of the cost would stop.
No random numbers: the same cost and start give the same result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.progress import no_progress

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.progress import Progress

_STEP = 0.02  # of each coordinate, at first
_MEAN, _SQUARES = 0.9, 0.98  # of the running means, what is kept per step
_LEAST = 1e-9  # gradient that counts


def minimise(
    gradient: Callable[[Floats, float], Floats],
    start: Floats,
    *,
    iterations: int,
    step: float = _STEP,
    progress: Progress = no_progress,
) -> Floats:
    """The point (m,) after `iterations` steps from `start`, coordinates of about one.

    gradient: of the cost at x (m,), done a part from 0 to 1 of the steps, since penalties may grow.
    """
    x = np.array(start, dtype=np.float64)
    mean, squares = np.zeros_like(x), np.zeros_like(x)
    for k in range(iterations):
        progress("optimising", k, iterations)
        done = k / iterations
        slope = gradient(x, done)
        mean = _MEAN * mean + (1.0 - _MEAN) * slope
        squares = _SQUARES * squares + (1.0 - _SQUARES) * slope**2
        unbiased = mean / (1.0 - _MEAN ** (k + 1))
        size = np.sqrt(squares / (1.0 - _SQUARES ** (k + 1)))
        x = x - step * 0.5 * (1.0 + np.cos(np.pi * done)) * unbiased / (size + _LEAST)
    progress("optimising", iterations, iterations)
    return x

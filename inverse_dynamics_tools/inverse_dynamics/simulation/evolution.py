# SPDX-License-Identifier: Apache-2.0
"""Minimisation without gradients: separable CMA-ES.

    best = minimise(cost, start, step=0.3, evaluations=5000, seed=0)

Each generation draws candidates around a mean, moves the mean towards the best half, and adapts one step size per
coordinate and one for all [Hansen, The CMA evolution strategy: a tutorial, arXiv 1604.00772; diagonal covariance as in
Ros and Hansen, PPSN X, 2008, whose symbols the code uses]. The same seed gives the same result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.progress import no_progress

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.progress import Progress


def minimise(
    cost: Callable[[Floats], float],
    start: Floats,
    *,
    step: float,
    evaluations: int,
    seed: int,
    progress: Progress = no_progress,
) -> Floats:
    """The best point met in that many evaluations of `cost`; start, result (m,)."""
    random = np.random.default_rng(seed)
    size = len(start)
    population = 4 + int(3 * np.log(size))
    parents = population // 2
    weights = np.log(parents + 0.5) - np.log(np.arange(1, parents + 1))
    weights /= weights.sum()
    mu = 1.0 / (weights**2).sum()

    # learning rates
    c_c = (4 + mu / size) / (size + 4 + 2 * mu / size)
    c_s = (mu + 2) / (size + mu + 5)
    faster = (size + 2) / 3  # a diagonal covariance may learn faster
    c_1 = min(1.0, faster * 2 / ((size + 1.3) ** 2 + mu))
    c_mu = min(1 - c_1, faster * 2 * (mu - 2 + 1 / mu) / ((size + 2) ** 2 + mu))
    damping = 1 + 2 * max(0.0, np.sqrt((mu - 1) / (size + 1)) - 1) + c_s
    expected = np.sqrt(size) * (1 - 1 / (4 * size) + 1 / (21 * size**2))

    mean, sigma, variances = np.array(start, dtype=np.float64), step, np.ones(size)
    path_c, path_s = np.zeros(size), np.zeros(size)
    best, best_cost = mean, cost(mean)
    for done in range(0, evaluations, population):
        # candidates, best first
        z = random.standard_normal((population, size))
        points = mean + sigma * np.sqrt(variances) * z
        costs = np.array([cost(point) for point in points])
        order = np.argsort(costs, kind="stable")
        if costs[order[0]] < best_cost:
            best, best_cost = points[order[0]], float(costs[order[0]])
        # move the mean, lengthen or shorten the paths
        z = z[order[:parents]]
        z_mean = weights @ z
        y_mean = np.sqrt(variances) * z_mean
        mean = mean + sigma * y_mean
        path_s = (1 - c_s) * path_s + np.sqrt(c_s * (2 - c_s) * mu) * z_mean
        path_c = (1 - c_c) * path_c + np.sqrt(c_c * (2 - c_c) * mu) * y_mean
        # adapt the step sizes
        variances = (
            (1 - c_1 - c_mu) * variances + c_1 * path_c**2 + c_mu * variances * (weights @ z**2)
        )
        sigma *= np.exp(c_s / damping * (np.linalg.norm(path_s) / expected - 1))
        progress("optimising", min(done + population, evaluations), evaluations)
    return best

# SPDX-License-Identifier: Apache-2.0
"""Least squares within bounds."""

import numpy as np
import pytest

from inverse_dynamics.diagnosis.fit import _bounded

SMALLER = 1e-6  # relative: what a ridge on numbers that the data hardly determine may cost


@pytest.mark.parametrize("size", [3, 12, 40])
def test_bounded_least_squares_are_as_good_as_those_of_scipy(size: int) -> None:
    optimize = pytest.importorskip("scipy.optimize")
    random = np.random.default_rng(size)
    for _ in range(30):
        # columns that are nearly alike, so that bounds are held and freed again
        A = random.normal(size=(60, size)) + 3.0 * random.normal(size=(60, 1))
        b = random.normal(size=60)
        low, high = -random.uniform(0.0, 0.05, size), random.uniform(0.0, 0.05, size)
        x = _bounded(A.T @ A, A.T @ b, low, high)
        assert np.abs(x - np.clip(x, low, high)).max() < 1e-15
        best = optimize.lsq_linear(A, b, (low, high), tol=1e-12).cost
        assert 0.5 * np.sum((A @ x - b) ** 2) == pytest.approx(best, rel=SMALLER)

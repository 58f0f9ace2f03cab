# SPDX-License-Identifier: Apache-2.0
"""The regressor of the trajectory search, against MuJoCo's inverse dynamics."""

from __future__ import annotations

import numpy as np
import pytest
from simulation_arms import simulated

from inverse_dynamics.excitation.information import base_count, condition_number, engine_of


# How many combinations of inertial parameters have an influence: with gravity along the first axis 36 for a UR10,
# 43 for a Panda [Gaz et al. 2019]; two more where gravity is tilted.
@pytest.mark.parametrize(
    ("name", "gravity", "count"),
    [
        ("ur10", (0, 0, -9.81), 36),
        ("ur10", (0, 3, -9), 38),
        ("panda", (0, 0, -9.81), 43),
    ],
)
def test_base_parameters_are_as_many_as_published(
    name: str, gravity: tuple[float, float, float], count: int
) -> None:
    engine = engine_of(simulated(name, gravity=gravity))
    assert base_count(engine) == count


def test_condition_number_is_the_ratio_of_singular_values() -> None:
    Y = np.random.default_rng(3).normal(size=(50, 2, 6))
    values = np.linalg.svd(Y.reshape(100, 6), compute_uv=False)
    assert condition_number(Y, 6) == pytest.approx(values[0] / values[-1], rel=1e-12)
    Y[:, :, 5] = Y[:, :, 2]
    assert condition_number(Y, 6) > 1e6
    values = np.linalg.svd(Y.reshape(100, 6), compute_uv=False)
    assert condition_number(Y, 5) == pytest.approx(values[0] / values[4], rel=1e-12)


@pytest.mark.parametrize("name", ["ur10", "panda"])
def test_condition_number_does_not_depend_on_rounding_or_on_the_order_of_columns(name: str) -> None:
    engine = engine_of(simulated(name))
    random = np.random.default_rng(4)
    Y = engine.regressor(*random.normal(size=(3, 100, len(engine.joint_names))))
    count = base_count(engine)
    condition = condition_number(Y, count)
    for _ in range(10):
        rounded = Y * (1 + 1e-15 * random.normal(size=Y.shape))
        shuffled = random.permutation(Y.shape[2])
        assert condition_number(rounded, count) == pytest.approx(condition, rel=1e-9)
        assert condition_number(rounded[:, :, shuffled], count) == pytest.approx(
            condition, rel=1e-9
        )

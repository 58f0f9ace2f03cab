# SPDX-License-Identifier: Apache-2.0
"""The regressor of the trajectory search, against MuJoCo's inverse dynamics."""

from __future__ import annotations

import numpy as np
import pytest
from simulation_arms import joint, link, robot, simulated

from inverse_dynamics.excitation.information import base_count, condition_number, engine_of
from inverse_dynamics.simulation.model import Payload, SimulatedRobot

MIXED = robot(
    link("base", 3.0),
    link("carriage", 2.0, "0.1 0.2 0.3"),
    link("arm", 1.0, "0.3 -0.1 0.2"),
    link("slide", 0.5, "0 0.1 -0.2"),
    link("tool", 0.2, "0.1 0 0"),
    joint("rail", "base", "carriage", kind="prismatic", axis="0.6 0 0.8", rpy="0.2 0.4 -1"),
    joint("turn", "carriage", "arm", axis="0 1 0", xyz="0.1 0.2 0.3", rpy="1 -0.5 0.7"),
    joint("reach", "arm", "slide", kind="prismatic", axis="1 0 0", xyz="0.3 0 0.1"),
    joint("flange", "slide", "tool", kind="fixed", xyz="0.2 0 0", rpy="0.3 0.2 0.1"),
)


def arms() -> dict[str, SimulatedRobot]:
    tilted = (1.0, -2.0, -9.0)
    return {
        "ur10": simulated("ur10", gravity=tilted),
        "panda": simulated("panda", gravity=tilted, payload=Payload(2.0, (0.1, -0.05, 0.2))),
        "prismatic joints": SimulatedRobot.from_urdf(MIXED, gravity=tilted),
    }


@pytest.mark.parametrize("name", arms())
def test_regressor_times_parameters_are_the_torques(name: str) -> None:
    arm = arms()[name]
    q, qd, qdd = np.random.default_rng(1).normal(size=(3, 100, len(arm.chain.joint_names)))
    tau = arm.torques(q, qd, qdd)
    engine = engine_of(arm)
    # rounding: torques of up to 1e3 N m
    np.testing.assert_allclose(
        engine.regressor(q, qd, qdd) @ engine.parameters, tau, rtol=0, atol=1e-10
    )


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

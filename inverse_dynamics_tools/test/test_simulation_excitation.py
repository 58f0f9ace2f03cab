# SPDX-License-Identifier: Apache-2.0
"""The search for exciting trajectories."""

from __future__ import annotations

import numpy as np
import pytest
from simulation_arms import CHAINS, pendulum, robots_package, simulated, two_links

from inverse_dynamics.simulation import excitation
from inverse_dynamics.simulation.collision import ContactChecker
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.evolution import minimise
from inverse_dynamics.simulation.excitation import condition_of, optimise_excitation
from inverse_dynamics.simulation.limits import MotionLimits, check_trajectory
from inverse_dynamics.simulation.model import Payload, SimulatedRobot
from inverse_dynamics.simulation.trajectory import FourierTrajectory
from inverse_dynamics.simulation.trajectory_file import read_trajectory


def ellipsoid(x: np.ndarray) -> float:
    """Least at (1, 2, ..., m), a thousand times steeper along the last axis than along the first."""
    size = len(x)
    return float(
        np.sum(10 ** (3 * np.arange(size) / (size - 1)) * (x - np.arange(1, size + 1)) ** 2)
    )


def test_minimum_of_an_ellipsoid_is_found() -> None:
    best = minimise(ellipsoid, np.zeros(8), step=1.0, evaluations=6000, seed=0)
    np.testing.assert_allclose(best, np.arange(1, 9), atol=1e-4)


def test_the_seed_decides_the_search() -> None:
    runs = [
        minimise(ellipsoid, np.zeros(4), step=1.0, evaluations=200, seed=seed) for seed in (1, 1, 2)
    ]
    np.testing.assert_array_equal(runs[0], runs[1])
    assert np.abs(runs[0] - runs[2]).max() > 1e-6


def test_progress_ends_at_the_number_of_evaluations() -> None:
    seen: list[tuple[str, int, int]] = []
    minimise(
        ellipsoid,
        np.zeros(4),
        step=1.0,
        evaluations=100,
        seed=0,
        progress=lambda *a: seen.append(a),
    )
    assert seen[-1] == ("optimising", 100, 100)


@pytest.mark.parametrize("name", ["ur10", "panda"])
def test_found_trajectory_is_allowed_at_rest_at_both_ends_and_better_than_the_start(
    name: str,
) -> None:
    robot = simulated(name)
    short = optimise_excitation(robot, seed=1, evaluations=20)
    longer = optimise_excitation(robot, seed=1, evaluations=400)
    assert longer.condition_number < 0.8 * short.condition_number
    assert longer.condition_number < 100
    trajectory = longer.trajectory
    check_trajectory(robot, trajectory, MotionLimits.of(robot), ContactChecker(robot))
    for derivative in trajectory.at(np.array([0.0, trajectory.period]))[1:]:
        np.testing.assert_allclose(derivative, 0.0, atol=1e-9)


def test_same_seed_same_trajectory() -> None:
    robot = SimulatedRobot.from_urdf(two_links(), tip="tip")
    found = [
        optimise_excitation(robot, seed=seed, evaluations=60, harmonics=3) for seed in (0, 0, 1)
    ]
    np.testing.assert_array_equal(found[0].trajectory.sine, found[1].trajectory.sine)
    assert np.abs(found[0].trajectory.sine - found[2].trajectory.sine).max() > 1e-3


def test_condition_grows_where_a_joint_rests() -> None:
    robot = SimulatedRobot.from_urdf(two_links(), tip="tip")
    good = optimise_excitation(robot, evaluations=60, harmonics=3).trajectory
    resting = FourierTrajectory(
        good.joint_names,
        good.period,
        good.center,
        good.sine * [[1.0], [1e-3], [1.0]],
        good.cosine * [[1.0], [1e-3], [1.0]],
    )
    assert condition_of(robot, resting) > 10 * condition_of(robot, good)


@pytest.mark.parametrize("name", CHAINS)
def test_stored_trajectory_is_twice_as_good_as_the_best_of_a_hundred_random_ones(name: str) -> None:
    robot = simulated(name)
    stored, _ = read_trajectory(
        robots_package() / f"trajectories/{name}.yaml", robot.chain.joint_names
    )
    assert isinstance(stored, FourierTrajectory)
    limits = MotionLimits.of(robot, excitation.TIME_TO_FULL_SPEED).fraction(excitation.MARGIN)
    family = excitation._Family(stored.joint_names, limits, stored.period, stored.sine.shape[1])
    starts = 0.3 * np.random.default_rng(0).normal(size=(100, family.size))
    random = [condition_of(robot, family.member(start)) for start in starts]
    assert 2 * condition_of(robot, stored) < min(random)


def test_search_needs_limits() -> None:
    robot = SimulatedRobot.from_urdf(pendulum(limit='<limit lower="-1" upper="1" effort="9"/>'))
    with pytest.raises(
        SimulationError, match="joint swing: the search needs a velocity limit, got inf"
    ):
        optimise_excitation(robot, evaluations=20)


def test_search_that_finds_nothing_says_why() -> None:
    robot = SimulatedRobot.from_urdf(two_links(), tip="tip", payload=Payload(1000.0))
    with pytest.raises(SimulationError, match=r"no exciting trajectory was found .* effort"):
        optimise_excitation(robot, evaluations=20, harmonics=3)

# SPDX-License-Identifier: Apache-2.0
"""Simulated recordings against the solvers: MuJoCo shares no code with them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from inverse_dynamics.evaluation.evaluation import evaluate
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import load_robot
from inverse_dynamics.robots.solvers import open_solver
from inverse_dynamics.simulation import MOUNTS, simulate, write_run

ROBOTS = ("ur10_simulated", "panda_simulated")
PLUGINS = (
    "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL",
    "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody",
)


@pytest.fixture(scope="module", params=ROBOTS)
def recording(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A simulated recording as the demo makes it."""
    out = tmp_path_factory.mktemp("recordings") / request.param
    write_run(simulate(load_robot(request.param)), out)
    return out


@pytest.mark.parametrize("plugin", PLUGINS)
def test_torques_at_the_simulators_accelerations_are_its_efforts(
    recording: Path, plugin: str
) -> None:
    robot = load_robot(recording.name)
    solver = open_solver(replace(robot, plugin=plugin), read_description(robot.urdf))
    truth = np.load(recording / "truth.npz")
    assert tuple(truth["joint_names"]) == tuple(solver.joint_names)
    computed = solver.torques(truth["q"], truth["qd"], truth["qdd"])
    np.testing.assert_allclose(computed, truth["effort"], rtol=0, atol=1e-6)


@pytest.mark.parametrize("plugin", PLUGINS)
def test_default_evaluation_is_within_one_percent_of_each_torque_range(
    recording: Path, plugin: str
) -> None:
    evaluation = evaluate(recording, recording.name, plugin=plugin)
    for error in evaluation.errors:
        assert error.nrmse < 0.01, error


def test_what_is_left_where_nothing_is_estimated_is_said_by_joint() -> None:
    robot = load_robot("ur10_simulated")
    run = simulate(robot, joint_friction=0.02, duration=1.0)
    solver = open_solver(robot, read_description(robot.urdf))
    assert run.differences_from(solver).max() < 1e-6
    off = run.motion.effort.copy()
    off[7, 2] -= 3.0
    spoiled = replace(run, motion=replace(run.motion, effort=off))
    left = spoiled.differences_from(solver)
    assert left[2] == pytest.approx(3.0, abs=1e-6)
    assert np.delete(left, 2).max() < 1e-6


def test_other_gravity_is_evaluated_with_the_same_gravity(tmp_path: Path) -> None:
    robot = load_robot("ur10_simulated")
    write_run(simulate(robot, gravity=MOUNTS["wall"], duration=5.0, rate=500), tmp_path / "wall")
    right = evaluate(tmp_path / "wall", robot, plugin=PLUGINS[1], gravity=MOUNTS["wall"])
    wrong = evaluate(tmp_path / "wall", robot, plugin=PLUGINS[1])
    assert right.mean_rmse < 0.01 * wrong.mean_rmse

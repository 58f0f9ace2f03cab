# SPDX-License-Identifier: Apache-2.0
"""A solver by the name of a robot, its configuration, its description, a short name of a plugin."""

import re
from dataclasses import replace

import numpy as np
import pytest

from inverse_dynamics import Solver, load_robot
from inverse_dynamics.errors import UserError
from inverse_dynamics.robots.robot_files import write_robot

STATE = np.random.default_rng(5).uniform(-1, 1, (3, 6))
RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"


def torques(solver):
    return solver.torques(*STATE)


@pytest.fixture(scope="module")
def simulated():
    robot = load_robot("ur10_simulated")
    text = robot.urdf.read_text()
    return torques(Solver(robot.plugin, urdf=text, root=robot.root, tip=robot.tip))


def test_a_robot_by_name_by_configuration_by_file(tmp_path, simulated):
    robot = load_robot("ur10_simulated")
    file = tmp_path / "arm.yaml"
    write_robot(robot, file)
    for named in ("ur10_simulated", robot, file, str(file)):
        np.testing.assert_allclose(torques(Solver(named)), simulated, rtol=1e-10)
    np.testing.assert_allclose(torques(robot.solver()), simulated, rtol=1e-10)


def test_an_identified_robot_has_its_own_model():
    plugin = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"
    np.testing.assert_array_equal(torques(Solver("ur10_real")), torques(Solver(plugin)))
    without = Solver("ur10_real", friction=False)
    np.testing.assert_array_equal(torques(without), torques(Solver(plugin, friction=False)))


def test_a_description_alone_is_rigid_bodies(simulated):
    robot = load_robot("ur10_simulated")
    solver = Solver(urdf=robot.urdf, root=robot.root, tip=robot.tip)
    np.testing.assert_allclose(torques(solver), simulated, rtol=1e-10)
    assert RIGID_BODY in repr(solver)


def test_what_is_given_takes_precedence(simulated):
    turned = Solver("ur10_simulated", gravity=[0, 0, 9.81])
    changed = replace(load_robot("ur10_simulated"), gravity=(0.0, 0.0, 9.81))
    np.testing.assert_array_equal(torques(turned), torques(Solver(changed)))
    assert not np.allclose(torques(turned), simulated)


@pytest.mark.parametrize(
    ("short", "package"), [("kdl", "kdl"), ("rigid_body", "rigid_body"), ("ur10", "ur10")]
)
def test_plugins_have_short_names(short, package):
    urdf = load_robot("ur10_simulated").urdf
    solver = (
        Solver(short, urdf=urdf, root="base_link", tip="tool0")
        if short != "ur10"
        else Solver(short)
    )
    assert f"<Solver {package}_inverse_dynamics_solver/" in repr(solver)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("ur10_reel",), "did you mean ur10_real?"),
        (("no/Such",), "'no/Such': not found"),
        (("arm.yaml",), "arm.yaml: no such file"),
        ((), "Solver: expected a robot, a plugin, urdf= or model=, got none"),
    ],
)
def test_what_names_no_solver_is_said(arguments, expected):
    with pytest.raises(UserError, match=re.escape(expected)):
        Solver(*arguments)

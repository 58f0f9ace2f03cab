# SPDX-License-Identifier: Apache-2.0
"""Simulated robots that are what a model says: its links, rotor inertias and friction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from example_robots import RIGID_BODY
from identified_arms import arm, identification
from simulation_arms import joint, link, pendulum, robot, robots_package, write_robot

from inverse_dynamics import Solver, load_robot
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.robots.robots import Robot
from inverse_dynamics.robots.solvers import open_solver
from inverse_dynamics.simulation import Payload, SimulationError, simulate
from inverse_dynamics.simulation.modelled import ModelFriction
from inverse_dynamics.simulation.trajectory import WaypointTrajectory, read_trajectory

LOAD = Payload(4.0, (0.02, 0.0, 0.1))
# of the torques, up to 300 N m: moments about principal axes are rounded
ROUNDING = 1e-8


@pytest.fixture(scope="module")
def identified(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """The run configuration of a UR10 with other masses, rotor inertia, and friction that grows with load."""
    model = arm()
    friction = tuple(
        {**figures, "fl": 0.02, "fs": 1.0, "vs": 0.2, "shift": 0.01} for figures in model.friction
    )
    return _written(friction, tmp_path_factory.mktemp("arm"))


def _written(friction: tuple[dict[str, float], ...], directory: Path) -> Robot:
    found = identification(model=replace(arm(), friction=friction))
    return load_robot(write_identification(found, directory / "arm.yaml").robot)


def motion_of(robot: Robot, **options: object) -> object:
    trajectory = robots_package() / "trajectories/ur10.yaml"
    return simulate(robot, trajectory=trajectory, rate=500, duration=2.0, **options).motion


@pytest.mark.parametrize("payload", [None, LOAD])
def test_effort_is_what_the_model_computes(identified: Robot, payload: Payload | None) -> None:
    motion = motion_of(identified, from_model=True, payload=payload)
    solver = Solver(RIGID_BODY, model=str(identified.model))
    if payload is not None:
        solver.set_payload("load", payload.mass, payload.center)
    computed = solver.torques(motion.q, motion.qd, motion.qdd)
    np.testing.assert_allclose(motion.effort, computed, rtol=ROUNDING, atol=300 * ROUNDING)
    friction = solver.friction_vector(motion.qd, q=motion.q)
    np.testing.assert_allclose(motion.friction, friction, atol=300 * ROUNDING)
    assert np.abs(motion.q - motion.q_desired).max() < 5e-3


def test_friction_remembers_the_simulated_motion(tmp_path: Path) -> None:
    remembering = tuple({**figures, "fm": 8.0, "distance": 0.05} for figures in arm().friction)
    robot = _written(remembering, tmp_path)
    motion = motion_of(robot, from_model=True)
    solver = Solver(RIGID_BODY, model=str(robot.model))
    limit = solver.friction_vector(motion.qd, q=motion.q)
    remembered = solver.friction_state().along(motion.q, motion.qd)
    assert np.abs(remembered).max() > 1.0  # N m
    # the simulated motion may turn round between two samples
    np.testing.assert_allclose(motion.friction, limit + remembered, atol=0.02)


def test_what_a_solver_carries_and_its_gravity_are_simulated() -> None:
    solver = Solver("ur10_simulated")
    turn = np.array([[0, 0, 1, 0.1], [1, 0, 0, 0], [0, 1, 0, 0.05], [0, 0, 0, 1.0]])
    body = {"center_of_mass": [0.02, 0.0, 0.1], "inertia": [0.05, 0.01, 0.0, 0.04, 0.0, 0.03]}
    solver.set_payload("tool", 2.0, **body)
    solver.set_payload("part", 3.0, **body, frame=turn)
    solver.set_gravity([0.0, 6.0, -7.0])
    motion = motion_of(solver)
    computed = solver.torques(motion.q, motion.qd, motion.qdd)
    np.testing.assert_allclose(motion.effort, computed, rtol=ROUNDING, atol=300 * ROUNDING)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_held_joints_are_simulated_where_they_are(tmp_path: Path, kind: str) -> None:
    upright = "0.4 1.5707963267948966 0.2"  # where angles aren't unique
    urdf = robot(
        *(link("base"), link("arm", 2.0, "0.2 0 0"), link("upper", 1.5, "0 0.1 0.3")),
        link("hand", 1.0, "0.3 0 0"),
        joint("swing", "base", "arm"),
        joint("bend", "arm", "upper", kind, "0.1 0.2 0.3", "1 2 -0.5", rpy=upright),
        joint("turn", "upper", "hand", xyz="0 0 0.4"),
    )
    held = load_robot(write_robot(tmp_path, urdf, "parameters: {locked_joints: {bend: 0.3}}\n"))
    ways = np.array([[0.0, 0.0], [0.5, -0.5], [0.0, 0.0]])
    motion = WaypointTrajectory.through(("swing", "turn"), np.arange(3.0), ways)
    followed = simulate(held, trajectory=motion, rate=500, table=False).motion
    computed = Solver(held).torques(followed.q, followed.qd, followed.qdd)
    np.testing.assert_allclose(followed.effort, computed, rtol=ROUNDING, atol=1e-6)
    assert np.abs(computed).max() > 10.0


def test_links_of_the_description_may_have_the_friction_of_any_solver() -> None:
    robot = load_robot("ur10_real")
    motion = motion_of(robot, joint_friction="model")
    friction = open_solver(robot, "").friction_vector(motion.qd, q=motion.q)
    np.testing.assert_allclose(motion.friction, friction, atol=1e-9)
    assert np.abs(motion.friction).max() > 10
    # rest of the torques: the description's links
    links = load_robot("ur10_simulated")
    computed = open_solver(links, links.urdf.read_text()).torques(motion.q, motion.qd, motion.qdd)
    np.testing.assert_allclose(motion.effort - friction, computed, atol=300 * ROUNDING)


def test_the_line_of_friction_is_exact_where_it_is_and_never_falls(identified: Robot) -> None:
    solver = Solver(RIGID_BODY, model=str(identified.model))
    friction = ModelFriction.of(solver)
    q = np.zeros(6)
    for qd in np.random.default_rng(0).uniform(-1, 1, (50, 6)):
        slope, at_rest = friction.line(qd, q)
        assert (slope >= 0).all()
        np.testing.assert_allclose(at_rest + slope * qd, friction.torques(qd, q), atol=1e-12)
    # at the step, where it is steep: not the average of both sides
    slope, _ = friction.line(np.full(6, -0.01), q)
    figures = arm().friction[0]
    assert slope[0] == pytest.approx(figures["fv"] + figures["fc"] / figures["width"], rel=0.5)


def test_a_simulation_states_what_it_was_made_of(identified: Robot) -> None:
    trajectory, _ = read_trajectory(robots_package() / "trajectories/ur10.yaml", identified.joints)
    made = simulate(identified, trajectory=trajectory, rate=125, duration=0.1, from_model=True)
    assert made.settings["links"] == "arm_model.yaml"
    assert made.settings["joint_friction"] == {"model": "arm_model.yaml"}
    # what is written doesn't depend on where files are
    assert str(identified.model.parent) not in yaml.safe_dump(made.settings)
    assert yaml.safe_load(yaml.safe_dump(made.settings)) == made.settings


def changed(identified: Robot, directory: Path, old: str, new: str) -> Robot:
    text = identified.model.read_text()
    assert old in text
    file = directory / "model.yaml"
    before, _, _ = text.replace(old, new).partition("checks:")
    file.write_text(before)
    return replace(identified, model=file)


def test_models_that_mujoco_cannot_hold_are_refused(identified: Robot, tmp_path: Path) -> None:
    no_model = replace(identified, model=None)
    with pytest.raises(SimulationError, match="model: expected a model file"):
        simulate(no_model, from_model=True)
    other_joints = changed(identified, tmp_path, "elbow_joint", "knee_joint")
    with pytest.raises(SimulationError, match="expected the joints of the description"):
        simulate(other_joints, from_model=True)
    elsewhere = changed(identified, tmp_path, "0.612", "0.65")
    with pytest.raises(SimulationError, match="expected a model with the joints' places"):
        simulate(elsewhere, from_model=True, payload=LOAD)
    published = replace(
        load_robot("panda_real"), model=robots_package() / "models/franka_inria_identified.yaml"
    )
    published = replace(published, plugin=RIGID_BODY)
    with pytest.raises(
        SimulationError, match="link fer_link1: expected inertia that a body can have"
    ):
        simulate(published, from_model=True)


def test_friction_that_a_solver_lacks_is_refused(tmp_path: Path) -> None:
    bare = load_robot(write_robot(tmp_path, pendulum()))
    with pytest.raises(SimulationError, match="joint friction: expected a solver with friction"):
        simulate(bare, joint_friction="model")

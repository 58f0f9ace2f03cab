# SPDX-License-Identifier: Apache-2.0
"""How far predicted torques are uncertain after a motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import two_arms
from simulation_arms import simulated, two_links

from inverse_dynamics import Solver
from inverse_dynamics.excitation import excitation as search
from inverse_dynamics.excitation.excitation import ExcitationOptions
from inverse_dynamics.excitation.excitation_motion import MotionFamily
from inverse_dynamics.excitation.information import (
    CORRELATION,
    OWN,
    STEP_WIDTH,
    Unknowns,
    _prior_scale,
    _pseudo_inertia,
)
from inverse_dynamics.robots.link_parameters import turned
from inverse_dynamics.simulation.collision import ContactChecker
from inverse_dynamics.simulation.model import SimulatedRobot


def unknowns_of(name: str = "ur10") -> Unknowns:
    robot = simulated(name)
    return ExcitationOptions().unknowns(robot)


def test_rows_times_parameters_are_the_torques_and_friction() -> None:
    robot = simulated("panda")
    unknowns = ExcitationOptions().unknowns(robot)
    states = unknowns.random_states(50)
    Z, tau = unknowns.rows_and_torques(*states)
    np.testing.assert_allclose(tau, robot.torques(*states), rtol=0, atol=1e-9)
    b = np.zeros(Z.shape[2])
    b[:70] = unknowns.model.parameters
    np.testing.assert_allclose(Z @ b, tau, rtol=0, atol=1e-9)
    rotor, viscous, step, offset, load = 0.3, 2.0, 1.5, -0.4, 0.1
    b[:70] = 0.0
    b[70 + 3 * OWN : 70 + 3 * OWN + 5] = rotor, viscous, step, offset, load
    qd, qdd = states.qd[:, 3], states.qdd[:, 3]
    tanh = np.tanh(qd / (STEP_WIDTH * unknowns.limits.velocity[3]))
    gravity = robot.torques(states.q, 0 * states.q, 0 * states.q)[:, 3]
    expected = rotor * qdd + viscous * qd + (step + load * np.abs(gravity)) * tanh + offset
    np.testing.assert_allclose((Z @ b)[:, 3], expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(np.delete(Z @ b, 3, axis=1), 0.0)


def test_deviation_is_that_of_estimates_from_simulated_noise() -> None:
    """Draw parameters from the prior, measure with noise, estimate, predict: the errors' deviation."""
    unknowns = unknowns_of()
    motion, tested = unknowns.random_states(40, seed=3), unknowns.random_states(30, seed=4)
    Z, Z_tested = unknowns.rows(*motion), unknowns.rows(*tested)
    gram = unknowns.gram(*motion, CORRELATION)
    V = unknowns.covariance(gram)
    random = np.random.default_rng(0)
    errors = []
    for _ in range(400):
        b = unknowns.scale @ random.standard_normal(len(V))
        measured = Z @ b + unknowns.noise * random.standard_normal(Z.shape[:2])
        estimate = V @ np.einsum("kjm,kj->m", Z, measured / unknowns.noise**2)
        errors.append(Z_tested @ (estimate - b))
    found = np.std(errors, axis=0).mean(axis=0)
    # 400 draws: 4 % of a standard deviation, averaged over 30 states
    np.testing.assert_allclose(found, unknowns.deviations(gram, tested), rtol=0.05)


def test_more_samples_in_the_same_time_tell_no_more() -> None:
    unknowns = unknowns_of()
    states = unknowns.random_states(20)
    doubled = [np.repeat(values, 2, axis=0) for values in states]
    np.testing.assert_allclose(
        unknowns.gram(*doubled, 0.05), unknowns.gram(*states, 0.1), rtol=1e-12, atol=1e-9
    )
    np.testing.assert_allclose(
        unknowns.gram(*states, 10.0), unknowns.gram(*states, CORRELATION), rtol=1e-12
    )


def test_no_information_leaves_the_prior_and_more_never_hurts() -> None:
    unknowns = unknowns_of()
    tested = unknowns.random_states(100)
    prior = unknowns.deviations(None, tested)
    np.testing.assert_allclose(
        unknowns.deviations(np.zeros_like(unknowns.scale), tested), prior, rtol=1e-9
    )
    gram = unknowns.gram(*unknowns.random_states(5, seed=1), 0.1)
    one, two = (unknowns.deviations(k * gram, tested) for k in (1, 2))
    assert (one < prior).all()
    assert (two < one).all()


def test_payload_rows_are_those_of_the_last_link() -> None:
    robot = simulated("ur10")
    arm, payload = (ExcitationOptions(payload=load).unknowns(robot) for load in (False, True))
    states = arm.random_states(10)
    np.testing.assert_array_equal(payload.rows(*states)[:, :, :10], arm.rows(*states)[:, :, 50:60])
    np.testing.assert_array_equal(payload.predicted[10:], 0.0)


@pytest.mark.parametrize(
    "link",
    [
        np.array([2.0, 0.2, -0.1, 0.3, 0.3, 0.01, 0.02, 0.4, -0.01, 0.35]),
        np.array(
            [2.0, 0.2, -0.1, 0.3, 0.08, 0.01, -0.03, 0.09, 0.015, 0.03]
        ),  # impossible: a thin shell
        np.zeros(10),
    ],
)
def test_prior_of_a_link_does_not_depend_on_its_frame(link: np.ndarray) -> None:
    """The density of the prior at turned parameters is that at the parameters themselves."""
    angle = 0.7
    R = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]]
    )
    here, there = (_prior_scale(_pseudo_inertia(p, 20.0)) for p in (link, turned(link, R)))
    change = 1e-3 * np.random.default_rng(0).standard_normal(10)
    lengths = [
        np.linalg.norm(np.linalg.solve(scale, p))
        for scale, p in ((here, change), (there, turned(change, R)))
    ]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-6)


def test_prior_knows_the_size_of_a_link_to_one_half() -> None:
    link = np.array([2.0, 0.2, -0.1, 0.3, 0.3, 0.01, 0.02, 0.4, -0.01, 0.35])
    scale = _prior_scale(_pseudo_inertia(link, 20.0))
    # gamma [tr(P0^-1 P) - log det P] of P = (1 + e) P0 has the second derivative 4 gamma, gamma = 2
    assert np.linalg.norm(np.linalg.solve(scale, link)) == pytest.approx(2.0, rel=1e-9)


@pytest.mark.parametrize("payload", [False, True])
def test_gradient_of_the_cost_is_that_of_finite_differences(payload: bool) -> None:
    robot = SimulatedRobot.from_urdf(two_links(height=0.3), tip="tip")
    options = ExcitationOptions(duration=8.0, payload=payload)
    unknowns = options.unknowns(robot)
    limits = unknowns.limits
    moving = np.array([not payload, True, True])
    family = MotionFamily.of(
        robot.chain.joint_names, limits, duration=8.0, slow=0.0 if payload else 3.0, moving=moving
    )
    tight = replace(limits, effort=0.1 * limits.effort)  # so that every penalty counts
    unknowns = replace(unknowns, limits=tight)
    judge = search._Judge(unknowns, family, ContactChecker(robot, clearance=0.2), None)
    random = np.random.default_rng(1)
    x = 0.6 * random.standard_normal(family.size)
    value, gradient = judge.cost(x)
    assert value == judge.cost(x)[0]
    for _ in range(3):
        d = random.standard_normal(family.size)
        step = 1e-5
        slope = (judge.cost(x + step * d)[0] - judge.cost(x - step * d)[0]) / (2 * step)
        assert gradient @ d == pytest.approx(slope, rel=5e-3)


def test_family_begins_and_ends_in_one_pose_and_rests_between_its_parts() -> None:
    robot = simulated("ur10")
    limits = ExcitationOptions().limits(robot)
    family = MotionFamily.of(
        robot.chain.joint_names, limits, duration=20.0, slow=4.0, moving=np.ones(6, dtype=bool)
    )
    x = np.random.default_rng(0).standard_normal(family.size)
    trajectory = family.member(x)
    q, qd, qdd = trajectory.at(np.array([0.0, 2.0, 10.0, 12.0, 20.0]))
    np.testing.assert_allclose(q[0], q[4])
    np.testing.assert_allclose(q[2], q[3])
    np.testing.assert_allclose(qd, 0.0, atol=1e-9)  # of accelerations of 1e2 on the other side
    np.testing.assert_allclose(qdd, 0.0, atol=1e-9)
    for start in (0.0, 10.0):
        slow = np.abs(trajectory.at(np.linspace(start, start + 2.0, 500))[1]).max(axis=0)
        np.testing.assert_allclose(slow, 0.05 * limits.velocity, rtol=0.01)
    basis = family.basis(np.linspace(0.0, 20.0, 77))
    for given, expected in zip(
        family.states(x, basis), trajectory.at(np.linspace(0.0, 20.0, 77)), strict=True
    ):
        np.testing.assert_allclose(given, expected, atol=1e-9)


def test_unknowns_of_a_tree_are_those_of_all_its_links() -> None:
    robot = SimulatedRobot.from_urdf(two_arms.URDF, tip="*")
    unknowns = ExcitationOptions().unknowns(robot)
    states = unknowns.random_states(20)
    Z, tau = unknowns.rows_and_torques(*states)
    assert Z.shape == (20, 9, 10 * 10 + OWN * 9)
    np.testing.assert_allclose(tau, robot.torques(*states), rtol=0, atol=1e-9)
    np.testing.assert_allclose(Z[:, :, :100] @ unknowns.model.parameters, tau, rtol=0, atol=1e-9)


@pytest.mark.parametrize("tip", [*two_arms.ARMS, "left_other_finger"])
def test_a_payload_of_a_tree_is_at_its_first_tip(tip: str) -> None:
    fingers = ("left_finger",) if tip == "left_other_finger" else ()  # which the other one follows
    tips = list(dict.fromkeys((tip, *fingers, *two_arms.ARMS)))
    robot = SimulatedRobot.from_urdf(two_arms.URDF, tip=",".join(tips))
    unknowns = ExcitationOptions(payload=True).unknowns(robot)
    states = unknowns.random_states(5)
    solver = Solver(urdf=two_arms.URDF, tip=tips)
    bare = solver.torques(*states)
    solver.set_payload("load", 1.0, [0.1, 0.0, 0.2], inertia=0.01 * np.eye(3))
    Z = unknowns.rows(*states)[:, :, :10]
    load = np.linalg.lstsq(Z.reshape(-1, 10), (solver.torques(*states) - bare).ravel())[0]
    np.testing.assert_allclose(Z @ load, solver.torques(*states) - bare, rtol=0, atol=1e-9)
    assert load[0] == pytest.approx(1.0)
    wrist = [robot.chain.joint_names[j] for j in search._wrist(robot.chain)]
    side = tip.partition("_")[0]
    last = ["left_finger_joint"] if tip.endswith("finger") else []
    expected = [*last, f"{side}_hand_joint", f"{side}_elbow_joint", f"{side}_shoulder_joint"]
    assert wrist == expected[:3]

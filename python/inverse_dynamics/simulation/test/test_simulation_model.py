# SPDX-License-Identifier: Apache-2.0
"""The simulated robot has exactly the dynamics its URDF states."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
import two_arms
from simulation_arms import (
    CHAINS,
    joint,
    link,
    pendulum,
    robot,
    robots_package,
    simulated,
    two_links,
)

from inverse_dynamics import FastModel, Solver
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.model import JointFriction, Payload, SimulatedRobot
from inverse_dynamics.simulation.modelled import carried_by
from inverse_dynamics.simulation.physics import drive
from inverse_dynamics.simulation.urdf import with_held_joints

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats

G = 9.81
ZERO = np.zeros((1, 1))


@pytest.mark.parametrize("name", CHAINS)
def test_dynamics_are_those_of_the_reference_states(name: str) -> None:
    # computed by another library from the vendor's URDF, given with 1e-16; the greatest torque is about 200 N m
    states = json.loads((robots_package() / f"reference/{name}_urdf.json").read_text())["states"]
    q, qd, qdd, tau = (
        np.array([state[key] for state in states]) for key in ("q", "qd", "qdd", "torques")
    )
    arm = simulated(name)
    np.testing.assert_allclose(arm.torques(q, qd, qdd), tau, rtol=0, atol=1e-11)
    for state in states:
        H = np.reshape(state["inertia"], (len(state["q"]),) * 2)
        np.testing.assert_allclose(arm.inertia_matrix(np.array(state["q"])), H, rtol=0, atol=1e-12)


def test_quaternions_turn_as_in_the_engine() -> None:
    urdf = (
        two_links()
        .replace('rpy="0 0 0"', "")
        .replace('<origin xyz="0.5 0 0"', '<origin xyz="0.5 0 0" quat_xyzw="0.5 0.4 -0.2 0.6"')
    )
    q, qd, qdd = np.random.default_rng(0).uniform(-2.0, 2.0, (3, 5, 3))
    torques = []
    for version in ("1.0", "1.1"):
        text = urdf.replace("<robot", f'<robot version="{version}"')
        torques.append(SimulatedRobot.from_urdf(text, tip="tip").torques(q, qd, qdd))
        engine = FastModel.from_urdf(text, tip="tip").torques(q, qd, qdd)
        np.testing.assert_allclose(torques[-1], engine, rtol=0, atol=1e-10)
    assert np.abs(torques[0] - torques[1]).max() > 1  # only version 1.1 has quaternions


def test_warnings_of_mujoco_are_notes(capfd: pytest.CaptureFixture[str]) -> None:
    limit = '<limit lower="0" upper="0" velocity="3" effort="50"/>'
    robot = SimulatedRobot.from_urdf(pendulum(limit=limit))
    assert "joint 'swing' has equal lower and upper limits" in robot.chain.notes[-1]
    assert capfd.readouterr() == ("", "")


def test_payload_is_a_point_mass_in_the_frame_of_the_tip() -> None:
    urdf = robot(
        link("base"),
        link("arm", 2.0, "0.5 0 0"),
        link("tip"),
        joint("swing", "base", "arm"),
        joint("end", "arm", "tip", kind="fixed", xyz="1 0 0", rpy="0 0 1.5707963267948966"),
    )
    # the tip's -y is the arm's x: 0.2 m further out
    arm = SimulatedRobot.from_urdf(urdf, payload=Payload(3.0, (0.0, -0.2, 0.0)))
    assert arm.torques(ZERO, ZERO, ZERO)[0, 0] == pytest.approx(-(2 * 0.5 + 3 * 1.2) * G, abs=1e-9)
    assert arm.inertia_matrix(np.zeros(1))[0, 0] == pytest.approx(0.52 + 3 * 1.2**2, abs=1e-9)


def test_gravity_is_a_vector_in_the_frame_of_the_root_link() -> None:
    urdf = robot(
        link("world"),
        link("base"),
        link("arm", 2.0, "0.5 0 0"),
        joint("mount", "world", "base", kind="fixed", rpy="0.3 -1.1 2.0"),
        joint("swing", "base", "arm"),
    )
    arm = SimulatedRobot.from_urdf(urdf, root="base")
    assert arm.torques(ZERO, ZERO, ZERO)[0, 0] == pytest.approx(-2 * G * 0.5, abs=1e-12)
    wall = SimulatedRobot.from_urdf(urdf, root="base", gravity=(-G, 0.0, 0.0))
    assert wall.torques(ZERO, ZERO, ZERO)[0, 0] == pytest.approx(0.0, abs=1e-12)
    up = wall.torques(ZERO - np.pi / 2, ZERO, ZERO)[0, 0]  # along z: falls towards -x
    assert up == pytest.approx(2 * G * 0.5, abs=1e-12)


def test_shapes_have_no_mass_of_their_own() -> None:
    shape = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    urdf = robot(
        link("base"),
        link("arm", 2.0, "0.5 0 0", shape),
        link("cover", shapes=shape),
        joint("swing", "base", "arm"),
        joint("fixed", "arm", "cover", kind="fixed"),
    )
    arm = SimulatedRobot.from_urdf(urdf)
    assert arm.torques(ZERO, ZERO, ZERO)[0, 0] == pytest.approx(-2 * G * 0.5, abs=1e-12)


def test_dynamics_element_does_nothing_by_itself() -> None:
    arm = SimulatedRobot.from_urdf(pendulum(inner='<dynamics damping="5" friction="7"/>'))
    assert arm.model.dof_damping[0] == 0
    assert arm.model.dof_frictionloss[0] == 0
    assert (arm.chain.damping[0], arm.chain.friction[0]) == (5, 7)


def test_friction_law_and_its_secant() -> None:
    law = JointFriction(np.array([3.0]), np.array([0.5]), slip=0.1)
    assert law.torques(np.array([10.0]))[0] == pytest.approx(3.0 + 5.0)
    assert law.torques(np.array([-0.1]))[0] == pytest.approx(-3.0 * np.tanh(1.0) - 0.05)
    for qd in (-2.0, -1e-3, 1e-12, 0.4):
        slope, at_rest = law.line(np.array([qd]), np.zeros(1))
        assert slope * qd == pytest.approx(law.torques(np.array([qd])), rel=1e-9)
        assert at_rest == pytest.approx(0.0, abs=1e-12)
    assert law.line(np.zeros(1), np.zeros(1))[0] == pytest.approx(3.0 / 0.1 + 0.5)


def test_limits_are_read_and_absent_ones_are_infinite() -> None:
    chain = simulated("ur10").chain
    assert chain.effort.tolist() == [330, 330, 150, 56, 56, 56]
    assert chain.upper[2] == pytest.approx(np.pi)
    turning = SimulatedRobot.from_urdf(pendulum(kind="continuous")).chain
    assert np.isinf(turning.upper[0])
    assert turning.velocity[0] == 2
    bare = SimulatedRobot.from_urdf(pendulum(kind="continuous", limit="")).chain
    assert np.isinf([bare.lower, bare.upper, bare.velocity, bare.effort]).all()


def test_joints_beside_the_chain_are_locked_and_said_so() -> None:
    urdf = robot(
        link("base"),
        link("arm", 2.0, "0.5 0 0"),
        link("finger", 1.0, "0.1 0 0"),
        joint("swing", "base", "arm"),
        joint("grip", "arm", "finger", kind="prismatic", xyz="1 0 0"),
    )
    arm = SimulatedRobot.from_urdf(urdf, tip="arm")
    assert arm.chain.joint_names == ("swing",)
    assert arm.chain.notes == ("joint grip is locked at zero",)
    assert arm.model.nv == 1
    assert arm.torques(ZERO, ZERO, ZERO)[0, 0] == pytest.approx(-(2 * 0.5 + 1.1) * G, abs=1e-12)


@pytest.mark.parametrize(
    ("urdf", "chain", "text"),
    [
        ("<robot", {}, "isn't a robot description: no XML"),
        ("<model/>", {}, "expected the element <robot>, got <model>"),
        (
            pendulum(),
            {"root": "bse"},
            "root: expected a link of the robot, got 'bse'; links: base, arm",
        ),
        (
            pendulum(kind="floating"),
            {},
            "expected revolute, continuous, prismatic or fixed, got floating",
        ),
        (
            two_links().replace("<axis", '<mimic joint="shoulder"/><axis', 1),
            {},
            "joint shoulder: <mimic>: expected a joint that follows another one",
        ),
        (
            robot(link("base"), link("arm"), joint("swing", "base", "arm")),
            {},
            "got no mass and no inertia; give link arm an <inertial>",
        ),
        (robot(link("a"), link("b")), {}, "expected one link that is no joint's child, got 2"),
        (
            pendulum(limit='<limit effort="a"/>'),
            {},
            "joint swing: <limit> effort: expected a finite number, got 'a'",
        ),
    ],
)
def test_descriptions_that_cannot_be_simulated(urdf: str, chain: dict[str, str], text: str) -> None:
    with pytest.raises(SimulationError) as error:
        SimulatedRobot.from_urdf(urdf, **chain)
    assert text in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("payload", "got"),
    [(Payload(-1.0), "-1"), (Payload(0.0, (0.0, 0.0, 0.1)), "0"), (Payload(np.nan), "nan")],
)
def test_payload_needs_a_mass(payload: Payload, got: str) -> None:
    text = rf"payload: expected a mass above zero \[kg\].*, got {got} kg at 0, 0, 0"
    with pytest.raises(SimulationError, match=text):
        SimulatedRobot.from_urdf(pendulum(), payload=payload)


def test_friction_needs_a_figure_per_joint() -> None:
    with pytest.raises(SimulationError, match="coulomb: expected 6 numbers"):
        simulated("ur10", friction=JointFriction(np.ones(5), np.ones(6)))
    with pytest.raises(SimulationError, match="viscous: expected 6 numbers"):
        simulated("ur10", friction=JointFriction(np.ones(6), -np.ones(6)))


def test_meshes_are_left_out() -> None:
    mesh = '<collision><geometry><mesh filename="package://none/arm.stl"/></geometry></collision>'
    urdf = pendulum().replace('<link name="arm">', f'<link name="arm">{mesh}')
    assert mesh in urdf
    assert "collision mesh" in SimulatedRobot.from_urdf(urdf).chain.notes[0]


def test_joints_that_mimic_follow_in_simulation_too() -> None:
    robot = SimulatedRobot.from_urdf(two_arms.URDF, tip="*")
    tree = Solver(urdf=two_arms.URDF, tip="*")
    q = np.zeros(9)

    def command(k: int, q: Floats, qd: Floats) -> Floats:
        return tree.torques(q, qd, np.array([0.3, 0, 0, 0, 0.2, 0, 0, 0, 0.4]) - 2 * qd)

    response = drive(robot, command, q, q, rate=500, ticks=500)
    np.testing.assert_allclose(
        response.effort[20:],  # first the springs that hold them swing
        tree.torques(response.q, response.qd, response.qdd)[20:],
        atol=1e-3,
    )
    assert response.q[-1, 8] > 0.05


def test_each_tip_carries_its_payloads() -> None:
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    tree.set_payload("first", 1.0, [0.0, 0.1, 0.0])
    tree.set_payload("other", 2.0, [0.0, 0.0, 0.2], tip="right_tool")
    tree.set_payload("more", 3.0, inertia=np.eye(3), tip="right_tool")
    found = carried_by(tree)
    assert [(body.mass, body.tip) for body in found] == [(1.0, ""), (5.0, "right_tool")]
    tip = ",".join(two_arms.ARMS)
    simulated = SimulatedRobot.from_urdf(two_arms.URDF, tip=tip, payload=found)
    states = two_arms.states(joints=len(tree.joint_names))
    np.testing.assert_allclose(simulated.torques(*states), tree.torques(*states), rtol=0, atol=1e-9)
    note = "joint left_other_finger_joint is locked at 0.1, as it mimics"
    assert note in simulated.chain.notes
    with pytest.raises(SimulationError, match="one of left_tool, right_tool, got left_finger"):
        SimulatedRobot.from_urdf(two_arms.URDF, tip=tip, payload=Payload(1.0, tip="left_finger"))


def test_joints_that_mimic_held_ones_are_held_with_them() -> None:
    held = {"left_finger_joint": -0.2}
    tip = ",".join(two_arms.ARMS)
    simulated = SimulatedRobot.from_urdf(with_held_joints(two_arms.URDF, held), tip=tip)
    parameters = {f"locked_joints.{name}": q for name, q in held.items()}
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS, parameters=parameters)
    states = two_arms.states(joints=len(tree.joint_names))
    np.testing.assert_allclose(simulated.torques(*states), tree.torques(*states), rtol=0, atol=1e-9)

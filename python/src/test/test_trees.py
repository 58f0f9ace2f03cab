# SPDX-License-Identifier: Apache-2.0
"""Solver on robots with several tips, against MuJoCo's own reading of the description, and differences."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from two_arms import JOINTS, TIPS, URDF, states

from inverse_dynamics import FastModel, Solver, load_robot
from inverse_dynamics.errors import InvalidParameterError, InvalidRobotDescriptionError, SolverError
from inverse_dynamics.simulation.model import SimulatedRobot

TREE = Solver(urdf=URDF, tip=TIPS)


@pytest.mark.parametrize("tip", [list(TIPS), ", ".join(TIPS), "*"])
def test_tips_are_a_list_names_with_commas_or_a_star(tip) -> None:
    tree = Solver(urdf=URDF, tip=tip)
    assert tree.joint_names == JOINTS
    assert set(tree.tip_names) == (set(TIPS) - {"left_tool"} if tip == "*" else set(TIPS))
    assert tree.tip == tree.tip_names[0]
    assert pickle.loads(pickle.dumps(tree)).tip_names == tree.tip_names


def test_a_list_of_one_tip_is_a_chain() -> None:
    chain = Solver(urdf=URDF, tip=["right_tool"])
    assert chain.tip_names == ("right_tool",)
    assert chain.tip == "right_tool"
    chain.set_payload("load", 2.0, tip="right_tool")
    wrench = np.arange(6.0)
    np.testing.assert_array_equal(
        chain.external_torques(np.zeros(5), wrench, tip="right_tool"),
        chain.external_torques(np.zeros(5), wrench),
    )
    assert chain.joint_names == ("lift_joint", "chest_joint", *JOINTS[1:4])


def test_torques_and_inertia_are_those_of_mujoco() -> None:
    simulated = SimulatedRobot.from_urdf(URDF, tip=",".join(TIPS))
    assert simulated.chain.joint_names == JOINTS
    q, qd, qdd = states()
    np.testing.assert_allclose(
        TREE.torques(q, qd, qdd), simulated.torques(q, qd, qdd), rtol=0, atol=1e-9
    )
    np.testing.assert_allclose(
        TREE.inertia_matrix(q[0]), simulated.inertia_matrix(q[0]), rtol=0, atol=1e-10
    )


def test_the_regressor_has_ten_columns_for_each_link() -> None:
    q, qd, qdd = states(2)
    assert TREE.regressor(q, qd, qdd).shape == (2, 9, 100)
    assert TREE.regressor(q[0], qd[0], qdd[0], out=np.zeros((9, 100))).shape == (9, 100)


@pytest.mark.parametrize("frame", [*TIPS, "chest_joint"])
def test_jacobians_are_derivatives_of_poses(frame: str) -> None:
    q, step = states(1)[0, 0], 1e-6
    J = TREE.jacobian(q, frame=frame)
    for j, unit in enumerate(np.eye(len(q))):
        ends = [TREE.pose(q + way * step * unit, frame=frame)[1] for way in (-1, 1)]
        np.testing.assert_allclose(J[:3, j], (ends[1] - ends[0]) / (2 * step), atol=1e-8)


def test_the_tip_of_methods_that_name_none_is_the_first() -> None:
    q, qd, qdd = states(1)[:, 0]
    np.testing.assert_allclose(TREE.jacobian(q), TREE.jacobian(q, frame=TIPS[0]), atol=1e-14)
    np.testing.assert_allclose(TREE.tip_pose(q)[1], TREE.pose(q, frame=TIPS[0])[1], atol=1e-14)
    wrench = np.arange(6.0)
    np.testing.assert_array_equal(
        TREE.external_torques(q, wrench), TREE.external_torques(q, wrench, tip=TIPS[0])
    )
    for tip in TIPS:
        torques = TREE.jacobian(q, frame=tip).T @ wrench
        np.testing.assert_allclose(TREE.external_torques(q, wrench, tip=tip), torques, atol=1e-12)
        np.testing.assert_allclose(
            TREE.torques(q, qd, qdd, wrench=wrench, tip=tip),
            TREE.torques(q, qd, qdd) + torques,
            atol=1e-12,
        )
        ends = [TREE.jacobian(q + way * 1e-6 * qd, frame=tip) for way in (-1, 1)]
        np.testing.assert_allclose(
            TREE.tip_jacobian_derivative(q, qd, tip=tip), (ends[1] - ends[0]) / 2e-6, atol=1e-7
        )


def test_a_payload_is_carried_by_the_tip_it_names() -> None:
    q = states(1)[0, 0]
    for tip in ("left_tool", "right_tool"):
        tree = Solver(urdf=URDF, tip=TIPS)
        tree.set_payload("load", 2.0, tip=tip)
        assert tree.payloads["load"]["tip"] == tip
        weight = np.array([0, 0, 2 * 9.81, 0, 0, 0])
        expected = TREE.gravity_vector(q) + TREE.external_torques(q, weight, tip=tip)
        np.testing.assert_allclose(tree.gravity_vector(q), expected, atol=1e-12)
        copied = pickle.loads(pickle.dumps(tree))
        np.testing.assert_array_equal(copied.gravity_vector(q), tree.gravity_vector(q))


@pytest.mark.parametrize(
    "call",
    [
        lambda solver: solver.set_payload("load", 1.0, tip="right_hand"),
        lambda solver: solver.external_torques(np.zeros(9), np.zeros(6), tip="right_hand"),
        lambda solver: solver.tip_jacobian_derivative(np.zeros(9), np.zeros(9), tip="right_hand"),
    ],
)
def test_a_wrong_tip_is_refused_by_name(call) -> None:
    with pytest.raises(SolverError, match=r"left_tool, .*right_tool, got 'right_hand'"):
        call(Solver(urdf=URDF, tip=TIPS))


def test_wrong_tips_are_refused() -> None:
    with pytest.raises(InvalidRobotDescriptionError, match="left_toool"):
        Solver(urdf=URDF, tip=["left_toool", "right_tool"])
    with pytest.raises(InvalidParameterError, match="argument tip: without effect"):
        TREE.torques(*states(1)[:, 0], tip="right_tool")


def test_limits_are_those_of_coordinates_and_of_joints_that_mimic_them() -> None:
    limits = TREE.limits
    assert limits["effort"].tolist() == [300.0] * 9
    # -2 <= 0.1 - 1.5 q <= 1.5, and its speed is at most 2
    assert limits["lower"][8] == pytest.approx(-1.4 / 1.5)
    assert limits["upper"][8] == pytest.approx(2.1 / 1.5)
    assert limits["velocity"][8] == pytest.approx(2 / 1.5)
    assert limits["velocity"][:8].tolist() == [2.0] * 8
    assert limits["upper"][2] == np.inf  # continuous


def test_run_configurations_state_several_tips(tmp_path) -> None:
    (tmp_path / "two_arms.urdf").write_text(URDF)
    for tip in ("[left_tool, right_tool]", "left_tool,right_tool"):
        file = tmp_path / "robot.yaml"
        file.write_text(
            "schema: 1\nname: two_arms\ndescription: two arms\n"
            "plugin: rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody\n"
            f"urdf: two_arms.urdf\ntip: {tip}\n"
        )
        assert load_robot(file).solver().tip_names == ("left_tool", "right_tool")


def test_limits_of_a_tree_of_a_model_file_are_those_of_its_description(tmp_path) -> None:
    engine = FastModel.from_urdf(URDF, tip=list(TIPS))
    file = tmp_path / "two_arms.yaml"
    file.write_text(engine.file_text(name="two_arms", source="its URDF", validity="a test"))
    limits = Solver("rigid_body", parameters={"model": f"{file}"}).limits
    for name in ("lower", "upper", "velocity", "effort"):
        np.testing.assert_allclose(limits[name], TREE.limits[name])

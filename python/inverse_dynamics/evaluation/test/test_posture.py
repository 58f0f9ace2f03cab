# SPDX-License-Identifier: Apache-2.0
"""Joints that the chain carries take the posture that the recording has; torques by MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from example_recordings import write_motion
from simulation_arms import joint, link, robot

from inverse_dynamics._core import ArmFitter, RobotDescription
from inverse_dynamics.cli import make_parser
from inverse_dynamics.evaluation.evaluation import evaluate
from inverse_dynamics.evaluation.posture import carried_joints, posture_of
from inverse_dynamics.identification import verb_identify as identify_verb
from inverse_dynamics.recordings.bags import write_joint_logs
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.recordings.recordings import position_ranges
from inverse_dynamics.robots.robots import robot_of_description, with_changes
from inverse_dynamics.robots.solvers import solver_of

JOINTS = ("waist", "right", "left", "grip")
CHAIN = ("waist", "right")
RATE = 200  # Hz
LEFT = -1.2  # rad


URDF = robot(
    link("base"),
    link("trunk", 20, "0.2 0.02 -0.1"),
    link("right_arm", 5, "0.2 0.02 -0.1"),
    link("left_arm", 5, "0.2 0.02 -0.1"),
    link("finger", 0.5, "0.05 0 0"),
    joint("waist", "base", "trunk", xyz="0 0 1"),
    joint("right", "trunk", "right_arm", xyz="0 -0.3 0.5"),
    joint("left", "trunk", "left_arm", xyz="0 0.3 0.5"),
    joint("grip", "left_arm", "finger", "prismatic", xyz="0.4 0 -0.1", axis="1 0 0"),
)


def motion(seconds: float = 8.0, left: float = 0.0) -> tuple[np.ndarray, ...]:
    """Time, q, qd, qdd of JOINTS; left: how far the left arm swings about LEFT."""
    time = np.arange(0.0, seconds, 1 / RATE)
    w = np.array([1.1, 1.7, 1.3, 1.0])
    size = np.array([0.4, 0.9, left, 0.0])
    phase = w * time[:, None]
    q = np.array([0.1, 0.2, LEFT, 0.02]) + size * np.sin(phase)
    return time, q, size * w * np.cos(phase), -size * w**2 * np.sin(phase)


def torques(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
    model = mujoco.MjModel.from_xml_string(URDF)
    data = mujoco.MjData(model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    order = [model.joint(name).dofadr[0] for name in JOINTS]
    out = np.empty_like(q)
    for k in range(len(q)):
        data.qpos[order], data.qvel[order], data.qacc[order] = q[k], qd[k], qdd[k]
        mujoco.mj_inverse(model, data)
        out[k] = data.qfrc_inverse[order]
    return out


@pytest.fixture
def urdf(tmp_path):
    file = tmp_path / "torso.urdf"
    file.write_text(URDF)
    return file


def table(file, left: float = 0.0, joints=JOINTS):
    time, q, qd, qdd = motion(left=left)
    tau = torques(q, qd, qdd)
    columns = [JOINTS.index(joint) for joint in joints]
    states = {"position": q, "velocity": qd, "effort": tau}
    return write_motion(file, joints, time, **{k: x[:, columns] for k, x in states.items()})


def bag(path):
    time, q, qd, qdd = motion()
    stamps = np.round(1e9 * (1 + time)).astype(np.int64)
    log = JointLog(JOINTS, stamps, stamps, q, qd, torques(q, qd, qdd))
    write_joint_logs(path, {"/joint_states": log})
    return path


def evaluated(recording, urdf, **options):
    return evaluate(recording, robot_of_description(urdf), tip="right_arm", **options)


def about_joints(evaluation):
    return [note for note in evaluation.notes if "beside the chain" in note]


@pytest.mark.parametrize("make", [lambda d: table(d / "still.csv"), lambda d: bag(d / "still")])
def test_an_arm_at_rest_is_held_where_it_is(tmp_path, urdf, make):
    result = evaluated(make(tmp_path), urdf)
    assert max(error.rmse for error in result.errors_of_kept) < 0.05  # N m, of 100; the filter's
    assert about_joints(result) == [
        "joints beside the chain are held where the recording has them (mean): left -1.2 rad, grip "
        "0.02 m; another position: parameters={'locked_joints.JOINT': ...}"
    ]
    # `ids payload` and `ids contact` open the solver again
    q = result.log.q[:5]
    expected = torques(*(part[:5] for part in motion()[1:]))[:, :2]
    solver = solver_of(result.robot)
    assert solver.torques(q, result.log.qd[:5], motion()[3][:5, :2]) == pytest.approx(expected)


def test_without_its_posture_the_torques_are_wrong(tmp_path, urdf):
    recording = table(tmp_path / "without.csv", joints=CHAIN)
    result = evaluated(recording, urdf)
    assert result.errors_of_kept[0].rmse > 3.0
    assert about_joints(result) == []  # the recording says nothing of them


def test_an_arm_that_moves_is_said_and_no_cause_is_named(tmp_path, urdf):
    result = evaluated(table(tmp_path / "moving.csv", left=0.8), urdf)
    assert result.errors_of_kept[0].rmse > 3.0
    assert result.diagnosis == ()
    held, moving = about_joints(result)
    assert "grip 0.02 m" in held
    assert (
        "joints beside the chain move: left (-2 to -0.4 rad); the torques don't include it"
        in moving
    )


def test_a_stated_position_stays_and_is_compared(tmp_path, urdf):
    recording = table(tmp_path / "still.csv")
    stated = {"locked_joints": {"left": 0.5, "grip": 0.02}}
    result = evaluated(recording, urdf, parameters=stated)
    assert result.robot.parameters["locked_joints.left"] == 0.5
    assert about_joints(result) == [
        "joints beside the chain are held, but not where the recording has them: "
        "left at -1.2 rad, locked_joints at 0.5 rad"
    ]


def test_bodies_that_are_ignored_take_no_posture(tmp_path, urdf):
    result = evaluated(table(tmp_path / "still.csv"), urdf, parameters={"attached": "ignore"})
    assert about_joints(result) == []


def test_only_joints_on_moving_links_are_carried():
    assert carried_joints(RobotDescription(URDF), CHAIN) == {"left": "rad", "grip": "m"}
    assert carried_joints(RobotDescription(URDF), ("right",), "trunk") == {}
    assert carried_joints(RobotDescription(URDF), ("left",), "trunk") == {"grip": "m"}
    follower = URDF.replace('<axis xyz="1 0 0"/>', '<axis xyz="1 0 0"/><mimic joint="left"/>')
    assert carried_joints(RobotDescription(follower), CHAIN) == {"left": "rad"}


def test_ranges_are_of_all_messages(tmp_path):
    recording = table(tmp_path / "moving.csv", left=0.8)
    q = motion(left=0.8)[1][:, 2]
    assert position_ranges(recording, ["left", "unknown"]) == {
        "left": pytest.approx((q.min(), q.mean(), q.max()))
    }
    ranges = position_ranges(bag(tmp_path / "bag"), ["left"])
    assert ranges["left"] == pytest.approx((LEFT, LEFT, LEFT))


def test_ranges_are_without_whole_turns_and_what_is_no_number(tmp_path):
    seam = np.where(np.arange(100) % 2, np.pi - 0.001, -np.pi + 0.001)
    seam[7] = np.nan
    time = np.arange(100) / RATE
    stamps = np.round(1e9 * (1 + time)).astype(np.int64)
    log = JointLog(("left",), stamps, stamps, *[seam[:, None]] * 3)
    write_joint_logs(tmp_path / "bag", {"/joint_states": log})
    least, mean, greatest = position_ranges(tmp_path / "bag", ["left"], turning=["left"])["left"]
    assert greatest - least == pytest.approx(0.002)
    assert abs(mean) == pytest.approx(np.pi, abs=0.002)


def test_identification_starts_from_the_posture(tmp_path, urdf):
    robot = with_changes(robot_of_description(urdf), tip="right_arm")
    posture = posture_of(table(tmp_path / "still.csv"), robot, URDF, CHAIN)
    assert posture.parameters["locked_joints.left"] == pytest.approx(LEFT)
    for locked, right in (({"left": LEFT, "grip": 0.02}, True), ({}, False)):
        fitter = ArmFitter.from_urdf(URDF, tip="right_arm", locked_joints=locked)
        trunk = fitter.prior[0, 1:4] - ArmFitter.from_urdf(URDF, tip="right_arm").prior[0, 1:4]
        assert (np.abs(trunk).max() > 0.5) == right


def test_identify_takes_the_chain_as_options_and_no_other_parameter(ids, tmp_path, urdf):
    recording = table(tmp_path / "still.csv")
    out = ("--out", str(tmp_path / "arm.yaml"))
    code, _, err = ids(
        "identify", str(recording), "--urdf", str(urdf), *out, "--parameter", "attached=ignore"
    )
    assert code == 2
    assert "--parameter attached: expected locked_joints.JOINT" in err
    options = "--tip right_arm --gravity 0,0,9.81 --joints a,b --cutoff 7 --parameter locked_joints.left=0.5"
    given = ("identify", str(recording), "--urdf", str(urdf), *out, *options.split())
    arguments = make_parser().parse_args(given)
    robot = identify_verb._robot(arguments)
    assert (robot.tip, robot.gravity, robot.joints) == ("right_arm", (0.0, 0.0, 9.81), ("a", "b"))
    assert (robot.cutoff, robot.friction) == (7.0, False)
    assert robot.parameters == {"locked_joints.left": 0.5}

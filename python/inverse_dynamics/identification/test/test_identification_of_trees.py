# SPDX-License-Identifier: Apache-2.0
"""A torso with two arms and a finger that mimics: identified, saved, and read as any other robot."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from inverse_dynamics import FastModel, Solver, evaluate, identify
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.result import IdentificationError
from inverse_dynamics.identification.urdf_export import urdf_text
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.robots import RIGID_BODY, load_robot

NOISE = 0.05  # N m
FRICTION = np.array([1.0, 0.8, 0.6, 0.4])  # N m, of the joints in the order of the description
JOINTS = ("left_shoulder", "waist", "right_shoulder", "right_elbow")
PLACES = {  # xyz, rpy, axis
    "waist": ("0 0 0.3", "0.3 0 0", "0 0.6 0.8"),
    "left_shoulder": ("0 0.2 0.4", "1.2 0 0.4", "0 0 1"),
    "finger": ("0.3 0 0.1", "0 1 0", "0 1 0"),
    "right_shoulder": ("0 -0.2 0.4", "-1.2 0 0.4", "0 0 1"),
    "right_elbow": ("0.3 0 0", "0.5 1.2 0", "0 0 1"),
}
PARENTS = {
    "left_shoulder": "waist",
    "finger": "left_shoulder",
    "waist": "base",
    "right_shoulder": "waist",
    "right_elbow": "right_shoulder",
}


HEAVIER = (1.4, 0.8, 1.1, 0.7, 1.6)  # links of the robot, than described


def description(scales: tuple[float, ...] = (1, 1, 1, 1, 1)) -> str:
    """Links have the names of the joints that move them, but for `base`."""
    parts = ["<robot name='torso'><link name='base'/>"]
    for number, (joint, parent) in enumerate(PARENTS.items()):
        xyz, rpy, axis = PLACES[joint]
        mass = scales[number] * (1 + 0.5 * number)
        mimic = "<mimic joint='left_shoulder' multiplier='-1.5' offset='0.2'/>"
        parts.append(
            f"<link name='{joint}'><inertial><origin xyz='0.1 0.05 0.1'/><mass value='{mass}'/>"
            f"<inertia ixx='{0.02 * mass}' iyy='{0.03 * mass}' izz='{0.02 * mass}' ixy='0' ixz='0' iyz='0'/>"
            f"</inertial></link><joint name='{joint}' type='revolute'><parent link='{parent}'/>"
            f"<child link='{joint}'/><origin xyz='{xyz}' rpy='{rpy}'/><axis xyz='{axis}'/>"
            f"<limit lower='-9' upper='9' effort='200' velocity='9'/>{mimic * (joint == 'finger')}</joint>"
        )
    return "".join([*parts, "</robot>"])


def motion(seed: int = 0):
    """Time, q, qd, qdd of sines, each joint with frequencies of its own."""
    random = np.random.default_rng(seed)
    time = np.arange(0, 30, 0.01)
    q, qd, qdd = np.zeros((3, len(time), len(JOINTS)))
    for j in range(len(JOINTS)):
        for frequency in random.uniform(0.1, 0.7, 3):  # Hz
            w, phase = 2 * np.pi * frequency, random.uniform(0, 6)
            q[:, j] += 0.5 * np.sin(w * time + phase)
            qd[:, j] += 0.5 * w * np.cos(w * time + phase)
            qdd[:, j] -= 0.5 * w**2 * np.sin(w * time + phase)
    return time, q, qd, qdd


def recorded(seed: int = 0, still: tuple[int, ...] = ()) -> JointLog:
    """What the robot with other masses and friction measured."""
    time, q, qd, qdd = motion(seed)
    for j in still:
        q[:, j], qd[:, j], qdd[:, j] = 0.3, 0, 0
    robot = FastModel.from_urdf(description(HEAVIER), tip=["finger", "right_elbow"])
    assert robot.joint_names == JOINTS
    noise = NOISE * np.random.default_rng(seed + 1).standard_normal(q.shape)
    effort = robot.torques(q, qd, qdd) + FRICTION * np.tanh(qd / 0.1) + 0.2 * qd + noise
    stamps = np.round(1e9 * (1 + time)).astype(np.int64)
    return JointLog(JOINTS, stamps, stamps, q, qd, effort)


@pytest.fixture(scope="module")
def urdf(tmp_path_factory) -> Path:
    file = tmp_path_factory.mktemp("tree") / "torso.urdf"
    file.write_text(description())
    return file


@pytest.fixture(scope="module")
def found(urdf):
    return identify(recorded(), urdf=urdf, tip="*")


def test_a_tree_is_identified_to_its_noise(found):
    assert found.joints == JOINTS
    assert found.links == tuple(PARENTS)
    assert found.model.parameters.shape == (5, 10)
    assert found.held_out["urdf"].min() > 5 * NOISE
    assert found.held_out["identified"].max() < 1.3 * NOISE
    assert [law["fc"] for law in found.model.friction] == pytest.approx(FRICTION, abs=0.1)


def test_its_solver_computes_another_motion(found):
    _, q, qd, qdd = motion(seed=5)
    error = found.solver().torques(q, qd, qdd) - recorded(seed=5).effort
    assert np.sqrt((error**2).mean(axis=0)).max() < 1.5 * NOISE


def test_its_files_are_a_robot(found, tmp_path):
    files = write_identification(found, tmp_path / "torso.yaml")
    evaluation = evaluate(recorded(seed=5), files.robot)
    assert evaluation.joint_names == JOINTS
    assert max(error.rmse for error in evaluation.errors_of_kept) < 1.5 * NOISE
    assert Solver(RIGID_BODY, model=str(files.model)).joint_names == JOINTS


def test_its_urdf_has_the_masses_of_all_links(found):
    again = FastModel.from_urdf(urdf_text(found), tip="*")
    assert again.link_joints == tuple(PARENTS)
    np.testing.assert_allclose(
        again.parameters, found.model.parameters.ravel(), rtol=1e-9, atol=1e-12
    )


def test_an_arm_that_stands_still_is_held(urdf):
    held = identify(recorded(still=(2, 3)), urdf=urdf, tip="finger, right_elbow")
    assert held.joints == ("left_shoulder", "waist")
    assert held.held_out["identified"].max() < 1.3 * NOISE
    assert any("right_elbow at 0.3 rad" in note for note in held.notes)


MOTORS = {  # the right elbow follows the motor of the shoulder, too
    "motors": [1.0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0.5, 1],
    "motor_names": ["left_shoulder", "waist", "right_shoulder", "wire"],
}
ELBOW = np.array([0, 0, 0.5, 1])  # its velocity by those of the motors


def driven(seed: int = 0) -> JointLog:
    """What motors measured: with friction at the elbow, too, and a spring that pulls a lever of the waist."""
    time, q, qd, qdd = motion(seed)
    robot = FastModel.from_urdf(description(HEAVIER), tip="*", motors=MOTORS)
    effort = robot.torques(q, qd, qdd) + FRICTION * np.tanh(qd / 0.1) + 0.2 * qd
    effort += np.outer(0.7 * np.tanh(qd @ ELBOW / 0.1), ELBOW)
    effort[:, 1] += 3 * np.sin(q[:, 1]) - 2 * np.cos(q[:, 1])
    effort += NOISE * np.random.default_rng(seed + 1).standard_normal(q.shape)
    stamps = np.round(1e9 * (1 + time)).astype(np.int64)
    return JointLog(tuple(MOTORS["motor_names"]), stamps, stamps, q, qd, effort)


def test_motors_friction_at_further_places_and_levers_are_identified(urdf, tmp_path):
    file = tmp_path / "driven.yaml"
    file.write_text(
        f"schema: 1\nname: driven\ndescription: x\nplugin: {RIGID_BODY}\nurdf: {urdf}\ntip: '*'\n"
        f"friction: false\nparameters: {{motors: {MOTORS['motors']}, motor_names: {MOTORS['motor_names']}}}\n"
        "friction_at:\n  elbow: {right_shoulder: 0.5, wire: 1}\nfit_springs: {waist: lever}\n"
    )
    found = identify(driven(), file)
    assert found.joints == tuple(MOTORS["motor_names"])
    assert found.held_out["identified"].max() < 1.3 * NOISE
    assert found.model.friction_at["elbow"]["fc"] == pytest.approx(0.7, abs=0.1)
    np.testing.assert_allclose(found.model.springs[1], [0, 3, -2], atol=0.2)
    intervals = {interval.name: interval for interval in found.intervals}
    assert intervals["elbow fc"].value == found.model.friction_at["elbow"]["fc"]
    assert 0 < intervals["waist lever_sin"].half_width < 1
    files = write_identification(found, tmp_path / "torso.yaml")
    evaluation = evaluate(driven(seed=5), files.robot)
    assert max(error.rmse for error in evaluation.errors_of_kept) < 1.5 * NOISE


def test_known_springs_are_refused_by_name(urdf):
    robot = replace(
        load_robot(urdf), tip="*", effort="torque", parameters={"springs.waist.stiffness": 3.0}
    )
    with pytest.raises(
        IdentificationError, match=r"got some of waist; .*fit_springs: {waist: linear}"
    ):
        identify(recorded(), robot)

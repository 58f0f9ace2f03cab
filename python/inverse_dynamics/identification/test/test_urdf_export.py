# SPDX-License-Identifier: Apache-2.0
"""An identified model as URDF and MJCF: the same torques where these can hold them, the rest of the file as it was."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from example_robots import JOINTS, URDF
from identified_arms import engine, identification
from test_identification_files import OBLIQUE

from inverse_dynamics import FastModel, Solver
from inverse_dynamics.identification.urdf_export import mjcf_text, urdf_text
from inverse_dynamics.robots.robots import RIGID_BODY, Robot


@pytest.fixture(scope="module")
def found():
    return identification()


@pytest.fixture(scope="module")
def text(found):
    return urdf_text(found)


def test_the_urdf_has_the_identified_inertia(found, text):
    again = FastModel.from_urdf(text, root="base_link", tip="tool0")
    np.testing.assert_allclose(
        again.parameters, found.model.parameters.ravel(), rtol=1e-11, atol=1e-12
    )
    assert abs(again.parameters - engine().parameters).max() > 0.1


def test_the_rest_of_the_file_stays(text):
    before = URDF.read_text()
    for comment in re.findall(r"<!--.*?-->", before, re.DOTALL):
        assert comment in text
    assert text[: text.index("<robot")] == before[: before.index("<robot")]

    def without_change(xml: str) -> list[tuple[str, dict[str, str]]]:
        robot = ElementTree.fromstring(xml)
        inertials = {id(e) for i in robot.iter("inertial") for e in i.iter()}
        return [
            (e.tag, e.attrib)
            for e in robot.iter()
            if id(e) not in inertials and e.tag != "dynamics"
        ]

    assert without_change(text) == without_change(before)


def with_friction(found, **changes):
    """The identification with other numbers of friction."""
    friction = tuple({**law, **changes} for law in found.model.friction)
    return replace(found, model=replace(found.model, friction=friction))


def dynamics(text):
    """(n, 2) damping and friction."""
    joints = {joint.get("name"): joint for joint in ElementTree.fromstring(text).findall("joint")}
    elements = [joints[name].find("dynamics") for name in JOINTS]
    return np.array([[float(e.get("damping")), float(e.get("friction"))] for e in elements])


def test_friction_is_in_dynamics_and_the_rest_is_told(found, text):
    sharp = dynamics(urdf_text(with_friction(found, width=1e-6)))
    np.testing.assert_allclose(sharp, [[f["fv"], f["fc"]] for f in found.model.friction], rtol=1e-6)
    assert "Not held here: the width of the step; offsets." in text
    rotor = "Rotor inertia has no place in a URDF"
    assert rotor in text
    assert rotor not in mjcf_text(found)


def test_friction_is_the_nearest_to_the_law(found):
    """To one that grows with load and falls with velocity, and never pushes."""
    other = with_friction(found, fl=0.1, fs=20.0, vs=0.2)
    written = dynamics(urdf_text(other))
    assert written.min() >= 0
    q, qd = (np.concatenate([getattr(b, key) for b in found.blocks]) for key in ("q", "qd"))
    solver = Solver(RIGID_BODY, urdf=urdf_text(found), root="base_link", tip="tool0")
    load = abs(solver.gravity_vector(q))
    for j, law in enumerate(other.model.friction):
        v = qd[:, j]
        height = law["fc"] + 0.1 * load[:, j] + 20.0 * np.exp(-((v / 0.2) ** 2))
        torque = law["fv"] * v + height * np.tanh(v / law["width"])
        error = np.std(torque - written[j] @ [v, np.sign(v)])
        for changed in 1.05 * written[j] * np.eye(2) + 0.95 * written[j] * (1 - np.eye(2)):
            assert error < np.std(torque - changed @ [v, np.sign(v)])
        assert error < np.std(
            torque - law["fv"] * v - (law["fc"] + 0.1 * load[:, j].mean()) * np.sign(v)
        )


def test_what_is_fixed_to_a_link_is_part_of_it(found, tmp_path):
    urdf = tmp_path / "oblique.urdf"
    urdf.write_text(OBLIQUE)
    chain = FastModel.from_urdf(OBLIQUE)
    two = slice(0, 2)
    model = replace(
        found.model,
        parameters=1.1 * chain.parameters.reshape(2, 10),
        friction=found.model.friction[two],
        rotor_inertia=np.zeros(2),
        torque_deviation=found.model.torque_deviation[two],
        seen=found.model.seen[:, two],
    )
    blocks = tuple(replace(block, q=block.q[:, two], qd=block.qd[:, two]) for block in found.blocks)
    robot = Robot("oblique", "", urdf, RIGID_BODY, urdf=urdf)
    oblique = replace(found, robot=robot, joints=("one", "two"), model=model, blocks=blocks)
    again = urdf_text(oblique)
    parameters = FastModel.from_urdf(again).parameters
    np.testing.assert_allclose(parameters, 1.1 * chain.parameters, rtol=1e-11, atol=1e-12)
    masses = {
        link.get("name"): link.find("inertial/mass") is not None
        for link in ElementTree.fromstring(again).findall("link")
    }
    assert masses == {
        "world": False, "base": False, "a": True, "mid": False, "b": True, "tool": False,
    }  # fmt: skip
    assert "a has mid in it; b has tool in it" in again


def test_mujoco_takes_both(found):
    mujoco = pytest.importorskip("mujoco")
    assert mujoco.MjModel.from_xml_string(urdf_text(found)).nv == len(JOINTS)
    model = mujoco.MjModel.from_xml_string(mjcf_text(found))
    assert model.nu == model.nv == len(JOINTS)
    np.testing.assert_allclose(model.dof_armature, found.model.rotor_inertia)
    data = mujoco.MjData(model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    model.dof_damping[:] = model.dof_frictionloss[:] = 0.0
    states = np.random.default_rng(1).uniform(-2.0, 2.0, (3, 5, len(JOINTS)))
    rigid = engine().regressor(*states) @ found.model.parameters.ravel()
    for q, qd, qdd, expected in zip(
        *states, rigid + found.model.rotor_inertia * states[2], strict=True
    ):
        data.qpos[:], data.qvel[:], data.qacc[:] = q, qd, qdd
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(data.qfrc_inverse, expected, atol=1e-9 * abs(expected).max())


def test_mujoco_friction_rises_as_the_law_does(found):
    """By a ramp over the width of its step, whatever else moves the joint, at rest too."""
    mujoco = pytest.importorskip("mujoco")
    wide = with_friction(found, width=0.3)
    text = mjcf_text(wide)
    assert "width" not in text
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    data = mujoco.MjData(model)
    fv, fc = np.array([[law[key] for law in wide.model.friction] for key in ("fv", "fc")])
    for v in (-0.5, -0.3, -0.1, 0.0, 0.05, 0.2, 0.5):
        data.qvel[:] = v
        data.qfrc_applied[:] = 5.0
        mujoco.mj_forward(model, data)
        friction = -(data.qfrc_passive + data.qfrc_constraint)
        assert (abs(friction - fv * v - fc * np.tanh(v / 0.3)) < 0.12 * fc).all()

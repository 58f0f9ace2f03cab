# SPDX-License-Identifier: Apache-2.0
"""An identified model as URDF and MJCF: the same torques where these can hold them, the rest of the file as it was."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from conftest import JOINTS, URDF
from identified_arms import arm, engine, identification
from test_identification_files import OBLIQUE

from inverse_dynamics import FastModel, Solver
from inverse_dynamics.results.urdf_export import mjcf_text, urdf_text
from inverse_dynamics.robot.robots import RIGID_BODY, Robot


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


def test_friction_is_in_dynamics_and_the_rest_is_told(found, text):
    for joint in ElementTree.fromstring(text).findall("joint"):
        if joint.get("name") in JOINTS:
            figures = found.model.friction[JOINTS.index(joint.get("name"))]
            assert float(joint.find("dynamics").get("damping")) == figures["fv"]
            assert float(joint.find("dynamics").get("friction")) == figures["fc"]
    assert "Not held here: the width of the step; offsets." in text


def test_friction_that_grows_with_load_is_that_of_the_mean_load(found):
    loaded = [{**figures, "fl": 0.1} for figures in found.model.friction]
    model = replace(found.model, friction=tuple(loaded))
    text = urdf_text(replace(found, model=model))
    robot = ElementTree.fromstring(text)
    joint = next(j for j in robot.findall("joint") if j.get("name") == JOINTS[1])
    solver = Solver(RIGID_BODY, urdf=text, root="base_link", tip="tool0")
    q = np.concatenate([block.q for block in found.blocks])
    load = abs(solver.gravity_vector(q)[:, 1]).mean()
    expected = found.model.friction[1]["fc"] + 0.1 * load
    assert float(joint.find("dynamics").get("friction")) == pytest.approx(expected, rel=1e-9)
    assert "the step is that of the mean load" in text


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
    blocks = tuple(replace(block, q=block.q[:, two]) for block in found.blocks)
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
    found = replace(found, model=arm())  # the ridged fit needn't be a body's
    text = urdf_text(found)
    mujoco = pytest.importorskip("mujoco")
    spec = mujoco.MjSpec.from_string(mjcf_text(found))
    default = spec.find_default(JOINTS[2])
    figures = found.model.friction[2]
    assert np.ravel(default.joint.damping)[0] == figures["fv"]
    assert default.joint.frictionloss == figures["fc"]
    assert default.joint.armature == found.model.rotor_inertia[2]
    model = mujoco.MjModel.from_xml_string(text)
    assert model.nv == len(JOINTS)
    np.testing.assert_allclose(model.dof_frictionloss, [f["fc"] for f in found.model.friction])

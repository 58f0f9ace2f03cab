# SPDX-License-Identifier: Apache-2.0
"""Denavit-Hartenberg parameters of robots whose URDF is known."""

import re

import numpy as np
import pytest

from inverse_dynamics import FastModel, load_robot
from inverse_dynamics.errors import RobotError
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.dh_tables import guess_of
from inverse_dynamics.robots.robots import robot_of_description

# Published by the makers: Universal Robots, "DH parameters", and Franka, "Robot and interface
# specifications".
UR10 = """\
convention: standard
degrees: true
joints:
  - {a: 0, alpha: 90, d: 0.1273}
  - {a: -0.612, alpha: 0, d: 0}
  - {a: -0.5723, alpha: 0, d: 0}
  - {a: 0, alpha: 90, d: 0.163941}
  - {a: 0, alpha: -90, d: 0.1157}
  - {a: 0, alpha: 0, d: 0.0922, theta: 0, name: last, limits: [-360, 360], velocity: 3, effort: 56}
"""
PANDA = """\
convention: modified
joints:
  - {a: 0, alpha: 0, d: 0.333}
  - {a: 0, alpha: -1.5707963267948966, d: 0}
  - {a: 0, alpha: 1.5707963267948966, d: 0.316}
  - {a: 0.0825, alpha: 1.5707963267948966, d: 0}
  - {a: -0.0825, alpha: -1.5707963267948966, d: 0.384}
  - {a: 0, alpha: 1.5707963267948966, d: 0}
  - {a: 0.088, alpha: 1.5707963267948966, d: 0}
"""


def model_of(tmp_path, text):
    file = tmp_path / "arm.yaml"
    file.write_text(text)
    return FastModel.from_urdf(read_description(file))


@pytest.mark.parametrize(
    ("text", "robot", "tip", "base"),
    [
        # the base of the URDF is turned by half a turn about z against that of the parameters
        (UR10, "ur10_simulated", "tool0", np.diag([-1.0, -1.0, 1.0])),
        (PANDA, "panda_simulated", "fer_link7", np.eye(3)),
    ],
)
def test_the_tip_goes_where_the_makers_urdf_has_it(tmp_path, text, robot, tip, base):
    of_table = model_of(tmp_path, text)
    known = load_robot(robot)
    of_urdf = FastModel.from_urdf(read_description(known.urdf), root=known.root, tip=tip)
    for q in np.random.default_rng(1).uniform(-3, 3, (20, len(of_urdf.joint_names))):
        (_, position), (_, expected) = of_table.tip_pose(q), of_urdf.tip_pose(q)
        np.testing.assert_allclose(base @ position, expected, atol=2e-6)


def test_limits_and_names_are_those_of_the_table(tmp_path):
    file = tmp_path / "arm.yaml"
    file.write_text(UR10.replace("alpha: 0, d: 0}", "alpha: 0, d: 0, type: prismatic}", 1))
    text = read_description(file)
    assert '<joint name="last" type="revolute">' in text
    assert f'upper="{2 * np.pi!r}" velocity="3.0" effort="56.0"' in text
    assert '<joint name="joint2" type="prismatic">' in text
    assert '<joint name="joint1" type="continuous">' in text


def test_limits_that_a_table_lacks_are_none(tmp_path):
    file = tmp_path / "arm.yaml"
    file.write_text(UR10)
    arm = Arm(robot_of_description(file))
    assert arm.limit("effort", np.inf).tolist() == [np.inf] * 5 + [56.0]
    assert arm.limit("velocity", np.inf).tolist() == [np.inf] * 5 + [3.0]
    assert arm.limit("upper", np.inf)[0] == np.inf


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            UR10.replace("standard", "usual"),
            "arm.yaml:1: convention: expected one of modified, standard",
        ),
        (UR10.replace("a: -0.612", "a: long"), "arm.yaml:5: joints[1].a: expected a number"),
        (UR10.replace("theta", "thetta"), "arm.yaml:9: joints[5].thetta"),
        ("convention: standard\njoints: []\n", "arm.yaml: joints: expected one or more, got none"),
        (UR10.replace("d: 0.1273", "d: 0, mass: 7") + "mass: 6\n", "arm.yaml: mass: expected more"),
    ],
)
def test_what_is_wrong_with_a_table_is_said(tmp_path, text, expected):
    with pytest.raises(RobotError, match=re.escape(expected)):
        model_of(tmp_path, text)


def test_masses_that_are_not_stated_are_parts_of_the_arms_mass_and_said_to_be_guesses(tmp_path):
    file = tmp_path / "arm.yaml"
    file.write_text(UR10)
    assert read_description(file).count('<mass value="2.0"/>') == 6
    assert "mass of link1, link2, link3, link4, link5, link6 (2 kg each" in guess_of(file)
    file.write_text(UR10.replace("d: 0.1273", "d: 0.1273, mass: 7.5") + "mass: 30\n")
    assert read_description(file).count('<mass value="4.5"/>') == 5
    assert "mass of link2, link3, link4, link5, link6 (4.5 kg each" in guess_of(file)
    file.write_text(UR10.replace("alpha", "mass: 1, alpha"))
    assert f"{file} doesn't state centers of mass and moments of inertia" in guess_of(file)
    assert guess_of(load_robot("ur10_simulated").urdf) == ""

# SPDX-License-Identifier: Apache-2.0
"""Bodies at the tip and gravity that change: in Python, in run configurations, as an option."""

from __future__ import annotations

import numpy as np
import pytest
from command_line import fails
from example_robots import FRANKA, RIGID_BODY, UR10
from simulation_arms import joint, link, robot, write_robot
from test_solver_parameters import efforts, planned

from inverse_dynamics import Solver, errors
from inverse_dynamics.terminal.values import payload

# One joint about y; the tip is 1 m out along x.
ARM = robot(
    link("base"),
    link("arm", 2.0, "0.5 0 0"),
    link("tip"),
    joint("swing", "base", "arm"),
    joint("end", "arm", "tip", kind="fixed", xyz="1 0 0"),
)
FULL = {
    "mass": 3.0,
    "center_of_mass": [0.1, 0.2, 0.3],
    "inertia": [0.011, 0.001, 0.002, 0.02, 0.003, 0.025],
    "frame": [[0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]],
}


def arm(plugin: str = RIGID_BODY) -> Solver:
    return Solver(plugin, urdf=ARM, tip="tip")


def states(solver: Solver) -> list[np.ndarray]:
    return list(np.random.default_rng(0).normal(size=(3, 20, len(solver.joint_names))))


@pytest.mark.parametrize("make", [arm, lambda: Solver(UR10), lambda: Solver(FRANKA)])
def test_payloads_are_what_was_set(make):
    solver = make()
    motion = states(solver)
    before = solver.torques(*motion)
    assert solver.payloads == {}
    solver.set_payload("tool", **FULL)
    with_tool = solver.torques(*motion)
    assert not np.allclose(before, with_tool)

    tool = solver.payloads["tool"]
    assert tool["mass"] == 3.0
    np.testing.assert_array_equal(tool["center_of_mass"], FULL["center_of_mass"])
    np.testing.assert_array_equal(tool["frame"], FULL["frame"])
    np.testing.assert_array_equal(tool["inertia"][np.triu_indices(3)], FULL["inertia"])
    solver.set_payload("other", **tool)
    solver.remove_payload("tool")
    np.testing.assert_array_equal(solver.torques(*motion), with_tool)
    solver.clear_payloads()
    np.testing.assert_array_equal(solver.torques(*motion), before)


def test_gravity_and_acceleration_of_the_base():
    solver = arm()
    motion = states(solver)
    np.testing.assert_array_equal(solver.gravity, [0, 0, -9.81])
    np.testing.assert_array_equal(solver.base_acceleration, [0, 0, 0])
    solver.set_gravity([1, 2, 3])
    expected = Solver(RIGID_BODY, urdf=ARM, tip="tip", gravity=(1, 2, 3)).torques(*motion)
    np.testing.assert_array_equal(solver.torques(*motion), expected)
    solver.set_gravity(np.array([2.0, 4.0, 6.0]))
    solver.set_base_acceleration([1, 2, 3])
    np.testing.assert_array_equal(solver.torques(*motion), expected)
    np.testing.assert_array_equal(solver.base_acceleration, [1, 2, 3])


WRONG = [
    (("part", -1.0), {}, "mass: expected a finite number >= 0"),
    (("part", np.nan), {}, "mass: expected a finite number >= 0"),
    (("part", "heavy"), {}, "argument mass"),
    (("", 1.0), {}, "argument name"),
    (
        ("part", 1.0, [0, 0]),
        {},
        r"center_of_mass: expected 3 numbers, got an array of shape \(2,\)",
    ),
    (("part", 1.0, ["a", "b", "c"]), {}, "center_of_mass: expected 3 numbers, got list"),
    (("part", 1.0, ["0", "0", "1"]), {}, "center_of_mass: expected 3 numbers, got list"),
    (("part", 1.0), {"inertia": ["1"] * 6}, "inertia: expected an array .* 6 numbers.*, got list"),
    (("part", 1.0, [0, 0, np.inf]), {}, "center_of_mass: expected 3 finite numbers"),
    (("part", 1.0), {"inertia": [1, 1, 1]}, "inertia: expected an array .3, 3., or 6 numbers"),
    (("part", 1.0), {"inertia": np.diag([1, 1, 2.1])}, "triangle inequality"),
    (("part", 1.0), {"inertia": [1, 0, 0, 1, 0, -1]}, "aren't positive"),
    (("part", 0.0), {"inertia": np.eye(3)}, "inertia without mass"),
    (("part", 1.0), {"inertia": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]}, "a symmetric matrix"),
    (("part", 1.0), {"frame": np.eye(3)}, r"frame: expected an array \(4, 4\), a pose"),
    (("part", 1.0), {"frame": 2 * np.eye(4)}, "frame: expected a last row of 0, 0, 0, 1"),
    (("part", 1.0), {"frame": np.diag([1, 1, -1, 1])}, "frame: expected a rotation matrix"),
]


@pytest.mark.parametrize(("arguments", "named", "text"), WRONG)
def test_wrong_bodies_are_refused_and_nothing_changes(arguments, named, text):
    solver = arm()
    solver.set_payload("part", 2.0)
    motion = states(solver)
    before = solver.torques(*motion)
    with pytest.raises((errors.InvalidParameterError, TypeError), match=text):
        solver.set_payload(*arguments, **named)
    np.testing.assert_array_equal(solver.torques(*motion), before)
    assert list(solver.payloads) == ["part"]


@pytest.mark.parametrize(
    "numbers",
    [
        [1, 2],
        "down",
        [0, 0, np.nan],
        None,
        [[0, 0, -9.81]],
        ["1", "0", "0"],
        [0, 0, 1j],
        np.array([b"1", b"0", b"0"]),
        [0, 0, 1.1e6],
        [0, -1e308, 0],
    ],
)
def test_wrong_gravity_is_refused(numbers):
    solver = arm()
    for change in (solver.set_gravity, solver.set_base_acceleration):
        with pytest.raises(errors.InvalidParameterError, match=r"argument .*expected 3 "):
            change(numbers)
    np.testing.assert_array_equal(solver.gravity, [0, 0, -9.81])


def made(directory, more):
    return write_robot(directory, ARM, "tip: tip\n" + more)


POINT = "parameters:\n  payload:\n    mass: 2.0\n    center_of_mass: [0.5, 0, 0]\n"
FILE = "mass: 2\ncenter_of_mass: [0, 0, -0.5]\nframe:\n  rpy: [0, -1.5707963267948966, 0]\n"


def torques(ids, directory, robot_file, *options):
    plan = planned(directory, ("swing",))
    out = directory / "out.csv"
    code, _, error = ids(
        "torques", plan, "--robot", robot_file, "--out", out, "--overwrite", *options
    )
    assert code == 0, error
    return efforts(out, "swing")


def test_payload_of_configuration_option_and_file_are_the_same(ids, tmp_path):
    bare = torques(ids, tmp_path, made(tmp_path, ""))
    expected = torques(ids, tmp_path, made(tmp_path, POINT))
    assert not np.allclose(bare, expected)
    named = POINT.replace("payload:\n", "payload:\n   gripper:\n")
    np.testing.assert_array_equal(torques(ids, tmp_path, made(tmp_path, named)), expected)
    option = ("--payload", "2,0.5,0,0")
    np.testing.assert_array_equal(torques(ids, tmp_path, made(tmp_path, ""), *option), expected)
    (tmp_path / "part.yaml").write_text(FILE)
    option = ("--payload", tmp_path / "part.yaml")
    np.testing.assert_allclose(torques(ids, tmp_path, made(tmp_path, ""), *option), expected)

    # Nothing is left of the configuration's body.
    inertia = POINT + "    inertia: [1, 0, 0, 1, 0, 1]\n"
    option = ("--payload", "2,0.5,0,0")
    np.testing.assert_array_equal(
        torques(ids, tmp_path, made(tmp_path, inertia), *option), expected
    )


def test_option_and_file_state_mass_center_and_inertia(tmp_path):
    inertia = [0.11, 0.01, 0.02, 0.15, 0.03, 0.2]  # xx xy xz yy yz zz
    stated = payload("2,0.5,0.1,0.2," + ",".join(map(str, inertia)))
    assert stated["payload.mass"] == 2.0
    assert stated["payload.center_of_mass"] == [0.5, 0.1, 0.2]
    assert stated["payload.inertia"] == inertia
    file = tmp_path / "part.yaml"
    file.write_text(f"mass: 2\ncenter_of_mass: [0.5, 0.1, 0.2]\ninertia: {inertia}\n")
    assert payload(str(file)) == stated


WRONG_OPTIONS = {
    "2,0,1": "1, 4 or 10 numbers",
    "two": "there is no such file",
    "inf": "1, 4 or 10 numbers",
    "2;0;0;1": "there is no such file",
    "": "there is no such file",
}


@pytest.mark.parametrize("text", WRONG_OPTIONS)
def test_wrong_options_say_what_is_expected(ids, tmp_path, text):
    plan = planned(tmp_path, ("swing",))
    fails(
        ids("torques", plan, "--out", "x.csv", "--robot", made(tmp_path, ""), "--payload", text),
        "--payload",
        "expected MASS, MASS,x,y,z or MASS,x,y,z,Ixx,Ixy,Ixz,Iyy,Iyz,Izz",
        WRONG_OPTIONS[text],
    )


WRONG_FILES = {
    "center_of_mass: [0, 0, 1]\n": ("part.yaml", "mass"),
    "mass: heavy\n": ("part.yaml:1: mass",),
    "mass: 2\ncenter: [0, 0, 1]\n": ("part.yaml:2", "center"),
    "mass: 2\ncenter_of_mass: [0, 1]\n": ("part.yaml:2: center_of_mass", "3"),
    "mass: 2\nframe: {quaternion: [0, 0, 0, 1]}\n": ("part.yaml:2", "quaternion"),
    "- 2\n": ("part.yaml",),
    "mass: [\n": ("part.yaml",),
}


@pytest.mark.parametrize("text", WRONG_FILES)
def test_wrong_files_are_named_with_their_line(ids, tmp_path, text):
    plan = planned(tmp_path, ("swing",))
    file = tmp_path / "part.yaml"
    file.write_text(text)
    fails(
        ids("torques", plan, "--out", "x.csv", "--robot", made(tmp_path, ""), "--payload", file),
        *WRONG_FILES[text],
    )


WRONG_PARAMETERS = {
    "payload: {mass: -2.0}": ("'payload.mass'", ">= 0"),
    "payload: {mas: 2.0}": ("'payload.mas'", "did you mean 'payload.mass'?"),
    "payload: {mass: 2.0, centre_of_mass: [0, 0, 1.0]}": (
        "did you mean 'payload.center_of_mass'?",
    ),
    "payload: {gripper: {mas: 2.0}}": ("did you mean 'payload.gripper.mass'?",),
    "payload: {gripper: {center_of_mass: [0, 0, 1.0]}}": ("'payload.gripper.mass'", "not set"),
    "payload: {mass: 2.0, inertia: [1.0, 0, 0, 1, 0, 3]}": ("'payload.inertia'", "triangle"),
    "payload: 2.0": ("'payload'", "payload.mass"),
    "payload: {mass: 2.0, frame: {xyz: [1.0, 2.0]}}": ("'payload.frame.xyz'", "3 numbers"),
}


@pytest.mark.parametrize("text", WRONG_PARAMETERS)
def test_wrong_parameters_are_named(ids, tmp_path, text):
    plan = planned(tmp_path, ("swing",))
    file = made(tmp_path, f"parameters:\n  {text}\n")
    fails(
        ids("torques", plan, "--out", "x.csv", "--robot", file),
        "robot arm",
        *WRONG_PARAMETERS[text],
    )


def test_option_and_parameter_of_one_body_are_refused(ids, tmp_path):
    plan = planned(tmp_path, ("swing",))
    command = ("torques", plan, "--out", "x.csv", "--robot", made(tmp_path, ""), "--payload", "2")
    fails(
        ids(*command, "--parameter", "payload.mass=3"),
        "--payload and --parameter payload.mass",
        "leave out one",
    )

# SPDX-License-Identifier: Apache-2.0
import dataclasses
import pickle
from dataclasses import replace
from pathlib import Path

import pytest
from example_recordings import damaged

from inverse_dynamics import cli
from inverse_dynamics.errors import ArgumentError, RobotError
from inverse_dynamics.installation.ament import PackageNotFoundError
from inverse_dynamics.robots.robots import RIGID_BODY, Robot, load_robot, robot_names, with_changes

COMPLETE = """\
schema: 1
name: mine
description: My robot
plugin: kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL
urdf: arm.urdf
root: base_link
tip: tool0
gravity: [0, -9.81, 0]
topic: /arm/joint_states
joints: [shoulder, elbow]
friction: false
effort: torque
drive_gains: [13.5, 9]
accelerations:
  method: low-pass
  cutoff: 5
source: measured
parameters:
  allow_massless: true
  batch_threads: 4
  locked_joints: {finger: 0.02, thumb: 1}
  mode: fast
  weights: [1, 2.5]
"""

GAINS = "drive_gains: [13.5, 9]"

LEAST = """\
schema: 1
name: mine
description: My robot
plugin: kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL
"""


@pytest.fixture
def write(tmp_path):
    (tmp_path / "arm.urdf").write_text("<robot/>")

    def write_file(text: str) -> Path:
        file = tmp_path / "mine.yaml"
        file.write_text(text)
        return file

    return write_file


def fails(file: Path, *expected: str) -> None:
    with pytest.raises(RobotError) as caught:
        load_robot(file)
    text = str(caught.value)
    assert text.startswith(str(file))
    for part in expected:
        assert part in text


def test_every_key_is_read(write, tmp_path):
    robot = load_robot(write(COMPLETE))
    assert robot.name == "mine"
    assert robot.description == "My robot"
    assert robot.plugin == "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL"
    assert robot.urdf == tmp_path / "arm.urdf"
    assert robot.model is None
    assert (robot.root, robot.tip) == ("base_link", "tool0")
    assert robot.gravity == (0.0, -9.81, 0.0)
    assert robot.topic == "/arm/joint_states"
    assert robot.joints == ("shoulder", "elbow")
    assert robot.friction is False
    assert (robot.effort, robot.accelerations, robot.cutoff) == ("torque", "low-pass", 5.0)
    assert robot.drive_gains == (13.5, 9.0)
    assert robot.source == "measured"
    assert robot.parameters == {
        "allow_massless": True,
        "batch_threads": 4,
        "locked_joints.finger": 0.02,
        "locked_joints.thumb": 1,
        "mode": "fast",
        "weights": [1.0, 2.5],
    }
    assert [type(value) for value in robot.parameters.values()] == [
        bool,
        int,
        float,
        int,
        str,
        list,
    ]


@pytest.mark.parametrize(
    ("line", "changed", "expected"),
    [
        ("name: mine", "nam: mine", ":1: the key name is missing; keys: schema, nam, description"),
        ("name: mine", "name: a/b", ":2: name: expected a plain name: results are called after it"),
        (
            "source: measured",
            "simulation: 5",
            ":17: simulation: expected keys with values, got '5'",
        ),
        ("tip: tool0", "tpi: tool0", ":7: tpi: unknown key; did you mean tip?; known here: schema"),
        ("schema: 1", "schema: 2", ":1: schema: expected 1, got '2'; it was written for another"),
        ("schema: 1", "schema: one", ":1: schema: expected an integer, got 'one'"),
        ("friction: false", "friction: 0", ":11: friction: expected true or false, got '0'"),
        ("gravity: [0, -9.81, 0]", "gravity: -9.81", ":8: gravity: expected a list of 3, got"),
        ("gravity: [0, -9.81, 0]", "gravity: [0, 1]", "expected a list of 3, got a list of 2"),
        ("gravity: [0, -9.81, 0]", "gravity: [0, .nan, 0]", ":8: gravity[1]: expected a finite"),
        ("joints: [shoulder, elbow]", "joints: [a, a]", ":10: joints: expected each name once"),
        ("joints: [shoulder, elbow]", "joints: [a, 1]", ":10: joints[1]: expected a text, got '1'"),
        ("effort: torque", "effort: force", ":12: effort: expected one of torque, current, to"),
        ("effort: torque", "effort: [torque]", ":12: effort: expected a text, got a list of 1"),
        (GAINS, "drive_gains: 13.5", ":13: drive_gains: expected a list, got '13.5'"),
        (GAINS, "drive_gains: []", ":13: drive_gains: expected a number per joint, got a"),
        (GAINS, "drive_gains: [13.5, 0]", ":13: drive_gains[1]: expected a drive gain above zero"),
        ("  method: low-pass", "  method: best", ":15: accelerations.method: expected one of auto"),
        ("  cutoff: 5", "  cutoff: -5", ":16: accelerations.cutoff: expected a frequency in Hz"),
        ("  mode: fast", "  mode:", ":22: parameters.mode: expected a text, a number, true or fal"),
        (
            "  mode: fast",
            "  tip: tool0",
            ":22: parameters.tip: is a key of its own: put tip at the",
        ),
        ("  mode: fast", "  gravity: [0, 0, 1]", ":22: parameters.gravity: is a key of its own"),
        ("  mode: fast", "  locked_joints.finger: 1", ":22: parameters.locked_joints.finger: stan"),
        (
            "[1, 2.5]",
            "[1, fast]",
            ":23: parameters.weights[1]: expected a number, as the entries be",
        ),
        (
            "[1, 2.5]",
            "[true, 1]",
            ":23: parameters.weights[1]: expected true or false, as the entrie",
        ),
        (
            "[1, 2.5]",
            "[[1], [2]]",
            ":23: parameters.weights[0]: expected a text, a number, true or",
        ),
        ("urdf: arm.urdf", "urdf: leg.urdf", ":5: urdf: expected a file, got 'leg.urdf'; "),
        ("arm.urdf", "package://nobody/a.urdf", ":5: urdf: expected a file, got 'package://nobody"),
        ("urdf: arm.urdf", "urdf: ~no_one/a.urdf", ":5: urdf: expected a file, got '~no_one/a.ur"),
        ("arm.urdf", 300 * "u", ":5: urdf: expected a file, got 'uuuu"),
        ("urdf: arm.urdf", "urdf: [arm.urdf]", ":5: urdf: expected a text, got a list of 1"),
        ("tip: tool0", "tip: [tool0", ":8: isn't YAML: expected ',' or ']'"),
        (
            "plugin: kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL",
            "plugin: kdl",
            ":4: plugin: expected package/Class, got 'kdl'; `ids robots --plugins` lists",
        ),
    ],
)
def test_mistakes_are_found_with_line_and_key(write, line, changed, expected):
    assert line in COMPLETE
    fails(write(COMPLETE.replace(line, changed)), expected)


def test_a_damaged_file_is_read_or_refused_but_never_crashes(write):
    file = write(COMPLETE)
    refused = []
    for content in damaged(COMPLETE.encode(), 400):
        file.write_bytes(content)
        try:
            load_robot(file)
        except RobotError as error:
            refused.append(str(error))
    assert len(refused) > 200
    assert all(str(file) in text and len(text) < 1000 for text in refused)


@pytest.mark.parametrize("key", ["schema", "name", "description", "plugin"])
def test_missing_key_is_named(write, key):
    lines = [line for line in LEAST.splitlines() if not line.startswith(f"{key}:")]
    fails(write("\n".join(lines)), f"the key {key} is missing")


def test_all_missing_keys_are_named_at_once(write):
    kept = [line for line in LEAST.splitlines() if line.startswith("name:")]
    fails(
        write("\n".join(kept)), ":1: the keys schema, description, plugin are missing; keys: name"
    )


@pytest.mark.parametrize(
    "path",
    [
        "~nobody_at_all/mine.yaml",
        "x" * 5000 + ".yaml",
        "a\0b.yaml",
        "~nouser\0/x",
        "~\ud800/x.yaml",
    ],
)
def test_a_path_that_can_not_be_is_an_error(path):
    with pytest.raises(RobotError, match="no such file; expected a run configuration"):
        load_robot(path)


def test_in_a_workspace_without_the_data_it_is_named(monkeypatch, tmp_path):
    index = tmp_path / "full/share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "other").touch()
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}/full:{tmp_path}/empty")
    with pytest.raises(PackageNotFoundError) as caught:
        robot_names()
    assert str(caught.value).startswith(
        "package inverse_dynamics_robots: not found: expected an installed package of that name, "
        f"got none in {tmp_path}/full, {tmp_path}/empty"
    )


@pytest.mark.parametrize("name", ["ur10_real", "panda_real", "ur10_simulated", "panda_simulated"])
def test_the_projects_robots_are_complete(name):
    robot = load_robot(name)
    assert robot.name == name
    assert robot.urdf.is_file()
    assert robot.source
    assert robot.joints


def test_a_robot_is_a_value() -> None:
    robot = load_robot("ur10_real")
    assert pickle.loads(pickle.dumps(robot)) == robot == load_robot("ur10_real")
    changed = dataclasses.replace(robot, gravity=(0, 0, 9.81), urdf=None)
    assert (changed.gravity, changed.urdf, changed.joints) == ((0, 0, 9.81), None, robot.joints)
    assert changed != robot
    assert "urdf=None" in repr(changed)
    with pytest.raises(AttributeError):
        changed.effort = "current"


@pytest.mark.parametrize(
    ("field", "text"),
    [
        (
            {"gravity": (0, 9.81)},
            r"argument gravity: expected tuple\[float, .* None, got \(0, 9.81\)",
        ),
        ({"urdf": 3}, r"argument urdf: expected str \| PathLike\[str\] \| None, got 3"),
        ({"tpi": "tool0"}, "argument tpi: unknown; did you mean tip?"),
    ],
)
def test_fields_of_a_robot_are_checked(field: dict, text: str) -> None:
    with pytest.raises(ArgumentError, match=text):
        Robot("arm", "", "arm.yaml", RIGID_BODY, **field)
    with pytest.raises(ArgumentError, match=text):
        with_changes(load_robot("ur10_real"), **field)


def test_a_new_robot_is_a_file_that_reads_back_as_it_was_stated(tmp_path):
    from inverse_dynamics.robots.robot_files import write_robot

    stated = replace(
        load_robot("ur10_simulated"),
        gravity=(0.0, 9.81, 0.0),
        joints=("a", "b", "c", "d", "e", "f"),
        effort="current",
        drive_gains=(1.5, 2.0, 3.0, 4.0, 5.0, 6.0),
        columns="q=q*, i=cur*",
        scale=("q=deg", "i=1,1,1,2,2,2"),
        sign=(1.0, -1.0, 1.0, 1.0, 1.0, 1.0),
        gears=(50.0, 50.0, 50.0, 40.0, 40.0, 40.0),
        rate=125.0,
        cutoff=7.5,
        accelerations="low-pass",
        parameters={},
    )
    file = tmp_path / "arm.yaml"
    write_robot(stated, file)
    assert replace(load_robot(file), file=stated.file, urdf=stated.urdf) == stated
    assert load_robot(file).urdf.samefile(stated.urdf)


def test_ids_robots_writes_a_new_robot_from_a_recording(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    urdf = str(load_robot("ur10_simulated").urdf)
    arguments = ["robots", "--new", "arm.yaml", "--urdf", urdf, "--root", "base_link"]
    assert cli.main([*arguments, "--tip", "tool0"]) == 0
    robot = load_robot("arm.yaml")
    assert (robot.name, robot.root, robot.tip, robot.effort) == (
        "arm",
        "base_link",
        "tool0",
        "auto",
    )
    assert cli.main(arguments) == 2
    assert "arm.yaml: exists already" in capsys.readouterr().err
    assert cli.main(["robots", "--new", "other.yaml"]) == 2
    assert "--new: expected --urdf FILE, got none" in capsys.readouterr().err

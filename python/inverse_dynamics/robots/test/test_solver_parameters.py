# SPDX-License-Identifier: Apache-2.0
"""Parameters of solvers, from run configurations and options to torques."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import textwrap
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import fails
from example_robots import RIGID_BODY
from simulation_arms import joint, link, pendulum, robot, two_links, write_robot

from inverse_dynamics import Solver, load_robot, read_evaluation
from inverse_dynamics.errors import (
    ArgumentError,
    InvalidParameterError,
    ParameterMissingError,
    UserError,
)
from inverse_dynamics.simulation import simulate

ROOT = Path(__file__).resolve().parents[4]
EXAMPLE = ROOT / "core/inverse_dynamics_solver/examples/pendulum_inverse_dynamics_solver"

# An arm with a finger beside the chain, which weighs elsewhere where it is locked elsewhere.
WITH_FINGER = robot(
    link("base"),
    link("arm", 2.0, "0.5 0 0"),
    link("tool", 0.5),
    link("tip"),
    link("finger", 1.0, "0.3 0 0"),
    joint("swing", "base", "arm"),
    joint("wrist", "arm", "tool", xyz="1 0 0"),
    joint("end", "tool", "tip", kind="fixed", xyz="0.1 0 0"),
    joint("bend", "tool", "finger"),
)
MASSLESS = robot(
    link("base"),
    link("arm", 2.0, "0.5 0 0"),
    link("nothing"),
    joint("swing", "base", "arm"),
    joint("spin", "arm", "nothing", xyz="1 0 0"),
)


def planned(directory: Path, joints: tuple[str, ...]) -> Path:
    """Three points, each joint at 0.1, 0.2, 0.3 rad, at rest."""
    kinds = ("position", "velocity", "acceleration")
    lines = [",".join(["time", *(f"{kind}.{name}" for kind in kinds for name in joints)])]
    for k in range(3):
        zeros = [0.0] * (2 * len(joints))
        lines.append(",".join(map(str, [0.1 * k, *[0.1 * (k + 1)] * len(joints), *zeros])))
    file = directory / "plan.csv"
    file.write_text("\n".join(lines) + "\n")
    return file


def efforts(file: Path, name: str) -> np.ndarray:
    table = np.genfromtxt(file, delimiter=",", names=True, deletechars="")
    return table[f"effort.{name}"]


def test_locked_joints_of_the_configuration_and_of_the_option_reach_the_solver(ids, tmp_path):
    more = "tip: tip\nparameters:\n  locked_joints:\n    bend: 1.0\n"
    arm = write_robot(tmp_path, WITH_FINGER, more)
    plan = planned(tmp_path, ("swing", "wrist"))
    command = ("torques", plan, "--robot", arm)
    q = np.array([[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]])
    for bend, option in ((1.0, ()), (-0.5, ("--parameter", "locked_joints.bend=-0.5"))):
        out = f"out_{bend}.csv"
        code, _, err = ids(*command, "--out", out, *option)
        assert (code, err) == (0, ""), err
        expected = Solver(
            RIGID_BODY, WITH_FINGER, tip="tip", parameters={"locked_joints.bend": bend}
        ).gravity_vector(q)
        for j, name in enumerate(("swing", "wrist")):
            np.testing.assert_allclose(efforts(Path(out), name), expected[:, j], rtol=1e-9)


def test_massless_links_can_be_allowed(ids, tmp_path):
    plan = planned(tmp_path, ("swing", "spin"))
    arm = write_robot(tmp_path, MASSLESS)
    fails(ids("torques", plan, "--robot", arm, "--out", "a.csv"), "ids: error: robot arm", "spin")
    arm = write_robot(tmp_path, MASSLESS, "parameters: {allow_massless: true, batch_threads: 2}\n")
    assert ids("torques", plan, "--robot", arm, "--out", "a.csv")[0] == 0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("mass", "expected NAME=VALUE, VALUE a number"),
        ("=1", "expected NAME=VALUE"),
        ("mass=", "expected NAME=VALUE"),
        ("mass={a: 1}", "expected NAME=VALUE"),
        ("mass=[1, [2]]", "got 'mass=[1, [2]]' (mass[1]: expected a text, a number, true or "),
        ("mass=!!float 1", "(isn't YAML: the tag 'tag:yaml.org,2002:float' isn't supported;"),
        ("mass=[1", "(isn't YAML: expected ',' or ']')"),
        ("mass=.nan", "(mass: expected a finite number, got '.nan')"),
        ("tip=tool0", "tip: has an option of its own: give --tip instead; see"),
        ("root=base", "root: has an option of its own: give --root instead; see"),
        ("gravity=[0, 0, 0]", "gravity: has an option of its own: give --gravity instead; see"),
        ("friction=false", "friction: has an option of its own: give --no-friction instead; see"),
        ("robot_description=x", "robot_description: has an option of its own: give --urdf instead"),
        (
            "model=x.yaml",
            "model: is not an option: put it at the top of the run configuration; see",
        ),
        ("a: 1\nb=1", "expected NAME=VALUE"),
    ],
)
def test_malformed_option_is_told(ids, text, expected):
    fails(ids("evaluate", "bag", "--robot", "x", "--parameter", text), "--parameter", expected)


def test_wrong_type_is_told_with_the_robot(ids, tmp_path):
    arm = write_robot(tmp_path, pendulum(), "parameters: {batch_threads: many}\n")
    plan = planned(tmp_path, ("swing",))
    result = ids("torques", plan, "--robot", arm, "--out", "a.csv")
    fails(result, "robot arm: parameter 'batch_threads'", "expected integer")


def test_a_parameter_that_the_solver_does_not_know_is_told_with_the_robot(ids, tmp_path):
    arm = write_robot(tmp_path, pendulum(), "parameters: {batch_thread: 2}\n")
    command = ("torques", planned(tmp_path, ("swing",)), "--out", "a.csv", "--robot")
    fails(ids(*command, arm), "robot arm: parameter 'batch_thread'", "batch_threads")
    fails(ids("robots", arm), "robot arm: parameter 'batch_thread'", "batch_threads")
    arm = write_robot(tmp_path, pendulum())
    result = ids(*command, arm, "--parameter", "locked_joint.a=1")
    fails(result, "robot arm: parameter 'locked_joint.a'")


def test_simulation_says_that_it_does_not_use_them(tmp_path):
    arm = load_robot(
        write_robot(tmp_path, two_links(), "tip: tip\nparameters: {batch_threads: 1}\n")
    )
    from inverse_dynamics.simulation.trajectory import WaypointTrajectory

    names = ("shoulder", "lift", "fold")
    still = WaypointTrajectory.through(names, np.array([0.0, 1.0]), np.zeros((2, 3)) + 0.5)
    notes = simulate(arm, trajectory=still, rate=125, duration=0.1).notes
    assert "parameters of the solver aren't used by the simulation: batch_threads" in notes
    with pytest.raises(
        UserError, match=r"locked_joints: expected joints of the description, got a$"
    ):
        simulate(replace(arm, parameters={"locked_joints.a": 1.0}), duration=0.1)


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    """The example of docs/add_a_solver.md, built and installed as its reader does."""
    build = tmp_path_factory.mktemp("pendulum")
    options = ["-DBUILD_TESTING=OFF"]
    if shutil.which("ccache"):
        options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
    for command in (
        ["-S", EXAMPLE, "-B", build, f"-DCMAKE_INSTALL_PREFIX={build}/install", *options],
        ["--build", build],
        ["--install", build],
    ):
        done = subprocess.run(["cmake", *command], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return build / "install"


def test_the_solver_of_the_documentation_works_with_ids(tmp_path, example):
    page = (ROOT / "docs/add_a_solver.md").read_text(encoding="utf-8")
    (configuration,) = re.findall(r"^ *```yaml\n(.*?)^ *```", page, re.MULTILINE | re.DOTALL)
    configuration = textwrap.dedent(configuration)
    (tmp_path / "pendulum.yaml").write_text(configuration)
    commands = re.findall(r"^ *ids (evaluate swing.csv .*)$", page, re.MULTILINE)
    assert len(commands) == 2
    time = 0.01 * np.arange(500)
    q, qd, qdd = np.sin(time), np.cos(time), -np.sin(time)
    effort = 2.0 * 0.5**2 * qdd + 0.1 * qd - 2.0 * 0.5 * -9.81 * np.sin(q)  # the law of the class
    rows = np.column_stack([time, q, qd, qdd, effort]).tolist()
    lines = ["time,position.pivot,velocity.pivot,acceleration.pivot,effort.pivot"]
    lines += [",".join(map(repr, row)) for row in rows]
    (tmp_path / "swing.csv").write_text("\n".join(lines) + "\n")

    environment = dict(os.environ)  # what sourcing the workspace of the solver changes
    for name, directory in (("AMENT_PREFIX_PATH", example), ("LD_LIBRARY_PATH", example / "lib")):
        environment[name] = f"{directory}:{environment.get(name, '')}"

    def ids(command: str) -> subprocess.CompletedProcess[str]:
        script = "import sys; from inverse_dynamics.cli import main; sys.exit(main())"
        return subprocess.run(
            [sys.executable, "-c", script, *command.split()],
            env=environment,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )

    found = []
    for out, command in enumerate(commands):
        done = ids(f"{command} --out {out}")
        assert (done.returncode, done.stderr) == (0, "")
        found.append(read_evaluation(tmp_path / str(out)))
    assert found[0].errors[0].max_abs < 1e-9
    assert found[1].errors[0].max_abs > 0.1
    assert found[1].robot.parameters == {"mass": 2.1, "length": 0.5, "damping": 0.1}

    (tmp_path / "pendulum.yaml").write_text(configuration.replace("  mass: 2.0\n", ""))
    done = ids(commands[0])
    assert done.returncode == 2
    assert done.stderr.startswith("ids: error: robot pendulum: parameter 'mass'")


def test_parameters_may_be_nested_as_in_yaml():
    q = np.zeros(2)

    def gravity(**parameters):
        return Solver(
            RIGID_BODY, urdf=WITH_FINGER, tip="tip", parameters=parameters
        ).gravity_vector(q)

    nested, dotted = {"locked_joints": {"bend": 1.0}}, {"locked_joints.bend": 1.0}
    np.testing.assert_array_equal(gravity(**nested), gravity(**dotted))
    assert abs(gravity(**nested) - gravity()).max() > 0.1
    body = {"mass": 2.0, "center_of_mass": [0.1, 0.0, 0.0]}
    dotted = {"payload.mass": 2.0, "payload.center_of_mass": [0.1, 0.0, 0.0]}
    np.testing.assert_array_equal(gravity(payload=body), gravity(**dotted))
    with pytest.raises(
        InvalidParameterError, match="parameter 'locked_joints.bend': expected each parameter once"
    ):
        gravity(**nested, **{"locked_joints.bend": 2.0})
    with pytest.raises(
        ArgumentError, match="parameter 'payload.mass': expected bool, int, .* got complex"
    ):
        gravity(payload={"mass": 2j})


def test_errors_are_in_the_words_of_python():
    with pytest.raises(
        ParameterMissingError, match=r"got neither; give a URDF \(urdf\) or a model file \(model\)$"
    ):
        Solver(RIGID_BODY)
    kdl = RIGID_BODY.replace("rigid_body", "kdl").replace("RigidBody", "KDL")
    with pytest.raises(ParameterMissingError, match=r"got nothing; give a URDF \(urdf\)$"):
        Solver(kdl)
    solver = Solver(RIGID_BODY, urdf=pendulum())
    with pytest.raises(
        InvalidParameterError, match="^set_payload: body 'tool': mass: expected a finite number"
    ):
        solver.set_payload("tool", -1.0)
    with pytest.raises(
        InvalidParameterError, match=r"^set_payload: argument name: .* for remove_payload\(\)$"
    ):
        solver.set_payload("", 1.0)
    with pytest.raises(InvalidParameterError, match="^set_gravity: argument gravity: wrong value"):
        solver.set_gravity([0.0, 0.0, 1e7])
    with pytest.raises(
        ArgumentError,
        match=r"argument gravity: expected tuple\[float, .*, got \[0.0, 0.0, -9.81, 0.0\]",
    ):
        Solver(RIGID_BODY, urdf=pendulum(), gravity=[0.0, 0.0, -9.81, 0.0])


def test_implausible_numbers_are_warned_of():
    arm = {
        "urdf": two_links(),
        "parameters": {"payload": {"mass": 0.5, "center_of_mass": [0, 0, -50]}},
    }
    assert Solver(RIGID_BODY, **arm).warnings == (
        "a payload of 0.5 kg is implausible: its center of mass is 50 m from the tip; check the units "
        "(kg, m, kg m^2)",
    )
    (warning,) = Solver(RIGID_BODY, urdf=two_links(), gravity=(0, 0, -981)).warnings
    assert warning.startswith("gravity of 981 m/s^2 is implausible")
    solver = Solver(RIGID_BODY, urdf=two_links())
    with pytest.warns(UserWarning, match="center of mass is 50 m from the tip"):
        solver.set_payload("part", 0.5, [0, 0, -50])
    with pytest.warns(UserWarning, match="gravity of 981 m/s"):
        solver.set_gravity([0, 0, -981])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solver.set_payload("part", 0.5, [0, 0, -0.05])
        solver.set_gravity([0, 0, 9.81])

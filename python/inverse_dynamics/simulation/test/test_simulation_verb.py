# SPDX-License-Identifier: Apache-2.0
"""`ids simulate` on the command line."""

from __future__ import annotations

import re
from functools import partial

import numpy as np
import pytest
import two_arms
import yaml
from command_line import fails
from simulation_arms import pendulum, two_links, write_robot

from inverse_dynamics import Solver, evaluate
from inverse_dynamics.excitation import excitation
from inverse_dynamics.excitation.excitation import ExcitationOptions
from inverse_dynamics.recordings.bags import read_joint_log

TRAJECTORY = """\
schema: 1
kind: waypoints
joints: [swing]
times: [0, 0.5, 1]
positions: [[0], [-0.3], [0]]
"""


@pytest.fixture
def arm(tmp_path):
    """Arguments that name a robot, a trajectory and the output."""
    (tmp_path / "motion.yaml").write_text(TRAJECTORY)
    robot = write_robot(tmp_path, pendulum(), plugin="some_package/SomeSolver")
    return ("simulate", "--robot", robot, "--trajectory", "motion.yaml", "--out", "bag")


@pytest.fixture
def made(ids, arm, tmp_path):
    """What a command prints, and the settings that it writes."""

    def run(options):
        code, out, err = ids(*arm, *options.split())
        assert (code, err) == (0, "")
        return out, yaml.safe_load((tmp_path / "bag/simulation.yaml").read_text())

    return run


def test_says_what_was_made(made):
    out, _ = made("--rate 125")
    assert "trajectory     1 s" in out
    assert "recording      bag, /joint_states: 125 messages of 1 joint, 1 s at 125 Hz" in out
    assert len(read_joint_log("bag")) == 125


@pytest.mark.parametrize("effort", ["torque", "auto", "current", "torque_without_gravity"])
def test_says_that_efforts_are_torques_where_the_configuration_says_otherwise(made, arm, effort):
    arm[2].write_text(f"{arm[2].read_text()}effort: {effort}\n")
    out, _ = made("--rate 125")
    said = (
        f"note           efforts are recorded as torques, though the run configuration says {effort}: "
        "evaluate them with --effort-is torque"
    )
    assert (said in out) == (effort in {"current", "torque_without_gravity"})


def test_all_options_arrive(made):
    _, settings = made(
        "--rate 1000 --duration 0.5 --seed 4 --storage mcap --payload 0.5,0.1,0,0.2 --joint-friction 0.1 "
        "--gravity -1,0,-9 --noise 1e-4,1e-3,0.2 --quantisation 1e-5,1e-4,0.1 --drop 0.1 --repeat 0.2 "
        "--jitter 1e-4 --start-stamp 5 --no-table"
    )
    expected = {
        "rate": 1000,
        "duration": 0.5,
        "seed": 4,
        "storage": "mcap",
        "payload": {"mass": 0.5, "center": [0.1, 0.0, 0.2], "inertia": [0.0] * 6, "tip": "arm"},
        "gravity": [-1, 0, -9],
        "noise": {"position": 1e-4, "velocity": 1e-3, "effort": 0.2},
        "quantisation": {"position": 1e-5, "velocity": 1e-4, "effort": 0.1},
        "drop": 0.1,
        "repeat": 0.2,
        "jitter": 1e-4,
        "start_stamp": 5,
    }
    assert {key: settings[key] for key in expected} == expected
    assert settings["joint_friction"]["coulomb"] == [10.0]
    log = read_joint_log("bag")
    assert 420 < len(log) < 480
    assert 5e9 <= log.header_stamps[0] < 5.01e9


def test_noise_of_an_evaluation_delay_and_rate_of_messages_arrive(ids, made, arm, tmp_path):
    (tmp_path / "result").mkdir()
    measured = np.random.default_rng(0).normal(size=(300, 1))
    series = {"time": 0.02 * np.arange(300), "measured": measured, "computed": 0 * measured}
    np.savez(tmp_path / "result/series.npz", **series, kept=np.full(300, True))
    out, settings = made("--rate 500 --effort-delay 0.01 --message-rate 50 --effort-noise result")
    assert "50 messages of 1 joint, 1 s at 50 Hz" in out
    assert settings["effort_noise"] == "result"
    assert (settings["effort_delay"], settings["message_rate"]) == (0.01, 50)
    log, truth = read_joint_log("bag"), np.load(tmp_path / "bag/truth.npz")
    assert np.std(log.effort - truth["effort"]) == pytest.approx(1.0, rel=0.3)
    # what is read must not be replaced
    assert ids(*arm[:-1], "result", "--effort-noise", "result")[0] == 2


def test_options_without_a_value_have_stated_defaults(made):
    _, settings = made(
        "--rate 125 --noise --quantisation --joint-friction --mount ceiling --payload 1"
    )
    assert settings["noise"] == {"position": 1e-5, "velocity": 1e-3, "effort": 0.1}
    assert settings["quantisation"] == {"position": 1e-5, "velocity": 1e-3, "effort": 0.01}
    assert settings["joint_friction"]["coulomb"] == [2.0]
    assert settings["gravity"] == [0, 0, 9.81]
    assert (settings["payload"]["mass"], settings["payload"]["center"]) == (1.0, [0.0, 0.0, 0.0])


def test_payloads_of_two_tips_arrive(ids, tmp_path):
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    two_arms.written(tmp_path)
    (tmp_path / "two_arms.yaml").write_text(
        "schema: 1\nname: two_arms\ndescription: two arms\nurdf: two_arms.urdf\ntip: [left_tool, right_tool]\n"
        "plugin: rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody\n"
    )
    n = len(tree.joint_names)
    (tmp_path / "motion.yaml").write_text(
        f"schema: 1\nkind: waypoints\njoints: [{', '.join(tree.joint_names)}]\ntimes: [0, 1, 2]\n"
        f"positions: [{n * [0.0]}, {n * [0.2]}, {n * [0.0]}]\n"
    )
    options = "--rate 500 --no-table --payload 2,0,0,0.1 --payload 1,right_tool --out bag"
    arm = ("--robot", "two_arms.yaml", "--trajectory", "motion.yaml")
    code, out, err = ids("simulate", *arm, *options.split())
    assert (code, err) == (0, ""), out
    carried = yaml.safe_load((tmp_path / "bag/simulation.yaml").read_text())["payload"]
    assert [(body["mass"], body["tip"]) for body in carried] == [
        (2.0, "left_tool"),
        (1.0, "right_tool"),
    ]
    parameters = {
        "payload.left.mass": 2.0,
        "payload.left.center_of_mass": [0.0, 0.0, 0.1],
        "payload.right.mass": 1.0,
        "payload.right.tip": "right_tool",
    }
    with_both = evaluate("bag", "two_arms.yaml", parameters=parameters)
    assert with_both.mean_rmse < 0.02 * evaluate("bag", "two_arms.yaml").mean_rmse
    code, _, err = ids("simulate", *arm, "--payload", "1,head", "--out", "other")
    assert code == 2
    assert "payload: tip: expected one of left_tool, right_tool, got head" in err


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (("--optimise", "--seed", "1"), ""),
        ((), "the run configuration names no trajectory: "),
    ],
)
def test_a_search_is_announced_and_its_motion_stored(ids, tmp_path, monkeypatch, options, why):
    monkeypatch.setattr(excitation, "ExcitationOptions", partial(ExcitationOptions, iterations=6))
    robot = write_robot(tmp_path, two_links(), "tip: tip\n")
    command = ("simulate", "--robot", robot, "--rate", "125", "--duration", "0.2", "--out", "bag")
    code, out, err = ids(*command, *options)
    assert code == 0
    assert err == (
        f"ids: {why}searching for an exciting one, which takes about a minute; --trajectory names one ...\n"
    )
    assert re.search(r"trajectory +0.2 of \d+ s, condition number of the base regressor", out)
    found = yaml.safe_load((tmp_path / "bag/trajectory.yaml").read_text())
    assert ("seed 1" in found["source"]) == ("--seed" in options)
    assert np.ptp(found["positions"], axis=0).min() > 0.01


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("--rate", "100"), "rate: expected one of 125, 500, 1000 Hz, got 100"),
        (("--from-model",), "solver plugin 'some_package/SomeSolver'"),
        (("--effort-noise", "no_result"), "no_result: expected a result of `ids evaluate`"),
        (("--optimise",), "expected either a trajectory or a search for one"),
        (("--trajectory", "no.yaml"), "no.yaml: can't be read"),
        (("--robot", "no.yaml"), "no.yaml"),
        (("--noise", "1"), "expected 3 numbers, separated by commas, got '1'"),
        (("--payload", "1,2"), "expected 1 or 4 numbers, separated by commas, got '1,2'"),
        (("--seed", "-1"), "expected an integer that isn't negative"),
        (("--drop", "nan"), "expected a number, got 'nan'"),
        (("--mount", "wall", "--gravity", "0,0,1"), "not allowed with"),
    ],
)
def test_mistakes_are_told_in_one_line_and_leave_nothing(ids, arm, tmp_path, options, text):
    result = ids(*arm, *options)
    fails(result, text)
    assert result[2].count("\n") == 1
    assert not (tmp_path / "bag").exists()


def test_existing_output_is_refused_before_the_work(ids, arm, tmp_path):
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag/notes.txt").write_text("mine")
    fails(ids(*arm), "exists already")
    fails(ids(*arm, "--overwrite"), "won't be overwritten")
    assert (tmp_path / "bag/notes.txt").read_text() == "mine"

# SPDX-License-Identifier: Apache-2.0
"""`ids simulate` on the command line."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import yaml
from simulation_arms import pendulum, two_links, write_robot

from inverse_dynamics.cli import main
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

SEARCHING = (
    "ids: {}searching for an exciting one, which takes about a minute; --trajectory names one ...\n"
)


@pytest.fixture
def arm(tmp_path: Path) -> list[str]:
    """Arguments that name a robot and a trajectory."""
    (tmp_path / "motion.yaml").write_text(TRAJECTORY)
    robot = write_robot(tmp_path, pendulum())
    return ["simulate", "--robot", str(robot), "--trajectory", str(tmp_path / "motion.yaml")]


def settings(bag: Path) -> dict[str, object]:
    return yaml.safe_load((bag / "simulation.yaml").read_text())


def test_says_what_was_made(
    arm: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / "bag"
    assert main([*arm, "--out", str(bag), "--rate", "125"]) == 0
    printed = capsys.readouterr()
    assert "trajectory     1 s" in printed.out
    assert (
        f"recording      {bag}, /joint_states: 125 messages of 1 joint, 1 s at 125 Hz"
        in printed.out
    )
    assert printed.err == ""
    assert len(read_joint_log(bag)) == 125


def test_says_that_efforts_are_torques_where_the_configuration_says_otherwise(
    arm: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    said = (
        "note           efforts are recorded as torques, though the run configuration says {}: evaluate "
        "them with --effort-is torque"
    )
    configuration = Path(arm[2])
    text = configuration.read_text()
    for effort in ("torque", "auto", "current", "torque_without_gravity"):
        configuration.write_text(f"{text}effort: {effort}\n")
        assert main([*arm, "--out", str(tmp_path / effort), "--rate", "125"]) == 0
        noted = said.format(effort) in capsys.readouterr().out
        assert noted == (effort in {"current", "torque_without_gravity"})


def test_all_options_arrive(arm: list[str], tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    options = (
        "--rate 1000 --duration 0.5 --seed 4 --storage mcap --payload 0.5,0.1,0,0.2 --joint-friction 0.1 "
        "--gravity -1,0,-9 --noise 1e-4,1e-3,0.2 --quantisation 1e-5,1e-4,0.1 --drop 0.1 --repeat 0.2 "
        "--jitter 1e-4 --start-stamp 5 --no-table"
    )
    assert main([*arm, "--out", str(bag), *options.split()]) == 0
    made = settings(bag)
    expected = {
        "rate": 1000,
        "duration": 0.5,
        "seed": 4,
        "storage": "mcap",
        "payload": {"mass": 0.5, "center": [0.1, 0.0, 0.2]},
        "gravity": [-1, 0, -9],
        "noise": {"position": 1e-4, "velocity": 1e-3, "effort": 0.2},
        "quantisation": {"position": 1e-5, "velocity": 1e-4, "effort": 0.1},
        "drop": 0.1,
        "repeat": 0.2,
        "jitter": 1e-4,
        "start_stamp": 5,
    }
    assert {key: made[key] for key in expected} == expected
    assert made["joint_friction"]["coulomb"] == [10.0]
    log = read_joint_log(bag)
    assert 420 < len(log) < 480
    assert 5e9 <= log.header_stamps[0] < 5.01e9


def test_noise_of_an_evaluation_delay_and_rate_of_messages_arrive(
    arm: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result, bag = tmp_path / "result", tmp_path / "bag"
    result.mkdir()
    random = np.random.default_rng(0)
    series = {"time": 0.02 * np.arange(300), "computed": np.zeros((300, 1))}
    series |= {"measured": random.normal(size=(300, 1)), "kept": np.full(300, True)}
    np.savez(result / "series.npz", **series)
    options = "--rate 500 --effort-delay 0.01 --message-rate 50 --effort-noise"
    assert main([*arm, "--out", str(bag), *options.split(), str(result)]) == 0
    assert "50 messages of 1 joint, 1 s at 50 Hz" in capsys.readouterr().out
    made = settings(bag)
    assert made["effort_noise"] == str(result)
    assert (made["effort_delay"], made["message_rate"]) == (0.01, 50)
    log, truth = read_joint_log(bag), np.load(bag / "truth.npz")
    assert np.std(log.effort - truth["effort"]) == pytest.approx(1.0, rel=0.3)
    # what is read must not be replaced
    assert main([*arm, "--out", str(result), "--effort-noise", str(result)]) == 2


def test_options_without_a_value_have_stated_defaults(arm: list[str], tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    options = "--rate 125 --noise --quantisation --joint-friction --mount ceiling --payload 1"
    assert main([*arm, "--out", str(bag), *options.split()]) == 0
    made = settings(bag)
    assert made["noise"] == {"position": 1e-5, "velocity": 1e-3, "effort": 0.1}
    assert made["quantisation"] == {"position": 1e-5, "velocity": 1e-3, "effort": 0.01}
    assert made["joint_friction"]["coulomb"] == [2.0]
    assert made["gravity"] == [0, 0, 9.81]
    assert made["payload"] == {"mass": 1.0, "center": [0.0, 0.0, 0.0]}


def searched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *options: str) -> Path:
    """A recording whose motion a short search has found."""
    monkeypatch.setattr(excitation, "ExcitationOptions", partial(ExcitationOptions, iterations=6))
    robot, bag = write_robot(tmp_path, two_links(), "", "tip: tip\n"), tmp_path / "bag"
    command = ["simulate", "--robot", str(robot), "--rate", "125", "--duration", "0.2"]
    assert main([*command, "--out", str(bag), *options]) == 0
    return bag


def test_optimise_stores_what_it_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = searched(tmp_path, monkeypatch, "--optimise", "--seed", "1")
    printed = capsys.readouterr()
    assert re.search(
        r"trajectory +0.2 of \d+ s, condition number of the base regressor", printed.out
    )
    assert printed.err == SEARCHING.format("")
    found = yaml.safe_load((bag / "trajectory.yaml").read_text())
    assert "seed 1" in found["source"]
    assert np.ptp(found["positions"], axis=0).min() > 0.01


def test_a_search_that_nobody_asked_for_is_announced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    searched(tmp_path, monkeypatch)
    why = "the run configuration names no trajectory: "
    assert capsys.readouterr().err == SEARCHING.format(why)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--rate", "100"], "rate: expected one of 125, 500, 1000 Hz, got 100"),
        (["--from-model"], "solver plugin 'some_package/SomeSolver'"),
        (["--effort-noise", "no_result"], "no_result: expected a result of `ids evaluate`"),
        (["--optimise"], "expected either a trajectory or a search for one"),
        (["--trajectory", "no.yaml"], "no.yaml: can't be read"),
        (["--robot", "no.yaml"], "no.yaml"),
    ],
)
def test_mistakes_end_with_code_2_and_leave_nothing(
    arm: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    text: str,
) -> None:
    bag = tmp_path / "bag"
    assert main([*arm, "--out", str(bag), *options]) == 2
    error = capsys.readouterr().err
    assert text in error
    assert error.count("\n") == 1
    assert not bag.exists()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--noise", "1"], "expected 3 numbers, separated by commas, got '1'"),
        (["--payload", "1,2"], "expected 1 or 4 numbers, separated by commas, got '1,2'"),
        (["--seed", "-1"], "expected an integer that isn't negative"),
        (["--drop", "nan"], "expected a number, got 'nan'"),
        (["--mount", "wall", "--gravity", "0,0,1"], "not allowed with"),
    ],
)
def test_malformed_options_are_explained(
    arm: list[str], capsys: pytest.CaptureFixture[str], options: list[str], text: str
) -> None:
    with pytest.raises(SystemExit) as stop:
        main([*arm, "--out", "unused", *options])
    assert stop.value.code == 2
    assert text in capsys.readouterr().err


def test_existing_output_is_refused_before_the_work(
    arm: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag/notes.txt").write_text("mine")
    for overwrite in ([], ["--overwrite"]):
        assert main([*arm, "--out", str(tmp_path / "bag"), *overwrite]) == 2
    assert "exists already" in capsys.readouterr().err
    assert (tmp_path / "bag/notes.txt").read_text() == "mine"

# SPDX-License-Identifier: Apache-2.0
"""What efforts mean, from the run configuration, the recording, the option or the data."""

import re
from dataclasses import replace

import numpy as np
import pytest
from example_recordings import motion, recording
from example_robots import RIGID_BODY, UR10, URDF

from inverse_dynamics import Solver, evaluate, load_robot
from inverse_dynamics.errors import RobotError
from inverse_dynamics.evaluation import run
from inverse_dynamics.robots.choices import EFFORT_MEANINGS

GAINS = (13.0, 14.0, 11.0, 10.0, 9.0, 8.0)


@pytest.fixture(scope="module")
def bags(tmp_path_factory, solver):
    """Recordings of one motion, a meaning each."""
    q, qd, qdd, _ = motion()
    torques = solver.torques(q, qd, qdd)
    efforts = {
        "torque": torques,
        "current": torques / GAINS,
        "torque_without_gravity": torques - solver.gravity_vector(q),
    }
    directory = tmp_path_factory.mktemp("recordings")
    for meaning, effort in efforts.items():
        recording(directory / meaning, solver, effort=effort)
    return directory


@pytest.fixture(scope="module")
def robot():
    return replace(load_robot("ur10_simulated"), plugin=RIGID_BODY, drive_gains=GAINS)


@pytest.mark.parametrize("meaning", EFFORT_MEANINGS)
def test_every_meaning_gives_the_same_errors_in_newton_metres(bags, robot, meaning):
    torque = evaluate(bags / "torque", robot)
    result = evaluate(bags / meaning, replace(robot, effort=meaning))
    for error, same in zip(result.errors, torque.errors, strict=True):
        assert error.rmse == pytest.approx(same.rmse, rel=1e-6)
        assert error.unit == "N m"
    assert result.effort.meaning == result.robot.effort == meaning
    assert result.effort.summary.startswith(
        f"{meaning.replace('_', ' ')}, as the run configuration says"
    )


@pytest.mark.parametrize("meaning", EFFORT_MEANINGS)
def test_the_data_tell_and_say_how_sure_they_are(bags, robot, meaning):
    result = evaluate(bags / meaning, replace(robot, effort="auto"))
    assert result.effort.meaning == meaning
    assert result.effort.verdict.sure
    assert ", found from the data" in result.effort.summary
    assert "; sure: " in result.effort.summary
    assert result.errors[1].nrmse < 0.01
    assert not [note for note in result.notes if "effort is taken" in note]


def test_what_the_data_tell_goes_before_the_run_configuration_and_that_is_said(bags, robot):
    result = evaluate(bags / "current", robot, effort_is="auto")
    assert result.effort.meaning == "current"
    assert (
        "effort is taken as current, found from the data, where the run configuration says torque"
        in result.notes
    )


def test_a_description_alone_states_nothing(bags, robot):
    alone = replace(robot, file=robot.urdf)
    assert evaluate(bags / "torque", alone).effort.summary.startswith("torque, by default")
    notes = evaluate(bags / "current", alone, effort_is="auto").notes
    assert not [note for note in notes if "effort is taken" in note]


@pytest.mark.parametrize("configured", ["torque", "torque_without_gravity"])
def test_where_the_data_dont_tell_the_configuration_counts(tmp_path, robot, configured):
    """As without gravity, or where all axes are upright."""
    none = (0.0, 0.0, 0.0)
    solver = Solver(RIGID_BODY, urdf=URDF.read_text(), root="base_link", tip="tool0", gravity=none)
    recording(tmp_path / "bag", solver)
    weightless = replace(robot, gravity=none, effort=configured)
    result = evaluate(tmp_path / "bag", weightless, effort_is="auto")
    assert (result.effort.meaning, result.effort.verdict.sure) == (configured, False)
    note = " ".join(result.notes)
    assert "the data don't determine what effort means" in note
    assert "torque and torque_without_gravity can't be told apart" in note
    assert f"taken as {configured}, as the run configuration says" in note
    nothing = evaluate(tmp_path / "bag", replace(weightless, effort="auto"))
    assert nothing.effort.meaning == "torque"
    assert "taken as torque, as nothing is stated" in " ".join(nothing.notes)


@pytest.fixture
def currents_by_format(monkeypatch):
    """Recordings whose format says that efforts are currents."""
    opened = run.open_motion
    monkeypatch.setattr(
        run, "open_motion", lambda *a, **k: opened(*a, **k)._replace(effort_is="current")
    )


def test_efforts_that_are_all_zero_are_said(tmp_path, bags, solver, robot):
    recording(tmp_path / "nothing", solver, effort=np.zeros((1500, 6)))
    said = "all recorded efforts are zero: does the robot's driver measure them? Some publish zeros"
    assert said in evaluate(tmp_path / "nothing", robot).notes
    assert said not in evaluate(bags / "torque", robot).notes


@pytest.mark.usefixtures("currents_by_format")
def test_the_format_goes_before_the_configuration_and_the_option_before_both(bags, robot):
    result = evaluate(bags / "current", robot)
    assert result.effort.summary.startswith("current, as the recording's format says")
    assert "where the run configuration says torque" in " ".join(result.notes)
    automatic = evaluate(bags / "current", replace(robot, effort="auto"))
    assert automatic.effort.meaning == "current"
    assert automatic.effort.verdict is None
    told = evaluate(bags / "torque", robot, effort_is="torque")
    assert told.effort.meaning == "torque"
    assert (
        "effort is taken as torque, as given, where the recording's format says current"
        in told.notes
    )


@pytest.mark.usefixtures("currents_by_format")
def test_where_the_data_dont_tell_the_format_counts(bags, robot):
    alike = replace(robot, drive_gains=(1.0,) * 6)
    result = evaluate(bags / "torque", alike, effort_is="auto")
    assert result.effort.verdict.sure is False
    assert result.effort.meaning == "current"
    assert "taken as current, as the recording's format says" in " ".join(result.notes)


def test_a_solver_identified_in_currents_brings_drive_gains_and_others_replace_them(tmp_path):
    solver = Solver(UR10)
    own = tuple(solver.drive_gains.tolist())
    q, qd, qdd, _ = motion()
    recording(tmp_path / "bag", solver, effort=solver.torques(q, qd, qdd) / own)
    ur10 = load_robot("ur10_real")
    result = evaluate(tmp_path / "bag", ur10, effort_is="current")
    assert result.effort.drive_gains == own
    assert result.errors[0].nrmse < 0.005
    assert not [note for note in result.notes if "drive gains" in note]
    result = evaluate(tmp_path / "bag", replace(ur10, drive_gains=GAINS), effort_is="current")
    assert result.effort.drive_gains == GAINS
    note = "drive gains are those of the run configuration; the solver's own are 13.58 14.3"
    assert note in " ".join(result.notes)


# Mistakes.


def test_currents_without_drive_gains_anywhere_are_an_error(bags, robot):
    without = replace(robot, drive_gains=(), effort="current")
    expected = (
        "robot ur10_simulated: effort means current, as the run configuration says: expected drive "
        f"gains [N m/A], got none from {robot.file} nor from {RIGID_BODY}; give drive_gains"
    )
    with pytest.raises(RobotError, match=re.escape(expected)):
        evaluate(bags / "current", without)

# SPDX-License-Identifier: Apache-2.0
"""`ids excite`."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import yaml
from command_line import fails
from identified_arms import identification
from simulation_arms import robots_package, two_links

from inverse_dynamics.excitation import excitation
from inverse_dynamics.excitation.excitation import ExcitationOptions
from inverse_dynamics.excitation.excite import excite
from inverse_dynamics.excitation.files import LEAD_IN, message_text
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.robots.robots import load_robot, robot_of_description
from inverse_dynamics.simulation import simulate, write_run
from inverse_dynamics.simulation.trajectory import WaypointTrajectory, read_trajectory


@pytest.fixture
def quick(monkeypatch):
    """Searches of a few iterations."""
    monkeypatch.setattr(excitation, "ExcitationOptions", partial(ExcitationOptions, iterations=6))


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "arm.urdf").write_text(two_links())
    return tmp_path / "arm.urdf"


@pytest.mark.usefixtures("quick")
def test_writes_a_motion_and_the_message_to_send(ids, arm, tmp_path):
    code, printed, err = ids("excite", "--urdf", arm, "--duration", "8", "--out", "motion.yaml")
    assert code == 0
    assert err == "ids: searching for the motion, which takes about a minute ...\n"
    assert "motion         8 s, condition number of the base regressor" in printed
    assert "noise          1 % of each effort limit" in printed
    rows = re.findall("N m .*", printed)
    shares = [int(share) for row in rows for share in row.split()[4:7]]
    assert 70 < max(shares) <= 80  # of the limits, of which --share leaves as much
    assert "written        motion.yaml, motion.npz, motion_joint_trajectory.yaml" in printed
    motion, source = read_trajectory(tmp_path / "motion.yaml", ("shoulder", "lift", "fold"))
    assert "made by ids excite" in source
    message = yaml.safe_load((tmp_path / "motion_joint_trajectory.yaml").read_text())
    assert message["joint_names"] == ["shoulder", "lift", "fold"]
    assert set(message) == {"header", "joint_names", "points"}
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "arm.urdf",
        "motion.npz",
        "motion.yaml",
        "motion_joint_trajectory.yaml",
    ]
    # what a controller makes of the points by polynomials of the fifth order is the motion
    stamps = [p["time_from_start"] for p in message["points"]]
    seconds = np.array([s["sec"] + 1e-9 * s["nanosec"] for s in stamps]) - LEAD_IN
    columns = [
        np.array([p[key] for p in message["points"]])
        for key in ("positions", "velocities", "accelerations")
    ]
    followed = WaypointTrajectory(tuple(message["joint_names"]), seconds, *columns)
    moments = np.linspace(0.0, 8.0, 333)
    for sent, meant in zip(followed.at(moments), motion.at(moments), strict=True):
        np.testing.assert_allclose(sent, meant, atol=1e-6)


def test_message_with_points_of_equal_distance() -> None:
    motion = WaypointTrajectory.through(("a",), np.array([0.0, 1.0]), np.array([[0.0], [1.0]]))
    points = yaml.safe_load(message_text(motion, ["b"], step=0.25))["points"]
    assert [p["time_from_start"] for p in points] == [
        {"sec": 3 + k // 4, "nanosec": k % 4 * 250_000_000} for k in range(5)
    ]
    np.testing.assert_allclose(points[2]["positions"], [0.5])


@pytest.mark.usefixtures("quick")
def test_motion_is_followed_by_the_simulated_robot(ids):
    robot = ("--robot", "ur10_simulated")
    assert ids("excite", *robot, "--duration", "6", "--out", "motion.yaml")[0] == 0
    command = ("simulate", *robot, "--trajectory", "motion.yaml", "--out", "bag")
    assert ids(*command, "--rate", "125")[0] == 0


@pytest.mark.usefixtures("quick")
def test_table_compares_with_the_stored_motion_of_the_robot(ids):
    _, printed, _ = ids("excite", "--robot", "panda_simulated", "--out", "motion.yaml")
    assert re.search(r"unit +from +to +speed +acc\. +torque +before +stored +after", printed)


def test_share_of_the_limits_is_kept(arm: Path) -> None:
    options = ExcitationOptions(share=0.3, duration=6.0, time_to_full_speed=1.0, iterations=6)
    result = excite(robot_of_description(arm), options=options)
    time = np.linspace(0.0, 6.0, 6001)
    q, qd, qdd = result.excitation.trajectory.at(time)
    assert np.abs(q).max() <= 0.9 + 1e-9
    assert np.abs(qd).max() <= 0.6 + 1e-9
    assert np.abs(qdd).max() <= 0.6 + 1e-9
    assert (result.greatest <= 1.0 + 1e-9).all()


def test_given_recording_that_never_moves_the_wrist_is_completed(tmp_path: Path) -> None:
    """The arm moved, the last three joints stood still: that is reported, and they are what moves most."""
    robot = load_robot("ur10_simulated")
    stored, _ = read_trajectory(robots_package() / "trajectories/ur10.yaml", tuple(robot.joints))
    still = WaypointTrajectory.through(
        stored.joint_names,
        (times := np.linspace(0.0, 20.0, 81)),
        np.where(np.arange(6) < 3, stored.at(times)[0], stored.at(np.zeros(1))[0]),
    )
    run = simulate(robot, trajectory=still, rate=125, table=False)
    write_run(run, tmp_path / "bag")
    options = ExcitationOptions(iterations=30)
    result = excite(robot, given=[tmp_path / "bag"], options=options)
    for joint in ("wrist_1_joint", "wrist_2_joint", "wrist_3_joint"):
        assert any(f"{joint} moves by" in note for note in result.notes)
    assert not any("elbow_joint moves by" in note for note in result.notes)
    assert result.noise_source == "residuals of the given recordings"
    left = result.deviation["motion"] / result.deviation["given"]
    assert left[3:].max() < 0.5
    assert (np.ptp(result.travel[3:], axis=1) > 0.5).all()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (
            ["--payload", "--given", "bag"],
            "got both: recordings of the arm contain no information about a payload",
        ),
        (["--urdf", "no.urdf"], "no.urdf: no such file"),
        (["--urdf", __file__], f"{__file__}: isn't XML; expected a URDF"),
        (["--tip", "nowhere"], "tip: expected a link of the robot, got 'nowhere'"),
        (["--share", "1.5"], "expected a part, above 0 and up to 1, got '1.5'"),
        (["--robot", "ur10_simulated"], "not allowed with"),
    ],
)
def test_mistakes_are_told_in_one_line_and_leave_nothing(ids, arm, tmp_path, options, text):
    result = ids("excite", "--urdf", arm, "--out", "motion.yaml", *options)
    fails(result, text)
    assert result[2].count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["arm.urdf"]


def test_older_files_are_replaced_only_where_that_is_asked(ids, arm, tmp_path):
    (tmp_path / "motion_joint_trajectory.yaml").write_text("mine")
    fails(
        ids("excite", "--urdf", arm, "--out", "motion.yaml"),
        "motion_joint_trajectory.yaml: exists already",
    )
    assert (tmp_path / "motion_joint_trajectory.yaml").read_text() == "mine"


def test_ctrl_c_leaves_nothing(arm: Path, tmp_path: Path) -> None:
    out = tmp_path / "results" / "motion.yaml"
    out.parent.mkdir()
    code = (
        "import sys, threading, os, signal\n"
        "from inverse_dynamics.excitation import excitation\n"
        "plain = excitation._Judge.cost\n"
        "def cost(self, x):\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    return plain(self, x)\n"
        "excitation._Judge.cost = cost\n"
        "from inverse_dynamics.cli import main\n"
        "sys.exit(main(sys.argv[1:]))\n"
    )
    command = ["excite", "--urdf", str(arm), "--out", str(out)]
    done = subprocess.run(
        [sys.executable, "-c", code, *command], capture_output=True, text=True, check=False
    )
    assert done.returncode == 128 + signal.SIGINT
    assert "interrupted" in done.stderr
    assert list(out.parent.iterdir()) == []


def test_the_band_of_a_model_is_the_noise(tmp_path: Path) -> None:
    found = identification()
    band = np.linspace(0.5, 3.0, 6)
    files = write_identification(
        replace(found, model=replace(found.model, torque_deviation=band)), tmp_path / "arm.yaml"
    )
    options = ExcitationOptions(duration=8.0, iterations=6)
    result = excite(files.robot, options=options)
    np.testing.assert_allclose(result.noise, band / 1.96)
    assert result.noise_source == "95 % band of the robot's model"
    plain = excite("ur10_simulated", options=options)
    assert plain.noise_source == "1 % of each effort limit"
    assert not np.allclose(
        plain.excitation.trajectory.positions, result.excitation.trajectory.positions
    )

# SPDX-License-Identifier: Apache-2.0
"""Joints that turn on and on: whether positions are within one turn or unbounded, results are the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from example_recordings import write_motion
from example_robots import KDL, RIGID_BODY
from simulation_arms import joint, link, robot

from inverse_dynamics import Solver, evaluate, identify
from inverse_dynamics.contacts.contacts import find_contacts
from inverse_dynamics.evaluation.ranges import on_one_turn, outside_of_seen
from inverse_dynamics.excitation.excitation import ExcitationOptions
from inverse_dynamics.excitation.excite import excite
from inverse_dynamics.payload.payload import estimate_payload
from inverse_dynamics.recordings.bags import write_joint_logs
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.robots import load_robot, robot_of_description
from inverse_dynamics.simulation import simulate, write_run

JOINTS = ("yaw", "pitch", "roll")
TURN = 2 * np.pi
SAME = 1e-9  # rounding of a few dozen turns, in what is compared
LOAD = {"mass": 1.5, "center_of_mass": [0.1, 0.02, -0.03]}


def description(kind: str = "continuous") -> str:
    limits = 'lower="-7" upper="7" ' if kind == "revolute" else ""
    options = {"kind": kind, "limit": f'<limit {limits}velocity="30" effort="200"/>'}
    return robot(
        link("base"),
        link("s1", 1.5, "0.05 0 0.1"),
        link("s2", 1.1, "0.1 0.02 -0.05"),
        link("s3", 0.7, "0.2 0 -0.1"),
        joint("yaw", "base", "s1", axis="0 0 1", **options),
        joint("pitch", "s1", "s2", axis="0 1 0", xyz="0.1 0 0.1", **options),
        joint("roll", "s2", "s3", axis="1 0 0.3", xyz="0.3 0 -0.1", **options),
    )


@pytest.fixture(scope="module")
def urdf(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("arm") / "turning.urdf"
    path.write_text(description())
    return path


REPORTS = {
    "unbounded": lambda q: q,
    "within_pi": lambda q: (q + np.pi) % TURN - np.pi,
    "within_turn": lambda q: q % TURN,
}


def motion(seconds: float, speed: float = 5.0) -> tuple[np.ndarray, ...]:
    """Time, q, qd, qdd at 250 Hz: yaw turns on with a mean speed [rad/s], all swing about seams."""
    time = np.arange(0, seconds, 1 / 250)
    turning = np.array([speed, 0.0, 0.0])
    q = time[:, None] * turning + np.pi * np.array([1, 1, -1])
    qd, qdd = np.tile(turning, (len(q), 1)), np.zeros_like(q)
    for k, (a, b) in enumerate([(0.5, 0.3), (0.3, -0.4), (-0.2, 0.2)], 1):
        w = TURN * 0.13 * k * np.array([1.0, 1.07, 1.15])
        s, c = np.sin(w * time[:, None]), np.cos(w * time[:, None])
        q, qd, qdd = q + a * s + b * c, qd + w * (a * c - b * s), qdd - w**2 * (a * s + b * c)
    return time, q, qd, qdd


def log_of(report: str, effort: np.ndarray, *how: float) -> JointLog:
    time, q, qd, _ = motion(*how)
    stamps = 1_000_000_000 + np.round(1e9 * time).astype(np.int64)
    return JointLog(JOINTS, stamps, stamps, REPORTS[report](q), qd, effort)


def write_csv(path: Path, log: JointLog) -> Path:
    states = {"position": log.q, "velocity": log.qd, "effort": log.effort}
    return write_motion(path, JOINTS, log.time, **states)


def recordings(directory: Path, effort: np.ndarray, *how: float) -> dict[str, Path]:
    """The same motion under each report."""
    return {
        report: write_csv(directory / f"{report}.csv", log_of(report, effort, *how))
        for report in REPORTS
    }


def torques(urdf: Path, *how: float) -> np.ndarray:
    return Solver(RIGID_BODY, urdf=urdf.read_text()).torques(*motion(*how)[1:])


def noise(count: int) -> np.ndarray:
    return 0.02 * np.random.default_rng(1).normal(size=(count, 3))


def test_python_tells_how_joints_move(urdf):
    assert Solver(RIGID_BODY, urdf=urdf.read_text()).joint_types == ("continuous",) * 3
    assert Solver(KDL, urdf=urdf.read_text()).joint_types == ("continuous",) * 3
    types = Solver(KDL, urdf=description("revolute").replace('"revolute"', '"prismatic"', 1))
    assert types.joint_types == ("prismatic", "revolute", "revolute")


@pytest.mark.parametrize("storage", ["csv", "bag"])
def test_evaluations_are_the_same(urdf, tmp_path, storage):
    effort = torques(urdf, 12.0) + noise(3000)
    found = {}
    for report in REPORTS:
        log = log_of(report, effort, 12.0)
        path = tmp_path / report
        if storage == "csv":
            path = write_csv(tmp_path / f"{report}.csv", log)
        else:
            write_joint_logs(path, {log.topic: log})
        found[report] = evaluate(path, robot_of_description(urdf))
    expected = found["unbounded"]
    assert expected.mean_rmse < 0.03
    assert not any("turn" in note for note in expected.notes)
    for other in found.values():
        assert other.accelerations.cutoff == pytest.approx(expected.accelerations.cutoff, rel=SAME)
        assert other.accelerations.time_base == expected.accelerations.time_base
        assert other.notes == expected.notes
        np.testing.assert_allclose(other.qdd, expected.qdd, rtol=0, atol=SAME)
        np.testing.assert_allclose(other.computed, expected.computed, rtol=0, atol=SAME)
        turns = (other.log.q - expected.log.q) / TURN
        np.testing.assert_allclose(turns, np.round(turns[0]) + 0 * turns, rtol=0, atol=SAME)


def test_identified_models_are_the_same(urdf, tmp_path):
    how = (24.0, 0.0)  # friction of a joint shows where it reverses
    _, _, qd, _ = motion(*how)
    friction = qd * [0.5, 0.4, 0.1] + np.tanh(qd / 0.02) * [0.6, 0.8, 0.2]
    effort = torques(urdf, *how) + friction + noise(6000)
    paths = recordings(tmp_path, effort, *how)
    found = {r: identify([path], robot_of_description(urdf)) for r, path in paths.items()}
    expected = found["unbounded"].held_out["identified"]
    assert np.max(expected) < 0.05
    for other in found.values():
        np.testing.assert_allclose(other.held_out["identified"], expected, rtol=1e-6)
        assert other.law == found["unbounded"].law


def test_ranges_of_recordings_on_different_turns_are_those_of_the_motion(urdf, tmp_path):
    """A driver that starts again reports other turns than before."""
    effort = torques(urdf, 24.0, 0.0) + noise(6000)
    logs = [log_of("unbounded", part, 24.0, 0.0) for part in (effort, effort + noise(6000))]
    logs[1].q[:] += TURN * np.array([-3, 1, 0])
    paths = [write_csv(tmp_path / f"{k}.csv", log) for k, log in enumerate(logs)]
    seen = identify(paths, robot_of_description(urdf)).model.seen[0]
    q = logs[0].q
    np.testing.assert_allclose(seen, np.stack([q.min(axis=0), q.max(axis=0)], axis=1), atol=0.05)


def test_recordings_of_joints_with_limits_stay_on_their_turns(urdf, tmp_path):
    fixed = tmp_path / "revolute.urdf"
    fixed.write_text(description("revolute"))
    for arm, moved in ((urdf, 0.0), (fixed, TURN)):
        log = log_of("unbounded", torques(urdf, 12.0, 0.0), 12.0, 0.0)
        first = evaluate(write_csv(tmp_path / "first.csv", log), robot_of_description(arm))
        log.q[:, 0] -= TURN
        second = evaluate(write_csv(tmp_path / "second.csv", log), robot_of_description(arm))
        one, other = (e.log.q for e in on_one_turn([first, second]))
        np.testing.assert_allclose(one[:, 0] - other[:, 0], moved, rtol=0, atol=SAME)
        np.testing.assert_array_equal(one[:, 1:], other[:, 1:])


def test_payloads_are_the_same(urdf, tmp_path):
    solver = Solver(RIGID_BODY, urdf=urdf.read_text())
    solver.set_payload("load", **LOAD)
    effort = solver.torques(*motion(12.0)[1:]) + noise(3000)
    paths = recordings(tmp_path, effort, 12.0)
    found = [estimate_payload(p, robot_of_description(urdf)).estimate for p in paths.values()]
    assert found[0].mass == pytest.approx(LOAD["mass"], abs=0.02)
    for other in found[1:]:
        assert other.mass == pytest.approx(found[0].mass, abs=SAME)
        np.testing.assert_allclose(other.center_of_mass, found[0].center_of_mass, atol=SAME)


def test_contacts_are_the_same(urdf, tmp_path):
    effort = torques(urdf, 24.0) + noise(6000)
    effort[4500:4600, 1] += 5.0  # a push
    paths = recordings(tmp_path, effort, 24.0)
    found = [
        find_contacts(path, robot_of_description(urdf), quiet=(0.0, 17.0))
        for path in paths.values()
    ]
    assert [contact.joint for contact in found[0].contacts] == ["pitch"]
    for other in found[1:]:
        np.testing.assert_allclose(other.torques, found[0].torques, rtol=0, atol=SAME)
        assert len(other.contacts) == 1


def test_a_motion_is_found_simulated_and_evaluated(urdf, tmp_path):
    file = tmp_path / "turning.yaml"
    file.write_text(
        f"schema: 1\nname: arm\ndescription: it turns\nplugin: {RIGID_BODY}\nurdf: {urdf}\n"
    )
    arm = load_robot(file)
    resting = log_of("unbounded", torques(urdf, 12.0, 0.0), 12.0, 0.0)
    resting.q[:, 0], resting.qd[:, 0] = 3.1, 0.0
    first = write_csv(tmp_path / "first.csv", resting)
    resting.q[:, 0] -= TURN
    given = [first, write_csv(tmp_path / "second.csv", resting)]
    options = ExcitationOptions(iterations=6, duration=6.0, table=False)
    found = excite(arm, given=given, options=options)
    assert any("yaw moves by 0 of 6.28 in the 2 given recordings" in note for note in found.notes)

    run = simulate(arm, trajectory=found.excitation.trajectory, rate=500, table=False)
    write_run(run, tmp_path / "bag")
    assert evaluate(tmp_path / "bag", arm).mean_rmse < 0.01


def test_the_range_of_identification_holds_for_any_turn():
    seen = np.array([[[-1.0, 3.0]], [[-1.0, 1.0]], [[-1.0, 1.0]]])
    zero, kept = np.zeros((2, 1)), np.ones(2, dtype=bool)

    def outside(low: float, high: float, kind: str) -> str:
        q = np.array([[low], [high]])
        return outside_of_seen(seen, (q, zero, zero), kept, ["j"], ["N m"], types=[kind])

    assert outside(TURN - 0.9, TURN + 2.9, "continuous") == ""
    assert "j q" in outside(TURN - 0.9, TURN + 2.9, "revolute")
    assert "j q -2.78" in outside(3.5, 6.2, "continuous")
    seen[0] = [0.0, 7.0]  # all around
    assert outside(20.0, 40.0, "continuous") == ""

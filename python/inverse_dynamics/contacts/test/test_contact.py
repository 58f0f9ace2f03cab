# SPDX-License-Identifier: Apache-2.0
"""External torques and contacts: what Python is given of them, find_contacts(), `ids contact`."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import two_arms
from command_line import fails
from example_recordings import write_motion
from example_robots import KDL
from pages import data_of
from simulation_arms import pendulum, write_robot

from inverse_dynamics import Solver, load_robot
from inverse_dynamics.contact import (
    AccelerationResidual,
    ContactDetector,
    EstimateStatus,
    EstimatorOptions,
    MomentumObserver,
    TipWrench,
    VelocitySource,
    contact_thresholds,
)
from inverse_dynamics.contacts.contacts import find_contacts
from inverse_dynamics.errors import EvaluationError, InvalidParameterError
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.identify import identify
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import robot_of_description

PERIOD = 1e-3
PUSH = (25.0, 26.0, 5.0)  # from, to [s], N m


@pytest.fixture(scope="module")
def solver():
    return Solver(KDL, urdf=pendulum(), root="base", tip="arm")


@pytest.fixture(scope="module")
def motion(solver):
    """Half a minute of a swinging pendulum that somebody holds for a second."""
    time = PERIOD * np.arange(30_000)
    middle = (time - PERIOD / 2)[:, None]
    effort = solver.torques(np.sin(middle), np.cos(middle), -np.sin(middle))
    effort[(time >= PUSH[0]) & (time < PUSH[1])] += PUSH[2]
    effort += 0.1 * np.random.default_rng(0).standard_normal(effort.shape)
    step = 2 * np.pi / 2**19
    return time, step * np.round(np.sin(time[:, None]) / step), effort


@pytest.fixture
def recording(tmp_path, motion):
    return write_table(tmp_path / "recording.csv", *motion)


@pytest.fixture
def robot(tmp_path):
    return write_robot(tmp_path, pendulum(), plugin=KDL)


def write_table(path, time, q, effort):
    qd = np.gradient(q[:, 0], time)
    return write_motion(path, ["swing"], time, position=q, velocity=qd, effort=effort)


@pytest.mark.parametrize("kind", [MomentumObserver, AccelerationResidual])
def test_run_is_update_after_update(solver, motion, kind):
    time, q, effort = (values[:200] for values in motion)
    torques, valid = kind(solver, EstimatorOptions([60.0])).run(time, q, effort)
    one = kind(solver, EstimatorOptions([60.0]))
    for k in range(len(time)):
        period = time[k] - time[k - 1] if k else 0.0
        now, status = one.update(q[k], effort[k], period)
        assert (now == torques[k]).all()
        assert (status == EstimateStatus.OK) == valid[k]
        assert (one.torques == now).all()
    assert valid.sum() > 100
    one.reset()
    assert one.update(q[0], effort[0], PERIOD)[1] == EstimateStatus.STARTING


def test_wrong_shapes_and_options_are_refused(solver, motion):
    time, q, effort = motion
    observer = MomentumObserver(solver, EstimatorOptions([60.0]))
    with pytest.raises(ValueError, match=r"q: expected an array \(30000, 1\), got \(30000,\)"):
        observer.run(time, q[:, 0], effort)
    with pytest.raises(ValueError, match="effort: expected an array"):
        observer.run(time, q, effort[1:])
    with pytest.raises(InvalidParameterError, match="momentum observer: gain: wrong size"):
        MomentumObserver(solver, EstimatorOptions([1.0, 1.0]))
    with pytest.raises(InvalidParameterError, match="tip wrench: noise: wrong size"):
        TipWrench(solver, [1.0, 1.0])
    with pytest.raises(ValueError, match="quiet: expected an array"):
        contact_thresholds(effort, PERIOD, 1.0, ["a", "b"])


def test_detector_and_thresholds(solver, motion):
    time, q, effort = motion
    torques, valid = MomentumObserver(solver, EstimatorOptions([60.0])).run(time, q, effort)
    quiet = valid & (time < 20)
    thresholds = contact_thresholds(torques[quiet], PERIOD, 1.0, solver.joint_names)
    assert thresholds.false_alarms_per_hour == 1.0
    assert 0 < thresholds.noise[0] < thresholds.torques[0] < 1.0
    detector = ContactDetector(thresholds.torques, solver.joint_names)
    contact = detector.run(time, torques)
    assert time[np.argmax(contact)] == pytest.approx(PUSH[0], abs=0.01)
    assert not contact[time > PUSH[1] + 0.3].any()
    other = ContactDetector(thresholds.torques, solver.joint_names)
    periods = np.diff(time, prepend=time[0])  # rounded: a hundred of them aren't always 0.1 s
    one_by_one = [other.update(*row) for row in zip(torques, periods, strict=True)]
    assert one_by_one == contact.tolist()
    assert other.joint == 0


def test_contacts_of_a_recording(recording, robot):
    found = find_contacts(recording, robot, quiet=(0.0, 20.0))
    assert found.estimator == "MomentumObserver"
    (contact,) = found.contacts
    assert contact.begin == pytest.approx(PUSH[0], abs=0.01)
    assert PUSH[1] < contact.end < PUSH[1] + 0.2
    assert found.time[found.contact][[0, -1]].tolist() == [contact.begin, contact.end]
    assert contact.unknown == 0
    assert found.interruptions == ()
    assert contact.joint == "swing"
    assert contact.torque == pytest.approx(PUSH[2], rel=0.1)
    assert contact.unseen == 5


def test_the_force_of_a_contact_is_its_mean(tmp_path):
    """20 N along x for a second; the arm passes a singularity of its wrist, where noise is a force."""
    robot = load_robot("ur10_simulated")
    arm = Arm(robot).solver
    time = 2e-3 * np.arange(15_000)
    start, size = (
        np.array([0.3, -1.2, 1.5, -1.0, 0.0, 0.4]),
        np.array([0.2, 0.1, 0.2, 0.1, 0.3, 0.5]),
    )

    def motion(t, derivative=0):
        return size * np.sin(2 * t + derivative * np.pi / 2)[:, None] * 2**derivative

    middle = time - 1e-3
    effort = arm.torques(start + motion(middle), motion(middle, 1), motion(middle, 2))
    pushed = (time >= 25) & (time < 26)
    effort[pushed] += arm.external_torques(start + motion(time[pushed]), [20.0, 0, 0, 0, 0, 0])
    effort += 0.1 * np.random.default_rng(2).standard_normal(effort.shape)
    states = {"position": start + motion(time), "velocity": motion(time, 1), "effort": effort}
    write_motion(tmp_path / "ur10.csv", arm.joint_names, time, **states)
    found = find_contacts(tmp_path / "ur10.csv", robot, quiet=(0.0, 20.0), gain=60.0)
    (contact,) = found.contacts
    assert contact.force == pytest.approx(20.0, rel=0.1)
    assert contact.force_direction == pytest.approx((1, 0, 0), abs=0.15)
    assert contact.greatest_force > 21


@pytest.mark.parametrize("band", [0.02, 1.0])
def test_a_friction_band_is_what_the_quiet_part_does_not_show(recording, robot, band):
    """So it leaves the thresholds as they are, and may be wider than all that the quiet part shows."""
    without = find_contacts(recording, robot, quiet=(0.0, 20.0))
    found = find_contacts(
        recording, robot, quiet_recording=recording, quiet=(0.0, 20.0), friction_band=[band]
    )
    assert found.thresholds.torques == without.thresholds.torques
    assert found.contacts[0].torque == pytest.approx(without.contacts[0].torque - band)


def test_a_gap_interrupts_the_estimate_and_not_the_contact(ids, tmp_path, motion, robot):
    time, q, effort = motion
    kept = ~((time >= 25.4) & (time < 25.6)) & ~((time >= 10.0) & (time < 10.03))
    recording = write_table(tmp_path / "gaps.csv", time[kept], q[kept], effort[kept])
    found = find_contacts(recording, robot, quiet=(0.0, 20.0), gain=60.0, tracking=200.0)
    assert not found.measured_velocities  # but those of positions
    (contact,) = found.contacts
    assert (contact.begin, contact.end) == pytest.approx((PUSH[0], PUSH[1] + 0.1), abs=0.1)
    (first, second) = found.interruptions
    assert first == pytest.approx((9.999, 10.08), abs=2e-3)  # until the velocity is known
    assert second == pytest.approx((25.399, 25.65), abs=2e-3)
    assert contact.unknown == pytest.approx(0.251, abs=2e-3)
    options = ("--robot", robot, "--quiet", "0,20", "--gain", "60", "--tracking", "200")
    code, out, _ = ids("contact", recording, *options, "--out", "found")
    assert code == 0
    text = " ".join(out.split())
    assert "interrupted 2 times, 0.333 s in all, the longest from 25.399 s to 25.65 s" in text
    assert "25.00 to 26.01 0.25 swing" in text
    summary = json.loads((tmp_path / "found" / "contacts.json").read_text())
    assert len(summary["interruptions"]) == 2


def test_thresholds_that_say_little_are_noted(tmp_path, motion, recording, robot):
    def notes_of(*quiet):
        notes = find_contacts(recording, robot, quiet=quiet).notes
        return [note for note in notes if "thresholds" in note]

    assert notes_of(0.0, 20.0) == []
    found = find_contacts(recording, robot, quiet=(0.0, 20.0))
    *_, (_, none) = replace(found, contacts=(), blind=("lift", "swing")).lines()
    assert none.startswith("none, but lift, swing can't tell")
    (note,) = notes_of(0.0, 0.02)
    assert note.startswith("thresholds rest on few peaks, and are high for that: swing (")

    limit = '<limit lower="-3" upper="3" velocity="2" effort="{}"/>'
    (tmp_path / "arm.urdf").write_text(pendulum(limit=limit.format(0.3)))
    (note,) = notes_of(0.0, 20.0)
    assert "high thresholds: swing (" in note
    assert "% of its effort limit): weaker contacts aren't found" in note

    (tmp_path / "arm.urdf").write_text(pendulum(limit=limit.format(0.01)))
    with pytest.raises(EvaluationError, match="no contact could be found, as thresholds exceed"):
        notes_of(0.0, 20.0)

    (tmp_path / "arm.urdf").write_text(pendulum(limit=limit.format(0)))  # none is stated
    time, q = (values[:10_000] for values in motion[:2])
    held = np.repeat(np.random.default_rng(1).standard_normal((200, 1)), 50, axis=0)
    slow = write_table(tmp_path / "slow.csv", time, np.full_like(q, np.pi / 2), held)
    notes = find_contacts(slow, robot, quiet=(0.0, 10.0), false_alarms=1e-6).notes
    assert any("more than any torque recorded): weaker contacts" in note for note in notes)


def test_efforts_mean_what_they_mean_in_an_evaluation(ids, tmp_path, solver, motion, robot):
    time, q, effort = motion
    table = write_table(tmp_path / "other.csv", time, q, effort - solver.gravity_vector(q))
    options = ("--robot", robot, "--quiet", "0,20", "--figures", "none", "--out", "found")
    meaning = ("--effort-is", "torque_without_gravity")
    code, out, _ = ids("contact", table, *options, *meaning)
    assert code == 0
    assert "effort means   torque without gravity, as given" in out
    summary = json.loads((tmp_path / "found" / "contacts.json").read_text())
    assert summary["effort"] == "torque_without_gravity"
    assert len(summary["contacts"]) == 1
    columns = zip(*(line.split(",") for line in table.read_text().splitlines()), strict=True)
    parts = {"efforts.csv": "effort", "states.csv": ""}
    columns = [*columns]
    for name, kind in parts.items():
        chosen = [c for c in columns if c[0] == "time" or c[0].startswith("effort") == bool(kind)]
        lines = map(",".join, zip(*chosen, strict=True))
        (tmp_path / name).write_text("\n".join(lines) + "\n")
    assert ids("contact", *sorted(parts, reverse=True), *options, *meaning)[0] == 0
    joined = json.loads((tmp_path / "found" / "contacts.json").read_text())
    assert joined["contacts"] == summary["contacts"]
    fails(ids("contact", table, *options, "--effort-is", "current", "--overwrite"), "drive_gains")
    fails(ids("contact", table, *options, "--effort-is", "force"), "invalid choice: 'force'")


def test_measured_velocities_must_be_given(solver, motion):
    options = EstimatorOptions([60.0], velocity=VelocitySource.MEASURED)
    for kind in (MomentumObserver, AccelerationResidual):
        estimator = kind(solver, options)
        expected = (
            "argument qd: expected velocities, as the estimator takes measured ones, got none"
        )
        with pytest.raises(InvalidParameterError, match=f"update: {expected}; give qd, or make"):
            estimator.update([0.0], [0.0], PERIOD)
        with pytest.raises(InvalidParameterError, match=f"run: {expected}"):
            estimator.run(*motion)


def test_without_a_quiet_part_there_are_no_thresholds(recording, robot):
    with pytest.raises(EvaluationError, match=r"give quiet=\(FROM, TO\)"):
        find_contacts(recording, robot)
    with pytest.raises(
        InvalidParameterError, match="recording.csv, from 0 s to 0.2 s: 2.* contact"
    ):
        find_contacts(recording, robot, quiet=(0.0, 0.2), false_alarms=1e9)
    with pytest.raises(InvalidParameterError, match="momentum observer: friction_band"):
        find_contacts(recording, robot, quiet=(0.0, 20.0), friction_band=[1.0, 2.0])


def test_the_command_writes_table_figure_and_series(ids, tmp_path, recording, robot):
    command = ("contact", recording, "--robot", robot, "--quiet", "0,20", "--out", "found")
    code, out, err = ids(*command)
    assert (code, err) == (0, "")
    for part in ("25.0", "swing", "MomentumObserver, "):
        assert part in out
    assert "thresholds for 1 false alarm per hour" in out
    files = {file.name for file in (tmp_path / "found").iterdir()}
    assert files == {"contacts.json", "contacts.png", "report.html", "series.npz"}
    summary = json.loads((tmp_path / "found" / "contacts.json").read_text())
    assert len(summary["contacts"]) == 1
    (run,) = data_of((tmp_path / "found" / "report.html").read_text())
    begin, end = run["contacts"][0]
    assert (begin, end) == (summary["contacts"][0]["begin"], summary["contacts"][0]["end"])
    torques, errors = run["plots"]
    assert torques["band"] == []
    assert errors["band"][0]["half"] == summary["joints"][0]["torques"]
    assert summary["joints"][0]["torques"] > summary["joints"][0]["noise"]
    series = np.load(tmp_path / "found" / "series.npz")
    assert series["torques"].shape == (30_000, 1)
    assert series["contact"].sum() > 1000
    assert series["wrenches"].shape == (30_000, 6)
    code, out, err = ids(*command, "--no-figures", "--json")
    assert (code, err) == (0, "ids: replaced the earlier result in found\n")
    document = {"schema": 3, "verb": "contact", "written": ["found"], "result": summary}
    assert json.loads(out) == document
    assert not (tmp_path / "found" / "contacts.png").exists()


def test_thresholds_of_another_recording(ids, tmp_path, motion, recording, robot):
    time, q, effort = (values[:20_000] for values in motion)
    quiet = write_table(tmp_path / "quiet.csv", time, q, effort)
    options = ("--robot", robot, "--quiet-recording", quiet, "--gain", "30", "--figures", "none")
    code, out, _ = ids("contact", recording, *options)
    assert code == 0
    assert f"quiet          {quiet}" in out
    assert "25.0" in out
    code, out, _ = ids("contact", quiet, *options)
    assert code == 0
    assert "contacts       none" in out


def test_wrong_options_are_told(ids, tmp_path, recording, robot):
    command = ("contact", recording, "--robot", robot, "--out", "found")
    fails(ids(*command), "which part of the recording is without contact?")
    fails(ids(*command, "--quiet", "20,0"), "expected two times, the later one second, got '20,0'")
    fails(ids(*command, "--quiet", "0,1,2"), "expected two times")
    fails(ids(*command, "--quiet", "0,20", "--friction-band", "a"), "expected numbers, a,b,c")
    fails(ids(*command, "--quiet", "100,200"), "expected a part of the recording, which ends")
    for span in ("-5,1e300", "1e300,2e300"):
        fails(
            ids(*command, f"--quiet={span}"),
            f"--quiet (quiet=): expected two times in s since the first sample, the later one second, "
            f"got {span.replace('e', 'e+')}",
        )
    quiet = (*command, "--quiet", "0,20")
    fails(
        ids(*quiet, "--false-alarms", "1e-323"), "at least 1e-06 (one in a century) [1/h], got 9."
    )
    fails(ids(*quiet, "--false-alarms", "1e9"), "too many false alarms: expected at most")
    for name in ("gain", "tracking"):
        for extreme in ("1e-300", "1e300"):
            fails(ids(*quiet, f"--{name}", extreme), f"{name}:", "from 0.001 to 1e6")
    fails(
        ids(*quiet, "--tracking", "0.01"), "expected a stretch of 1e+03 s without a gap of 0.02 s"
    )
    assert not (tmp_path / "found").exists()


def alarms_in_hours(found, hours):
    """Contacts that a detector begins in the torques of a recording, put together in parts of 2 s."""
    period, torques = np.median(np.diff(found.time)), found.torques[found.valid]
    length = round(2.0 / period)
    begins = np.random.default_rng(0).integers(0, len(torques) - length, round(hours * 1800))
    together = np.concatenate([torques[begin : begin + length] for begin in begins])
    names = found.evaluation.joint_names
    detector = ContactDetector(found.thresholds.torques, names)
    contact = detector.run(period * np.arange(len(together)), together)
    return int((np.diff(contact, prepend=False) & contact).sum())


@pytest.mark.parametrize("half", [0, 1])
@pytest.mark.parametrize("name", ["ur10_real", "panda_real"])
def test_no_contact_that_is_none(recordings, tmp_path, name, half):
    """Of each half of a real recording, with the model and the errors of the other half.

    None in 3 h of it: with a confidence of 95 %, there are no more than the stated one per hour.
    """
    folder = recordings / f"{name.removesuffix('_real')}_exciting_trajectory"
    middle = {"ur10_real": 13.7, "panda_real": 12.1}[name]  # s
    parts = ({"end": middle}, {"start": middle})
    identified = identify([folder], name, **parts[half])
    robot = write_identification(identified, tmp_path / "arm.yaml").robot
    found = find_contacts(folder, robot, **parts[1 - half])
    assert found.quiet.startswith("errors of the model on held-out data: ")
    assert found.contacts == ()
    assert alarms_in_hours(found, 3.0) == 0
    ratio = found.thresholds.torques / np.abs(found.torques).max(axis=0)
    assert ratio.min() < 6  # thresholds aren't so high that nothing could ever be one


def test_a_quiet_part_at_rest_does_not_stand_for_a_motion(tmp_path, solver, robot):
    """Friction that the model lacks shows where the joint moves; then thresholds are raised."""
    rng = np.random.default_rng(0)
    time = 0.01 * np.arange(6000)
    q = np.where(time < 3, 1.0, np.cos(time - 3))[:, None]
    qd = np.where(time < 3, 0.0, -np.sin(time - 3))[:, None]
    qdd = np.where(time < 3, 0.0, -np.cos(time - 3))[:, None]
    effort = solver.torques(q, qd, qdd) + 2.0 * qd + 0.01 * rng.standard_normal(q.shape)
    table = write_table(tmp_path / "moving.csv", time, q, effort)
    found = find_contacts(table, robot, quiet=(0.0, 2.9))
    assert found.contacts == ()
    assert any("thresholds are raised, " in note and ": swing (" in note for note in found.notes)


def test_jitter_of_stamps_is_no_torque(ids, tmp_path):
    """It is in the stamps alone, and raises the noise of usual sensors by a half at most."""
    noise = []
    for jitter in ("0", "5e-4"):
        options = ("--duration", "40", "--message-rate", "100", "--jitter", jitter, "--noise")
        code, _, err = ids("simulate", "--robot", "ur10_simulated", *options, "--out", jitter)
        assert code == 0, err
        found = find_contacts(tmp_path / jitter, "ur10_simulated", quiet=(0.0, 35.0))
        assert found.contacts == ()
        noise.append(found.thresholds.noise)
    assert (noise[1] <= 1.5 * noise[0]).all()


def test_friction_that_turns_round_is_no_contact(tmp_path):
    """Efforts are sampled with the states: those of friction jump in the sample in which the joint turns round."""
    urdf = pendulum(inner='<dynamics damping="0.4" friction="0.8"/>')
    (tmp_path / "arm.urdf").write_text(urdf)
    arm = robot_of_description(tmp_path / "arm.urdf")
    arm = replace(arm, friction=True, parameters={"urdf_friction": True})
    time = 0.004 * np.arange(5000)[:, None]
    q, qd, qdd = np.sin(3 * time), 3 * np.cos(3 * time), -9 * np.sin(3 * time)
    effort = Solver(arm.plugin, urdf=urdf, parameters=arm.parameters).torques(q, qd, qdd)
    effort += 0.02 * np.random.default_rng(0).standard_normal(effort.shape)
    states = {"position": q, "velocity": qd, "effort": effort}
    write_motion(tmp_path / "turns_round.csv", ["swing"], time, **states)
    found = find_contacts(tmp_path / "turns_round.csv", arm, quiet=(0.0, 0.5))
    assert found.contacts == ()
    assert np.abs(found.torques).max() < 0.05


def test_the_wrench_of_a_tree_is_that_of_the_first_tip(tmp_path):
    push, file = np.array([20.0, 0.0, -10.0, 0.0, 0.0, 0.0]), two_arms.written(tmp_path)
    for tips in (two_arms.ARMS, two_arms.ARMS[::-1]):
        tree = Solver(urdf=two_arms.URDF, tip=tips)
        table = two_arms.motion(tree)
        pushed = (table["time"] > 10.0) & (table["time"] < 11.0)
        table["effort"] += 0.05 * np.random.default_rng(0).standard_normal(table["effort"].shape)
        table["effort"][pushed] += tree.external_torques(table["q"][pushed], push)
        found = find_contacts(table, quiet=(1.0, 9.0), urdf=file, tip=tips)
        (contact,) = found.contacts
        middle = found.wrenches[pushed][100:-20].mean(axis=0)
        np.testing.assert_allclose(middle[:3], push[:3], atol=3.0)
        assert 10.0 < contact.begin < 10.1
        assert any(f"the wrench is that at {tips[0]}" in note for note in found.notes)

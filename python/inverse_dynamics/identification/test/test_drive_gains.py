# SPDX-License-Identifier: Apache-2.0
"""Drive gains from motor currents of a UR10 that is known, without and with a known load."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from command_line import fails

from inverse_dynamics import _core, evaluate, identify, load_robot, write_joint_logs
from inverse_dynamics.cli import main
from inverse_dynamics.identification.drive_gains import identify_drive_gains
from inverse_dynamics.identification.result import IdentificationError
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.terminal.values import payload

RATE, SECONDS = 125.0, 40.0  # Hz, s
LOAD = payload("5,0.03,-0.02,0.12")
# Gravity turns the second to the fifth joint; about the first its axis is vertical, and of the sixth
# the load is beside the axis by 36 mm.
LOADED = slice(1, 5)
# N m, correlated over a quarter of a second: what the best model leaves of a real UR10's torques.
NOISE = np.array([1.17, 1.35, 1.72, 0.467, 0.423, 1.38])


SWEEP = np.array([1.0, 0.7, 1.0, 2.0, 2.0, 2.0])  # wrists turn far: gravity loads them both ways


def motion(seconds, seed):
    """Sums of sines about a bent pose, as slow as a robot with a load may move: q, qd, qdd (N, 6)."""
    random = np.random.default_rng(seed)
    time = np.arange(0, seconds, 1 / RATE)[:, None]
    pose = np.array([0.0, -1.2, 1.3, -0.6, -1.2, 0.3])
    q, qd, qdd = pose + 0 * time, np.zeros((len(time), 6)), np.zeros((len(time), 6))
    for frequency in (0.07, 0.19, 0.33, 0.52):
        w, phase = 2 * np.pi * frequency, random.uniform(0, 6, 6)
        amplitude = random.uniform(0.15, 0.3, 6) * SWEEP * (0.25 / frequency) ** 0.7
        q += amplitude * np.sin(w * time + phase)
        qd += amplitude * w * np.cos(w * time + phase)
        qdd -= amplitude * w**2 * np.sin(w * time + phase)
    return q, qd, qdd


def fitter_of(robot):
    return _core.ArmFitter.from_urdf(read_description(robot.urdf), root=robot.root, tip=robot.tip)


class Currents:
    """A UR10 whose drive gains are known, and recordings of its currents.

    Links and friction are fitted to the identified UR10, whose rows are no chain of bodies: a load's
    torque would contradict them.
    """

    def __init__(self):
        published = Arm(load_robot("ur10_real")).solver
        self.gains = published.drive_gains
        self.robot = replace(load_robot("ur10_simulated"), effort="current")
        self.bodies = Arm(self.robot).solver
        self.fitter = fitter_of(self.robot)
        states = motion(SECONDS, seed=50)
        sample = (*states, published.torques(*states))
        self.truth = self.fitter.fit(
            self.fitter.data([sample]), _core.ArmFitOptions("step", prior_strength=1.0)
        )

    def torques(self, q, qd, qdd, load=None):
        tau = self.fitter.torques(self.truth, q, qd, qdd)
        if load is not None:
            without = self.bodies.torques(q, qd, qdd)
            self.bodies.set_payload("load", load["payload.mass"], load["payload.center_of_mass"])
            tau += self.bodies.torques(q, qd, qdd) - without
            self.bodies.clear_payloads()
        return tau

    def record(self, path, load=None, seconds=SECONDS, seed=1):
        q, qd, qdd = motion(seconds, seed)
        tau = self.torques(q, qd, qdd, load)
        random, noise = np.random.default_rng(seed + 100), np.zeros_like(tau)
        for k in range(1, len(noise)):
            noise[k] = 0.97 * noise[k - 1] + random.normal(0, NOISE * np.sqrt(1 - 0.97**2), 6)
        stamps = (np.arange(1, len(q) + 1) * 1e9 / RATE).astype(np.int64)
        log = JointLog(
            self.robot.joints or self.fitter.joint_names,
            stamps,
            stamps,
            q + random.normal(0, 1e-5, q.shape),
            qd + random.normal(0, 1e-4, q.shape),
            (tau + noise) / self.gains,
        )
        write_joint_logs(path, {self.robot.topic: log})
        return path


@pytest.fixture(scope="module")
def currents():
    return Currents()


@pytest.fixture(scope="module")
def bags(currents, tmp_path_factory):
    """Without and with the load."""
    directory = tmp_path_factory.mktemp("currents")
    return (
        currents.record(directory / "alone"),
        currents.record(directory / "loaded", LOAD, seed=2),
    )


def test_gains_come_back_where_gravity_loads_the_joint(currents, bags):
    alone, loaded = bags
    wrong = replace(currents.robot, drive_gains=(7.0,) * 6)  # taken where nothing else is known
    found = identify_drive_gains([alone], [(loaded, LOAD)], wrong, fitter_of(wrong))
    values = np.array([gain.value for gain in found])
    np.testing.assert_allclose(values[LOADED], currents.gains[LOADED], rtol=0.03)
    for gain, true in zip(found, currents.gains, strict=True):
        assert gain.stated == 7.0
        if gain.half_width is None:
            assert gain.value == 7.0
        else:
            assert abs(gain.value - true) < 1.5 * gain.half_width
    assert all(gain.half_width is not None for gain in found[LOADED])


def test_a_model_of_currents_evaluates_currents(currents, bags, tmp_path, capsys):
    """From recordings to a robot that every verb takes."""
    alone, loaded = bags
    configuration = tmp_path / "mine.yaml"
    configuration.write_text(
        "schema: 1\nname: mine\ndescription: a UR10\n"
        "plugin: rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody\n"
        f"urdf: {currents.robot.urdf}\nroot: base_link\ntip: tool0\ngravity: [0, 0, -9.81]\n"
        f"topic: {currents.robot.topic}\njoints: [{', '.join(currents.fitter.joint_names)}]\n"
        f"friction: false\neffort: current\ndrive_gains: {currents.gains.round(1).tolist()}\n"
        "source: test\n"
    )
    out = tmp_path / "arm.yaml"
    load = f"{loaded}=5,0.03,-0.02,0.12"
    arguments = ["--known-payload", load, "--robot", str(configuration), "--out", str(out)]
    assert main(["identify", str(alone), *arguments]) == 0
    assert "drive gains    shoulder_pan_joint" in capsys.readouterr().out
    figures = json.loads((tmp_path / "arm.json").read_text())
    gains = [gain["value"] for gain in figures["drive_gains"]]
    assert [gain["joint"] for gain in figures["drive_gains"]] == figures["joints"]
    result = evaluate(alone, out)
    assert result.effort.meaning == "current"
    np.testing.assert_allclose(result.effort.drive_gains, gains)
    assert result.mean_rmse < 1.3 * NOISE.mean()
    again = evaluate(loaded, out, parameters=LOAD)  # whose torques nothing but gains was fitted to
    assert again.mean_rmse < 1.3 * NOISE.mean()


def test_a_load_on_the_axis_of_the_last_joint_doesnt_determine_its_gain(currents, bags, tmp_path):
    on_axis = payload("5,0,0,0.12")
    loaded = currents.record(tmp_path / "on_axis", on_axis, seed=3)
    with pytest.raises(IdentificationError) as caught:
        identify([bags[0]], currents.robot, known_payloads=[(loaded, on_axis)])
    text = str(caught.value)
    assert "doesn't determine the drive gain of" in text
    assert "wrist_3_joint (+- " in text
    assert not any(name in text for name in ("elbow_joint", "shoulder_lift_joint"))
    assert "its center beside the axis" in text
    assert "drive_gains" in text


def test_currents_alone_determine_no_gains(currents, bags):
    with pytest.raises(IdentificationError) as caught:
        identify([bags[0]], currents.robot)
    assert "may all be twice as large" in str(caught.value)
    assert "known_payloads=" in str(caught.value)
    assert caught.value.mistake == "Efforts are motor currents"


@pytest.mark.parametrize(
    ("load", "changes", "expected"),
    [
        (LOAD, {"effort_is": "torque"}, "expected motor currents, .* got torque"),
        ({**LOAD, "payload.mass": 0.0}, {}, "expected a mass above zero, got 0.0"),
        ({"payload.mass": 5.0}, {}, "expected MASS,x,y,z, got a mass alone: .* 0,0,0 if"),
    ],
)
def test_wrong_use_is_refused(currents, bags, load, changes, expected):
    with pytest.raises(IdentificationError, match=expected):
        identify([bags[0]], currents.robot, known_payloads=[(bags[1], load)], **changes)


def test_a_recording_is_either_loaded_or_not(currents, bags):
    with pytest.raises(IdentificationError, match="expected each recording once"):
        identify([bags[0]], currents.robot, known_payloads=[(bags[0], LOAD)])


@pytest.mark.parametrize("text", ["loaded", "=5", "loaded=five", "loaded=5,1"])
def test_the_option_is_a_recording_and_a_load(text, ids):
    options = ["--known-payload", text, "--robot", "ur10_simulated", "--out", "arm.yaml"]
    fails(ids("identify", "alone", *options), "--known-payload")

# SPDX-License-Identifier: Apache-2.0
"""What a model may be wrong by: its file, and that it is that of the fit."""

from __future__ import annotations

import json

import numpy as np
import pytest
from example_recordings import motion
from example_robots import JOINTS
from identified_arms import identification

from inverse_dynamics import Solver, write_joint_logs
from inverse_dynamics._core import ArmUncertainty
from inverse_dynamics.errors import RobotError
from inverse_dynamics.evaluation import bands
from inverse_dynamics.identification.cross_validation import noise_in_motion
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.uncertainty import usual_level
from inverse_dynamics.payload.payload import estimate_payload
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.model_errors import model_errors_file, read_uncertainty
from inverse_dynamics.robots.robots import RIGID_BODY

SIZE = 16 * len(JOINTS)  # unknowns of the law `step`


@pytest.fixture
def found():
    factor = np.random.default_rng(4).normal(size=(SIZE, 5)) * 10.0 ** np.arange(-6, -1)
    return identification(factor=factor)


@pytest.fixture
def model(found, tmp_path):
    return write_identification(found, tmp_path / "arm.yaml").model


def states(count=30):
    q, qd, qdd, _ = motion()
    return q[:count], qd[:count], qdd[:count]


def test_the_file_has_the_deviations_of_the_fit(found, model):
    read, why = read_uncertainty(model)
    assert why == ""
    solver = Solver(RIGID_BODY, model=str(model))
    direct = ArmUncertainty(found.model.friction, found.factor)
    for k in range(5):
        z = np.eye(5)[k]
        expected = direct.torques(solver, z, states())
        np.testing.assert_allclose(
            read.torques(solver, z, states()), expected, rtol=1e-5, atol=1e-6 * abs(expected).max()
        )


def test_a_file_of_another_model_is_left_aside(model):
    model.write_text(model.read_text() + "# by hand\n")
    arm, why = read_uncertainty(model)
    assert arm is None
    assert "arm_model.json: it is another model's, or arm_model.yaml has changed since" in why


def test_no_file_is_no_error(model):
    model_errors_file(model).unlink()
    arm, why = read_uncertainty(model)
    assert arm is None
    assert "arm_model.json: there is none" in why


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda content: content.pop("friction"), "expected schema 4 with the keys"),
        (lambda content: content.update(schema=1), "expected schema 4 with the keys"),
        (lambda content: content.update(more=1), "expected schema 4 with the keys"),
        (lambda content: content["deviations"][0].pop(), "expected deviations: rows"),
        (lambda content: content["deviations"].clear(), "expected deviations: rows"),
        (lambda content: content["deviations"][0].__setitem__(0, "x"), "expected deviations: rows"),
        (lambda content: content.update(deviations=[5.0]), "expected deviations: rows"),
        (lambda content: content.update(deviations=[[]]), "expected deviations: rows"),
        (
            lambda content: content["deviations"][0].__setitem__(0, 10**400),
            "expected deviations: rows",
        ),
        (lambda content: content["friction"][0].update(fc="x"), "expected friction: numbers"),
        (lambda content: content["friction"][0].update(fx=1.0), "expected friction: numbers"),
        (lambda content: content["friction"][0].pop("fc"), "expected friction: numbers"),
        (lambda content: content["held_out"].pop("gain"), "expected held_out: gain, period"),
        (lambda content: content["held_out"].update(gain=0), "expected held_out: gain, period"),
        (lambda content: content["held_out"].update(period="x"), "expected held_out: gain, period"),
        (lambda content: content["held_out"]["torques"].clear(), "expected held_out: gain, period"),
        (
            lambda content: [row.pop() for row in content["held_out"]["torques"]],
            "expected held_out: gain, period",
        ),
        (lambda content: content["band"].pop("level"), "expected band: noise, level"),
        (lambda content: content["band"]["level"].pop(), "expected band: noise, level"),
        (lambda content: content["band"].update(share=[-0.1] * 6), "expected band: noise, level"),
        (lambda content: content.update(fitted_to=["x"]), "expected fitted_to: hexadecimal"),
    ],
)
def test_a_damaged_file_is_refused(model, change, text):
    file = model_errors_file(model)
    content = json.loads(file.read_text())
    change(content)
    file.write_text(json.dumps(content))
    with pytest.raises(RobotError, match=rf"arm_model\.json: {text}.*identify the arm again"):
        read_uncertainty(model)


def test_what_is_not_json_is_refused(model):
    for text in ("no", "[" * 100_000):
        model_errors_file(model).write_text(text)
        with pytest.raises(RobotError, match=r"arm_model\.json: expected JSON of `ids identify`"):
            read_uncertainty(model)


def test_payloads_are_estimated_with_the_deviations_that_a_model_has(model, tmp_path):
    solver = Solver(RIGID_BODY, model=str(model))
    solver.set_payload("load", 4.0, center_of_mass=[0.0, 0.02, 0.1])
    q, qd, qdd, stamps = motion()
    noise = 0.1 * np.random.default_rng(6).standard_normal(q.shape)
    log = JointLog(JOINTS, stamps, stamps, q, qd, solver.torques(q, qd, qdd) + noise)
    write_joint_logs(tmp_path / "loaded", {log.topic: log})
    payload = estimate_payload(tmp_path / "loaded", tmp_path / "arm.yaml")
    assert len(payload.estimate.arm) == 5
    assert payload.estimate.mass == pytest.approx(4.0, rel=0.05)
    assert not [note for note in payload.notes if "arm_model.json" in note]

    model_errors_file(model).unlink()
    without = estimate_payload(tmp_path / "loaded", tmp_path / "arm.yaml")
    assert len(without.estimate.arm) == 0
    assert [note for note in without.notes if "arm_model.json: there is none" in note]


def test_joints_that_never_leave_the_step_of_friction_have_a_noise():
    """One stands still, one has a step as wide as its velocities; only of the third samples at rest don't count."""
    v = np.linspace(-1.0, 1.0, 201)
    qd = np.column_stack([np.zeros_like(v), v, v])
    errors = np.where(np.abs(qd) < 0.02, 5.0, 1.0)
    widths = (0.1, 0.3, 0.005)
    noise = noise_in_motion(errors, qd, [{"width": width} for width in widths])
    np.testing.assert_allclose(noise * bands.NORMAL, [5.0, 1.0, 1.0])


def test_offsets_of_another_day_are_a_share_of_the_range_of_efforts():
    """The limit; three times the greatest torque where there is none or it is passed, and at most seven times."""
    level = usual_level(np.full(4, 20.0), np.array([87.0, np.inf, 10.0, 1e4]))
    np.testing.assert_allclose(level, bands.LEVEL * np.array([87.0, 60.0, 60.0, 140.0]))


def test_the_band_of_a_recording_is_made_in_parts(model, monkeypatch):
    solver = Solver(RIGID_BODY, model=str(model))
    band, _, _ = bands.read_band(model, solver)
    monkeypatch.setattr(bands, "_ROWS", 7)
    np.testing.assert_array_equal(
        band.of_recording(solver, *states()), band.half_widths(solver, *states())
    )

# SPDX-License-Identifier: Apache-2.0
"""docs/why_dont_my_torques_match.md: its commands run, and each mistake looks as the page says."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from pages import NO_FIGURES, REPOSITORY, blocks_of, page, run

from inverse_dynamics import Evaluation, read_evaluation

PAGE = page("docs/why_dont_my_torques_match.md")
PAN, LIFT, ELBOW, WRIST_1, WRIST_2, WRIST_3 = range(6)
MISTAKES = (
    "currents", "without_gravity", "ceiling", "wall", "payload", "tool", "friction", "order",
    "direction", "degrees", "clock", "stamps",
)  # fmt: skip
FITS = 0.1  # N m: beside the mistakes, all of them above 0.5, nothing


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Follow the page, in what stands for the root of the repository."""
    root = tmp_path_factory.mktemp("root")
    for name in ("docs", "core"):
        (root / name).symlink_to(REPOSITORY / name)
    for block in blocks_of(PAGE, "xml", "bash"):
        if block.language == "xml":
            (root / "payload.xml").write_text(block.code)
        else:
            run(block, root, NO_FIGURES)
    return root / "out/why"


def rmse(evaluation: Evaluation) -> np.ndarray:
    return np.array([error.rmse for error in evaluation.errors])


def error_of(evaluation: Evaluation, joint: int) -> np.ndarray:
    return evaluation.computed[:, joint] - evaluation.measured[:, joint]


def slope(x: np.ndarray, y: np.ndarray) -> float:
    return float(np.polyfit(x, y, 1)[0])


def right_motion(results: Path) -> Evaluation:
    return read_evaluation(results / "right")


def test_without_a_mistake_torques_match(results: Path) -> None:
    assert rmse(right_motion(results)).max() < FITS


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_no_small_thing(results: Path, name: str) -> None:
    assert rmse(read_evaluation(results / name)).max() > 0.5


@pytest.mark.parametrize("name", [name for name in MISTAKES if name not in ("tool", "friction")])
def test_the_remedy_helps(results: Path, name: str) -> None:
    assert rmse(read_evaluation(results / f"{name}_right")).max() < FITS


def test_currents_are_the_torques_at_another_scale(results: Path) -> None:
    e = read_evaluation(results / "currents")
    assert slope(e.computed[:, LIFT], e.measured[:, LIFT]) == pytest.approx(1 / 14.3, rel=0.01)
    assert slope(e.computed[:, WRIST_1], e.measured[:, WRIST_1]) == pytest.approx(
        1 / 11.2, rel=0.01
    )
    assert all(error.r2 < 0 for error in e.errors)


def test_without_gravity_the_error_is_gravity(results: Path) -> None:
    e = read_evaluation(results / "without_gravity")
    slow = np.abs(e.log.qd[:, LIFT]).argmin()
    assert abs(e.measured[slow, LIFT]) < 0.3 * abs(e.computed[slow, LIFT])
    error = rmse(e)
    assert error[PAN] < FITS
    assert error[[LIFT, ELBOW]].min() > 30


def test_on_the_ceiling_torques_are_upside_down_but_for_the_first(results: Path) -> None:
    e = read_evaluation(results / "ceiling")
    assert rmse(e)[PAN] < FITS
    for joint in (LIFT, ELBOW, WRIST_1, WRIST_2):
        assert -1.2 < slope(e.computed[:, joint], e.measured[:, joint]) < -0.7


def test_on_a_wall_the_first_joint_carries_weight(results: Path) -> None:
    e = read_evaluation(results / "wall")
    assert np.abs(e.computed[:, PAN]).max() < 11
    assert np.abs(e.measured[:, PAN]).max() > 40
    assert np.abs(e.measured[0, PAN]) > 30  # the robot stands still


def test_a_payload_spares_the_last_joint_and_a_tool_does_not(results: Path) -> None:
    payload, tool = (read_evaluation(results / name) for name in ("payload", "tool"))
    np.testing.assert_allclose(rmse(payload), [3.2, 24, 23, 6.5, 2.4, 0], rtol=0.03, atol=0.001)
    for joint in (LIFT, ELBOW):
        measured, computed = payload.measured[:, joint], payload.computed[:, joint]
        assert np.abs(measured).max() > 1.2 * np.abs(computed).max()
    assert np.abs(tool.computed[:, WRIST_3]).max() < 0.01
    assert np.abs(tool.measured[:, WRIST_3]).max() > 1


def test_a_tip_before_what_hangs_there_does_no_harm(results: Path) -> None:
    from inverse_dynamics import evaluate

    e = evaluate(
        results / "payload_recording",
        "ur10_simulated",
        urdf=results / "ur10_with_payload.urdf",
        tip="wrist_3_link",
    )
    assert rmse(e).max() < FITS


def test_a_tip_that_leaves_joints_out_is_the_error_on_the_page(results: Path) -> None:
    from inverse_dynamics import UserError, evaluate

    (shown,) = re.findall(r"^ids: error: (joints: .*)$", PAGE, re.MULTILINE)
    with pytest.raises(UserError, match=re.escape(shown)):
        evaluate(results / "recording", "ur10_simulated", tip="forearm_link")


def test_friction_is_against_the_velocity_in_every_joint(results: Path) -> None:
    e = read_evaluation(results / "friction")
    for joint in range(6):
        qd, error = e.log.qd[:, joint], error_of(e, joint)
        moving = np.abs(qd) > 0.1
        qd, error = qd[moving], error[moving]
        assert (np.sign(error) == -np.sign(qd)).all()
        steps_and_speed = np.stack([np.sign(qd), qd], axis=1)
        parts, *_ = np.linalg.lstsq(steps_and_speed, error, rcond=None)
        assert (parts < 0).all()
        assert np.std(error - steps_and_speed @ parts) < 0.01 * np.std(error)


def test_exchanged_joints_carry_the_others_torque(results: Path) -> None:
    e, right = read_evaluation(results / "order"), right_motion(results)
    np.testing.assert_allclose(e.measured[:, PAN], right.measured[:, ELBOW])
    np.testing.assert_allclose(e.measured[:, ELBOW], right.measured[:, PAN])
    assert e.measured[:, PAN].max() < -15
    assert np.abs(e.computed[:, PAN]).max() < 10


def test_a_reversed_effort_is_a_mirror_image_of_one_joint(results: Path) -> None:
    e = read_evaluation(results / "direction")
    assert slope(e.computed[:, ELBOW], e.measured[:, ELBOW]) == pytest.approx(-1, abs=1e-3)
    assert np.delete(rmse(e), ELBOW).max() < FITS


def test_degrees_give_thousands_of_newton_metres(results: Path) -> None:
    e = read_evaluation(results / "degrees")
    assert rmse(e)[[PAN, LIFT, ELBOW]].min() > 1000
    assert np.abs(e.log.q[:, LIFT]).max() > 2 * np.pi


def test_a_slow_clock_exaggerates_inertia(results: Path) -> None:
    e = read_evaluation(results / "clock")
    assert slope(e.log.qd[:, PAN], np.gradient(e.log.q[:, PAN], e.time)) == pytest.approx(
        2, rel=0.02
    )
    assert slope(e.measured[:, PAN], e.computed[:, PAN]) > 1.5
    assert rmse(e)[PAN] / np.ptp(e.measured[:, PAN]) > 4 * rmse(e)[LIFT] / np.ptp(
        e.measured[:, LIFT]
    )


def test_bad_stamps_give_spikes_and_a_note(results: Path) -> None:
    e = read_evaluation(results / "stamps")
    assert any("repeat an earlier one" in note for note in e.notes)
    roughness = [np.abs(np.diff(values[:, PAN])).max() for values in (e.computed, e.measured)]
    assert roughness[0] > 10 * roughness[1]
    mended = read_evaluation(results / "stamps_right")
    assert any("contradict the stamps" in note for note in mended.notes)

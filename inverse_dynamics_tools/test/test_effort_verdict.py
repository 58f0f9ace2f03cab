# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from inverse_dynamics.evaluation.effort_verdict import Verdict, compare_meanings

MEANINGS = pytest.mark.parametrize("meaning", ["torque", "current", "torque_without_gravity"])
GAINS = (10.0, 12.0, 8.0)


def arm(samples: int = 2000) -> tuple[np.ndarray, np.ndarray]:
    """Computed torques and gravity (N, 3) [N m] of 20 s; gravity doesn't load the first joint."""
    time = np.linspace(0, 20, samples)[:, None]
    gravity = np.array([0.0, 60.0, 20.0]) * np.cos(0.7 * time + np.array([0, 1, 2]))
    dynamics = np.array([20.0, 30.0, 10.0]) * np.sin(3.1 * time + np.array([2, 0, 1]))
    return gravity + dynamics, gravity


def recorded(meaning: str, computed: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """Efforts of that meaning, without any error."""
    if meaning == "current":
        return computed / GAINS
    return computed - gravity if meaning == "torque_without_gravity" else computed.copy()


def model_error(share: float, computed: np.ndarray) -> np.ndarray:
    """As slow as the torques themselves: what models leave out isn't noise."""
    time = np.linspace(0, 20, len(computed))[:, None]
    return share * np.ptp(computed, axis=0) * np.sin(1.3 * time + np.arange(3))


@MEANINGS
@pytest.mark.parametrize("share", [0.0, 0.02, 0.1])
def test_each_meaning_is_recognised_whatever_the_model_leaves_out(meaning, share):
    computed, gravity = arm()
    effort = recorded(meaning, computed + model_error(share, computed), gravity)
    verdict = compare_meanings(computed, gravity, effort, GAINS)
    # with a tenth of the range wrong, another mount may explain efforts without gravity
    expected = (meaning, share) != ("torque_without_gravity", 0.1)
    assert verdict.sure == expected, verdict.reason
    assert verdict.best == meaning
    assert [c.worse_in for c in verdict.candidates[1:]] >= [17, 17]
    assert verdict.candidates[0].margin == 1
    assert verdict.candidates[1].margin > 1.1


def test_figures_are_those_worked_by_hand():
    computed = np.tile([[4.0, 0.0], [-4.0, 0.0]], (100, 1))
    gravity = np.full((200, 2), 0.0)
    gravity[:, 0] = 3.0
    effort = computed + np.array([1.0, 0.0])
    verdict = compare_meanings(computed, gravity, effort)
    torque, without = verdict.candidates
    # Errors of the first joint are 1 and 4 of a range of 8; the second's are nothing, and the same.
    assert (torque.meaning, without.meaning) == ("torque", "torque_without_gravity")
    assert torque.error == pytest.approx(1 / 8)
    assert without.error == pytest.approx(4 / 8)
    assert without.margin == pytest.approx(np.sqrt(4.0))
    assert (torque.worse_in, without.worse_in) == (0, 20)
    assert "torque is 12 % of the range off, torque_without_gravity 50 % (worse in 20 of 20" in (
        verdict.summary
    )


@MEANINGS
def test_units_of_the_efforts_and_of_a_joint_dont_matter(meaning):
    computed, gravity = arm()
    effort = recorded(meaning, computed + model_error(0.05, computed), gravity)
    small = compare_meanings(computed * 1e-3, gravity * 1e-3, effort * 1e-3, GAINS)
    verdict = compare_meanings(computed, gravity, effort, GAINS)
    for one, other in zip(small.candidates, verdict.candidates, strict=True):
        assert one.meaning == other.meaning
        assert one.margin == pytest.approx(other.margin)


def test_joints_that_the_model_knows_nothing_of_dont_vote_for_small_efforts():
    """As friction does where a model has none: computed is zero, recorded isn't."""
    computed, gravity = arm()
    friction = 15 * np.sign(np.sin(np.linspace(0, 60, len(computed))))[:, None]
    nothing = np.zeros((len(computed), 3))
    both, both_gravity = np.hstack([computed, nothing]), np.hstack([gravity, nothing])
    gains = (*GAINS, *GAINS)
    efforts = np.hstack([computed, friction * np.ones(3)]) / gains
    verdict = compare_meanings(both, both_gravity, efforts, gains)
    assert (verdict.best, verdict.sure) == ("current", True)


def unsure(verdict: Verdict, *parts: str) -> None:
    assert not verdict.sure
    for part in parts:
        assert part in verdict.reason


@pytest.mark.parametrize("share", [0.0, 0.05])
def test_an_arm_without_gravity_cant_tell_torque_from_torque_without_gravity(share):
    """Not even where the model is perfect, and rounding decides."""
    computed, gravity = arm()
    computed = computed - gravity
    effort = computed + model_error(share, computed)
    verdict = compare_meanings(computed, 1e-6 * gravity, effort, GAINS)
    unsure(verdict, "can't be told apart, as gravity hardly loads the joints in this motion")
    assert {verdict.best, *verdict.rivals} == {"torque", "torque_without_gravity"}


def test_drive_gains_near_one_leave_current_and_torque_open_and_gravity_isnt_blamed():
    computed, gravity = arm()
    effort = computed + model_error(0.05, computed)
    unsure(compare_meanings(computed, gravity, effort, (1.001,) * 3), "current", "told apart")
    assert "gravity hardly" not in compare_meanings(computed, gravity, effort, (1.001,) * 3).reason


def test_a_meaning_that_is_better_only_now_and_then_isnt_sure():
    computed, gravity = arm()
    effort = computed.copy()
    effort[: 8 * 100] -= gravity[: 8 * 100]
    verdict = compare_meanings(computed, gravity, effort)
    assert (verdict.best, verdict.candidates[1].worse_in) == ("torque", 12)
    unsure(verdict, "torque and torque_without_gravity can't be told apart")
    assert "gravity hardly" not in verdict.reason


def test_a_meaning_that_is_always_better_but_by_little_isnt_sure():
    computed, gravity = arm()
    effort = computed + 1.0
    verdict = compare_meanings(computed, 0.0 * gravity + 0.05, effort)
    assert [c.worse_in for c in verdict.candidates] == [0, 20]
    unsure(verdict, "can't be told apart")


def test_currents_without_known_gains_fit_nothing():
    computed, gravity = arm()
    verdict = compare_meanings(computed, gravity, recorded("current", computed, gravity))
    unsure(verdict, "no meaning fits")
    assert "current wasn't considered, as no drive gains are known" in verdict.summary


def test_gravity_the_wrong_way_round_isnt_taken_for_torque_without_gravity():
    computed, gravity = arm()
    upside_down = computed - 2 * gravity
    verdict = compare_meanings(upside_down, -gravity, computed)
    assert verdict.best == "torque_without_gravity"
    unsure(verdict, "no meaning fits")


@pytest.mark.parametrize("samples", [0, 1, 19, 99])
def test_few_samples_are_said_to_be_too_few(samples):
    computed, gravity = (values[:samples] for values in arm())
    unsure(
        compare_meanings(computed, gravity, computed), f"{samples} valid samples", "100 are needed"
    )


def test_a_robot_that_stands_still_without_load_tells_nothing():
    nothing = np.zeros((500, 2))
    unsure(compare_meanings(nothing, nothing, nothing, (10.0, 10.0)), "can't be told apart")


def test_samples_that_dont_count_or_arent_finite_are_left_out():
    computed, gravity = arm()
    effort = computed.copy()
    effort[:900] = 1e6
    effort[1500, 1] = np.nan
    kept = np.arange(len(effort)) >= 900
    assert compare_meanings(computed, gravity, effort, GAINS, kept).sure
    unsure(compare_meanings(computed, gravity, effort, GAINS), "")

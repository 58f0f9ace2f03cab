# SPDX-License-Identifier: Apache-2.0
"""What a recording does to a motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from inverse_dynamics.simulation.controller import Gains
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.physics import Motion
from inverse_dynamics.simulation.sensors import EPOCH, EffortNoise, Resolution, Sensors

N = 20_000
TIME = (np.arange(N) + 0.5) / 1000


def motion() -> Motion:
    phase = TIME[:, None] + np.arange(2)
    q = np.sin(phase)
    gains = Gains(*np.zeros((5, 2)))
    return Motion(TIME, q, np.cos(phase), -q, 10 * np.cos(2 * phase), 0 * q, q, gains)


def test_without_options_the_recording_is_the_motion() -> None:
    true, recorded = motion(), Sensors().record(motion(), 0)
    np.testing.assert_array_equal(recorded.q, true.q)
    np.testing.assert_array_equal(recorded.qd, true.qd)
    np.testing.assert_array_equal(recorded.effort, true.effort)
    np.testing.assert_array_equal(recorded.rows, np.arange(N))
    assert recorded.stamps[0] == EPOCH * 1e9 + 500_000
    assert (np.diff(recorded.stamps) == 1_000_000).all()


def test_noise_has_its_standard_deviation_in_each_field() -> None:
    true, recorded = motion(), Sensors(noise=Resolution(1e-3, 1e-2, 0.5)).record(motion(), 0)
    for noisy, exact, std in (
        (recorded.q, true.q, 1e-3),
        (recorded.qd, true.qd, 1e-2),
        (recorded.effort, true.effort, 0.5),
    ):
        # 40 000 draws: the estimate is good to 0.35 %
        assert np.std(noisy - exact) == pytest.approx(std, rel=0.02)
        assert abs(np.mean(noisy - exact)) < 0.03 * std


def test_quantised_figures_are_multiples_of_the_step() -> None:
    recorded = Sensors(quantisation=Resolution(0.01, 0.0, 0.25)).record(motion(), 0)
    np.testing.assert_allclose(recorded.q / 0.01, np.round(recorded.q / 0.01), atol=1e-9)
    assert np.abs(recorded.q - motion().q).max() == pytest.approx(0.005, rel=0.01)
    np.testing.assert_array_equal(recorded.qd, motion().qd)
    assert set(np.unique(recorded.effort % 0.25)) == {0.0}


def test_dropped_messages_leave_gaps_in_the_stamps() -> None:
    recorded = Sensors(drop=0.1).record(motion(), 0)
    assert len(recorded.rows) == pytest.approx(0.9 * N, rel=0.01)
    np.testing.assert_array_equal(recorded.q, motion().q[recorded.rows])
    np.testing.assert_array_equal(
        recorded.stamps - recorded.stamps[0], 1_000_000 * (recorded.rows - recorded.rows[0])
    )


def test_repeated_messages_carry_older_figures_under_newer_stamps() -> None:
    recorded = Sensors(repeat=0.2, noise=Resolution(1e-6, 0, 0)).record(motion(), 0)
    same = (recorded.q[1:] == recorded.q[:-1]).all(axis=1)
    assert same.mean() == pytest.approx(0.2, abs=0.01)
    np.testing.assert_array_equal((recorded.effort[1:] == recorded.effort[:-1]).all(axis=1), same)
    assert (np.diff(recorded.stamps) == 1_000_000).all()


@pytest.mark.parametrize("start", [EPOCH, 0.0])
def test_stamps_jitter_but_increase(start: float) -> None:
    recorded = Sensors(jitter=1e-4, start_stamp=start).record(motion(), 0)
    offset = recorded.stamps - round(1e9 * start) - np.round(1e9 * TIME)
    assert np.std(offset) == pytest.approx(1e5, rel=0.02)
    wild = Sensors(jitter=0.05, start_stamp=start).record(motion(), 0)
    assert (np.diff(wild.stamps) > 0).all()
    assert wild.stamps[0] >= 0


def test_effects_draw_from_streams_of_their_own() -> None:
    noise = Resolution(1e-3, 1e-3, 1e-3)
    alone = Sensors(noise=noise).record(motion(), 5)
    with_drops = Sensors(noise=noise, drop=0.3, jitter=1e-4).record(motion(), 5)
    np.testing.assert_array_equal(with_drops.q, alone.q[with_drops.rows])
    rows = Sensors(drop=0.3).record(motion(), 5).rows
    np.testing.assert_array_equal(with_drops.rows, rows)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"drop": 1.5}, "drop: expected 0 to 1, got 1.5"),
        ({"repeat": np.nan}, "repeat: expected 0 to 1, got nan"),
        ({"jitter": -1.0}, "jitter: expected 0 to 60 s, got -1"),
        ({"start_stamp": 3e9}, "start stamp: expected 0 to 2e9 s (a ROS stamp has 32 bits), got"),
        ({"effort_delay": 2.0}, "effort delay: expected 0 to 1 s, got 2"),
        ({"noise": Resolution(0, np.inf, 0)}, "noise: velocity: expected 0 to 1e6, got inf"),
        (
            {"quantisation": Resolution(0, 0, 1e-320)},
            "quantisation: effort: expected 0 or at least 1",
        ),
    ],
)
def test_impossible_sensors_are_refused(options: dict[str, object], text: str) -> None:
    with pytest.raises(SimulationError) as error:
        Sensors(**options)
    assert text in str(error.value)


def test_nothing_left_is_an_error() -> None:
    with pytest.raises(SimulationError, match="drop: 0.99999 leaves 0 of 20000 messages"):
        Sensors(drop=0.99999).record(motion(), 0)


# ---- noise of real residuals, delay, rate of the messages ----------------------------------------


def coloured(samples: int = 5000, seed: int = 0) -> np.ndarray:
    """Residuals of two joints: an AR(1) process, the second joint's with half of the first's in it."""
    random = np.random.default_rng(seed)
    values = np.zeros((samples, 2))
    for k in range(1, samples):
        values[k] = 0.98 * values[k - 1] + random.normal(0, 0.1, 2)
    values[:, 1] += 0.5 * values[:, 0]
    return values + np.array([3.0, -1.0])


def correlation(values: np.ndarray, lag: int) -> np.ndarray:
    """(2, 2) normalised covariance at a lag."""
    centered = (values - values.mean(0)) / values.std(0)
    return centered[: len(centered) - lag].T @ centered[lag:] / (len(centered) - lag)


def test_effort_noise_has_the_colour_of_the_residuals() -> None:
    residuals = coloured()
    sensors = Sensors(effort_noise=EffortNoise(residuals, 1e-3, stretch=0.5))
    noise = sensors.record(motion(), 0).effort - motion().effort
    assert np.std(noise, axis=0) == pytest.approx(np.std(residuals, axis=0), rel=0.2)
    assert np.abs(noise.mean(0)).max() < 0.2 * noise.std()
    for lag in (0, 1, 10, 30):
        np.testing.assert_allclose(
            correlation(noise, lag), correlation(residuals, lag), atol=0.12, err_msg=f"lag {lag}"
        )
    np.testing.assert_array_equal(sensors.record(motion(), 0).q, motion().q)


def test_efforts_are_late() -> None:
    sensors = Sensors(effort_delay=0.0125)
    recorded = sensors.record(motion(), 0)
    then = 10 * np.cos(2 * (TIME[:, None] - 0.0125 + np.arange(2)))
    np.testing.assert_allclose(recorded.effort[13:], then[13:], atol=1e-5)
    np.testing.assert_allclose(recorded.effort[:12], motion().effort[0] * np.ones((12, 1)))
    np.testing.assert_array_equal(recorded.q, motion().q)


def test_messages_may_be_fewer_than_samples() -> None:
    recorded = Sensors(message_rate=30.0, drop=0.1).record(motion(), 0)
    assert len(recorded.rows) == pytest.approx(0.9 * 20 * 30, abs=30)
    due = np.round((TIME[recorded.rows] - TIME[0]) * 30)
    late = TIME[0] + due / 30 - TIME[recorded.rows]
    assert (np.abs(late) < 1e-3).all()
    np.testing.assert_array_equal(recorded.q, motion().q[recorded.rows])
    np.testing.assert_allclose(recorded.stamps, 1e9 * (EPOCH + TIME[recorded.rows]), atol=300)


@pytest.mark.parametrize("rate", [0.0, 1001.0, np.nan])
def test_impossible_rates_of_messages_are_refused(rate: float) -> None:
    with pytest.raises(
        SimulationError, match="message rate: expected a rate above zero, and at most"
    ):
        Sensors(message_rate=rate).record(motion(), 0)


def test_residuals_that_are_no_use_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match="expected at least 4 s of samples"):
        EffortNoise(coloured(3000), 1e-3)
    with pytest.raises(SimulationError, match="expected finite residuals"):
        EffortNoise(np.full((5000, 2), np.nan), 1e-3)
    with pytest.raises(SimulationError, match="expected residuals of 2 joints, got 3"):
        Sensors(effort_noise=EffortNoise(np.zeros((5000, 3)), 1e-3)).record(motion(), 0)
    with pytest.raises(SimulationError, match="expected a result of `ids evaluate`"):
        EffortNoise.of_result(tmp_path)
    for damaged in (b"", b"PK", b"PK\3\4" * 10):
        (tmp_path / "series.npz").write_bytes(damaged)
        with pytest.raises(SimulationError, match="expected a result of `ids evaluate`"):
            EffortNoise.of_result(tmp_path)


def test_residuals_are_those_of_an_evaluation(tmp_path: Path) -> None:
    time = 0.01 * np.arange(1000)
    measured, computed = coloured(1000), coloured(1000, seed=1)
    kept = np.arange(1000) != 7
    np.savez(tmp_path / "series.npz", time=time, measured=measured, computed=computed, kept=kept)
    noise = EffortNoise.of_result(tmp_path)
    np.testing.assert_array_equal(noise.residuals, (measured - computed)[kept])
    assert noise.period == pytest.approx(0.01)
    assert noise.source == str(tmp_path)

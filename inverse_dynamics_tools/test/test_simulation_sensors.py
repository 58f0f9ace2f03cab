# SPDX-License-Identifier: Apache-2.0
"""What a recording does to a motion."""

from __future__ import annotations

import numpy as np
import pytest

from inverse_dynamics.simulation.controller import Gains
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.physics import Motion
from inverse_dynamics.simulation.sensors import EPOCH, Resolution, Sensors

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


@pytest.mark.parametrize("epoch", [EPOCH, 0.0])
def test_stamps_jitter_but_increase(epoch: float) -> None:
    recorded = Sensors(jitter=1e-4, epoch=epoch).record(motion(), 0)
    offset = recorded.stamps - round(1e9 * epoch) - np.round(1e9 * TIME)
    assert np.std(offset) == pytest.approx(1e5, rel=0.02)
    wild = Sensors(jitter=0.05, epoch=epoch).record(motion(), 0)
    assert (np.diff(wild.stamps) > 0).all()
    assert wild.stamps[0] >= 0


def test_effects_draw_from_streams_of_their_own() -> None:
    noise = Resolution(1e-3, 1e-3, 1e-3)
    alone = Sensors(noise=noise).record(motion(), 5)
    with_drops = Sensors(noise=noise, drop=0.3, jitter=1e-4).record(motion(), 5)
    np.testing.assert_array_equal(with_drops.q, alone.q[with_drops.rows])
    rows = Sensors(drop=0.3).record(motion(), 5).rows
    np.testing.assert_array_equal(with_drops.rows, rows)


def test_the_seed_decides() -> None:
    sensors = Sensors(noise=Resolution(1e-3, 1e-3, 1e-3))
    first, again, other = (sensors.record(motion(), seed).q for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"drop": 1.0}, "drop: expected a probability from 0 to below 1, got 1"),
        ({"drop": -0.1}, "drop: expected a probability"),
        ({"repeat": np.nan}, "repeat: expected a probability"),
        ({"jitter": -1.0}, "jitter: expected a time in s that isn't negative, got -1"),
        ({"epoch": 3e9}, "start stamp: expected at most 2e+09 s"),
        ({"jitter": 1e300}, "jitter: expected at most 60 s, got 1e+300"),
        ({"noise": Resolution(0, 1e300, 0)}, "noise: velocity: expected at most 1e+06, got 1e+300"),
        (
            {"quantisation": Resolution(0, 0, 1e-320)},
            "quantisation: effort: expected 0 or at least 1",
        ),
        ({"noise": Resolution(-1, 0, 0)}, "noise: position: expected a number that isn't negative"),
        ({"quantisation": Resolution(0, 0, np.inf)}, "quantisation: effort: expected a number"),
    ],
)
def test_impossible_sensors_are_refused(options: dict[str, object], text: str) -> None:
    with pytest.raises(SimulationError) as error:
        Sensors(**options)
    assert text in str(error.value)


def test_nothing_left_is_an_error() -> None:
    with pytest.raises(SimulationError, match="drop: 0.99999 leaves 0 of 20000 messages"):
        Sensors(drop=0.99999).record(motion(), 0)

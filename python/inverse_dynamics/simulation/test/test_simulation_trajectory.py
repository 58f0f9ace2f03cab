# SPDX-License-Identifier: Apache-2.0
"""Trajectories: derivatives, rest at the ends, files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from inverse_dynamics.simulation.errors import TrajectoryError
from inverse_dynamics.simulation.trajectory import (
    FourierTrajectory,
    WaypointTrajectory,
    read_trajectory,
    trajectory_text,
)

NAMES = ("a", "b")


def fourier() -> FourierTrajectory:
    random = np.random.default_rng(0)
    return FourierTrajectory(NAMES, 4.0, np.array([0.1, -2.0]), *random.normal(size=(2, 2, 3)))


def waypoints() -> WaypointTrajectory:
    times = np.array([0.0, 1.0, 1.7, 4.0])
    positions = np.array([[0.0, 1.0], [0.5, 0.0], [-0.3, 0.2], [0.0, 2.0]])
    return WaypointTrajectory.through(NAMES, times, positions)


def with_a_rest() -> WaypointTrajectory:
    times = np.array([0.0, 1.0, 1.7, 3.1, 4.0])
    positions = np.array([[0.0, 1.0], [0.5, 0.0], [-0.3, 0.2], [0.4, 0.9], [0.0, 2.0]])
    return WaypointTrajectory.through(NAMES, times, positions, (2,))


@pytest.mark.parametrize("trajectory", [fourier(), waypoints()], ids=["fourier", "waypoints"])
def test_velocity_and_acceleration_are_derivatives(
    trajectory: FourierTrajectory | WaypointTrajectory,
) -> None:
    h = 1e-5
    time = np.linspace(0.01, 3.99, 101)
    _, qd, qdd = trajectory.at(time)
    before, after = trajectory.at(time - h), trajectory.at(time + h)
    # central differences: h^2 times the third derivative, and rounding over h
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), qd, atol=1e-6)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), qdd, atol=1e-6)


def test_fourier_series_by_hand() -> None:
    # one harmonic, period 2 pi: q = 1 + 2 sin t - 3 cos t
    trajectory = FourierTrajectory(
        ("a",), 2 * np.pi, np.ones(1), np.array([[2.0]]), np.array([[3.0]])
    )
    q, qd, qdd = trajectory.at(np.array([0.0, np.pi / 2]))
    np.testing.assert_allclose(q[:, 0], [-2.0, 3.0])
    np.testing.assert_allclose(qd[:, 0], [2.0, 3.0])
    np.testing.assert_allclose(qdd[:, 0], [3.0, -2.0])


def test_two_waypoints_are_joined_by_the_curve_of_least_jerk() -> None:
    trajectory = WaypointTrajectory.through(("a",), np.array([0.0, 2.0]), np.array([[1.0], [4.0]]))
    s = np.linspace(0.0, 1.0, 11)
    expected = 1.0 + 3.0 * (10 * s**3 - 15 * s**4 + 6 * s**5)
    np.testing.assert_allclose(trajectory.at(2 * s)[0][:, 0], expected, atol=1e-12)


def test_waypoints_are_passed_and_both_ends_are_at_rest() -> None:
    trajectory = waypoints()
    q, qd, qdd = trajectory.at(trajectory.times)
    np.testing.assert_allclose(q, trajectory.positions, atol=1e-12)
    for ends in (qd[[0, -1]], qdd[[0, -1]]):
        np.testing.assert_allclose(ends, 0.0, atol=1e-12)
    assert np.abs(qd[1:-1]).min() > 0.01  # it doesn't stop on its way
    late, velocity, _ = trajectory.at(np.array([100.0]))
    np.testing.assert_allclose(late[0], trajectory.positions[-1], atol=1e-12)
    np.testing.assert_allclose(velocity, 0.0, atol=1e-12)


def test_jerk_and_its_rate_are_continuous_at_waypoints() -> None:
    trajectory, h = waypoints(), 1e-3
    for t in trajectory.times[1:-1]:
        left = trajectory.at(t - h * np.arange(4.0))[2]
        right = trajectory.at(t + h * np.arange(4.0))[2]
        # one-sided second-order differences of the acceleration
        jerks = [(3 * a[0] - 4 * a[1] + a[2]) / 2 * s for a, s in ((left, 1), (right, -1))]
        rates = [2 * a[0] - 5 * a[1] + 4 * a[2] - a[3] for a in (left, right)]
        np.testing.assert_allclose(jerks[0] / h, jerks[1] / h, atol=1e-2)
        np.testing.assert_allclose(rates[0] / h**2, rates[1] / h**2, rtol=1e-2, atol=1.0)


def test_all_joints_stop_at_a_rest_and_the_parts_are_motions_of_their_own() -> None:
    trajectory = with_a_rest()
    q, qd, qdd = trajectory.at(np.array([1.7]))
    np.testing.assert_allclose(q, [[-0.3, 0.2]])
    np.testing.assert_allclose(qd, 0.0, atol=1e-12)
    np.testing.assert_allclose(qdd, 0.0, atol=1e-12)
    second = WaypointTrajectory.through(
        NAMES, trajectory.times[2:] - trajectory.times[2], trajectory.positions[2:]
    )
    time = np.linspace(0.0, second.duration, 40)
    for whole, part in zip(trajectory.at(1.7 + time), second.at(time), strict=True):
        np.testing.assert_allclose(whole, part, atol=1e-12)


@pytest.mark.parametrize("rests", [(0,), (4,), (2, 2), (3, 1), (-1,)])
def test_rests_are_waypoints_between_the_ends(rests: tuple[int, ...]) -> None:
    motion = with_a_rest()
    with pytest.raises(TrajectoryError, match="rests: expected waypoints between the first"):
        WaypointTrajectory.through(NAMES, motion.times, motion.positions, rests)


@pytest.mark.parametrize("times", [[0.0], [0.0, 1.0, 1.0], [0.5, 1.0], [0.0, np.nan]])
def test_waypoints_need_increasing_times(times: list[float]) -> None:
    with pytest.raises(TrajectoryError, match="at least two times, increasing from 0 s"):
        WaypointTrajectory.through(("a",), np.array(times), np.zeros((len(times), 1)))


@pytest.mark.parametrize(
    "trajectory", [fourier(), waypoints(), with_a_rest()], ids=["fourier", "waypoints", "rest"]
)
def test_file_keeps_every_digit_and_joints_are_matched_by_name(
    trajectory: FourierTrajectory | WaypointTrajectory, tmp_path: Path
) -> None:
    file = tmp_path / "motion.yaml"
    file.write_text(trajectory_text(trajectory, "found: on a\nbeach"))
    read, source = read_trajectory(file, NAMES)
    assert source == "found: on a beach"
    time = np.linspace(0, 4, 50)
    turned, _ = read_trajectory(file, NAMES[::-1])
    for a, b, c in zip(read.at(time), trajectory.at(time), turned.at(time), strict=True):
        np.testing.assert_array_equal(a, b)
        np.testing.assert_array_equal(c, b[:, ::-1])


GOOD = """\
schema: 1
kind: waypoints
joints: [a, b]
times: [0, 1]
positions: [[0, 0], [1, 2]]
"""


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("schema: 1", "schema: 2", "motion.yaml:1: schema: expected 1, got '2'"),
        ("waypoints", "spline", "motion.yaml:2: kind: expected one of fourier, waypoints"),
        ("[a, b]", "[a, c]", "motion.yaml:3: joints: expected the joints a, b, got a, c"),
        ("[a, b]", "[a, a]", "expected the joints a, b, got a, a"),
        ("[0, 1]", "[1, 2]", "motion.yaml:4: times: expected at least two times that increase"),
        ("[0, 1]", "[0, .inf]", "times[1]: expected a finite number"),
        ("[1, 2]]", "[1]]", "motion.yaml:5: positions[1]: expected a list of 2"),
        ("[[0, 0], ", "[", "motion.yaml:5: positions: expected a list of 2"),
        ("times: [0, 1]\n", "", "the key times is missing"),
        ("times", "time", "the key times is missing"),
        ("kind", "speed: 3\nkind", "speed: unknown key"),
        ("kind", "rests: [1]\nkind", "motion.yaml:2: rests: expected waypoints between the first"),
        ("kind", "rests: [0.5]\nkind", "motion.yaml:2: rests[0]: expected an integer"),
        ("waypoints", "fourier", "the keys period, center, sine, cosine are missing"),
    ],
)
def test_mistakes_in_files_are_pointed_at(tmp_path: Path, old: str, new: str, text: str) -> None:
    assert old in GOOD
    file = tmp_path / "motion.yaml"
    file.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(TrajectoryError) as error:
        read_trajectory(file, NAMES)
    assert text in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("period: 4.0", "period: 0", "period: expected a time in s above zero"),
        ("center: [0.1, -2.0]", "center: [0.1]", "center: expected a list of 2"),
        ("cosine:\n", "cosine: []\nsine2:\n", "cosine: expected a list of 2"),
    ],
)
def test_mistakes_in_fourier_files(tmp_path: Path, old: str, new: str, text: str) -> None:
    good = trajectory_text(fourier(), "x")
    assert old in good
    file = tmp_path / "motion.yaml"
    file.write_text(good.replace(old, new))
    with pytest.raises(TrajectoryError) as error:
        read_trajectory(file, NAMES)
    assert text in str(error.value)

# SPDX-License-Identifier: Apache-2.0
"""What a trajectory may not do, and how it is said; contacts with itself and with the table."""

from __future__ import annotations

import numpy as np
import pytest
from simulation_arms import CHAINS, robots_package, simulated, two_links

from inverse_dynamics.simulation.collision import TABLE, ContactChecker
from inverse_dynamics.simulation.errors import TrajectoryError
from inverse_dynamics.simulation.limits import MotionLimits, check_trajectory
from inverse_dynamics.simulation.model import JointFriction, Payload, SimulatedRobot
from inverse_dynamics.simulation.trajectory import (
    FourierTrajectory,
    WaypointTrajectory,
    read_trajectory,
)


def arm(**options: object) -> SimulatedRobot:
    return SimulatedRobot.from_urdf(two_links(), tip="tip", **options)


def sway(position: float = 0.0, velocity: float = 0.0, frequency: float = 1.0) -> FourierTrajectory:
    """First joint swings about `position` with the given greatest velocity, at a frequency in Hz."""
    return FourierTrajectory(
        ("shoulder", "lift", "fold"),
        1.0 / frequency,
        np.array([position, 0.0, 0.0]),
        np.array([[velocity], [0.0], [0.0]]),
        np.zeros((3, 1)),
    )


def check(trajectory: FourierTrajectory | WaypointTrajectory, **options: object) -> None:
    checked = arm(**options)
    check_trajectory(checked, trajectory, MotionLimits.of(checked), ContactChecker(checked))


def test_limits_of_acceleration_and_jerk_are_those_of_urdf_1_2() -> None:
    def checked(limits: str) -> None:
        urdf = (
            two_links()
            .replace("<robot", '<robot version="1.2"')
            .replace("<limit", f"<limit {limits}")
        )
        limited = SimulatedRobot.from_urdf(urdf, tip="tip")
        check_trajectory(limited, sway(velocity=1.0), MotionLimits.of(limited), None)

    checked('acceleration="6.4" deceleration="6.4" jerk="40"')  # 2 pi and its square at 1 Hz
    with pytest.raises(
        TrajectoryError, match=r"shoulder: acceleration at 0.\d+ s: expected -5 to 5"
    ):
        checked('acceleration="6.4" deceleration="5"')
    with pytest.raises(
        TrajectoryError, match=r"shoulder: jerk at 0.\d+ s: expected -20 to 20 rad/s\^3"
    ):
        checked('jerk="20"')


def test_motion_within_all_limits_passes() -> None:
    check(sway(velocity=1.99))


@pytest.mark.parametrize(
    ("trajectory", "options", "text"),
    [
        (
            sway(position=3.5),
            {},
            "joint shoulder: position at 0.00 s: expected -3 to 3 rad, got 3.5",
        ),
        (
            sway(velocity=2.5),
            {},
            "joint shoulder: velocity at 0.00 s: expected -2 to 2 rad/s, got 2.5",
        ),
        # m g l of the arm: the bars' 9.81 (0.25 2 + 0.5 0.1 + 0.75 1), seen by `lift` in part
        (
            sway(),
            {"payload": Payload(20.0)},
            "joint lift: effort at 0.00 s: expected -100 to 100 N m",
        ),
        # H qdd of the shoulder alone: 0.74 kg m^2, times 2 rad/s 2 pi 16 Hz
        (sway(velocity=2.0, frequency=16.0), {}, "joint shoulder: effort at 0.0"),
    ],
)
def test_excess_names_joint_quantity_time_and_limit(
    trajectory: FourierTrajectory, options: dict[str, object], text: str
) -> None:
    with pytest.raises(TrajectoryError) as error:
        check(trajectory, **options)
    assert text in str(error.value)


def test_friction_counts_as_effort() -> None:
    zero, coulomb, viscous = np.zeros(3), np.array([70.0, 0, 0]), np.array([30.0, 0, 0])
    check(sway(velocity=1.9))
    check(sway(velocity=1.9), friction=JointFriction(coulomb, zero))
    check(sway(velocity=1.9), friction=JointFriction(zero, viscous))
    with pytest.raises(TrajectoryError, match="joint shoulder: effort"):
        check(sway(velocity=1.9), friction=JointFriction(coulomb, viscous))


def test_acceleration_is_limited_only_where_asked() -> None:
    limits = MotionLimits.of(arm(), time_to_full_speed=0.5)
    np.testing.assert_allclose(limits.acceleration, 4.0)
    with pytest.raises(
        TrajectoryError, match=r"joint shoulder: acceleration at .* -4 to 4 rad/s\^2"
    ):
        check_trajectory(arm(), sway(velocity=1.0), limits, None)
    check_trajectory(arm(), sway(velocity=1.0), MotionLimits.of(arm()), None)


def test_part_of_the_limits_keeps_the_middle_of_the_range() -> None:
    limits = MotionLimits.of(simulated("panda"), 0.5).fraction(0.8)
    chain = simulated("panda").chain
    np.testing.assert_allclose(limits.lower + limits.upper, chain.lower + chain.upper)
    np.testing.assert_allclose(limits.upper - limits.lower, 0.8 * (chain.upper - chain.lower))
    np.testing.assert_allclose(limits.effort, 0.8 * chain.effort)


def test_joints_of_another_robot_are_refused() -> None:
    with pytest.raises(TrajectoryError, match="expected joints shoulder_pan_joint"):
        check_trajectory(simulated("ur10"), sway(), MotionLimits.of(simulated("ur10")), None)


def test_distance_between_two_bars() -> None:
    checker = ContactChecker(arm(), clearance=0.05)
    assert checker.notes == ()
    # stretched: the second bar begins 0.05 m after the elbow at 0.5 m, the first ends at 0.4 m: 0.15 m apart
    # folded by 3 rad it lies beside and across the first one
    states = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 3.0]])
    violations = checker.violations(states)
    assert violations[0] == 0.0
    assert violations[1] > 0.05  # they overlap
    assert set(checker.closest_pair(states[1])[1:]) == {"upper", "lower"}


def test_distance_to_the_table_by_hand() -> None:
    # at 0.3 rad downwards the lower bar's far end is 0.45 m from the elbow; its corner 0.02 m below its axis
    low = SimulatedRobot.from_urdf(two_links(height=0.2), tip="tip")
    checker = ContactChecker(low, clearance=0.1)
    expected = 0.2 - 0.45 * np.sin(0.3) - 0.02 * np.cos(0.3)
    distance, *links = checker.closest_pair(np.array([0.0, 0.3, 0.0]))
    assert set(links) == {TABLE, "lower"}
    assert distance == pytest.approx(expected, abs=1e-6)
    assert checker.violations(np.array([[0.0, 0.3, 0.0]]))[0] == pytest.approx(
        0.1 - expected, abs=1e-6
    )
    free = ContactChecker(low, clearance=0.1, table=False)
    assert free.violations(np.array([[0.0, 0.3, 0.0]]))[0] == 0.0


def test_contact_is_refused_with_both_names_and_the_time() -> None:
    fold = WaypointTrajectory.through(
        ("shoulder", "lift", "fold"), np.array([0.0, 4.0]), np.array([[0.0, 0, 0], [0, 0, 2.99]])
    )
    with pytest.raises(
        TrajectoryError, match=r"at \d\.\d\d s \w+ and \w+: expected a distance of at least 0.01 m"
    ):
        check(fold)


def test_shapes_that_always_overlap_are_not_compared() -> None:
    urdf = two_links().replace('box size="0.4 0.04 0.04"', 'box size="1.2 0.04 0.04"')
    checker = ContactChecker(SimulatedRobot.from_urdf(urdf, tip="tip"))
    assert checker.violations(np.array([[0.0, 0.0, 0.1]]))[0] == 0.0


@pytest.mark.parametrize("name", CHAINS)
def test_stored_trajectory_starts_at_rest_and_stays_within_four_fifths_of_each_limit(
    name: str,
) -> None:
    checked = simulated(name)
    file = robots_package() / f"trajectories/{name}.yaml"
    trajectory, _ = read_trajectory(file, checked.chain.joint_names)
    check_trajectory(
        checked, trajectory, MotionLimits.of(checked, 0.5).fraction(0.801), ContactChecker(checked)
    )
    for derivative in trajectory.at(np.zeros(1))[1:]:
        np.testing.assert_allclose(derivative, 0.0, atol=1e-12)


@pytest.mark.parametrize("name", CHAINS)
def test_arms_have_shapes_that_can_touch(name: str) -> None:
    checker = ContactChecker(simulated(name))
    assert checker.notes == ()
    lower, upper = (
        np.maximum(checker.robot.chain.lower, -3),
        np.minimum(checker.robot.chain.upper, 3),
    )
    states = np.random.default_rng(0).uniform(lower, upper, (100, len(lower)))
    touching = checker.violations(states) > 0
    assert 5 < touching.sum() < 100
    pairs = [checker.closest_pair(state) for state in states[touching]]
    assert all(distance < checker.clearance for distance, *_ in pairs)

# SPDX-License-Identifier: Apache-2.0
"""The controller by hand, and the laws a simulated motion obeys."""

from __future__ import annotations

import numpy as np
import pytest
from simulation_arms import CHAINS, pendulum, robots_package, simulated

from inverse_dynamics.simulation.controller import (
    DesiredMotion,
    Gains,
    JointTrajectoryController,
    default_gains,
)
from inverse_dynamics.simulation.model import MOUNTS, JointFriction, Payload, SimulatedRobot
from inverse_dynamics.simulation.physics import RATES, follow
from inverse_dynamics.simulation.trajectory import Trajectory, WaypointTrajectory, read_trajectory

PERIOD = 0.01


def controller(limit: float = 100.0, **gains: float) -> JointTrajectoryController:
    """One joint that shall be at 1 rad with 2 rad/s; feed-forward 3 N m."""
    names = ("p", "i", "d", "i_clamp", "ff_velocity_scale")
    defaults = dict.fromkeys(names, 0.0) | {"i_clamp": 1000.0}
    desired = DesiredMotion(*(np.full((1000, 1), value) for value in (1.0, 2.0, 3.0)))
    values = {name: np.array([value]) for name, value in (defaults | gains).items()}
    return JointTrajectoryController(Gains(**values), desired, np.array([limit]), PERIOD)


def stored(name: str) -> Trajectory:
    file = robots_package() / f"trajectories/{name}.yaml"
    return read_trajectory(file, simulated(name).chain.joint_names)[0]


Q, QD = np.array([0.9]), np.array([1.5])


def test_command_is_feed_forward_and_pid_terms() -> None:
    assert controller().update(0, Q, QD)[0] == 3.0
    assert controller(ff_velocity_scale=5).update(0, Q, QD)[0] == pytest.approx(3 + 5 * 2)
    assert controller(p=10).update(0, Q, QD)[0] == pytest.approx(3 + 10 * 0.1)
    assert controller(d=4).update(0, Q, QD)[0] == pytest.approx(3 + 4 * 0.5)


def test_integral_grows_with_time_up_to_its_clamp() -> None:
    integrating = controller(i=10)
    commands = [integrating.update(k, Q, QD)[0] for k in range(5)]
    np.testing.assert_allclose(commands, 3 + 10 * 0.1 * PERIOD * np.arange(1, 6))
    clamped = controller(i=10, i_clamp=0.02)
    assert [clamped.update(k, Q, QD)[0] for k in range(5)][-1] == pytest.approx(3.02)


def test_command_stays_within_the_effort_limit_and_the_integral_does_not_wind_up() -> None:
    winding = controller(i=1000, p=100, limit=20.0)
    assert [winding.update(k, Q - 1, QD)[0] for k in range(500)] == [20.0] * 500
    # as soon as the error changes sign the command leaves the limit: nothing has to be unwound
    assert winding.update(500, Q + 0.2, QD)[0] < 20.0
    assert controller(limit=2.0).update(0, Q, QD)[0] == 2.0


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("name", CHAINS)
def test_robots_follow_their_trajectories_at_every_rate(name: str, rate: int) -> None:
    motion = follow(simulated(name), stored(name), rate=rate, duration=3.0)
    assert len(motion.time) == 3 * rate
    assert np.abs(motion.q - motion.q_desired).max() < 2e-3
    assert np.abs(motion.q - motion.q[0]).max() > 0.5


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("name", CHAINS)
def test_default_gains_hold_the_robot_against_a_push(name: str, rate: int) -> None:
    """Linearised closed loop, sampled: all its eigenvalues lie within the unit circle."""
    robot, trajectory = simulated(name), stored(name)
    gains = default_gains(robot, trajectory, rate)
    n, h = len(gains.p), 1.0 / rate
    for q in trajectory.at(np.linspace(0, trajectory.duration, 20))[0]:
        inverse = np.linalg.inv(robot.inertia_matrix(q))
        delta = 1e-5 * np.eye(n)
        zero = np.zeros((n, n))
        stiffness = (robot.torques(q + delta, zero, zero) - robot.torques(q - delta, zero, zero)).T
        A = np.block(
            [[np.zeros((n, n)), np.eye(n)], [-inverse @ (stiffness / 2e-5), np.zeros((n, n))]]
        )
        B = np.vstack([np.zeros((n, n)), inverse])
        # exact discretisation by a series: h is short against the arm's motion
        series = np.eye(2 * n) + A * h / 2 + A @ A * h**2 / 6 + A @ A @ A * h**3 / 24
        Ad, Bd = np.eye(2 * n) + A @ series * h, series @ B * h
        I = np.diag(gains.i * h)  # noqa: E741  the integral of the error, N m
        feedback = np.hstack([np.diag(gains.p) + I, np.diag(gains.d)])
        closed = np.block(
            [[Ad - Bd @ feedback, -Bd], [np.hstack([I, np.zeros((n, n))]), np.eye(n)]]
        )
        assert np.abs(np.linalg.eigvals(closed)).max() < 1.0


OPTIONS = {
    "as it is": {},
    "payload, ceiling": {"payload": Payload(1.5, (0.0, 0.05, 0.1)), "gravity": MOUNTS["ceiling"]},
    "friction, wall": {"friction": 0.01, "gravity": MOUNTS["wall"]},
}


@pytest.mark.parametrize("options", OPTIONS)
@pytest.mark.parametrize("name", CHAINS)
def test_effort_is_what_the_acceleration_needs(name: str, options: str) -> None:
    chosen = dict(OPTIONS[options])
    chain = simulated(name).chain
    if "friction" in chosen:
        part = chosen["friction"] * chain.effort
        chosen["friction"] = JointFriction(part, part / chain.velocity)
    robot = simulated(name, **chosen)
    motion = follow(robot, stored(name), rate=500, duration=2.0)
    needed = robot.torques(motion.q, motion.qd, motion.qdd)
    if robot.friction is not None:
        np.testing.assert_allclose(motion.friction, robot.friction.torques(motion.qd), atol=1e-9)
        assert np.abs(motion.friction).max() > 0.1
    # rounding: torques of up to 300 N m
    np.testing.assert_allclose(needed + motion.friction, motion.effort, rtol=0, atol=1e-9)


def test_work_of_the_effort_becomes_energy() -> None:
    robot = SimulatedRobot.from_urdf(pendulum())
    swing = WaypointTrajectory.through(("swing",), np.array([0.0, 1.0]), np.array([[0.0], [-1.0]]))
    motion = follow(robot, swing, rate=1000, duration=0.6)
    inertia = 0.02 + 2 * 0.25
    energy = 0.5 * inertia * motion.qd[:, 0] ** 2 - 2 * 9.81 * 0.5 * np.sin(motion.q[:, 0])
    power = motion.effort[:, 0] * motion.qd[:, 0]
    work = np.concatenate([[0.0], np.cumsum((power[1:] + power[:-1]) / 2 / 1000)])
    assert np.ptp(energy) > 1.0
    # the trapezoidal rule on a torque with steps: about 1e-3 of the steps
    np.testing.assert_allclose(energy - energy[0], work, atol=2e-5)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("name", CHAINS)
def test_differences_of_velocities_estimate_the_sampled_acceleration(name: str, rate: int) -> None:
    """Not late by half a period: that would be an error of up to 1 % of the torque's range at 125 Hz."""
    robot = simulated(name)
    motion = follow(robot, stored(name), rate=rate, duration=5.0)
    estimate = np.gradient(motion.qd, motion.time, axis=0)
    error = robot.torques(motion.q, motion.qd, estimate) - motion.effort
    rmse = np.sqrt((error**2)[2:-2].mean(axis=0))
    assert (rmse < 2e-4 * np.ptp(motion.effort, axis=0)).all()


def test_actuator_gives_no_more_than_its_limit() -> None:
    weak = pendulum(limit='<limit lower="-3" upper="3" velocity="2" effort="5"/>')
    robot = SimulatedRobot.from_urdf(weak)
    hold = WaypointTrajectory.through(("swing",), np.array([0.0, 1.0]), np.zeros((2, 1)))
    motion = follow(robot, hold, rate=500, duration=0.5)  # it takes 9.81 N m
    np.testing.assert_allclose(motion.effort, -5.0)
    assert motion.q[-1, 0] > 0.3  # so it falls
    np.testing.assert_allclose(robot.torques(motion.q, motion.qd, motion.qdd), -5.0, atol=1e-12)


def test_repeating_trajectory_goes_on_and_samples_lie_in_the_middle_of_periods() -> None:
    motion = follow(simulated("ur10"), stored("ur10"), rate=125, duration=20.5)
    assert motion.time[0] == pytest.approx(0.004)
    np.testing.assert_allclose(np.diff(motion.time), 0.008)
    np.testing.assert_allclose(motion.q[2500:], motion.q[: 2562 - 2500], atol=1e-3)

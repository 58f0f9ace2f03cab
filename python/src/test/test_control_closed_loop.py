# SPDX-License-Identifier: Apache-2.0
"""The control laws on robots in MuJoCo, which knows nothing of the solvers, at 1 kHz."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
import pytest
import two_arms
from example_robots import RIGID_BODY
from simulation_arms import CHAINS, HOME, pendulum, simulated, urdf_of

from inverse_dynamics import Solver
from inverse_dynamics.control import (
    Compensated,
    ComputedTorque,
    FeedForward,
    Gains,
    GravityCompensation,
    LawOptions,
    PdGains,
    PdGravityCompensation,
    SafeStop,
    Status,
)
from inverse_dynamics.simulation.limits import MotionLimits, check_trajectory
from inverse_dynamics.simulation.model import JointFriction, Payload, SimulatedRobot
from inverse_dynamics.simulation.physics import Command, Response, drive
from inverse_dynamics.simulation.trajectory import WaypointTrajectory

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.arrays import Floats

RATE = 1000
PERIOD = 1 / RATE

# From HOME there and back in 2.4 s: up to 83 % of the velocity limits.
MOVE = {
    "ur10": np.array([1.2, 0.6, -0.9, 1.2, -1.0, 1.5]),
    "panda": np.array([1.2, 0.8, -0.7, 0.9, -1.0, 0.8, -1.2]),
}
TIMES = np.array([0.0, 1.2, 2.4])
COULOMB, VISCOUS = 1.0, 2.0  # N m; N m s/rad
UR_COULOMB, UR_VISCOUS = (0.8, 0.8, 0.7, 0.8, 0.8, 0.8), (0.9, 0.9, 0.8, 0.9, 0.9, 0.9)


def rubbing(name: str) -> str:
    """The URDF with friction in each joint."""
    dynamics = f'<dynamics damping="{VISCOUS}" friction="{COULOMB}"/></joint>'
    bare = re.sub(r"<dynamics [^>]*>", "", urdf_of(name))
    return re.sub(r'(<joint [^>]*"revolute">.*?)</joint>', r"\1" + dynamics, bare, flags=re.S)


@cache
def solver_of(name: str) -> Solver:
    return Solver(RIGID_BODY, urdf_of(name), *CHAINS[name])


@cache
def fast_motion(name: str) -> WaypointTrajectory:
    robot = simulated(name)
    positions = HOME[name] + np.outer([0, 1, 0], MOVE[name])
    motion = WaypointTrajectory.through(robot.chain.joint_names, TIMES, positions)
    check_trajectory(robot, motion, MotionLimits.of(robot).fraction(0.9), None)
    return motion


def options_of(
    name: str, robot: SimulatedRobot, compensated: Compensated | None = None
) -> LawOptions:
    compensated = compensated or Compensated()
    return LawOptions(effort_limit=robot.chain.effort, damping_rate=5.0, compensated=compensated)


def follow_fast_motion(robot: SimulatedRobot, name: str, law: Command) -> tuple[Response, Floats]:
    """The response, and its errors (N, n), until one second after the motion."""
    motion = fast_motion(name)
    start, _, _ = motion.at(np.zeros(1))
    ticks = round((TIMES[-1] + 1.0) * RATE)
    response = drive(robot, law, start[0], np.zeros_like(start[0]), rate=RATE, ticks=ticks)
    return response, response.q - motion.at(response.time)[0]


class Tracking:
    """Computed torque on the fast motion; keeps the statuses of all updates."""

    def __init__(
        self,
        name: str,
        robot: SimulatedRobot,
        frequency: float,
        ratio: float,
        solver: Solver | None = None,
        compensated: Compensated | None = None,
    ) -> None:
        n = len(robot.dofs)
        self.gains = Gains.of(np.full(n, frequency), np.full(n, ratio))
        options = options_of(name, robot, compensated)
        self.law = ComputedTorque(solver or solver_of(name), self.gains, options)
        self.statuses: set[Status] = set()
        self.references = list(zip(*fast_motion(name).at(np.arange(10000) * PERIOD), strict=True))

    def command(self, k: int, q: Floats, qd: Floats) -> Floats:
        tau, status = self.law.update(q, qd, *self.references[k], period=PERIOD)
        self.statuses.add(status)
        return tau


@pytest.mark.parametrize("name", CHAINS)
def test_computed_torque_tracks_ten_times_better_than_pd_of_the_same_gains(name: str) -> None:
    """The strongest PD there is: its gains weighted with H(q), gravity compensated.

    Greatest errors [rad]: UR10 1.7e-4 against 2.6e-2, Panda 8.7e-4 against 2.9e-2.
    """
    robot, solver = simulated(name), solver_of(name)
    tracking = Tracking(name, robot, 20.0, 1.0)

    def pd(k: int, q: Floats, qd: Floats) -> Floats:
        q_ref, qd_ref, _ = tracking.references[k]
        a = tracking.gains.Kp * (q_ref - q) + tracking.gains.Kd * (qd_ref - qd)
        return solver.inertia_matrix(q) @ a + solver.gravity_vector(q)

    _, error = follow_fast_motion(robot, name, tracking.command)
    _, pd_error = follow_fast_motion(robot, name, pd)
    assert 10 * np.abs(error).max() < np.abs(pd_error).max() < 0.1
    assert 10 * np.sqrt((error**2).mean()) < np.sqrt((pd_error**2).mean())
    assert tracking.statuses == {Status.OK}


@pytest.mark.parametrize("name", CHAINS)
def test_a_robot_that_compensates_shares_itself_follows_as_one_that_does_not(name: str) -> None:
    """Hidden shares of gravity and friction, each joint its own.

    Viscous friction that the robot compensates would no longer damp what the law, by the reference's velocity, leaves
    of Coulomb friction at a reversal: without lostDamping() errors are up to 2.2 times as great.
    """
    n = len(HOME[name])
    solver = Solver(RIGID_BODY, rubbing(name), *CHAINS[name], parameters={"urdf_friction": True})
    gravity, friction = np.random.default_rng(0).uniform(0, 1, (2, n))
    equal = np.array([gravity, friction, friction])
    of_ur = np.array([gravity, *(np.resize(s, n) for s in (UR_COULOMB, UR_VISCOUS))])

    def greatest(shares: Floats, known: Compensated) -> float:
        left = JointFriction((1 - shares[1]) * COULOMB, (1 - shares[2]) * VISCOUS)
        robot = simulated(name, friction=left)
        tracking = Tracking(name, robot, 20.0, 1.0, solver, known)

        def command(k: int, q: Floats, qd: Floats) -> Floats:
            return tracking.command(k, q, qd) + shares[0] * solver.gravity_vector(q)

        return float(np.abs(follow_fast_motion(robot, name, command)[1]).max())

    none = greatest(0 * equal, Compensated())
    others = np.random.default_rng(1).uniform(0, 1, (2, 3, n))
    for shares in (equal, of_ur, *others):
        known = Compensated(gravity=shares[0], friction=shares[1], viscous=shares[2])
        assert greatest(shares, known) <= 1.1 * none
    assert greatest(of_ur, Compensated()) > 2 * none


@pytest.mark.parametrize("name", CHAINS)
def test_an_unknown_payload_gives_a_bounded_error_without_oscillation(name: str) -> None:
    """2 kg at the tip. Greatest errors [rad]: UR10 0.076, Panda 0.067; at rest 0.014 and 0.050."""
    heavy = simulated(name, payload=Payload(2.0))
    tracking = Tracking(name, heavy, 60.0, 1.5)
    response, error = follow_fast_motion(heavy, name, tracking.command)
    assert np.abs(error).max() < 0.1
    assert tracking.statuses == {Status.OK}  # no saturation
    # after the motion each joint settles with at most one overshoot, and stands
    settling = response.qd[response.time > TIMES[-1]]
    for qd in settling.T:
        directions = np.sign(qd[np.abs(qd) > 1e-3])
        assert np.count_nonzero(np.diff(directions)) <= 1
    assert np.abs(settling[-300:]).max() < 1e-6


@pytest.mark.parametrize("name", CHAINS)
def test_gravity_compensation_keeps_the_arm_where_it_is_put(name: str) -> None:
    robot = simulated(name)
    law = GravityCompensation(solver_of(name), options_of(name, robot))

    def command(k: int, q: Floats, qd: Floats) -> Floats:
        tau, status = law.update(q, qd, PERIOD)
        assert status == Status.OK
        return tau

    for part in (0.0, 0.5, 1.0):
        posture = HOME[name] + part * MOVE[name]
        rest = np.zeros_like(posture)
        response = drive(robot, command, posture, rest, rate=RATE, ticks=3 * RATE)
        assert np.abs(response.q - posture).max() < 1e-9
        # pushed, it moves on a little and stays there
        pushed = drive(robot, command, posture, 0.2 * MOVE[name], rate=RATE, ticks=8 * RATE)
        assert 0.01 < np.abs(pushed.q[-1] - posture).max() < 0.5
        assert np.abs(pushed.qd[-1]).max() < 1e-3


@pytest.mark.parametrize("name", CHAINS)
def test_a_lost_reference_ends_at_rest_and_keeps_the_limits(name: str) -> None:
    robot = simulated(name)
    tracking = Tracking(name, robot, 20.0, 1.0)
    lost = 500  # at greatest speed, about

    def command(k: int, q: Floats, qd: Floats) -> Floats:
        if k == lost:
            nan = np.full_like(q, np.nan)
            tracking.references[k:] = [(nan, nan, nan)] * (len(tracking.references) - k)
        return tracking.command(k, q, qd)

    start = HOME[name]
    response = drive(robot, command, start, np.zeros_like(start), rate=RATE, ticks=8 * RATE)
    assert np.abs(response.qd[lost]).max() > 1.0
    assert np.abs(response.qd[-1]).max() < 2e-3
    assert tracking.statuses == {Status.OK, Status.REFERENCE_NOT_FINITE}
    assert (np.abs(response.effort) <= robot.chain.effort).all()


@pytest.mark.parametrize("name", CHAINS)
def test_safe_stop_stops_on_the_way(name: str) -> None:
    robot = simulated(name)
    tracking = Tracking(name, robot, 20.0, 1.0)
    stop = SafeStop(np.full(len(robot.dofs), 5.0), robot.chain.joint_names)
    pressed = 500

    def command(k: int, q: Floats, qd: Floats) -> Floats:
        if k == pressed:
            stop.begin(*tracking.references[k - 1][:2])
        if k >= pressed:
            tracking.references[k] = stop.advance(PERIOD)
        return tracking.command(k, q, qd)

    start = HOME[name]
    response = drive(robot, command, start, np.zeros_like(start), rate=RATE, ticks=1500)
    assert np.abs(response.qd[pressed]).max() > 1.0
    end = pressed + round(stop.duration * RATE)
    where = tracking.references[end][0]
    assert np.abs(response.q[end:] - where).max() < 2e-3
    assert np.abs(response.qd[-1]).max() < 1e-4
    assert tracking.statuses == {Status.OK}


@pytest.mark.parametrize("name", CHAINS)
def test_feed_forward_makes_a_weak_pd_follow(name: str) -> None:
    robot = simulated(name)
    law = FeedForward(solver_of(name), options_of(name, robot))
    Kd = 10.0 * np.diag(solver_of(name).inertia_matrix(HOME[name]))
    references = list(zip(*fast_motion(name).at(np.arange(10000) * PERIOD), strict=True))

    def pd(k: int, q: Floats, qd: Floats) -> Floats:
        return 20 * Kd * (references[k][0] - q) + Kd * (references[k][1] - qd)

    def with_feed_forward(k: int, q: Floats, qd: Floats) -> Floats:
        tau, status = law.update(q, qd, *references[k], effort=pd(k, q, qd), period=PERIOD)
        assert status == Status.OK
        return tau

    _, error = follow_fast_motion(robot, name, with_feed_forward)
    _, pd_error = follow_fast_motion(robot, name, pd)
    assert np.abs(error).max() < 0.02
    assert 10 * np.abs(error).max() < np.abs(pd_error).max()


@pytest.mark.parametrize("law", ["computed torque", "PD"])
def test_a_joint_turns_ten_times_whatever_its_driver_reports(law: str) -> None:
    """Position and reference within a turn, at up to 20 rad/s: the motion is that of unbounded ones."""
    text = pendulum(kind="continuous", limit='<limit velocity="30" effort="1000"/>')
    robot, solver = SimulatedRobot.from_urdf(text), Solver(RIGID_BODY, text)
    options = LawOptions(effort_limit=robot.chain.effort, damping=np.array([5.0]))
    times = np.array([0.0, 5.0, 6.0])
    motion = WaypointTrajectory.through(
        robot.chain.joint_names, times, np.array([[0.0], [20 * np.pi], [20 * np.pi]])
    )
    ticks = 6 * RATE
    references = list(zip(*motion.at(np.arange(ticks) * PERIOD), strict=True))

    def turn(
        report: Callable[[Floats], Floats], report_reference: Callable[[Floats], Floats]
    ) -> Response:
        computed = ComputedTorque(solver, Gains.of(np.full(1, 20.0), np.ones(1)), options)
        pd = PdGravityCompensation(solver, PdGains(np.full(1, 400.0), np.full(1, 40.0)), options)

        def command(k: int, q: Floats, qd: Floats) -> Floats:
            q_ref, qd_ref, qdd_ref = references[k]
            q, q_ref = report(q), report_reference(q_ref)
            if law == "PD":
                tau, status = pd.update(q, qd, q_ref, qd_ref, PERIOD)
            else:
                tau, status = computed.update(q, qd, q_ref, qd_ref, qdd_ref, period=PERIOD)
            assert status == Status.OK
            return tau

        return drive(robot, command, np.zeros(1), np.zeros(1), rate=RATE, ticks=ticks)

    reports = (lambda q: q, lambda q: (q + np.pi) % (2 * np.pi) - np.pi, lambda q: q % (2 * np.pi))
    expected = turn(reports[0], reports[0])
    assert expected.q[-1] == pytest.approx(20 * np.pi, abs=0.01)
    assert expected.qd.max() > 20.0
    for report, report_reference in zip(reports, (*reports[1:], reports[0]), strict=True):
        found = turn(report, report_reference)
        np.testing.assert_allclose(found.q, expected.q, rtol=0, atol=1e-9)
        np.testing.assert_allclose(found.effort, expected.effort, rtol=0, atol=1e-6)


def test_gravity_compensation_holds_both_arms_and_the_torso() -> None:
    robot = SimulatedRobot.from_urdf(two_arms.URDF, tip="*")
    tree = Solver(urdf=two_arms.URDF, tip="*")
    posture = np.linspace(-0.5, 0.5, 9)
    law = GravityCompensation(tree, LawOptions(effort_limit=robot.chain.effort, damping_rate=5.0))

    def command(k: int, q: Floats, qd: Floats) -> Floats:
        tau, status = law.update(q, qd, PERIOD)
        assert status == Status.OK
        return tau

    response = drive(robot, command, posture, np.zeros(9), rate=RATE, ticks=2 * RATE)
    assert np.abs(response.q - posture).max() < 1e-4  # the springs of joints that mimic give way

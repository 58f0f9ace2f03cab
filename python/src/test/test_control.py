# SPDX-License-Identifier: Apache-2.0
"""Bindings of the control laws; the laws themselves are tested in C++."""

import re

import numpy as np
import pytest
from example_robots import RIGID_BODY, UR10
from simulation_arms import CHAINS, urdf_of

from inverse_dynamics import Solver
from inverse_dynamics.control import (
    Compensated,
    ComputedTorque,
    FeedForward,
    FrictionOptions,
    FrictionSource,
    Gains,
    GravityCompensation,
    LawOptions,
    ModelState,
    PdGains,
    PdGravityCompensation,
    SafeStop,
    Status,
    damping_for,
)
from inverse_dynamics.errors import InvalidParameterError

PERIOD = 1e-3
N = 6

# rounding of torques of some hundred N m, summed in another order
ROUNDING = 1e-11

rng = np.random.default_rng(4)
q, qd, q_ref, qd_ref, qdd_ref = rng.uniform(-1, 1, (5, N))


def options(**changes):
    return LawOptions(
        **{"effort_limit": np.full(N, 1e6), "damping": np.arange(1.0, 7.0), **changes}
    )


@pytest.fixture(scope="module")
def solver():
    return Solver(RIGID_BODY, urdf_of("ur10"), *CHAINS["ur10"])


@pytest.fixture(scope="module")
def identified():
    return Solver(UR10)


def test_computed_torque(solver):
    gains = Gains.of(np.full(N, 20.0), np.full(N, 0.7))
    tau, status = ComputedTorque(solver, gains, options()).update(
        q, qd, q_ref, qd_ref, qdd_ref, period=PERIOD
    )
    a = qdd_ref + 400 * (q_ref - q) + 28 * (qd_ref - qd)
    np.testing.assert_allclose(tau, solver.torques(q, qd, a), atol=ROUNDING)
    assert status == Status.OK
    assert not status.is_refusal


def test_gravity_compensation(solver, identified):
    tau, _ = GravityCompensation(solver, options()).update(q, qd, PERIOD)
    np.testing.assert_allclose(tau, solver.gravity_vector(q) - np.arange(1, 7) * qd, atol=ROUNDING)
    guided = options(friction=FrictionOptions(blend=1e-6))
    tau, _ = GravityCompensation(identified, guided).update(q, 0 * qd, PERIOD, qd_reference=qd_ref)
    expected = identified.gravity_vector(q) + identified.friction_vector(qd_ref)
    np.testing.assert_allclose(tau, expected, atol=ROUNDING)


def test_pd_with_gravity_compensation(identified):
    Kp, Kd = np.arange(10.0, 70, 10), np.arange(1.0, 7)
    without = options(friction=FrictionOptions(FrictionSource.NONE))
    law = PdGravityCompensation(identified, PdGains(Kp, Kd), without)
    tau, status = law.update(q, qd, q_ref, qd_ref, PERIOD)
    expected = identified.gravity_vector(q) + Kp * (q_ref - q) + Kd * (qd_ref - qd)
    np.testing.assert_allclose(tau, expected, atol=ROUNDING)
    assert status == Status.OK
    law.set_gains(PdGains(2 * Kp, Kd))
    tau, _ = law.update(q, qd, q_ref, qd_ref, PERIOD)
    np.testing.assert_allclose(tau, expected + Kp * (q_ref - q), atol=ROUNDING)
    with pytest.raises(ValueError, match="expected 6 finite numbers that aren't negative"):
        law.set_gains(PdGains(-Kp, Kd))


def test_feed_forward_of_an_identified_robot(identified):
    effort = np.arange(N)
    law = FeedForward(identified, options(friction=FrictionOptions(FrictionSource.NONE)))
    tau, _ = law.update(q, qd, q_ref, qd_ref, qdd_ref, effort=effort, period=PERIOD)
    without = identified.torques(q_ref, qd_ref, qdd_ref) - identified.friction_vector(qd_ref)
    np.testing.assert_allclose(tau, without + effort, atol=ROUNDING)
    compensated = options(compensated=Compensated(gravity=True, coriolis=True, friction=True))
    law = FeedForward(identified, compensated, at=ModelState.MEASURED)
    tau, _ = law.update(q, qd, q_ref, qd_ref, qdd_ref, effort=effort, period=PERIOD)
    np.testing.assert_allclose(tau, identified.inertia_matrix(q) @ qdd_ref + effort, atol=ROUNDING)


def test_shares_of_each_joint_are_left_out():
    """Friction of <dynamics>: damping qd + friction sign(qd)."""
    urdf = re.sub("<dynamics [^>]*>", '<dynamics damping="3" friction="2"/>', urdf_of("ur10"))
    rubs = Solver(RIGID_BODY, urdf, *CHAINS["ur10"], parameters={"urdf_friction": True})
    share = rng.uniform(0, 1, (4, N))
    compensated = Compensated(share[0], share[1], share[2], share[3])
    law = FeedForward(rubs, options(compensated=compensated))
    fast = 1 + np.abs(qd_ref)  # friction is blended in below
    tau, _ = law.update(q, qd, q_ref, fast, qdd_ref, effort=np.zeros(N), period=PERIOD)
    g, c = rubs.gravity_vector(q_ref), rubs.coriolis_vector(q_ref, fast)
    left = [(1 - share[0]) * g, (1 - share[1]) * c, (1 - share[2]) * 2, (1 - share[3]) * 3 * fast]
    expected = rubs.inertia_matrix(q_ref) @ qdd_ref + sum(left)
    np.testing.assert_allclose(tau, expected, atol=1e-9)
    message = "feed-forward: compensated: gravity: joint shoulder_pan_joint: .* a share from 0 to 1"
    with pytest.raises(InvalidParameterError, match=message):
        FeedForward(rubs, options(compensated=Compensated(gravity=1.2)))


def test_limits_and_safe_torque(solver):
    limit = np.full(N, 30.0)
    law = GravityCompensation(solver, options(effort_limit=limit, rate_limit=np.full(N, 1e4)))
    g = solver.gravity_vector(q)
    assert (np.abs(g) > limit).any()
    law.start(np.zeros(N))
    tau, status = law.update(q, 0 * qd, PERIOD)
    np.testing.assert_array_equal(tau, np.clip(g, -10, 10))
    assert status == Status.SATURATED
    np.testing.assert_array_equal(law.saturated, np.abs(g) > limit)
    np.testing.assert_array_equal(law.rate_limited, np.abs(g) > 10)
    law.start()
    tau, status = law.hold(q, np.full(N, np.nan), PERIOD)
    np.testing.assert_array_equal(tau, np.clip(g, -30, 30))
    assert status == Status.STATE_NOT_FINITE
    assert status.is_refusal
    assert status.text == "the measured state isn't finite: safe torque instead"
    assert law.update(q[:3], qd, PERIOD)[1] == Status.WRONG_SIZE
    held = law.update(q, 0 * qd, PERIOD)[0]
    for period in (0.0, -1.0, np.nan, 1e9):
        tau, status = law.update(0 * q, 0 * qd, period)
        np.testing.assert_array_equal(tau, held)
        assert status == Status.NO_PERIOD


def test_safe_stop(solver):
    stop = SafeStop(np.full(N, 2.0), solver.joint_names)
    with pytest.raises(ValueError, match="call begin"):
        stop.advance(PERIOD)
    assert stop.begin(q, qd) == Status.OK
    assert stop.duration == pytest.approx(np.abs(qd).max() / 2)
    positions, velocities, accelerations = stop.advance(stop.duration)
    assert stop.finished
    np.testing.assert_allclose(positions, q + qd * stop.duration / 2)
    assert not velocities.any()
    assert not accelerations.any()


def test_damping_for(solver):
    expected = 5 * np.diagonal(solver.inertia_matrix(q))
    np.testing.assert_allclose(damping_for(solver, q, 5.0, PERIOD), expected, rtol=1e-12)


def test_mistakes_are_named(solver, identified):
    gains = Gains(np.ones(N), np.ones(N))
    with pytest.raises(InvalidParameterError, match="use the law FeedForward"):
        ComputedTorque(identified, gains, options())
    with pytest.raises(InvalidParameterError, match="joint elbow_joint: wrong value"):
        ComputedTorque(solver, gains, options(damping=[0, 0, -1, 0, 0, 0]))
    with pytest.raises(InvalidParameterError, match="dampingFor: rate: wrong value"):
        damping_for(solver, q, -1.0, PERIOD)

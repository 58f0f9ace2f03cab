# SPDX-License-Identifier: Apache-2.0
"""Bindings of the control laws; the laws themselves are tested in C++."""

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
    Status,
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


def test_mistakes_are_named(solver, identified):
    gains = Gains(np.ones(N), np.ones(N))
    with pytest.raises(InvalidParameterError, match="use the law FeedForward"):
        ComputedTorque(identified, gains, options())
    with pytest.raises(InvalidParameterError, match="joint elbow_joint: wrong value"):
        ComputedTorque(solver, gains, options(damping=[0, 0, -1, 0, 0, 0]))
    with pytest.raises(InvalidParameterError, match="damping_rate: wrong value"):
        ComputedTorque(solver, gains, options(damping_rate=-1.0))

# SPDX-License-Identifier: Apache-2.0
"""Control laws of the package inverse_dynamics_control, to be tried on simulated robots.

    from inverse_dynamics.control import ComputedTorque, Gains, LawOptions

    options = LawOptions(effort_limit=limits, damping_rate=5.0)  # 1/s
    law = ComputedTorque(solver, Gains.of(np.full(6, 20.0), np.ones(6)), options)
    tau, status = law.update(q, qd, q_reference, qd_reference, qdd_reference, period=1e-3)

They are what controllers call in C++, one state a call: see docs/control.md for the laws, their options and what they
promise. All arrays are (n,): rad, rad/s, rad/s^2, N m (prismatic m, m/s, m/s^2, N); joints in the order of
`solver.joint_names`. A torque is always finite and within its limits; the status says what it is.

Constructors raise InvalidParameterError, with law, option and joint: a number out of its range, a wrong size, a solver
that the law can't be used with. Updates raise nothing; an array of a wrong size is a status.
"""

from inverse_dynamics._core import (
    Compensated,
    ComputedTorque,
    ControlLaw,
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
)

__all__ = [
    "Compensated",
    "ComputedTorque",
    "ControlLaw",
    "FeedForward",
    "FrictionOptions",
    "FrictionSource",
    "Gains",
    "GravityCompensation",
    "LawOptions",
    "ModelState",
    "PdGains",
    "PdGravityCompensation",
    "SafeStop",
    "Status",
]

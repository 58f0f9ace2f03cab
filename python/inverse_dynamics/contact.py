# SPDX-License-Identifier: Apache-2.0
"""What touches the robot: estimators and detector of the package inverse_dynamics_control.

    from inverse_dynamics.contact import ContactDetector, EstimatorOptions, MomentumObserver, contact_thresholds

    observer = MomentumObserver(solver, EstimatorOptions(gain=np.full(7, 60.0)))
    torques, valid = observer.run(time, q, effort)                      # a recording without contact
    thresholds = contact_thresholds(torques[valid], 1e-3, 1.0, solver.joint_names)
    detector = ContactDetector(thresholds.torques, solver.joint_names)

They are what controllers call in C++: see docs/contact.md. Arrays are (n,), or (N, n) for N samples: rad, rad/s, N m
(prismatic m, m/s, N); joints in the order of `solver.joint_names`. External torques are what the robot exerts on its
surroundings.

Constructors and contact_thresholds raise InvalidParameterError. Updates raise nothing; an array of a wrong size is a
status.
"""

from inverse_dynamics._core import (
    AccelerationResidual,
    Compensated,
    ContactDetector,
    ContactThresholds,
    EstimateStatus,
    EstimatorOptions,
    ExternalTorqueEstimator,
    MomentumObserver,
    TipWrench,
    VelocitySource,
    WrenchStatus,
    contact_thresholds,
)

__all__ = [
    "AccelerationResidual",
    "Compensated",
    "ContactDetector",
    "ContactThresholds",
    "EstimateStatus",
    "EstimatorOptions",
    "ExternalTorqueEstimator",
    "MomentumObserver",
    "TipWrench",
    "VelocitySource",
    "WrenchStatus",
    "contact_thresholds",
]

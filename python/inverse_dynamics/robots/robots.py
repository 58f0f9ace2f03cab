# SPDX-License-Identifier: Apache-2.0
"""Run configurations: what a robot is, in one YAML file.

    robot = load_robot("ur10_real")        # one of the project's
    robot = load_robot("my_robot.yaml")    # one's own
    robot = load_robot("arm.urdf")         # its description alone

Which solver, from which description or model, between which links, and what its recordings look
like. Read in C++ (inverse_dynamics_evaluation/run_configuration.hpp), strictly: unknown or missing
keys and wrong types are errors with file, line and key.
"""

from __future__ import annotations

from inverse_dynamics._core import (
    Robot,
    load_robot,
    robot_names,
    robot_of_description,
    with_changes,
)

__all__ = [
    "RIGID_BODY",
    "Robot",
    "load_robot",
    "robot_names",
    "robot_of_description",
    "with_changes",
]

RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"

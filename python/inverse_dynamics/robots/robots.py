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

from contextlib import suppress
from typing import TYPE_CHECKING

from inverse_dynamics._core import Robot as Robot
from inverse_dynamics._core import Solver
from inverse_dynamics._core import load_robot as load_robot
from inverse_dynamics._core import robot_names as robot_names
from inverse_dynamics._core import robot_of_description as robot_of_description
from inverse_dynamics._core import with_changes as with_changes
from inverse_dynamics.errors import RobotError, SolverError

if TYPE_CHECKING:
    from pathlib import Path

_GRAVITY = (0.0, 0.0, -9.81)  # m/s^2, where nothing is stated
RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"


def robot_of(given: Robot | Solver | Path | str | None, urdf: Path | str | None = None) -> Robot:
    """The run configuration of a name, a file, a Solver (with its gravity); of a description alone where none is given.

    Raises RobotError.
    """
    if given is None:
        if urdf is None:
            raise RobotError(
                "expected a robot or urdf=, got neither; robot_names() lists the names of robots"
            )
        return robot_of_description(urdf)
    if isinstance(given, Solver):
        robot = given.robot
        with suppress(SolverError):  # of a solver whose gravity can't change
            gravity = tuple(given.gravity.tolist())
            if gravity != (robot.gravity or _GRAVITY):  # set since
                return with_changes(robot, gravity=gravity)
        return robot
    return given if isinstance(given, Robot) else load_robot(given)

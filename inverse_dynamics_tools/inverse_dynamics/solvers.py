# SPDX-License-Identifier: Apache-2.0
"""A solver made ready for a robot."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from inverse_dynamics import _core
from inverse_dynamics.errors import InvalidRobotDescriptionError, SolverError

if TYPE_CHECKING:
    from inverse_dynamics.robots import Robot


def open_solver(robot: Robot, description: str = "") -> _core.Solver:
    """The solver that a run configuration names. description: URDF text, or none.

    Raises SolverError: the solver's, with the robot before its text.
    """
    try:
        return _core.Solver(
            robot.plugin,
            urdf=description,
            root=robot.root,
            tip=robot.tip,
            gravity=robot.gravity,
            friction=robot.friction,
            model=None if robot.model is None else str(robot.model),
            parameters=robot.parameters,
        )
    except SolverError as error:
        at_fault = isinstance(error, InvalidRobotDescriptionError)
        where = f"robot {robot.name}" + (f" ({robot.urdf})" if at_fault else "")
        raise type(error)(f"{where}: {error}") from error


def description_notes(robot: Robot, use: str) -> list[str]:
    """What a reader should know of a description that was given: what it is of use for, if no more."""
    if not brings_own_model(robot):
        return []
    return [
        f"{robot.urdf} is {use}, not computed from: {robot.plugin} brings its own model; another "
        "--plugin computes from a description"
    ]


def brings_own_model(robot: Robot) -> bool:
    """Whether the solver has no need of a description or model file: then it reads none."""
    try:
        open_solver(replace(robot, model=None))
    except SolverError:
        return False
    return True

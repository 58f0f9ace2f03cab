# SPDX-License-Identifier: Apache-2.0
"""A solver made ready for a robot."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from inverse_dynamics import _core
from inverse_dynamics.errors import InvalidRobotDescriptionError, RobotError, SolverError
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import RIGID_BODY
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from inverse_dynamics.robots.robots import Robot


def open_solver(robot: Robot, description: str = "") -> _core.Solver:
    """The solver that a run configuration names. description: URDF text, or none.

    Raises SolverError: the solver's, with the robot before its text; RobotError: root and tip that
    the solver doesn't use, and that don't belong to its joints.
    """
    solver = make_solver(robot, description)
    if (robot.root or robot.tip) and (description or robot.urdf is None):
        _check_links(robot, description, solver)
    return solver


def solver_of(robot: Robot) -> _core.Solver:
    """The solver of a run configuration with its description. Raises UserError."""
    return open_solver(robot, "" if robot.urdf is None else read_description(robot.urdf))


def _check_links(robot: Robot, description: str, solver: _core.Solver) -> None:
    if robot.model is not None or not brings_own_model(robot):
        return
    if not description:
        given = " and ".join(name for name in ("root", "tip") if getattr(robot, name))
        raise RobotError(
            f"robot {robot.name}: {given}: expected none, as {robot.plugin} brings its own model and "
            "there is no description to check them with; leave them out"
        )
    parameters = {"allow_massless": True}
    reader = replace(robot, plugin=RIGID_BODY, gravity=None, parameters=parameters)
    own, chain = solver.joint_names, make_solver(reader, description).joint_names
    # joints of other names may be the same ones
    if chain != own if set(chain) & set(own) else len(chain) != len(own):
        raise RobotError(
            f"robot {robot.name} ({robot.urdf}): root '{robot.root}', tip '{robot.tip}': {robot.plugin} "
            f"doesn't use them: expected the {counted(len(own), 'joint')} of its own model between "
            f"them, got {len(chain)}: {listed(chain)}; correct them or leave them out"
        )


def make_solver(robot: Robot, description: str) -> _core.Solver:
    """The same as open_solver() for root and tip that have been checked."""
    try:
        # without a description none is read, not even the robot's own
        model = None if robot.model is None else str(robot.model)
        return _core.Solver(replace(robot, urdf=None), urdf=description, model=model)
    except SolverError as error:
        at_fault = isinstance(error, InvalidRobotDescriptionError)
        where = f"robot {robot.name}" + (f" ({robot.urdf})" if at_fault else "")
        raise type(error)(f"{where}: {error}") from error


def description_notes(robot: Robot, use: str) -> list[str]:
    """A warning where a description that was given is used for nothing but `use`."""
    if not brings_own_model(robot):
        return []
    return [
        f"{robot.urdf} is used only for {use}: {robot.plugin} brings its own model, so a tool or "
        "payload in the description isn't included in the torques: give --payload for it; another "
        "--plugin computes from a description"
    ]


def brings_own_model(robot: Robot) -> bool:
    """Whether the solver has no need of a description or model file: then it reads none."""
    try:
        make_solver(replace(robot, model=None), "")
    except SolverError:
        return False
    return True

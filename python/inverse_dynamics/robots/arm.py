# SPDX-License-Identifier: Apache-2.0
"""The arm of a run configuration: its solver, the names and units of its joints, its limits."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import RobotDescription, effort_options, recorded_names
from inverse_dynamics.errors import RobotError, SolverError
from inverse_dynamics.robots.descriptions import parse_description, read_description
from inverse_dynamics.robots.dh_tables import guess_of
from inverse_dynamics.robots.robots import RIGID_BODY, Robot
from inverse_dynamics.robots.solvers import brings_own_model, make_solver, open_solver

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import Floats


class Arm:
    """The arm of a run configuration, before a recording is read. Raises UserError."""

    def __init__(self, robot: Robot, solver: Solver | None = None) -> None:
        """solver: one that is made already, of this run configuration, whose payloads others carry, too."""
        self._given = solver
        if solver is None:
            description = "" if robot.urdf is None else read_description(robot.urdf)
            solver = open_solver(robot, description)
        else:
            description = solver.urdf
        self.description = description
        self.solver = solver
        self.joint_names = tuple(self.solver.joint_names)
        self.recorded_names = tuple(recorded_names(robot, list(self.joint_names)))
        effort_options(robot, self.solver)  # drive gains that don't fit are refused
        if description:
            # also where the solver doesn't read it
            parse_description(description, robot.urdf)
            try:
                RobotDescription(description)
            except RobotError as error:
                raise RobotError(f"{robot.urdf}: {error}") from error
        self.units = tuple(
            "N" if kind == "prismatic" else "N m" for kind in self.solver.joint_types
        )
        self.robot = robot

    def limit(self, name: str, absent: float) -> Floats:
        """(n,) of `lower`, `upper`, `velocity`, `effort`, `acceleration`, `deceleration` or `jerk`.

        The description's, or without one the model's; absent: of joints that have none.
        """
        stated = self.solver.limits.get(name, np.full(len(self.joint_names), np.inf))
        return np.where(np.isfinite(stated), stated, absent)

    @cached_property
    def guess(self) -> str:
        """What is made up of the bodies that torques are computed from: no evidence against a recording."""
        robot = self.robot
        return "" if robot.model or brings_own_model(robot) else guess_of(robot.urdf)

    @cached_property
    def subtracted(self) -> Solver:
        """The solver whose gravity efforts without gravity lack: of an identified model, the description's.

        The robot subtracts what its maker computes, which nobody measures with such efforts.
        """
        robot = self.robot
        if robot.model is None or robot.urdf is None or robot.plugin != RIGID_BODY:
            return self.solver
        described = self.solver_with(model=None, friction=False)
        # those of a model of motors aren't the joints of the description
        return described if described.joint_names == self.solver.joint_names else self.solver

    def solver_with(self, **changes: Any) -> Solver:
        """Another solver, of the same arm with other entries of its run configuration. Raises SolverError."""
        made = make_solver(replace(self.robot, **changes), self.description)
        if self._given is not None:
            with suppress(SolverError):  # one without payloads
                for name, body in self._given.payloads.items():
                    made.set_payload(name, **body)
                made.set_gravity(self._given.gravity)
        return made

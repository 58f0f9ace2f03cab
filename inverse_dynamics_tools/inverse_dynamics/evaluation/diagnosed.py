# SPDX-License-Identifier: Apache-2.0
"""The diagnosis of an evaluation: diagnosis.py with the evaluation's solver and samples."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import SolverError
from inverse_dynamics.evaluation.diagnosis import (
    ArmModel,
    Diagnosis,
    Samples,
    diagnose,
    rows_of_pieces,
)
from inverse_dynamics.robot.solvers import open_solver

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.data.joint_log import JointLog
    from inverse_dynamics.evaluation.diagnosis import Compute
    from inverse_dynamics.evaluation.effort import Effort
    from inverse_dynamics.robot.robots import Robot


def diagnosis_of(
    robot: Robot,
    solver: Solver,
    description: str,
    log: JointLog,
    qdd: Floats,
    effort: Effort,
) -> Diagnosis | None:
    """Why computed torques don't match the measured ones, where the cause is clear.

    robot, solver, description: what the torques were computed with. qdd: (N, n).
    """
    rows = rows_of_pieces(len(log))
    if rows is None:
        return None
    samples = Samples(
        tuple(solver.joint_names),
        log.time_at(rows),
        log.q[rows],
        log.qd[rows],
        qdd[rows],
        effort.torques(log.effort[rows]),
    )
    return diagnose(samples, _arm_model(robot, effort, solver, description))


def _arm_model(robot: Robot, effort: Effort, solver: Solver, description: str) -> ArmModel:
    ones = np.ones(len(solver.joint_names))
    model = ArmModel(
        torques=solver.torques,
        gravity=solver.gravity_vector,
        compared_without_gravity=effort.meaning == "torque_without_gravity",
        has_friction=bool(np.any(solver.friction_vector(ones, q=ones))),
    )

    @cache
    def other() -> Solver:  # one that may be changed
        return open_solver(robot, description)

    def mounted(gravity: Floats) -> Compute:
        def torques(q: Floats, qd: Floats, qdd: Floats) -> Floats:
            before = other().gravity
            other().set_gravity(gravity)
            try:
                return other().torques(q, qd, qdd)
            finally:
                other().set_gravity(before)

        return torques

    def loaded(mass: float, center: Floats) -> Compute:
        def torques(q: Floats, qd: Floats, qdd: Floats) -> Floats:
            other().set_payload(_BODY, mass, center)
            try:
                return other().torques(q, qd, qdd)
            finally:
                other().remove_payload(_BODY)

        return torques

    with suppress(SolverError):  # solvers needn't be able to
        model = replace(model, gravity_direction=solver.gravity, mounted=mounted)
    with suppress(SolverError):
        _ = solver.payloads
        model = replace(model, loaded=loaded)
    return model


_BODY = "diagnosis"

# SPDX-License-Identifier: Apache-2.0
"""Baselines of a new model: the description, and the present model with its friction refitted."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.posture import LOCKED, motors_of
from inverse_dynamics.robots.robots import RIGID_BODY, with_changes
from inverse_dynamics.robots.solvers import open_solver

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.robots.robots import Robot

    Motion = tuple[Floats, Floats, Floats]
    """q, qd, qdd; (M, n) each."""
    Computed = tuple[Floats, Floats, Floats, Floats]
    """q, qd, torques of the present model, and measured ones; (M, n) each."""

_STEP_WIDTH = 0.05  # rad/s, of a step that a model without friction is given


def baselines(robot: Robot, description: str) -> dict[str, Solver]:
    """By name of COLUMNS: the description without friction, and the present model if there is one."""
    posture = {name: at for name, at in robot.parameters.items() if name.startswith(LOCKED)}
    parameters = {**motors_of(robot), **posture}
    urdf = replace(robot, model=None, plugin=RIGID_BODY, friction=False, parameters=parameters)
    found = {"urdf": open_solver(with_changes(urdf), description)}
    if robot.plugin != RIGID_BODY or robot.model is not None:
        found["present"] = open_solver(robot, description)
    return found


def baseline_torques(
    solvers: Mapping[str, Solver], motion: Motion, fitted: Sequence[Computed]
) -> dict[str, Floats]:
    """(M, n) by name of COLUMNS. fitted: samples that the friction of the present model is refitted to."""
    found = {name: solver.torques(*motion) for name, solver in solvers.items()}
    if "present" in found:
        q, qd, _ = motion
        found["present_refitted"] = _refitted(solvers["present"], fitted, q, qd, found["present"])
    return found


def _refitted(
    solver: Solver, fitted: Sequence[Computed], q: Floats, qd: Floats, computed: Floats
) -> Floats:
    """Rigid bodies as they are; step, viscous friction and offset of each joint fitted to samples."""

    def parts(q: Floats, qd: Floats, computed: Floats) -> tuple[Floats, Floats]:
        """Torques without friction, (M, n); and its columns, (M, 3, n): its law's shape, qd, 1."""
        friction = solver.friction_vector(qd, q=q)
        shape = friction if friction.any() else np.tanh(qd / _STEP_WIDTH)
        return computed - friction, np.stack([shape, qd, np.ones_like(qd)], axis=1)

    of_fitted = [(measured, *parts(*rows)) for *rows, measured in fitted]
    errors = np.concatenate([measured - rigid for measured, rigid, _ in of_fitted])
    columns = np.concatenate([columns for _, _, columns in of_fitted])
    values = [np.linalg.lstsq(columns[:, :, j], e)[0] for j, e in enumerate(errors.T)]
    rigid, own = parts(q, qd, computed)
    return np.asarray(rigid + np.einsum("kcj,jc->kj", own, values))

# SPDX-License-Identifier: Apache-2.0
"""What a new model is compared with: the description, and the present model with its friction refitted."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.robot.robots import RIGID_BODY, with_changes
from inverse_dynamics.robot.solvers import open_solver

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.identification.blocks import Block
    from inverse_dynamics.robot.robots import Robot

_STEP_WIDTH = 0.05  # rad/s, of a step that a model without friction is given


class Baselines:
    """Torques of models that aren't new."""

    def __init__(self, robot: Robot, description: str) -> None:
        urdf = replace(robot, model=None, plugin=RIGID_BODY, friction=False, parameters={})
        self._urdf = open_solver(with_changes(urdf), description)
        self._present: Solver | None = None
        if robot.plugin != RIGID_BODY or robot.model is not None:
            self._present = open_solver(robot, description)

    def torques(self, block: Block, others: Sequence[Block]) -> dict[str, Floats]:
        """By name of COLUMNS, (M, n) of a block; what is fitted is fitted to the others."""
        found = {"urdf": self._urdf.torques(block.q, block.qd, block.qdd)}
        if self._present is not None:
            found["present"] = self._present.torques(block.q, block.qd, block.qdd)
            found["present_refitted"] = self._refitted(self._present, block, others)
        return found

    def _refitted(self, solver: Solver, block: Block, others: Sequence[Block]) -> Floats:
        """Rigid bodies as they are; step, viscous friction and offset of each joint refitted."""
        rigid, columns = _parts(solver, block)
        parts = [_parts(solver, other) for other in others]
        errors = np.concatenate(
            [(b.tau - r)[b.counts] for b, (r, _) in zip(others, parts, strict=True)]
        )
        known = np.concatenate([c[b.counts] for b, (_, c) in zip(others, parts, strict=True)])
        for j in range(rigid.shape[1]):
            figures = np.linalg.lstsq(known[:, :, j], errors[:, j])[0]
            rigid[:, j] += columns[:, :, j] @ figures
        return rigid


def _parts(solver: Solver, block: Block) -> tuple[Floats, Floats]:
    """Torques without friction, (M, n); and its columns, (M, 3, n): its own law's shape, qd, 1."""
    friction = solver.friction_vector(block.qd, q=block.q)
    rigid = solver.torques(block.q, block.qd, block.qdd) - friction
    shape = friction if friction.any() else np.tanh(block.qd / _STEP_WIDTH)
    return rigid, np.stack([shape, block.qd, np.ones_like(block.qd)], axis=1)


def root_mean_squares(columns: Sequence[Mapping[str, Floats]]) -> dict[str, Floats]:
    """(n,) by name, of errors (M, n) of blocks by name."""
    return {
        name: np.sqrt((np.concatenate([c[name] for c in columns]) ** 2).mean(0))
        for name in columns[0]
    }

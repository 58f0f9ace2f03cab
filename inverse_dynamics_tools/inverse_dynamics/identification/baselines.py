# SPDX-License-Identifier: Apache-2.0
"""What a new model is compared with: the description, and the present model with its friction refitted."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.posture import LOCKED
from inverse_dynamics.robot.descriptions import read_description
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
        posture = {name: at for name, at in robot.parameters.items() if name.startswith(LOCKED)}
        urdf = replace(robot, model=None, plugin=RIGID_BODY, friction=False, parameters=posture)
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
        refitted = RefittedFriction(
            solver,
            [
                (b.q[b.counts], b.qd[b.counts], solver.torques(*b.fitted[:3]), b.fitted[3])
                for b in others
            ],
        )
        return refitted.torques(block.q, block.qd, solver.torques(block.q, block.qd, block.qdd))


def solver_of(robot: Robot) -> Solver:
    """The solver of a run configuration with its description. Raises UserError."""
    return open_solver(robot, "" if robot.urdf is None else read_description(robot.urdf))


class RefittedFriction:
    """A solver's rigid bodies; step, viscous friction and offset of each joint fitted to samples."""

    def __init__(
        self, solver: Solver, samples: Sequence[tuple[Floats, Floats, Floats, Floats]]
    ) -> None:
        """samples: q, qd, torques of the solver and measured ones, (M, n) each."""
        self._solver = solver
        parts = [self._parts(q, qd, computed) for q, qd, computed, _ in samples]
        errors = np.concatenate([s[3] - r for s, (r, _) in zip(samples, parts, strict=True)])
        columns = np.concatenate([c for _, c in parts])
        self._values = np.stack(
            [np.linalg.lstsq(columns[:, :, j], e)[0] for j, e in enumerate(errors.T)], axis=1
        )  # (3, n)

    def torques(self, q: Floats, qd: Floats, computed: Floats) -> Floats:
        """(M, n) with that friction; computed: the solver's torques."""
        rigid, columns = self._parts(q, qd, computed)
        refitted: Floats = rigid + np.einsum("kcj,cj->kj", columns, self._values)
        return refitted

    def _parts(self, q: Floats, qd: Floats, computed: Floats) -> tuple[Floats, Floats]:
        """Torques without friction, (M, n); and its columns, (M, 3, n): its law's shape, qd, 1."""
        friction = self._solver.friction_vector(qd, q=q)
        shape = friction if friction.any() else np.tanh(qd / _STEP_WIDTH)
        return computed - friction, np.stack([shape, qd, np.ones_like(qd)], axis=1)


def root_mean_squares(columns: Sequence[Mapping[str, Floats]]) -> dict[str, Floats]:
    """(n,) by name, of errors (M, n) of blocks by name."""
    return {
        name: np.sqrt((np.concatenate([c[name] for c in columns]) ** 2).mean(0))
        for name in columns[0]
    }

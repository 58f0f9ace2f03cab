# SPDX-License-Identifier: Apache-2.0
"""How well a solver matches the simulator where nothing has to be estimated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.simulation.run import SimulatedRun


def greatest_differences(run: SimulatedRun, solver: Solver) -> Floats:
    """(n,) N m: `max |tau - effort|` at the simulator's own accelerations, its joint friction aside.

    solver: of rigid bodies, of the robot that was simulated.
    """
    motion = run.motion
    computed = solver.torques(motion.q, motion.qd, motion.qdd)
    differences: Floats = np.abs(computed - (motion.effort - motion.friction)).max(axis=0)
    return differences

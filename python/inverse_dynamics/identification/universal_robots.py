# SPDX-License-Identifier: Apache-2.0
"""Friction as a request of Universal Robots' driver, as `ros2 service call` takes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import RobotError
from inverse_dynamics.outputs.yaml_text import yaml_list
from inverse_dynamics.robots.solvers import solver_of

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.result import Identification

_FAST = 1e3  # rad/s, where only viscous friction still grows


def friction_request(found: Identification) -> str:
    """Shares of friction that the robot compensates: a request of ur_msgs/srv/SetFrictionModelParameters.

    Those are what efforts, the commands of the recordings, lack of the present model's friction.
    """
    speeds = np.median(np.abs(np.concatenate([block.qd for block in found.blocks])), axis=0)
    present, here = (
        _viscous_and_coulomb(solver, speeds) for solver in (solver_of(found.robot), found.solver())
    )
    if not (present > 0).all():
        raise RobotError(
            f"robot {found.robot.name}: expected a model with friction in every joint, which the robot's share is of, "
            "got one without; identify it first, from motor currents"
        )
    viscous, coulomb = np.clip(1 - here / present, 0, 1)
    return (
        "# ros2 service call /friction_model_controller/set_friction_model_parameters "
        'ur_msgs/srv/SetFrictionModelParameters "$(cat FILE)"\n'
        f"# Shares of the friction of {found.robot.name} that the robot has compensated in the recordings.\n"
        f"parameters:\n  viscous_scale: {yaml_list(viscous)}\n  coulomb_scale: {yaml_list(coulomb)}\n"
    )


def _viscous_and_coulomb(solver: Solver, speeds: Floats) -> Floats:
    """(2, n): N m s/rad; and N m at speeds (n,), the mean of both directions."""
    still = np.zeros_like(speeds)
    there, back, once, twice = (
        solver.friction_vector(v, q=still)
        for v in (speeds, -speeds, still + _FAST, still + 2 * _FAST)
    )
    viscous = (twice - once) / _FAST
    return np.array([viscous, (there - back) / 2 - viscous * speeds])

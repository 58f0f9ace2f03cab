# SPDX-License-Identifier: Apache-2.0
"""Requests of Universal Robots' driver, as `ros2 service call` takes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import RobotError
from inverse_dynamics.identification.baselines import solver_of
from inverse_dynamics.results.yaml_text import yaml_list, yaml_number

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.identification.payload import Payload
    from inverse_dynamics.identification.result import Identification

UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # ixx ixy ixz iyy iyz izz
_FAST = 1e3  # rad/s, where only viscous friction still grows


def payload_request(payload: Payload, name: str) -> str:
    """The load: a request of ur_msgs/srv/SetPayload. name: of the file."""
    found = payload.estimate
    mass = yaml_number(found.mass)
    center = ", ".join(
        f"{axis}: {yaml_number(x)}" for axis, x in zip("xyz", payload.center_of_mass, strict=True)
    )
    inertia = [
        f"i{'xyz'[i]}{'xyz'[j]}: {yaml_number(found.inertia[i, j])}"
        for i, j in UPPER
        if found.inertia_is_known
    ]
    nested = ", ".join([f"m: {mass}", f"com: {{{center}}}", *inertia])
    lines = [
        "# ros2 service call /io_and_status_controller/set_payload ur_msgs/srv/SetPayload "
        f'"$(cat {name})"',
        f"# In place of the payload that is set, about {payload.frame}, which must be the flange.",
        "# ur_msgs 2.6 (humble to lyrical); older ones have no inertia.",
        f"mass: {mass}",
        f"center_of_gravity: {{{center}}}",
        *inertia,
        f"# ur_msgs 3 (rolling), instead of all above: {{payload: {{{nested}}}}}",
    ]
    return "\n".join(lines) + "\n"


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

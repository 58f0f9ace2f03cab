# SPDX-License-Identifier: Apache-2.0
"""A load as texts: for --payload and run configurations, and for the driver of Universal Robots."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from inverse_dynamics.outputs.yaml_text import yaml_list, yaml_number

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.payload.payload import Payload

UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # ixx ixy ixz iyy iyz izz


def upper(matrix: Floats) -> list[float]:
    """Entries of a symmetric matrix (3, 3), by rows."""
    return [float(matrix[entry]) for entry in UPPER]


def yaml_text(payload: Payload) -> str:
    """The body as --payload reads it, with the intervals as comments."""
    found, evaluation = payload.estimate, payload.evaluation
    center = payload.center_of_mass_half_width
    lines = [
        f"# What {evaluation.robot.name} carries at its tip, by `ids payload`; 95 % intervals.",
        f"# Tip frame: {payload.frame}.",
        f"mass: {yaml_number(found.mass)}  # kg, +- {found.mass_half_width:.2g}",
        f"center_of_mass: {yaml_list(payload.center_of_mass)}  # m, tip frame, +- "
        + ", ".join(f"{width:.2g}" if math.isfinite(width) else "any" for width in center),
    ]
    if len(tips := evaluation.arm.solver.tip_names) > 1:
        lines.append(f"tip: {tips[0]}")
    if found.inertia_is_known:
        widths = upper(found.inertia_half_width)
        lines.append("# ixx ixy ixz iyy iyz izz about center_of_mass [kg m^2]")
        lines.append(
            f"inertia: {yaml_list(upper(found.inertia))}  # +- "
            + ", ".join(f"{width:.2g}" for width in widths)
        )
    else:
        lines.append("# inertia: not determined by the data")
    return "\n".join(lines) + "\n"


def payload_request(payload: Payload, name: str) -> str:
    """A request of ur_msgs/srv/SetPayload, as `ros2 service call` takes it. name: of the file."""
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

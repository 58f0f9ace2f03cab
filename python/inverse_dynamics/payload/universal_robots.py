# SPDX-License-Identifier: Apache-2.0
"""A load as a request of Universal Robots' driver, as `ros2 service call` takes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.outputs.yaml_text import yaml_number

if TYPE_CHECKING:
    from inverse_dynamics.payload.payload import Payload

UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # ixx ixy ixz iyy iyz izz


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

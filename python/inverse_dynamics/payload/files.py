# SPDX-License-Identifier: Apache-2.0
"""payload.yaml: a load for --payload and for run configurations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from inverse_dynamics.outputs.yaml_text import yaml_list, yaml_number
from inverse_dynamics.payload.tables import upper

if TYPE_CHECKING:
    from inverse_dynamics.payload.payload import Payload


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

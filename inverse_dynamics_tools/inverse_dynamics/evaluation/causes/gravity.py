# SPDX-License-Identifier: Apache-2.0
"""A base that is mounted in another way than the model says: gravity in another direction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.causes.rival import Rival, Told

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting

_LENGTH = (8.0, 12.0)  # m/s^2 of gravity, with masses that are wrong by a fifth
_LEAST_ANGLE = 4.0  # degrees: below it, flexible bases and wrong centers of mass look like a mount


def rivals(view: View, _: Fitting) -> Iterator[Rival]:
    """Gravity is linear in its three components."""
    arm = view.arm
    if arm.pulled is None or arm.gravity_direction is None:
        return
    own, free = arm.gravity_direction * (not arm.compared_without_gravity), (np.inf,) * 3
    yield Rival(
        "gravity",
        view.computed,
        view.qd,
        lambda change, _: _tell(own, own + change),
        columns=tuple(arm.pulled(view.motion[0])),
        low=tuple(-x for x in free),
        high=free,
        includes=("no_gravity",),
    )


def _tell(own: Floats, found: Floats) -> Told | None:
    length, size = float(np.linalg.norm(found)), float(np.linalg.norm(own))
    if not _LENGTH[0] <= length <= _LENGTH[1]:
        return None
    direction = np.round(found * 9.81 / length, 2) + 0.0
    cosine = float(direction @ own) / max(float(np.linalg.norm(direction)) * size, 1e-12)
    angle = float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    if size and angle < _LEAST_ANGLE:
        return None
    option = ",".join(f"{x:g}" for x in direction)
    return Told(
        "gravity",
        "The robot hangs from the ceiling" if angle > 150 else "The robot hangs on a wall",
        f"torques match if gravity acts along {option} m/s² in the frame of the root link"
        + (f", {angle:.0f}° from where the model has it" if size else ", and is in the efforts"),
        ("" if size else "give --effort-is torque; ")
        + f"give --gravity {option}, or `gravity:` in the run configuration",
        value=[float(x) for x in direction],
        shared=direction - own,
    )

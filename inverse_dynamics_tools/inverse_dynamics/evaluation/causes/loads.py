# SPDX-License-Identifier: Apache-2.0
"""A body at the tip that the model lacks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.causes.rival import Rival, Told, printed

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting

_MASS = (0.02, 1.0)  # of the arm's: less is within what makers know of it, no arm lifts more
_REACH = 1.0  # m between the tip and a load's center of mass
_BESIDE = 0.02  # of the greatest torque of the load: in the last joint, if it is beside its axis


def rivals(view: View, _: Fitting) -> Iterator[Rival]:
    """Torques are linear in mass and first moment, but for a small moment of inertia."""
    parts = view.loaded
    if parts is None or view.arm.compared_without_gravity:
        return
    yield Rival(
        "payload",
        view.computed,
        view.qd,
        lambda body, _: _tell(body, parts, view.arm.mass),
        columns=tuple(parts),
        low=(0.0,) + (-np.inf,) * 3,
        high=(np.inf,) * 4,
    )


def _tell(body: Floats, parts: Floats, arm: float) -> Told | None:
    least, most = (share * arm for share in _MASS)
    if body[0] <= least or (arm and body[0] > most):
        return None
    if np.linalg.norm(body[1:]) > _REACH * body[0]:
        return None
    mass = printed(body[0])
    center = np.round(body[1:] / body[0], 3) + 0.0
    rounded = np.array([mass, *(mass * center)])
    load = np.tensordot(rounded, parts, axes=1)
    beside = float(np.abs(load[:, -1]).max()) > _BESIDE * float(np.abs(load).max())
    where = ",".join(f"{x:g}" for x in center)
    return Told(
        "tool" if beside else "payload",
        "A tool the description lacks, and the tip" if beside else "A payload",
        f"torques match if the tip carries about {mass:.2g} kg at {where} m",
        f"give --payload {mass:g},{where}, or the load's link in the description",
        value=[mass, *map(float, center)],
        shared=rounded,
    )

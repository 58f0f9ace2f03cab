# SPDX-License-Identifier: Apache-2.0
"""Friction that changes with the temperature of the joints: `f(T) = f(T0) (1 + k (T - T0))`.

found = identify(["cold", "mild", "warm"], "my_arm.yaml")
write_identification(at_temperature(found, [20, 28, 35], 31), "arm_31.yaml")

k is the slope of the levels of the recordings [result.Level], T0 their mean temperature. Any number of a recording
will do, as the minutes since the robot was switched on.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.bands import SHARE
from inverse_dynamics.identification.result import IdentificationError
from inverse_dynamics.identification.uncertainty import USUAL_COUNTS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.result import Identification

_TORQUES = ("fv", "fc", "fl", "fs", "fm")  # of smooth_coulomb
_FEWEST = 3  # recordings: two always lie on a line


def at_temperature(
    found: Identification,
    temperatures: Sequence[float] | Floats,
    temperature: float | Floats,
) -> Identification:
    """Model and band with the friction of a temperature: of all joints, or (n,).

    temperatures: of each recording, (R,) or (R, n).

    Raises IdentificationError: fewer than three recordings, the same temperature in all, or one so far from them
    that no friction would be left.
    """
    count, n = len(found.levels), len(found.joints)
    given = np.array(temperatures, dtype=float)
    enough = count >= _FEWEST and len(given) == count
    T = given.reshape(count, -1) * np.ones(n) if enough else np.empty((0, n))
    if not enough or (np.ptp(T, axis=0) == 0).any():
        raise IdentificationError(
            f"temperatures: expected different ones of {_FEWEST} or more recordings that are identified together, "
            f"got {given.tolist()} of {count} recordings"
        )
    share = np.array([level.share for level in found.levels])
    factors = count * (1 + share) / (count + share)  # a level is held against the other recordings
    warmer = T - T.mean(axis=0)
    k = (warmer * (factors - 1)).sum(axis=0) / (warmer**2).sum(axis=0)
    left = ((factors - 1 - k * warmer) ** 2).sum(axis=0)
    factor = 1 + k * (np.asarray(temperature) - T.mean(axis=0))
    for name, value, of_joint in zip(found.joints, factor, T.T, strict=True):
        if not value > 0:
            raise IdentificationError(
                f"joint {name}: expected a temperature at which friction is above zero, got {value:.2g} times that "
                f"of the recordings; give one nearer to their range, {of_joint.min():g} to {of_joint.max():g}"
            )
    friction = tuple(
        {key: float(value * scale) if key in _TORQUES else value for key, value in law.items()}
        for law, scale in zip(found.model.friction, factor, strict=True)
    )
    return replace(
        found,
        model=replace(found.model, friction=friction),
        band=replace(
            found.band,
            friction=friction,
            share=np.sqrt((USUAL_COUNTS * SHARE**2 + left) / (USUAL_COUNTS + count)),
        ),
    )

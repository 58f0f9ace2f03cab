# SPDX-License-Identifier: Apache-2.0
"""Energy and power that a motion takes at the joints: losses of motors and gears beyond friction aren't in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import Floats


@dataclass(frozen=True)
class MotionEnergy:
    """Energy and power of a motion. Joints that brake return nothing."""

    driven: float  # J, integral of positive power over all joints
    friction: float  # J, lost to friction, also while joints brake
    peak_power: float  # W, the greatest sum of positive powers

    @classmethod
    def of(
        cls, solver: Solver, time: Floats, q: Floats, qd: Floats, efforts: Floats
    ) -> MotionEnergy:
        """Of N states at times (N,) s: q, qd, efforts (N, n). Power is linear between them."""
        power = np.maximum(efforts * qd, 0.0).sum(axis=1)
        lost = (solver.friction_vector(qd, q=q) * qd).sum(axis=1)
        return cls(
            float(np.trapezoid(power, time)), float(np.trapezoid(lost, time)), float(power.max())
        )

    @classmethod
    def together(cls, parts: Iterable[MotionEnergy]) -> MotionEnergy:
        """Of motions one after the other."""
        every = list(parts)
        return cls(
            sum(part.driven for part in every),
            sum(part.friction for part in every),
            max(part.peak_power for part in every),
        )

    @property
    def numbers(self) -> dict[str, float]:
        """For JSON."""
        return {
            "energy": self.driven,
            "energy_friction": self.friction,
            "peak_power": self.peak_power,
        }

    def __str__(self) -> str:
        return f"{self.driven:.1f} J, {self.friction:.1f} J of it friction; at most {self.peak_power:.0f} W"

# SPDX-License-Identifier: Apache-2.0
"""Torque noise of a real robot: what its model leaves unexplained, in another order.

    noise = EffortNoise.of_result(Path("recording_panda_real"))
    torques += noise.at(time, np.random.default_rng(0))

Residuals of neighbouring samples are alike, and those of different joints are too. So stretches of all joints together
are drawn with replacement and put one after another: the circular block bootstrap [Politis, Romano 1992, in: Exploring
the Limits of Bootstrap]. Within a stretch the correlation is that of the recording; where two meet there is a jump.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.simulation.errors import SimulationError

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.base.arrays import Floats

STRETCH = 2.0
"""Default length of a stretch [s], several times the correlation time of the residuals of real arms."""

_FILE = "series.npz"


@dataclass(frozen=True)
class EffortNoise:
    """Residuals to draw from."""

    residuals: Floats = field(repr=False)  # (M, n) N m (prismatic N); used without their means
    period: float  # s between two of them
    source: str = "given by the caller"
    stretch: float = STRETCH  # s

    def __post_init__(self) -> None:
        if not (np.ndim(self.residuals) == 2 and np.isfinite(self.residuals).all()):
            raise SimulationError(f"effort noise: {self.source}: expected finite residuals (M, n)")
        for name, value in (("period", self.period), ("stretch", self.stretch)):
            if not (np.isfinite(value) and value > 0):
                raise SimulationError(
                    f"effort noise: {name}: expected a time in s above zero, got {value:g}"
                )
        if len(self.residuals) * self.period < 2 * self.stretch:
            raise SimulationError(
                f"effort noise: {self.source}: expected at least {2 * self.stretch:g} s of samples without a fault, "
                f"got {len(self.residuals) * self.period:.2g} s; evaluate a longer recording"
            )

    @classmethod
    def of_result(cls, directory: Path) -> EffortNoise:
        """Measured minus computed torques of a result of `ids evaluate`. Raises SimulationError."""
        file = directory / _FILE
        try:
            with np.load(file, allow_pickle=False) as series:
                arrays = {name: series[name] for name in ("time", "measured", "computed", "kept")}
        except Exception as error:  # of damaged files, whatever their reader raises
            raise SimulationError(
                f"effort noise: {directory}: expected a result of `ids evaluate`, with measured and computed torques "
                f"in {_FILE}, got none that can be read"
            ) from error
        residuals = (arrays["measured"] - arrays["computed"])[arrays["kept"]]
        steps = np.diff(arrays["time"][arrays["kept"]])
        return cls(residuals, float(np.median(steps)) if len(steps) else 0.0, f"{directory}")

    def check_joints(self, joints: int) -> None:
        """Raises SimulationError unless the residuals are of so many joints."""
        if self.residuals.shape[1] != joints:
            raise SimulationError(
                f"effort noise: {self.source}: expected residuals of {joints} joints, got "
                f"{self.residuals.shape[1]}; are they of another robot?"
            )

    def at(self, time: Floats, random: np.random.Generator) -> Floats:
        """(N, n) noise at times (N,) s, ascending; between two residuals: on the line through them."""
        count = len(self.residuals)
        stretch = np.floor((time - time[0]) / self.stretch).astype(int)
        starts = random.integers(count, size=stretch[-1] + 1)
        place = starts[stretch] + (time - time[0] - stretch * self.stretch) / self.period
        before = np.floor(place + 1e-6).astype(int)
        share = np.maximum(place - before, 0.0)[:, None]
        centered = self.residuals - self.residuals.mean(axis=0)
        noise: Floats = (1 - share) * centered[before % count] + share * centered[
            (before + 1) % count
        ]
        return noise

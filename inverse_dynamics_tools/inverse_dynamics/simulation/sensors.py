# SPDX-License-Identifier: Apache-2.0
"""What a recording does to a motion: noise, quantisation, repeated and lost messages, stamps that jitter.

    recorded = Sensors(noise=Resolution(1e-5, 1e-3, 0.1), drop=0.01).record(motion, seed=0)

Only the recording is affected; the controller sees the robot as it is. Each effect draws from a random stream of its
own, so switching one on leaves the others as they were.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from inverse_dynamics.simulation.errors import SimulationError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from inverse_dynamics.base.arrays import Floats, Integers
    from inverse_dynamics.simulation.physics import Motion

EPOCH = 1_700_000_000.0
"""Stamp of the start of a simulation [s], so that stamps look like those of a real clock."""

_LATEST_EPOCH = 2.0e9  # s
_MOST_JITTER = 60.0  # s
_FINEST, _COARSEST = 1e-12, 1e6  # of noise and steps


@dataclass(frozen=True)
class Resolution:
    """One number for each of the three fields of a joint state; the same for all joints."""

    position: float  # rad
    velocity: float  # rad/s
    effort: float  # N m


NOISE = Resolution(1e-5, 1e-3, 0.1)
"""Default standard deviations, of the order of an industrial arm's."""

QUANTISATION = Resolution(1e-5, 1e-3, 0.01)
"""Default steps."""


class Recorded(NamedTuple):
    """Messages: M of them, n joints."""

    rows: NDArray[np.intp]  # (M,) which sample of the motion each message was sent for
    stamps: Integers  # (M,) ns
    q: Floats  # (M, n) rad
    qd: Floats  # (M, n) rad/s
    effort: Floats  # (M, n) N m


@dataclass(frozen=True)
class Sensors:
    """How a motion is recorded; by default as it is."""

    noise: Resolution | None = None  # standard deviations of Gaussian noise
    quantisation: Resolution | None = None  # steps
    drop: float = 0.0  # probability that a message is lost
    repeat: float = 0.0  # probability that a message carries the numbers of the one before
    jitter: float = 0.0  # s, standard deviation of the stamps
    epoch: float = EPOCH  # s

    def __post_init__(self) -> None:
        for name, value in (("drop", self.drop), ("repeat", self.repeat)):
            if not 0 <= value < 1:
                raise SimulationError(
                    f"{name}: expected a probability from 0 to below 1, got {value:g}"
                )
        for name, value in (("jitter", self.jitter), ("start stamp", self.epoch)):
            if not (np.isfinite(value) and value >= 0):
                raise SimulationError(
                    f"{name}: expected a time in s that isn't negative, got {value:g}"
                )
        if self.epoch > _LATEST_EPOCH:
            raise SimulationError(
                f"start stamp: expected at most {_LATEST_EPOCH:g} s (a ROS stamp has 32 bits), got {self.epoch:g}"
            )
        if self.jitter > _MOST_JITTER:
            raise SimulationError(
                f"jitter: expected at most {_MOST_JITTER:g} s, got {self.jitter:g}"
            )
        for name, three in (("noise", self.noise), ("quantisation", self.quantisation)):
            for field, value in vars(three).items() if three else ():
                if not (np.isfinite(value) and value >= 0):
                    expected = "a number that isn't negative"
                elif value > _COARSEST:
                    expected = f"at most {_COARSEST:g}"
                elif 0 < value < _FINEST:
                    expected = f"0 or at least {_FINEST:g}"
                else:
                    continue
                raise SimulationError(f"{name}: {field}: expected {expected}, got {value:g}")

    def record(self, motion: Motion, seed: int) -> Recorded:
        """Messages of a motion; the same seed gives the same ones."""
        noise, drop, repeat, jitter = (np.random.default_rng((seed, i)) for i in range(4))
        fields = [motion.q, motion.qd, motion.effort]
        if self.noise is not None:
            stds = vars(self.noise).values()
            fields = [
                values + std * noise.standard_normal(values.shape)
                for values, std in zip(fields, stds, strict=True)
            ]
        if self.quantisation is not None:
            steps = vars(self.quantisation).values()
            fields = [
                step * np.round(values / step) if step > 0 else values
                for values, step in zip(fields, steps, strict=True)
            ]
        samples = len(motion.time)
        # a repeated message carries the numbers of the last one that was new
        new = repeat.random(samples) >= self.repeat
        new[0] = True
        source = np.maximum.accumulate(np.where(new, np.arange(samples), 0))
        kept = np.flatnonzero(drop.random(samples) >= self.drop)
        if len(kept) < 2:
            raise SimulationError(f"drop: {self.drop:g} leaves {len(kept)} of {samples} messages")
        q, qd, effort = (values[source[kept]] for values in fields)
        return Recorded(kept, self._stamps(motion.time, jitter)[kept], q, qd, effort)

    def _stamps(self, time: Floats, random: np.random.Generator) -> Integers:
        """Increasing stamps [ns], one ns apart at least."""
        jittered = time + self.jitter * random.standard_normal(len(time))
        offsets = np.round(1e9 * jittered).astype(np.int64)
        order = np.arange(len(time))
        apart = np.maximum.accumulate(offsets - order) + order
        return apart - min(0, int(apart[0])) + round(self.epoch * 1e9)  # never before the epoch

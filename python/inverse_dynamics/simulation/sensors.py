# SPDX-License-Identifier: Apache-2.0
"""Errors of a recorded motion: noise, delay, quantisation, repeated and lost messages, stamps that jitter.

    recorded = Sensors(noise=Resolution(1e-5, 1e-3, 0.1), drop=0.01).record(motion, seed=0)

Only the recording is affected; the controller sees the robot as it is. Each effect draws from a random stream of its
own, so switching one on leaves the others as they were.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from inverse_dynamics.simulation.errors import SimulationError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from inverse_dynamics.arrays import Floats, Integers
    from inverse_dynamics.simulation.physics import Motion

EPOCH = 1_700_000_000.0
"""Stamp of the start of a simulation [s], so that stamps look like those of a real clock."""

STRETCH = 2.0
"""Default length of a stretch [s], several times the correlation time of the residuals of real arms."""

_FINEST = 1e-12  # of noise and steps
_ROUNDING = 1e-9


@dataclass(frozen=True)
class EffortNoise:
    """Torque noise of a real robot: what its model leaves unexplained, in another order.

        noise = EffortNoise.of_result(Path("recording_panda_real"))
        torques += noise.at(time, np.random.default_rng(0))

    Residuals of neighbouring samples are alike, and those of different joints are too. So stretches of all joints
    together are drawn with replacement and put one after another: the circular block bootstrap [Politis, Romano 1992,
    in: Exploring the Limits of Bootstrap]. Where two stretches meet, there is a jump.
    """

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
        try:
            with np.load(directory / "series.npz", allow_pickle=False) as series:
                arrays = {name: series[name] for name in ("time", "measured", "computed", "kept")}
        except Exception as error:  # of damaged files, whatever their reader raises
            raise SimulationError(
                f"effort noise: {directory}: expected a result of `ids evaluate`, with measured and computed torques "
                "in series.npz, got none that can be read"
            ) from error
        residuals = (arrays["measured"] - arrays["computed"])[arrays["kept"]]
        steps = np.diff(arrays["time"][arrays["kept"]])
        return cls(residuals, float(np.median(steps)) if len(steps) else 0.0, f"{directory}")

    def at(self, time: Floats, random: np.random.Generator) -> Floats:
        """(N, n) noise at times (N,) s, ascending; between two residuals: on the line through them."""
        count = len(self.residuals)
        stretch = np.floor((time - time[0]) / self.stretch).astype(int)
        starts = random.integers(count, size=stretch[-1] + 1)
        place = starts[stretch] + (time - time[0] - stretch * self.stretch) / self.period
        before = np.floor(place + 1e-6).astype(int)
        share = np.maximum(place - before, 0.0)[:, None]
        centered = self.residuals - self.residuals.mean(axis=0)
        here, next_one = centered[before % count], centered[(before + 1) % count]
        return np.asarray((1 - share) * here + share * next_one)


@dataclass(frozen=True)
class Resolution:
    """One number for each of the three fields of a joint state; the same for all joints."""

    position: float  # rad
    velocity: float  # rad/s
    effort: float  # N m


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
    effort_noise: EffortNoise | None = None  # of another colour, on top of `noise`
    effort_delay: float = 0.0  # s by which recorded efforts are older than positions and velocities
    message_rate: float | None = None  # Hz; None: a message for each sample
    quantisation: Resolution | None = None  # steps
    drop: float = 0.0  # probability that a message is lost
    repeat: float = 0.0  # probability that a message carries the numbers of the one before
    jitter: float = 0.0  # s, standard deviation of the stamps
    start_stamp: float = EPOCH  # s

    def __post_init__(self) -> None:
        steps = {
            f"{name}: {quantity}": value
            for name, three in (("noise", self.noise), ("quantisation", self.quantisation))
            for quantity, value in (vars(three).items() if three else ())
        }
        for name, value, most in (
            ("drop", self.drop, "1"),
            ("repeat", self.repeat, "1"),
            ("jitter", self.jitter, "60 s"),
            ("start stamp", self.start_stamp, "2e9 s (a ROS stamp has 32 bits)"),
            ("effort delay", self.effort_delay, "1 s"),
            *((name, value, "1e6") for name, value in steps.items()),
        ):
            if not 0 <= value <= float(most.split()[0]):
                raise SimulationError(f"{name}: expected 0 to {most}, got {value:g}")
        for name, value in steps.items():
            if 0 < value < _FINEST:
                raise SimulationError(f"{name}: expected 0 or at least {_FINEST:g}, got {value:g}")

    @property
    def are_random(self) -> bool:
        """Whether another seed gives another recording of the same motion."""
        return bool(self.noise or self.effort_noise or self.drop or self.repeat or self.jitter)

    def check(self, joints: int, rate: float) -> None:
        """Raises SimulationError unless this number of joints can be recorded at this rate [Hz]."""
        noise = self.effort_noise
        if noise is not None and noise.residuals.shape[1] != joints:
            raise SimulationError(
                f"effort noise: {noise.source}: expected residuals of {joints} joints, got "
                f"{noise.residuals.shape[1]}; are they of another robot?"
            )
        if self.message_rate is not None and not 0 < self.message_rate <= rate * (1 + _ROUNDING):
            raise SimulationError(
                f"message rate: expected a rate above zero, and at most the controller's ({rate:g} Hz), got "
                f"{self.message_rate:g} Hz"
            )

    def record(self, motion: Motion, seed: int) -> Recorded:
        """Messages of a motion; the same seed gives the same ones."""
        samples, joints = motion.q.shape
        self.check(joints, (samples - 1) / (motion.time[-1] - motion.time[0]))
        noise, drop, repeat, jitter, coloured = (np.random.default_rng((seed, i)) for i in range(5))
        sampled = self._sampled(motion.time)
        time = motion.time[sampled]
        fields = [motion.q[sampled], motion.qd[sampled], self._effort(motion, sampled)]
        if self.effort_noise is not None:
            fields[2] = fields[2] + self.effort_noise.at(time, coloured)
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
        # a repeated message carries the numbers of the last one that was new
        new = repeat.random(len(time)) >= self.repeat
        new[0] = True
        source = np.maximum.accumulate(np.where(new, np.arange(len(time)), 0))
        kept = np.flatnonzero(drop.random(len(time)) >= self.drop)
        if len(kept) < 2:
            raise SimulationError(f"drop: {self.drop:g} leaves {len(kept)} of {len(time)} messages")
        q, qd, effort = (values[source[kept]] for values in fields)
        return Recorded(sampled[kept], self._stamps(time, jitter)[kept], q, qd, effort)

    def _sampled(self, time: Floats) -> NDArray[np.intp]:
        """Samples that messages are sent for: the last ones that are there when a message is due."""
        if self.message_rate is None:
            return np.arange(len(time))
        due = np.arange(int((time[-1] - time[0]) * self.message_rate + _ROUNDING) + 1)
        after = time[0] + due / self.message_rate + _ROUNDING
        rows: NDArray[np.intp] = np.searchsorted(time, after, "right") - 1
        return rows

    def _effort(self, motion: Motion, sampled: NDArray[np.intp]) -> Floats:
        """As it was some time ago; before the first sample, as it was then."""
        if self.effort_delay == 0:
            return motion.effort[sampled]
        then = motion.time[sampled] - self.effort_delay
        columns = [np.interp(then, motion.time, column) for column in motion.effort.T]
        return np.transpose(columns)

    def _stamps(self, time: Floats, random: np.random.Generator) -> Integers:
        """Increasing stamps [ns], one ns apart at least."""
        jittered = time + self.jitter * random.standard_normal(len(time))
        offsets = np.round(1e9 * jittered).astype(np.int64)
        order = np.arange(len(time))
        apart = np.maximum.accumulate(offsets - order) + order
        # never before the start
        return apart - min(0, int(apart[0])) + round(self.start_stamp * 1e9)

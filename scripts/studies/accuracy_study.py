# SPDX-License-Identifier: Apache-2.0
"""Measures the choice of the cut-off on synthetic recordings, and writes the table of docs/accuracy.md.

A recording is a motion with known accelerations and the noise of one kind of velocity; every second one has an event.
The error of the default accelerations, over all samples, is divided by the least error that the same filter has with
a given cut-off. No constant was chosen by these recordings, but one bound: motion has no more power than the velocity.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from studies import show, table

from inverse_dynamics import _core

if TYPE_CHECKING:
    from collections.abc import Iterator

    from inverse_dynamics.arrays import Floats, Integers

    Random = np.random.Generator

JOINTS = 7


@dataclass(frozen=True)
class Motion:
    """Samples (N, n) at equal distances, exact."""

    rate: float  # Hz
    q: Floats
    qd: Floats
    qdd: Floats

    @property
    def time(self) -> Floats:
        """(N,) s."""
        return np.arange(len(self.q)) / self.rate


@dataclass(frozen=True)
class Recording:
    """What a robot would have recorded of a motion."""

    event: str
    motion: Motion
    time: Floats  # stamps
    source: Integers  # of each message, the index of its sample of the motion
    q: Floats
    qd: Floats


# ---- motions -------------------------------------------------------------------------------------


def fourier(rate: float, duration: float, frequency: float, random: Random) -> Motion:
    """Five sines per joint up to a frequency: in motion at both ends."""
    time = np.arange(round(rate * duration) + 1)[:, None] / rate
    q, qd, qdd = (np.zeros((len(time), JOINTS)) for _ in range(3))
    for _ in range(5):
        w = 2 * np.pi * frequency * random.uniform(0.2, 1.0, JOINTS)
        speed, phase = 0.3 * random.standard_normal(JOINTS), random.uniform(0, 2 * np.pi, JOINTS)
        q += speed / w * np.sin(w * time + phase)
        qd += speed * np.cos(w * time + phase)
        qdd -= speed * w * np.sin(w * time + phase)
    return Motion(rate, q, qd, qdd)


def quintic(x: Floats) -> tuple[Floats, Floats, Floats]:
    """From 0 to 1 over 0 <= x <= 1, at rest outside; with both derivatives by x."""
    x = np.clip(x, 0.0, 1.0)
    return (
        x**3 * (10 - 15 * x + 6 * x**2),
        30 * x**2 * (1 - x) ** 2,
        60 * x * (1 - x) * (1 - 2 * x),
    )


def points(rate: float, duration: float, frequency: float, random: Random) -> Motion:
    """Quintic motions from point to point with rests of up to half a second."""
    time = np.arange(round(rate * duration) + 1)[:, None] / rate
    q, qd, qdd = (np.zeros((len(time), JOINTS)) for _ in range(3))
    begin = random.uniform(0.0, 0.3)
    while begin < duration - 0.2:
        length = random.uniform(0.7, 1.3) / frequency
        way = 0.3 * length * random.standard_normal(JOINTS)
        p, pd, pdd = quintic((time - begin) / length)
        q += way * p
        qd += way / length * pd
        qdd += way / length**2 * pdd
        begin += length + random.uniform(0.0, 0.5)
    return Motion(rate, q, qd, qdd)


# ---- what a robot records ------------------------------------------------------------------------


def white(motion: Motion, random: Random) -> tuple[Floats, Floats]:
    """Positions of an encoder of 12 to 22 bits, velocities with white noise of their own."""
    return encoded(motion, int(random.integers(12, 23))), motion.qd + noise(motion, random)


def low_passed(motion: Motion, random: Random) -> tuple[Floats, Floats]:
    """Such positions; noise of velocities below 40 Hz, or of all frequencies where the samples hold no more."""
    values = 3 * noise(motion, random)
    if motion.rate > 100:
        values = _core.low_pass(values, motion.rate, 40.0, 1)
    return encoded(motion, int(random.integers(12, 23))), motion.qd + values


def quantised(motion: Motion, random: Random) -> tuple[Floats, Floats]:
    """Velocities in steps of 0.005 rad/s."""
    return encoded(motion, 20), 0.005 * np.round(motion.qd / 0.005)


def differences(motion: Motion, random: Random) -> tuple[Floats, Floats]:
    """Backward differences of an encoder of 14 to 20 bits, in half of them behind a filter.

    The driver runs when the recording begins: its first difference is like the second.
    """
    bits = int(random.integers(14, 21))
    tremor = 0.3 * 2 * np.pi / 2.0**bits * random.standard_normal(motion.q.shape)
    q = encoded(replace(motion, q=motion.q + tremor), bits)
    qd = np.diff(q, axis=0, prepend=2 * q[:1] - q[1:2]) * motion.rate
    if random.integers(2):
        keep = np.exp(-2 * np.pi * random.uniform(10, 60) / motion.rate)
        for k in range(1, len(qd)):
            qd[k] = keep * qd[k - 1] + (1 - keep) * qd[k]
    return q, qd


def encoded(motion: Motion, bits: int) -> Floats:
    """Positions of an encoder."""
    step = 2 * np.pi / 2.0**bits
    return step * np.round(motion.q / step)


def noise(motion: Motion, random: Random) -> Floats:
    """White, of 3e-4 to 3e-2 rad/s."""
    deviation = float(10 ** random.uniform(-3.5, -1.5))
    return deviation * random.standard_normal(motion.qd.shape)


# ---- recordings with one event -------------------------------------------------------------------


def with_velocity(motion: Motion, qd: Floats, qdd: Floats) -> Motion:
    """A motion from the same position, integrated by the trapezoidal rule with its correction."""
    steps = (qd[1:] + qd[:-1]) / 2 - (qdd[1:] - qdd[:-1]) / (12 * motion.rate)
    q = motion.q[:1] + np.vstack((np.zeros((1, qd.shape[1])), steps.cumsum(axis=0))) / motion.rate
    return Motion(motion.rate, q, qd, qdd)


def impact(motion: Motion, at: float, random: Random) -> Motion:
    """Velocities that jump within 3 to 20 ms, and swing at 8 to 25 Hz until that has decayed."""
    t = (motion.time - at)[:, None]
    rise, decay, w = random.uniform(0.003, 0.02), random.uniform(5, 15), random.uniform(50, 157)
    size = random.uniform(0.1, 0.6) * random.standard_normal(motion.q.shape[1])
    p, pd, _ = quintic(t / rise)
    envelope, cos, sin = np.exp(-decay * np.maximum(t, 0.0)), np.cos(w * t), np.sin(w * t)
    qdd = envelope * (pd / rise * cos - p * (decay * cos + w * sin))
    return with_velocity(motion, motion.qd + size * p * envelope * cos, motion.qdd + size * qdd)


def slowed(motion: Motion, gain: Floats, rate: Floats) -> Motion:
    """A motion whose velocities are multiplied by a gain of a known rate."""
    return with_velocity(motion, gain * motion.qd, gain * motion.qdd + rate * motion.qd)


def emergency_stop(motion: Motion, at: float, random: Random) -> Motion:
    """Rest after a stop within 0.03 to 0.2 s."""
    length = random.uniform(0.03, 0.2)
    p, pd, _ = quintic((motion.time - at)[:, None] / length)
    return slowed(motion, 1 - p, -pd / length)


def pause(motion: Motion, at: float, random: Random) -> Motion:
    """A rest of up to half of the recording."""
    t = (motion.time - at)[:, None] / 0.3
    down, down_d, _ = quintic(t)
    up, up_d, _ = quintic(t - 1 - random.uniform(0.1, 0.5) * motion.time[-1] / 0.3)
    return slowed(motion, 1 - down + up, (up_d - down_d) / 0.3)


def slip(motion: Motion, at: float, random: Random) -> Motion:
    """One joint turns away at up to 20 rad/s within 0.1 to 0.4 s."""
    length = random.uniform(0.1, 0.4)
    way = np.zeros(motion.q.shape[1])
    way[random.integers(len(way))] = random.uniform(1, 10) * length
    p, pd, pdd = quintic((motion.time - at)[:, None] / length)
    q, qd = motion.q + way * p, motion.qd + way / length * pd
    return Motion(motion.rate, q, qd, motion.qdd + way / length**2 * pdd)


def spike(recording: Recording, at: int, random: Random) -> Recording:
    """One sample of one joint is wrong, in q, in qd or in both."""
    q, qd, joint = recording.q.copy(), recording.qd.copy(), random.integers(recording.q.shape[1])
    size, where = 10 ** random.uniform(-1, 1), random.integers(3)
    q[at, joint] += 0.1 * size * (where != 0)
    qd[at, joint] += size * (where != 1)
    return replace(recording, q=q, qd=qd)


def seam(recording: Recording, at: int, random: Random) -> Recording:
    """Positions of one joint jump by a whole turn from one sample on."""
    q = recording.q.copy()
    q[at:, random.integers(q.shape[1])] -= 2 * np.pi
    return replace(recording, q=q)


def restart(recording: Recording, at: int, random: Random) -> Recording:
    """No sample for up to 3 s; in half of the recordings, positions count from others after it."""
    q = recording.q.copy()
    q[at:] += random.integers(2) * random.uniform(-3, 3, q.shape[1])
    gap = random.uniform(0.02, 3.0)
    kept = (recording.time < recording.time[at]) | (recording.time > recording.time[at] + gap)
    return replace(
        recording,
        time=recording.time[kept],
        source=recording.source[kept],
        q=q[kept],
        qd=recording.qd[kept],
    )


MOVED = {"impact": impact, "emergency stop": emergency_stop, "slip": slip, "pause": pause}
RECORDED = {"spike": spike, "seam": seam, "restart": restart}
MOST_SAMPLES = 30000  # of a recording with an event: 10 min at 50 Hz


def recordings() -> Iterator[Recording]:
    """200 recordings of 2 to 7 joints, 3 s to 10 min, 50 Hz to 1 kHz; every second has an event."""
    noises = (white, low_passed, quantised, differences)
    events = [*MOVED, *RECORDED]
    for number in range(200):
        random = np.random.default_rng(500000 + number)
        rate = float(random.choice((50.0, 100.0, 125.0, 200.0, 250.0, 500.0, 1000.0)))
        duration = min(np.exp(random.uniform(np.log(3), np.log(600))), MOST_SAMPLES / rate)
        highest = min(4.0, rate / 15)
        frequency = max(np.exp(random.uniform(np.log(0.1), np.log(highest))), 1.5 / duration)
        make = points if random.integers(2) else fourier
        whole = make(rate, duration, frequency, random)
        n = random.integers(2, JOINTS + 1)
        motion = Motion(rate, whole.q[:, :n], whole.qd[:, :n], whole.qdd[:, :n])
        event = events[number // 2 % len(events)] if number % 2 else "none"
        at = random.uniform(0.2, 0.8) * duration
        if event in MOVED:
            motion = MOVED[event](motion, at, random)
        q, qd = noises[random.integers(len(noises))](motion, random)
        time = motion.time
        if random.integers(4) == 0:  # late stamps
            time = time + random.uniform(0.0, 0.8 / rate, len(time))
        recording = Recording(event, motion, time, np.arange(len(q)), q, qd)
        if event in RECORDED:
            recording = RECORDED[event](recording, round(at * rate), random)
        yield recording


def ratio(recording: Recording) -> float:
    """Error of the accelerations of the default, over that of the best cut-off that is given."""

    def error(cutoff: float) -> float:
        qdd = _core.low_pass_accelerations(
            recording.time, recording.q, recording.qd, np.zeros((0, 0)), cutoff
        )[0]
        return float(np.sqrt(((qdd - recording.motion.qdd[recording.source]) ** 2).mean()))

    given = np.geomspace(0.25, min(0.39 * recording.motion.rate, 120.0), 25)
    return error(0.0) / min(error(cutoff) for cutoff in given)


# ---- table ---------------------------------------------------------------------------------------


def number(value: float) -> str:
    """Short: 1.03, 12, 9e+06."""
    if value < 10:
        return f"{value:.2f}"
    return f"{value:.0f}" if value < 1e4 else f"{value:.0e}"


def table_of(ratios: list[tuple[str, float]]) -> str:
    """Ratios without an event, and with each kind."""
    rows = []
    kinds = ["none", *MOVED, *RECORDED]
    for name, chosen in [*((kind, {kind}) for kind in kinds), ("all", set(kinds))]:
        values = np.array([ratio for kind, ratio in ratios if kind in chosen])
        quantiles = (number(value) for value in np.quantile(values, (0.5, 0.95, 1.0)))
        rows.append((name, len(values), *quantiles, f"{100 * np.mean(values <= 1.3):.0f} %"))
    return table(("event", "recordings", "median", "95 %", "greatest", "within 1.3"), rows)


if __name__ == "__main__":
    ratios = [(recording.event, ratio(recording)) for recording in recordings()]
    show(table_of(ratios), "accuracy.md", "accuracy_study")

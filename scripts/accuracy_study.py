# SPDX-License-Identifier: Apache-2.0
"""Measures accelerations on synthetic recordings and writes the tables of docs/accuracy.md.

    ./scripts/accuracy_study            # all recordings, a few minutes; prints the tables
    ./scripts/accuracy_study --short    # every fourth recording
    ./scripts/accuracy_study --write    # all recordings; replaces the tables in docs/accuracy.md

A recording is a motion of a Panda with known accelerations, sampled with the noise of one kind of
velocity. Its error is the root mean square over all samples, ends included, of the computed torques
minus the true ones, mean over the joints; for recordings that rest, of the accelerations within the
motion. It is divided by the least error of a fixed cut-off: a zero-phase Butterworth filter whose
ends are continued by point reflection, the same for all recordings, with the cut-off between 0.25
and 80 Hz that knowing the truth makes best.

For 200 further recordings, half of them with one event, the choice alone is judged: the error of the
accelerations over all samples with the default is divided by the least one with a cut-off that is
given. No constant was chosen by them, but one bound: motion has no more power than the velocity.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics.robot.robots import load_robot
from inverse_dynamics.robot.solvers import open_solver

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from inverse_dynamics.base.arrays import Floats, Integers

PAGE = Path(__file__).parent.parent / "docs" / "accuracy.md"
BEGIN, END = "<!-- scripts/accuracy_study: begin -->", "<!-- scripts/accuracy_study: end -->"
JOINTS = 7
MOST_TORQUES = 4000  # samples of a recording whose torques are computed, evenly spread
CUTOFFS = np.geomspace(0.25, 80.0, 33)  # Hz, of the fixed filter


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

    group: str
    motion: Motion
    time: Floats  # stamps
    source: Integers  # whose sample of the motion a message holds: repeats hold an older one
    q: Floats
    qd: Floats
    clean_qd: Floats  # of all samples of the motion: what the fixed filter gets
    moving: Integers | None = None  # where the error is taken, if not everywhere


# ---- motions -------------------------------------------------------------------------------------


def fourier(rate: float, duration: float, frequency: float, random: np.random.Generator) -> Motion:
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


def faded(motion: Motion, seconds: float) -> Motion:
    """A motion times a window that rises and falls: at rest at both ends."""
    time = motion.time[:, None]
    up, up_d, up_dd = quintic(time / seconds)
    down, down_d, down_dd = quintic((time[-1] - time) / seconds)
    w = up * down
    wd = (up_d * down - up * down_d) / seconds
    wdd = (up_dd * down - 2 * up_d * down_d + up * down_dd) / seconds**2
    q = w * motion.q
    qd = wd * motion.q + w * motion.qd
    return Motion(motion.rate, q, qd, wdd * motion.q + 2 * wd * motion.qd + w * motion.qdd)


def points(rate: float, duration: float, frequency: float, random: np.random.Generator) -> Motion:
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


def single(rate: float, duration: float, begin: float, length: float, speed: float = 0.3) -> Motion:
    """One quintic motion of a mean speed [rad/s] in a long rest."""
    time = np.arange(round(rate * duration) + 1)[:, None] / rate
    way = speed * length * np.linspace(1.0, -0.5, JOINTS)
    p, pd, pdd = quintic((time - begin) / length)
    return Motion(rate, way * p, way / length * pd, way / length**2 * pdd)


# ---- what a robot records ------------------------------------------------------------------------


def fine(motion: Motion, random: np.random.Generator) -> Floats:
    """Positions of a good encoder."""
    return motion.q + 1e-6 * random.standard_normal(motion.q.shape)


def white(
    motion: Motion, random: np.random.Generator, deviation: float = 0.003
) -> tuple[Floats, Floats]:
    """Velocities with white noise [rad/s]."""
    return fine(motion, random), motion.qd + deviation * random.standard_normal(motion.qd.shape)


def little(motion: Motion, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Velocities with a tenth of that noise."""
    return white(motion, random, 0.0003)


def low_passed(motion: Motion, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Noise below 40 Hz, or of all frequencies where the samples hold no more."""
    noise = 0.01 * random.standard_normal(motion.qd.shape)
    if motion.rate > 100:
        noise = _core.low_pass(noise, motion.rate, 40.0, 1)
    return fine(motion, random), motion.qd + noise


def quantised(motion: Motion, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Velocities in steps of 0.005 rad/s."""
    return fine(motion, random), 0.005 * np.round(motion.qd / 0.005)


def differentiated(motion: Motion, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Differences of the recorded positions, in steps of 1e-5 rad, smoothed by a filter of 30 Hz."""
    q = 1e-5 * np.round((motion.q + 3e-6 * random.standard_normal(motion.q.shape)) / 1e-5)
    qd = np.gradient(q, 1 / motion.rate, axis=0)
    return q, _core.low_pass(qd, motion.rate, 30.0, 1) if motion.rate > 100 else qd


# The positions and velocities that a robot records of a motion.
NOISES: dict[str, Callable[[Motion, np.random.Generator], tuple[Floats, Floats]]] = {
    "white": white,
    "little": little,
    "low-passed": low_passed,
    "quantised": quantised,
    "differentiated": differentiated,
}


def recorded(
    group: str,
    motion: Motion,
    noise: str,
    random: np.random.Generator,
    moving: Integers | None = None,
) -> Recording:
    """A recording of a motion; from 125 Hz on one in four has late stamps, one in four repeats."""
    q, qd = NOISES[noise](motion, random)
    time, source = motion.time, np.arange(len(q))
    fault = random.integers(4) if moving is None and motion.rate > 100 else 3
    if fault == 0:
        time = time + random.uniform(0.0, 0.8 / motion.rate, len(time))
    elif fault == 1:
        source[9::10] -= 1
    return Recording(group, motion, time, source, q[source], qd[source], qd, moving)


def recordings(step: int) -> Iterator[Recording]:
    """All recordings, or every `step`-th."""
    plan: list[tuple[str, float, float, float, str]] = [
        (group, rate, duration, frequency, noise)
        for group, duration in (
            ("20 s, in motion at both ends", 20.0),
            ("20 s, from rest to rest", 20.0),
            ("20 s, from point to point", 20.0),
            ("3 s", 3.0),
        )
        for rate in (30.0, 125.0, 1000.0, 1000.0)
        for frequency in (0.1, 0.3, 1.0, 2.0, 5.0)
        for noise in NOISES
        if frequency <= rate / 15
    ]
    for index, (group, rate, duration, frequency, noise) in enumerate(plan):
        if index % step:
            continue
        random = np.random.default_rng(index)
        frequency = max(frequency, 1.0 / duration)
        if group == "20 s, from point to point":
            motion = points(rate, duration, frequency, random)
        else:
            motion = fourier(rate, duration, frequency, random)
            if group != "20 s, in motion at both ends" and not (duration == 3.0 and index % 2):
                motion = faded(motion, min(1.0 / frequency, duration / 3))
        yield recorded(group, motion, noise, random)
    for index, noise in enumerate(NOISES):
        for number, (duration, begin, length) in enumerate(
            ((1200.0, 600.3, 0.5), (600.0, 0.4, 0.5), (600.0, 598.7, 1.0), (600.0, 200.0, 3.0))
        ):
            if (index + number) % step:
                continue
            motion = single(125.0, duration, begin, length)
            moving = np.flatnonzero(np.abs(motion.time - begin - length / 2) <= length / 2)
            random = np.random.default_rng(1000 + 10 * index + number)
            yield recorded("10 or 20 min of rest, one motion", motion, noise, random, moving)
    yield from rests(step)


def rests(step: int) -> Iterator[Recording]:
    """Long rests of any rate, speed and length of the motion: no constant was chosen by them."""
    for number in range(0, 60, step):
        random = np.random.default_rng(90000 + number)
        rate = float(random.choice((100.0, 125.0, 200.0, 250.0, 500.0, 1000.0)))
        duration, length = 40000 / rate, random.uniform(0.4, 1.0)
        begin, speed = random.uniform(1.0, duration - 2.0), 10 ** random.uniform(-1.0, 0.0)
        motion = single(rate, duration, begin, length, speed)
        moving = np.flatnonzero(np.abs(motion.time - begin - length / 2) <= length / 2)
        noise = list(NOISES)[number % len(NOISES)]
        yield recorded("40 to 400 s of rest, other motions", motion, noise, random, moving)


# ---- recordings with one event -------------------------------------------------------------------


def with_velocities(motion: Motion, qd: Floats, qdd: Floats) -> Motion:
    """A motion from the same position, integrated by the trapezoidal rule with its correction."""
    steps = (qd[1:] + qd[:-1]) / 2 - (qdd[1:] - qdd[:-1]) / (12 * motion.rate)
    q = motion.q[:1] + np.vstack((np.zeros((1, qd.shape[1])), steps.cumsum(axis=0))) / motion.rate
    return Motion(motion.rate, q, qd, qdd)


def impact(motion: Motion, at: float, random: np.random.Generator) -> Motion:
    """Velocities that jump within 3 to 20 ms, and swing at 8 to 25 Hz until that has decayed."""
    t = (motion.time - at)[:, None]
    rise, decay, w = random.uniform(0.003, 0.02), random.uniform(5, 15), random.uniform(50, 157)
    size = random.uniform(0.1, 0.6) * random.standard_normal(motion.q.shape[1])
    p, pd, _ = quintic(t / rise)
    envelope, cos, sin = np.exp(-decay * np.maximum(t, 0.0)), np.cos(w * t), np.sin(w * t)
    qdd = envelope * (pd / rise * cos - p * (decay * cos + w * sin))
    return with_velocities(motion, motion.qd + size * p * envelope * cos, motion.qdd + size * qdd)


def slowed(motion: Motion, gain: Floats, rate: Floats) -> Motion:
    """A motion whose velocities are multiplied by a gain of a known rate."""
    return with_velocities(motion, gain * motion.qd, gain * motion.qdd + rate * motion.qd)


def emergency_stop(motion: Motion, at: float, random: np.random.Generator) -> Motion:
    """Rest after a stop within 0.03 to 0.2 s."""
    length = random.uniform(0.03, 0.2)
    p, pd, _ = quintic((motion.time - at)[:, None] / length)
    return slowed(motion, 1 - p, -pd / length)


def pause(motion: Motion, at: float, random: np.random.Generator) -> Motion:
    """A rest of up to half of the recording."""
    t = (motion.time - at)[:, None] / 0.3
    down, down_d, _ = quintic(t)
    up, up_d, _ = quintic(t - 1 - random.uniform(0.1, 0.5) * motion.time[-1] / 0.3)
    return slowed(motion, 1 - down + up, (up_d - down_d) / 0.3)


def slip(motion: Motion, at: float, random: np.random.Generator) -> Motion:
    """One joint turns away at up to 20 rad/s within 0.1 to 0.4 s."""
    length = random.uniform(0.1, 0.4)
    way = np.zeros(motion.q.shape[1])
    way[random.integers(len(way))] = random.uniform(1, 10) * length
    p, pd, pdd = quintic((motion.time - at)[:, None] / length)
    q, qd = motion.q + way * p, motion.qd + way / length * pd
    return Motion(motion.rate, q, qd, motion.qdd + way / length**2 * pdd)


def spike(recording: Recording, at: int, random: np.random.Generator) -> Recording:
    """One sample of one joint is wrong, in q, in qd or in both."""
    q, qd, joint = recording.q.copy(), recording.qd.copy(), random.integers(recording.q.shape[1])
    size, where = 10 ** random.uniform(-1, 1), random.integers(3)
    q[at, joint] += 0.1 * size * (where != 0)
    qd[at, joint] += size * (where != 1)
    return replace(recording, q=q, qd=qd)


def seam(recording: Recording, at: int, random: np.random.Generator) -> Recording:
    """Positions of one joint jump by a whole turn from one sample on."""
    q = recording.q.copy()
    q[at:, random.integers(q.shape[1])] -= 2 * np.pi
    return replace(recording, q=q)


def restart(recording: Recording, at: int, random: np.random.Generator) -> Recording:
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


def coarse(motion: Motion, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Positions of an encoder of 12 to 17 bits, velocities with noise of their own."""
    step = 2 * np.pi / 2 ** random.integers(12, 18)
    q = step * np.round(motion.q / step)
    return q, motion.qd + 10 ** random.uniform(-3.5, -1.5) * random.standard_normal(q.shape)


def differences(motion: Motion, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Backward differences of an encoder of 14 to 20 bits, in half of them behind a filter.

    The driver runs when the recording begins: its first difference is like the second.
    """
    step = 2 * np.pi / 2 ** random.integers(14, 21)
    q = step * np.round(motion.q / step + 0.3 * random.standard_normal(motion.q.shape))
    qd = np.diff(q, axis=0, prepend=2 * q[:1] - q[1:2]) * motion.rate
    if random.integers(2):
        keep = np.exp(-2 * np.pi * random.uniform(10, 60) / motion.rate)
        for k in range(1, len(qd)):
            qd[k] = keep * qd[k - 1] + (1 - keep) * qd[k]
    return q, qd


def eventful(step: int) -> Iterator[Recording]:
    """200 recordings of 2 to 7 joints, 3 s to 10 min, 50 Hz to 1 kHz; every second has an event."""
    noises = [*NOISES.values(), coarse, differences]
    events = [*MOVED, *RECORDED]
    for number in range(0, 200, step):
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
        recording = Recording(event, motion, time, np.arange(len(q)), q, qd, qd)
        if event in RECORDED:
            recording = RECORDED[event](recording, round(at * rate), random)
        yield recording


def choice_ratio(recording: Recording) -> float:
    """Error of the accelerations of the default, over that of the best cut-off that is given."""

    def error(cutoff: float) -> float:
        qdd = _core.low_pass_accelerations(
            recording.time, recording.q, recording.qd, np.zeros((0, 0)), cutoff
        )[0]
        return float(np.sqrt(((qdd - recording.motion.qdd[recording.source]) ** 2).mean()))

    given = np.geomspace(0.25, min(0.39 * recording.motion.rate, 120.0), 25)
    return error(0.0) / min(error(cutoff) for cutoff in given)


# ---- errors --------------------------------------------------------------------------------------


class Judge:
    """Errors of estimated accelerations of one recording."""

    def __init__(self, recording: Recording, torques: Callable[[Floats, Floats, Floats], Floats]):
        self.recording, self.torques = recording, torques
        motion = recording.motion
        stride = -(-len(motion.q) // MOST_TORQUES)
        self.at = np.arange(0, len(motion.q), stride)
        source = recording.source[self.at]  # a repeat repeats the torque too
        self.true = torques(motion.q[source], motion.qd[source], motion.qdd[source])

    def error(self, qdd: Floats) -> float:
        """Of torques over all samples, or of accelerations within the motion."""
        moving = self.recording.moving
        if moving is not None:
            difference = qdd[moving] - self.recording.motion.qdd[moving]
        else:
            at = self.at
            computed = self.torques(self.recording.q[at], self.recording.qd[at], qdd[at])
            difference = computed - self.true
        return float(np.sqrt((difference**2).mean(axis=0)).mean())

    def best_fixed(self) -> float:
        """Least error of a fixed cut-off, its ends continued by reflection."""
        recording, rate = self.recording, self.recording.motion.rate
        qd, offset = recording.clean_qd, 0
        if recording.moving is not None:  # all that a fixed filter sees of a long rest
            margin = round(20 * rate)
            offset = max(recording.moving[0] - margin, 0)
            qd = qd[offset : recording.moving[-1] + margin]
        errors = []
        for cutoff in (fixed for fixed in CUTOFFS if fixed < 0.4 * rate):
            qdd = np.zeros_like(recording.qd)
            qdd[offset : offset + len(qd)] = derivative(_core.low_pass(qd, rate, cutoff), rate)
            errors.append(self.error(qdd[recording.source]))
        return min(errors)


def derivative(x: Floats, rate: float) -> Floats:
    """Central differences of fourth order; of second order beside the ends."""
    result = np.gradient(x, 1 / rate, axis=0)
    result[2:-2] = rate * (8 * (x[3:-1] - x[1:-3]) - (x[4:] - x[:-4])) / 12
    return result


METHODS = ("raw backward differences", "the default")


def ratios(recording: Recording, judge: Judge) -> dict[str, float]:
    """Error of each method over that of the best fixed cut-off."""
    default = _core.low_pass_accelerations(
        recording.time, recording.q, recording.qd, np.zeros((0, 0))
    )[0]
    estimates = (_core.backward_difference(recording.time, recording.qd), default)
    best = judge.best_fixed()
    return {method: judge.error(qdd) / best for method, qdd in zip(METHODS, estimates, strict=True)}


# ---- tables --------------------------------------------------------------------------------------


def number(value: float) -> str:
    """Short: 1.03, 12, 9e+06."""
    if value < 10:
        return f"{value:.2f}"
    return f"{value:.0f}" if value < 1e4 else f"{value:.0e}"


def row(name: str, values: list[float]) -> str:
    """One row of a table: median, 95 %, greatest, above 1.1."""
    median, most, greatest = np.quantile(values, (0.5, 0.95, 1.0))
    above = sum(value > 1.1 for value in values)
    return (
        f"| {name} | {number(median)} | {number(most)} | {number(greatest)} "
        f"| {above} of {len(values)} |"
    )


def event_table(ratios_of: list[tuple[str, float]]) -> str:
    """Ratios without an event, and with each kind."""
    head = (
        "| event | recordings | median | 95 % | greatest | within 1.3 |\n|---|---|---|---|---|---|"
    )
    lines = [head]
    kinds = ["none", *MOVED, *RECORDED]
    for name, chosen in [*((kind, {kind}) for kind in kinds), ("all", set(kinds))]:
        values = np.array([ratio for kind, ratio in ratios_of if kind in chosen])
        if len(values):
            median, most, greatest = (number(v) for v in np.quantile(values, (0.5, 0.95, 1.0)))
            within = f"{100 * np.mean(values <= 1.3):.0f} %"
            lines.append(f"| {name} | {len(values)} | {median} | {most} | {greatest} | {within} |")
    return "\n".join(lines)


def tables(results: list[tuple[str, dict[str, float]]]) -> str:
    """Both tables in Markdown, without events."""
    head = "median | 95 % | greatest | above 1.1 |\n|---|---|---|---|---|"
    groups = list(dict.fromkeys(group for group, _ in results))
    lines = [f"| the default, recordings of | {head}"]
    lines += [
        row(group, [found["the default"] for name, found in results if name == group])
        for group in groups
    ]
    lines += ["", f"| method, all {len(results)} recordings | {head}"]
    lines += [row(method, [found[method] for _, found in results]) for method in METHODS]
    return "\n".join(lines)


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--short", action="store_true", help="every fourth recording")
    parser.add_argument("--write", action="store_true", help="replace the tables in docs")
    arguments = parser.parse_args()
    if arguments.short and arguments.write:
        parser.error("--write needs all recordings: leave out --short")

    solver = open_solver(load_robot("panda_real"), "")
    results = []
    for recording in recordings(4 if arguments.short else 1):
        results.append((recording.group, ratios(recording, Judge(recording, solver.torques))))
        if sys.stderr.isatty():
            print(f"\r{len(results)} recordings", end="", file=sys.stderr)
    with_events = [
        (recording.group, choice_ratio(recording))
        for recording in eventful(4 if arguments.short else 1)
    ]
    table = f"{tables(results)}\n\n{event_table(with_events)}"
    print(table)
    if arguments.write:
        page = PAGE.read_text(encoding="utf-8")
        before, rest = page.split(BEGIN)
        after = rest.split(END)[1]
        PAGE.write_text(f"{before}{BEGIN}\n\n{table}\n\n{END}{after}", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: Apache-2.0
"""Positions, velocities and time that contradict each other, the description's limits, or the efforts.

Comparing velocities with the slope of positions needs no torques, so it comes first; contradictions are
corrected before rivals are compared.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis.rival import Mistake, Rival, printed
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.diagnosis.arm import ArmModel
    from inverse_dynamics.diagnosis.fit import Fitting
    from inverse_dynamics.diagnosis.pieces import Pieces, View

_AGREE = 0.1  # relative, of velocities and slopes of positions: filters of drivers take some
_SAME = 0.04  # relative, of the factors of joints, and of a factor and that of a unit
_FOLLOWS = 0.2  # of the square of the slopes: what velocities in another unit may leave
_DEGREE = 180 / np.pi
_RATES = {  # velocity over slope of the positions
    30 / np.pi: "rpm",
    1 / (2 * np.pi): "turns per second",
    1000.0: "mrad/s",
    0.001: "krad/s",
}
_CLOCKS = {1000.0: "ms", 1e6: "us", 1e9: "ns", 1e-3: "thousands of seconds", 60.0: "1/60 s"}
TURNS = 4 * np.pi  # rad: joints without limits seldom turn on
_GAP = 5.0  # times the usual distance of samples: across a longer one, time may be wrong
_BEYOND = 1.2  # times the limit
_CLOCK = 1.12  # least factor of time that efforts distinguish from wrong inertias


def contradictions(
    samples: Pieces, arm: ArmModel, ways: tuple[Floats, Floats, Mask] | None = None
) -> list[tuple[Mistake, Pieces]]:
    """Contradictions of velocities, positions and time that explain the same, and the samples without each.

    ways: (K, n) by how much positions change, by how much velocities say, and the joints (n,) that move; by default
    those of the pieces.
    """
    way, integral, moves = ways or _ways(samples)
    power = np.maximum((integral**2).sum(axis=0), 1e-300)
    rate = (way * integral).sum(axis=0) / power  # positions change so many times as fast
    total = np.maximum((way**2).sum(axis=0), 1e-300)
    follows = moves & (((way - rate * integral) ** 2).sum(axis=0) < _FOLLOWS * total)
    silent = moves & (power < 1e-6 * total)
    if silent.any():
        return [(_velocity(samples, silent, 0.0, "zero"), _with_slopes(samples, silent))]
    wrong = follows & (np.abs(rate - 1) > _AGREE)
    if not wrong.any():
        return []
    prismatic = arm.of_type("prismatic", len(moves))
    turning = follows & ~prismatic
    usable = turning if turning.any() else follows
    middle = float(np.median(rate[usable]))
    found = []
    if (np.abs(rate[usable] / middle - 1) < _SAME).all():
        everywhere = bool((wrong == follows).all())
        in_degrees = _in_degrees(samples, prismatic, middle) if turning.any() else None
        if in_degrees:
            return [in_degrees]
        if by_clock := _by_clock(samples, usable, middle, everywhere):
            found.append(by_clock)
    factor = float(np.median(1 / rate[wrong]))
    reverse = (np.abs(rate[wrong] + 1) < _AGREE).all()
    text = "reversed" if reverse else f"{factor:.3g} times too fast"
    text = next((f"in {u}" for f, u in _RATES.items() if abs(factor / f - 1) < _SAME), text)
    return [*found, (_velocity(samples, wrong, factor, text), _with_slopes(samples, wrong))]


def _ways(samples: Pieces) -> tuple[Floats, Floats, Mask]:
    """(K, n) by how much positions change in each piece, by how much velocities say; joints that move."""
    step = np.diff(samples.time, axis=1)[..., None]
    whole = (step[..., 0] > 0).all(axis=1) & (step.max(axis=(1, 2)) < _GAP * np.median(step))
    integral = (0.5 * (samples.qd[:, 1:] + samples.qd[:, :-1]) * step).sum(axis=1)[whole]
    way = (samples.q[:, -1] - samples.q[:, 0])[whole]
    if not len(way):
        return way, integral, np.zeros(way.shape[1], bool)
    # drivers repeat values: the least change that positions show; infinite where none changes
    steps = np.abs(np.diff(samples.q, axis=1))
    resolution = np.where(steps > 0, steps, np.inf).min(axis=(0, 1))
    return way, integral, np.quantile(np.abs(way), 0.9, axis=0) > 5 * resolution


def _in_degrees(samples: Pieces, prismatic: Mask, rate: float) -> tuple[Mistake, Pieces] | None:
    """Positions or velocities of all joints that turn, also of those at rest."""
    if min(abs(rate / _DEGREE - 1), abs(rate * _DEGREE - 1)) >= _SAME:
        return None
    scale = np.where(prismatic, 1.0, 1 / _DEGREE)
    if rate > 1:
        which, other, key = "positions", "velocities", "q"
        right = replace(samples, q=samples.q * scale)
    else:
        which, other, key = "velocities", "positions", "qd"
        right = replace(samples, qd=samples.qd * scale, qdd=samples.qdd * scale)
    reason = (
        f"positions change {rate:.3g} times as fast as velocities say: {which} are in degrees, "
        f"{other} in rad"
    )
    return _degrees(reason, prismatic, (key,)), right


def _by_clock(
    samples: Pieces, usable: Mask, rate: float, everywhere: bool
) -> tuple[Mistake, Pieces] | None:
    """Time that runs at another speed for all joints, which no unit of velocities explains."""
    known = any(abs(1 / rate / factor - 1) < _SAME for factor in _RATES if factor < 100)
    if rate <= 0 or known or not everywhere or usable.sum() < 2:
        return None
    unit = next((u for f, u in _CLOCKS.items() if abs(1 / rate / f - 1) < _SAME), "")
    finding = Mistake(
        "clock",
        "A clock at the wrong speed",
        f"positions change {rate:.3g} times as fast as velocities say, in every joint"
        + (f": time is in {unit}" if unit else ""),
        "record again with a clock that runs right; until then, of a recording of ROS the clock of reception may do: "
        f"--clock receive, and of a table: --scale time={printed(rate)}",
        value=rate,
    )
    return finding, replace(samples, time=samples.time * rate, qdd=samples.qdd / rate)


def _degrees(reason: str, prismatic: Mask, keys: Sequence[str] = ("q", "qd")) -> Mistake:
    """prismatic: (n,) joints, whose numbers are right."""
    unit = ",".join("1" if right else "deg" for right in prismatic) if prismatic.any() else "deg"
    scales = "; if velocities are recorded, also ".join(f"--scale {key}={unit}" for key in keys)
    which = " and ".join({"q": "positions", "qd": "velocities"}[key] for key in keys)
    remedy = f"convert {which} to rad{'/s' * (keys == ('qd',))}: give {scales}"
    return Mistake("degrees", "Degrees", reason, remedy, value=_DEGREE)


def _velocity(samples: Pieces, wrong: Mask, factor: float, text: str) -> Mistake:
    names = samples.named(wrong)
    whose = "" if wrong.all() else f" of {listed(names)}"
    return Mistake(
        "velocity",
        "Velocities that contradict positions",
        f"velocities{whose} contradict the slope of the positions: they are {text}",
        "record velocities in rad/s (prismatic: m/s)"
        + (f", or give --scale qd={printed(1 / factor):g}" if factor and wrong.all() else ""),
        () if wrong.all() else names,
        value=printed(factor),
    )


def _with_slopes(samples: Pieces, wrong: Mask) -> Pieces:
    """Velocities and accelerations of some joints from a cubic through the positions of each piece."""
    qd, qdd = samples.qd.copy(), samples.qdd.copy()
    for k, time in enumerate(samples.time):
        t = time - time.mean()
        span = max(float(np.ptp(t)), 1e-12)
        powers = np.vander(t / span, 4, increasing=True)
        _, b, c, d = np.linalg.lstsq(powers, samples.q[k], rcond=None)[0]
        slope = (b + 2 * c * powers[:, 1:2] + 3 * d * powers[:, 2:3]) / span
        qd[k] = np.where(wrong, slope, qd[k])
        qdd[k] = np.where(wrong, (2 * c + 6 * d * powers[:, 1:2]) / span**2, qdd[k])
    return replace(samples, qd=qd, qdd=qdd)


def beyond_limits(view: View) -> Mask:
    """(n,) joints that turn and are far beyond their limits, or beyond two turns without any."""
    greatest, stated = np.abs(view.motion[0]).max(axis=0), _stated_limits(view)
    limit = np.where(np.isfinite(stated), stated, TURNS)
    return np.asarray(~view.prismatic & (greatest > _BEYOND * limit))


def _stated_limits(view: View) -> Floats:
    """(n,) of positions; infinite where the description states none."""
    if view.arm.position_limits is None:
        return np.full(len(view.names), np.inf)
    stated = np.abs(view.arm.position_limits).max(axis=0)
    return np.where(stated > 0, stated, np.inf)


def rivals(view: View, _: Fitting) -> Iterator[Rival]:
    """Degrees, where positions are beyond limits; time that runs at another speed, by the efforts."""
    beyond = beyond_limits(view)
    if beyond.any():
        for which in {tuple(~view.prismatic), tuple(beyond)}:
            scale = np.where(which, 1 / _DEGREE, 1.0)
            q, qd, qdd = (scale * values for values in view.motion)
            names = view.samples.named(np.array(which))
            some = "" if which == tuple(~view.prismatic) else f" of {listed(names)}"
            finding = _degrees(
                f"positions{some} are beyond the joints' limits, or two turns where none is stated, and torques match "
                "if they are degrees",
                ~np.array(which),
            )
            yield view.rival("degrees", finding, base=view.arm.compared(q, qd, qdd), qd=qd)
    still = np.zeros_like(view.computed)
    if view.friction is not None:
        still = still + view.friction
    if not view.arm.compared_without_gravity:
        still = still + view.gravity
    columns = (view.computed - still,)
    yield view.rival("clock", _clock, base=still, columns=columns, low=1e-6, high=1e6)


def _clock(square: Floats, _: Floats) -> Mistake | None:
    rate = printed(np.sqrt(square[0]))
    if max(rate, 1 / rate) < _CLOCK:
        return None
    return Mistake(
        "clock",
        "A clock at the wrong speed",
        f"torques match if the motion is {rate:g} times as fast as time and velocities say",
        f"divide time by {rate:g}, and multiply velocities by it",
        value=rate,
        shared=np.array([rate**2]),
    )


def beyond_reach(view: View) -> tuple[Mistake, ...]:
    """Positions that are beyond limits in most joints, and torques that fit neither as rad nor as degrees."""
    bounded = ~view.prismatic & np.isfinite(_stated_limits(view))  # two turns are a guess
    beyond, turning = bounded & beyond_limits(view), view.informative & bounded
    if not turning.any() or beyond[turning].mean() < 0.5:
        return ()
    greatest = np.abs(view.motion[0]).max(axis=0)
    names = view.samples.named(beyond)
    reach = f"positions of {listed(names)} go to {listed([f'{g:.3g}' for g in greatest[beyond]])}, far beyond "
    motors = Mistake(
        "motor_side",
        "Positions of the motors",
        f"{reach}the joints' limits in rad: they may be those of the motors, before the gears",
        "divide positions and velocities by the gear ratios, and multiply efforts by them: --gears",
    )
    q, qd, qdd = (values / _DEGREE for values in view.motion)
    if beyond_limits(view.moving(q, qd, qdd)).any():
        return (motors,)
    degrees = _degrees(
        f"{reach}the joints' limits in rad: they may be degrees",
        view.prismatic,
    )
    return motors, degrees

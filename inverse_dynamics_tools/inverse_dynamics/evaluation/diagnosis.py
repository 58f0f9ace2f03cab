# SPDX-License-Identifier: Apache-2.0
"""Why computed torques don't match the measured ones: the mistake that, undone, leaves the least error.

    found = diagnose(samples, arm)          # one Diagnosis, or none
    print(found.text, found.mistake)

Every mistake of docs/why_dont_my_torques_match.md that changes torques is a hypothesis: the samples are put
right as if it had been made, torques are computed again, and the errors are compared. Friction and offset
are fitted to each joint in each case, friction with the sign that friction has, so that a model without
friction isn't taken for something else. A hypothesis is reported only if it halves the error at least, leaves a
small one, and does better than all others; where a model fits nothing is reported. Else what
torques alone show is looked for: saturation, coupled joints, drift.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.wording import listed

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats, Integers

PAGE = "docs/why_dont_my_torques_match.md"

_MISMATCH = 0.08  # error of a joint, as a share of its measured range, below which a model fits
_ROUNDING = 1e-9  # the same, of what is explained exactly
_GAIN = 2.0  # least ratio of errors that makes a hypothesis believable
_FITS = 0.12  # greatest error that it may leave
_WORSE = 1.5  # how much worse a single joint may fit because of it
_SAME_RATIO = 0.05  # of velocities, relative: no clock is wrong by 57.3
_PIECES, _PIECE = 60, 50  # of a recording: short contiguous pieces of all of it

Compute = Callable[["Floats", "Floats", "Floats"], "Floats"]


@dataclass(frozen=True)
class Samples:
    """Samples of a motion: pieces of M contiguous ones. (K, M) s; (K, M, n) rad, rad/s, rad/s^2, N m."""

    joints: tuple[str, ...]
    time: Floats
    q: Floats
    qd: Floats
    qdd: Floats
    measured: Floats

    def flat(self, values: Floats) -> Floats:
        """(K M, n)."""
        return values.reshape(-1, values.shape[-1])


@dataclass(frozen=True)
class ArmModel:
    """What computes torques (N, n) of motions; gravity: (N, n) of positions.

    mounted: computes them with gravity in another direction, (3,) m/s^2, in the root's axes; None: it can't.
    compared_without_gravity: whether measured torques are without gravity, and are compared so.
    """

    torques: Compute
    gravity: Callable[[Floats], Floats]
    gravity_direction: Floats | None = None  # (3,) m/s^2
    mounted: Callable[[Floats], Compute] | None = None
    loaded: Callable[[float, Floats], Compute] | None = (
        None  # with a mass [kg] at a place of the tip [m]
    )
    compared_without_gravity: bool = False
    has_friction: bool = False

    def compared(self, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """What measured torques are compared with."""
        torques = self.torques(q, qd, qdd)
        return torques - self.gravity(q) if self.compared_without_gravity else torques


@dataclass(frozen=True)
class Diagnosis:
    """A cause, and what to do about it.

    kind: currents, no_gravity, ceiling, wall, payload, tool, friction, order, effort_order, direction,
    effort_direction, degrees, clock, saturation, coupling, drift. mistake: the nearest heading of
    PAGE; "": none is near.
    """

    kind: str
    mistake: str
    reason: str
    remedy: str
    joints: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Reason, remedy and the place in the documentation."""
        return f"{self.reason}; {self.remedy}" + (f" ({self.reference})" if self.mistake else "")

    @property
    def reference(self) -> str:
        """The page and the place on it."""
        anchor = "".join(c for c in self.mistake.lower() if c.isalnum() or c in " -").replace(
            " ", "-"
        )
        return f"{PAGE}#{anchor}"


@dataclass(frozen=True)
class _Hypothesis:
    """Samples put right and torques computed for them: (N, n) each."""

    diagnosis: Diagnosis
    measured: Floats
    computed: Floats
    qd: Floats
    scaled: bool = False  # each joint's torque has a scale of its own


def rows_of_pieces(samples: int) -> Integers | None:
    """(K, M) rows of four or more pieces, spread over all samples; None: there are too few."""
    length = min(_PIECE, samples // 4)
    if length < 2:
        return None
    starts = np.linspace(0, samples - length, min(_PIECES, samples // length)).astype(np.int64)
    return starts[:, None] + np.arange(length)


def pieces_of(
    joints: Sequence[str],
    time: Floats,
    q: Floats,
    qd: Floats,
    qdd: Floats,
    measured: Floats,
) -> Samples | None:
    """Pieces of a recording of N samples, as rows_of_pieces() chooses them."""
    if (rows := rows_of_pieces(len(time))) is None:
        return None
    return Samples(tuple(joints), time[rows], q[rows], qd[rows], qdd[rows], measured[rows])


def diagnose(samples: Samples, model: ArmModel) -> Diagnosis | None:
    """The cause of a mismatch, if one is clear; None also where torques match."""
    q, qd, qdd, measured = (
        samples.flat(values) for values in (samples.q, samples.qd, samples.qdd, samples.measured)
    )
    if not all(np.isfinite(values).all() for values in (q, qd, qdd, measured)):
        return None
    span = _span(measured)
    computed = model.compared(q, qd, qdd)
    before = _errors(measured, computed, qd, span)
    load = None
    if before.max() > _MISMATCH:
        if clock := _clock(samples):
            return clock
        best = _best(_hypotheses(samples, model, computed), before, span)
        if best and best.kind not in ("payload", "tool"):
            return best
        load = best  # efforts that are cut off look like one, too
    if full := _saturation(samples.joints, measured, computed, qd, span):
        return full
    if load:
        return load
    return residual_cause(samples, computed) or _friction(model, measured, computed, before, span)


def residual_cause(samples: Samples, computed: Floats) -> Diagnosis | None:
    """What no model of an arm can have: saturation, coupled joints, drift. computed: (K M, n) N m."""
    measured, qd = samples.flat(samples.measured), samples.flat(samples.qd)
    span = _span(measured)
    return (
        _saturation(samples.joints, measured, computed, qd, span)
        or _coupling(samples.joints, measured, computed, qd, span)
        or _drift(samples, measured, computed, qd, span)
    )


def _span(measured: Floats) -> Floats:
    """Measured range of each joint; one that measures nothing counts a thousandth of the greatest."""
    span = np.ptp(measured, axis=0)
    return np.asarray(np.maximum(span, 1e-3 * max(float(span.max()), 1e-12)))


def _friction_columns(qd: Floats) -> Floats:
    """(N, 3) of a joint: viscous friction, a step, an offset."""
    width = 0.05 * float(np.sqrt(np.mean(qd**2))) or 1.0
    return np.column_stack([qd, np.tanh(qd / width), np.ones(len(qd))])


def _fit(columns: Floats, values: Floats, positive: Sequence[int]) -> Floats:
    """Least squares, some coefficients not negative: those that would be are left out."""
    active = list(range(columns.shape[1]))
    result = np.zeros(columns.shape[1])
    while active:
        found = np.linalg.lstsq(columns[:, active], values, rcond=None)[0]
        negative = [k for k, x in zip(active, found, strict=True) if k in positive and x < 0]
        if not negative:
            result[active] = found
            break
        active = [k for k in active if k not in negative]
    return result


def _residual(measured: Floats, computed: Floats, qd: Floats, more: Floats | None = None) -> Floats:
    """(N,) what is left of a joint beside friction and offset. more: other columns, of any sign."""
    columns = _friction_columns(qd)
    if more is not None:
        columns = np.column_stack([columns, more])
    error = measured - computed
    return error - columns @ _fit(columns, error, (0, 1))


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _errors(measured: Floats, computed: Floats, qd: Floats, span: Floats) -> Floats:
    """(n,) root mean square errors beside friction and offset, as shares of measured ranges."""
    return np.array(
        [
            _rms(_residual(measured[:, j], computed[:, j], qd[:, j])) / span[j]
            for j in range(measured.shape[1])
        ]
    )


def _scaled_errors(hypothesis: _Hypothesis, span: Floats) -> tuple[Floats, Floats]:
    """The same, where measured torques are a multiple of the computed ones; and those multiples."""
    errors, scales = [], []
    for j in range(hypothesis.measured.shape[1]):
        columns = np.column_stack(
            [_friction_columns(hypothesis.qd[:, j]), hypothesis.computed[:, j]]
        )
        x = _fit(columns, hypothesis.measured[:, j], (0, 1, 3))
        errors.append(_rms(hypothesis.measured[:, j] - columns @ x) / span[j])
        scales.append(x[3])
    return np.array(errors), np.array(scales)


def _best(hypotheses: Iterator[_Hypothesis], before: Floats, span: Floats) -> Diagnosis | None:
    """The hypothesis that explains most, if it is believable."""
    best, least = None, np.inf
    for hypothesis in hypotheses:
        if hypothesis.scaled:
            after, scales = _scaled_errors(hypothesis, span)
            if not _are_currents(scales, hypothesis.computed):
                continue
        else:
            after = _errors(
                hypothesis.measured, hypothesis.computed, hypothesis.qd, _span(hypothesis.measured)
            )
        if not np.isfinite(after).all():
            continue
        changed = np.abs(after - before) > 1e-3 * before + 1e-9
        if not changed.any():
            continue
        believable = (
            before[changed].mean() >= _GAIN * after[changed].mean()
            and after[changed].mean() <= _FITS
            and bool((after <= _WORSE * before + 0.02).all())
        )
        # one more free number for each joint is worth a little
        weight = 1.2 if hypothesis.scaled else 1.0
        if believable and weight * after.mean() < least:
            best, least = hypothesis.diagnosis, weight * after.mean()
    return best


def _are_currents(scales: Floats, computed: Floats) -> bool:
    """Whether measured values are a small part of torques, in every joint with a torque worth the name."""
    strong = np.ptp(computed, axis=0) > 0.05 * np.ptp(computed, axis=0).max()
    return bool((scales[strong] > 0.005).all() and (scales[strong] < 0.6).all())


def _hypotheses(samples: Samples, model: ArmModel, computed: Floats) -> Iterator[_Hypothesis]:
    q, qd, qdd, measured = (
        samples.flat(values) for values in (samples.q, samples.qd, samples.qdd, samples.measured)
    )
    names = samples.joints
    yield _Hypothesis(_CURRENTS, measured, computed, qd, scaled=True)
    if not model.compared_without_gravity:
        yield _Hypothesis(_NO_GRAVITY, measured, computed - model.gravity(q), qd)
    if np.abs(q).max() > 4 * np.pi:
        radians = (np.radians(values) for values in (q, qd, qdd))
        yield _Hypothesis(_DEGREES, measured, model.compared(*radians), np.radians(qd))
    yield from _mounts(model, q, qd, qdd, measured)
    yield from _directions(names, model, q, qd, qdd, measured, computed)
    yield from _orders(names, model, q, qd, qdd, measured, computed)
    yield from _loads(names, model, q, qd, qdd, measured, computed)


_CURRENTS = Diagnosis(
    "currents",
    "Efforts are motor currents",
    "measured efforts have the shape of the torques at another scale in every joint: they may be motor currents",
    "give --effort-is current, and drive_gains unless the solver knows them",
)
_NO_GRAVITY = Diagnosis(
    "no_gravity",
    "Gravity is subtracted from the efforts",
    "the error is the gravity torque: the robot's driver subtracts it from its efforts",
    "give --effort-is torque_without_gravity",
)
_DEGREES = Diagnosis(
    "degrees",
    "Degrees",
    "positions go beyond two turns, and torques match if they are degrees",
    "convert positions and velocities to rad",
)


def _mounts(
    model: ArmModel, q: Floats, qd: Floats, qdd: Floats, measured: Floats
) -> Iterator[_Hypothesis]:
    if model.mounted is None or model.gravity_direction is None:
        return
    own = model.gravity_direction
    size = float(np.linalg.norm(own))
    for axis in range(3) if size else ():
        for sign in (1.0, -1.0):
            direction = np.zeros(3)
            direction[axis] = sign * size
            if np.linalg.norm(direction - own) < 0.1 * size:
                continue
            ceiling = np.linalg.norm(direction + own) < 0.1 * size
            option = ",".join(f"{x:g}" for x in direction)
            diagnosis = Diagnosis(
                "ceiling" if ceiling else "wall",
                "The robot hangs from the ceiling" if ceiling else "The robot hangs on a wall",
                f"torques match if gravity acts along {option} m/s² in the frame of the root link",
                f"give --gravity {option}, or `gravity:` in the run configuration",
            )
            compared = replace(model, torques=model.mounted(direction)).compared
            yield _Hypothesis(diagnosis, measured, compared(q, qd, qdd), qd)


def _directions(
    names: Sequence[str],
    model: ArmModel,
    q: Floats,
    qd: Floats,
    qdd: Floats,
    measured: Floats,
    computed: Floats,
) -> Iterator[_Hypothesis]:
    for j, name in enumerate(names):
        sign = np.ones(len(names))
        sign[j] = -1.0
        for kind, what in (
            ("effort_direction", "effort is"),
            ("direction", "position, velocity and effort are"),
        ):
            diagnosis = Diagnosis(
                kind,
                "A joint is reversed",
                f"joint {name}: torques match if its {what} reversed",
                "change the sign where the recording is made"
                + (", or the <axis> in the description" if kind == "direction" else ""),
                (name,),
            )
            if kind == "effort_direction":
                yield _Hypothesis(diagnosis, sign * measured, computed, qd)
            else:
                again = model.compared(sign * q, sign * qd, sign * qdd)
                yield _Hypothesis(diagnosis, sign * measured, again, sign * qd)


def _orders(
    names: Sequence[str],
    model: ArmModel,
    q: Floats,
    qd: Floats,
    qdd: Floats,
    measured: Floats,
    computed: Floats,
) -> Iterator[_Hypothesis]:
    for i, j in combinations(range(len(names)), 2):
        order = list(range(len(names)))
        order[i], order[j] = j, i
        pair = (names[i], names[j])
        swapped = Diagnosis(
            "order",
            "Joints in another order",
            f"torques match if joints {pair[0]} and {pair[1]} have each other's columns",
            "give the recording's names in the order of the chain: --joints, or `joints:`",
            pair,
        )
        efforts = replace(
            swapped,
            kind="effort_order",
            reason=f"torques match if joints {pair[0]} and {pair[1]} have each other's efforts",
            remedy="correct this where the recording is made: positions are in order, efforts aren't",
        )
        moved = [values[:, order] for values in (q, qd, qdd)]
        yield _Hypothesis(swapped, measured[:, order], model.compared(*moved), moved[1])
        yield _Hypothesis(efforts, measured[:, order], computed, qd)


def _loads(
    names: Sequence[str],
    model: ArmModel,
    q: Floats,
    qd: Floats,
    qdd: Floats,
    measured: Floats,
    computed: Floats,
) -> Iterator[_Hypothesis]:
    """A body at the tip: its mass and center are fitted, to all joints together."""
    if model.loaded is None or model.compared_without_gravity:
        return
    reach = 0.1  # m: torques are linear in mass and first moment, but for a small moment of inertia
    unloaded = model.torques(q, qd, qdd)
    at_tip = model.loaded(1.0, np.zeros(3))(q, qd, qdd) - unloaded
    parts = [at_tip]
    for axis in range(3):
        place = np.zeros(3)
        place[axis] = reach
        moved = model.loaded(1.0, place)(q, qd, qdd) - unloaded
        parts.append((moved - at_tip) / reach)
    body = _fitted_body(np.array(parts), measured - computed, qd, _span(measured))
    if body is None:
        return
    mass, first_moment = body[0], body[1:]
    center = first_moment / mass
    load = np.tensordot(body, np.array(parts), axes=1)
    beside = float(np.abs(load[:, -1]).max()) > 0.02 * float(np.abs(load).max())
    where = ",".join(f"{round(float(x), 3) + 0.0:g}" for x in center)
    yield _Hypothesis(
        Diagnosis(
            "tool" if beside else "payload",
            "A tool the description lacks, and the tip" if beside else "A payload",
            f"torques match if the tip carries about {mass:.2g} kg at {where} m",
            f"give --payload {mass:.2g},{where}, or the load's link in the description",
        ),
        measured,
        computed + load,
        qd,
    )


def _fitted_body(parts: Floats, error: Floats, qd: Floats, span: Floats) -> Floats | None:
    """Mass and first moment (4,) that explain most of the errors beside friction; None: no body does."""
    rows, right = [], []
    for j in range(error.shape[1]):
        friction = _friction_columns(qd[:, j])
        basis = np.linalg.qr(friction)[0]
        columns = parts[:, :, j].T
        rows.append((columns - basis @ (basis.T @ columns)) / span[j])
        right.append((error[:, j] - basis @ (basis.T @ error[:, j])) / span[j])
    body = np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)[0]
    if body[0] < 0.05 or np.linalg.norm(body[1:]) > 1.0 * body[0]:
        return None
    return np.asarray(body)


def _clock(samples: Samples) -> Diagnosis | None:
    """Whether positions and velocities contradict each other by a factor."""
    step = np.diff(samples.time, axis=1)
    if not (step > 0).any():
        return None
    fresh = step > 0
    slope = np.diff(samples.q, axis=1)[fresh] / step[fresh][:, None]
    mean = (0.5 * (samples.qd[:, 1:] + samples.qd[:, :-1]))[fresh]
    power = (mean**2).sum(axis=0)
    if not (power > 0).all():
        return None
    factor = (mean * slope).sum(axis=0) / power
    left = ((slope - factor * mean) ** 2).sum(axis=0) / np.maximum((slope**2).sum(axis=0), 1e-300)
    middle = float(np.median(factor))
    agree = bool((np.abs(factor - middle) < 0.05 * abs(middle)).all() and (left < 0.1).all())
    if not agree or middle <= 0 or abs(np.log(middle)) < np.log(1.1):
        return None
    for ratio, degrees, radians in (
        (np.degrees(1), "positions", "velocities"),
        (np.radians(1), "velocities", "positions"),
    ):
        if abs(np.log(middle / ratio)) < _SAME_RATIO:
            return Diagnosis(
                "degrees",
                "Degrees",
                f"positions change {middle:.3g} times as fast as velocities say, in every joint: {degrees} are in "
                f"degrees, {radians} in rad",
                f"convert {degrees} to rad" + ("/s" if degrees == "velocities" else ""),
            )
    return Diagnosis(
        "clock",
        "A clock at the wrong speed",
        f"positions change {middle:.3g} times as fast as velocities say, in every joint",
        "give --clock receive, or record again with a clock that runs right",
    )


def _saturation(
    names: Sequence[str], measured: Floats, computed: Floats, qd: Floats, span: Floats
) -> Diagnosis | None:
    """Efforts that stay at their greatest value while the model asks for more."""
    found = []
    for j, name in enumerate(names):
        for sign in (1.0, -1.0):
            effort = sign * measured[:, j]
            limit = effort.max()
            flat = effort > limit - 2e-3 * span[j]
            speed = np.abs(qd[:, j])
            resting = speed[flat].mean() < 0.05 * speed.max()
            if limit <= 0 or resting or not 0.02 <= flat.mean() <= 0.9:
                continue
            columns, error = _friction_columns(qd[:, j]), measured[:, j] - computed[:, j]
            missing = -sign * (error - columns @ _fit(columns[~flat], error[~flat], (0, 1)))
            if missing[flat].mean() > max(2 * _rms(missing[~flat]), 0.03 * span[j]):
                found.append((name, limit * sign, flat.mean()))
    if not found:
        return None
    joints = tuple(dict.fromkeys(name for name, _, _ in found))
    name, limit, share = found[0]
    return Diagnosis(
        "saturation",
        "",
        f"joint {name}: efforts stay at {limit:.4g} in {100 * share:.0f} % of the samples while the model "
        "asks for more: the drive or the sensor is at its limit",
        "record a slower motion, or one with less load",
        joints,
    )


def _coupling(
    names: Sequence[str], measured: Floats, computed: Floats, qd: Floats, span: Floats
) -> Diagnosis | None:
    """A joint whose effort has the friction of another joint in it: a gear between the two.

    Torques of other joints alone prove nothing: a wrong mass gives them too.
    """
    before = _errors(measured, computed, qd, span)
    best, least = None, 0.5
    for j in map(int, np.flatnonzero(before > _MISMATCH)):
        masses = _rms(_residual(measured[:, j], computed[:, j], qd[:, j], computed)) / span[j]
        if masses <= _ROUNDING:
            continue
        for k in (k for k in range(len(names)) if k != j):
            friction = _friction_columns(qd[:, k])[:, :2]
            more = np.column_stack([computed, friction])
            after = _rms(_residual(measured[:, j], computed[:, j], qd[:, j], more)) / span[j]
            if after < least * masses and after < _FITS:
                best, least = (j, k), after / masses
    if best is None:
        return None
    pair = (names[best[0]], names[best[1]])
    return Diagnosis(
        "coupling",
        "",
        f"joint {pair[0]}: its effort has friction of joint {pair[1]} in it: a gear couples the two",
        "convert efforts and positions of the motors to those of the joints where the recording is made",
        pair,
    )


def _drift(
    samples: Samples, measured: Floats, computed: Floats, qd: Floats, span: Floats
) -> Diagnosis | None:
    """Friction or offset that changes along the recording.

    What wrong masses give of gravity may change with time too, where the motion is slow.
    """
    time = samples.time.reshape(-1)
    if np.ptp(time) < 15.0:
        return None
    share = (time - time.mean()) / np.ptp(time)
    found = []
    for j, name in enumerate(samples.joints):
        plain = _residual(measured[:, j], computed[:, j], qd[:, j])
        more = share[:, None] * _friction_columns(qd[:, j])
        drifting = _rms(_residual(measured[:, j], computed[:, j], qd[:, j], more))
        otherwise = _rms(_residual(measured[:, j], computed[:, j], qd[:, j], computed))
        if _rms(plain) > 0.03 * span[j] and drifting < min(0.6 * _rms(plain), otherwise):
            found.append(name)
    if not found:
        return None
    return Diagnosis(
        "drift",
        "Friction",
        f"friction or offset of {listed(found)} changes along the recording, as it does while gears warm up",
        "move the robot for half an hour before recording, or leave out the beginning with --from",
        tuple(found),
    )


def _friction(
    model: ArmModel, measured: Floats, computed: Floats, before: Floats, span: Floats
) -> Diagnosis | None:
    """A model without friction, and errors that are little else."""
    raw = np.sqrt(((measured - computed) ** 2).mean(axis=0)) / span
    if model.has_friction or raw.mean() < _MISMATCH or raw.mean() < _GAIN * before.mean():
        return None
    return Diagnosis(
        "friction",
        "Friction",
        "the error is mostly friction and offset, which the model lacks",
        "take a model with friction, or make one: ids identify RECORDING --robot NAME --out arm.yaml, or "
        "with --urdf FILE instead of --robot NAME",
    )

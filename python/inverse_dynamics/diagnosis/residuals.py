# SPDX-License-Identifier: Apache-2.0
"""Causes outside a model of rigid bodies: friction, a guiding hand, efforts at a limit, coupled joints, drift."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis.rival import Mistake, Rival, printed
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.diagnosis.fit import Fitting
    from inverse_dynamics.diagnosis.pieces import View

_FLAT = 2e-3  # of a joint's range: efforts within it of the greatest one are at the limit
_SHARE = (0.02, 0.9)  # of the samples, at a limit
_PILE = 5.0  # times as many efforts at a limit as in the bands beside it
_CUT = 0.5  # part of the torque beyond the limit that is missing
_LONG = 15.0  # s: in less, friction that changes is nothing but wrong
_LEAVES = 0.6  # most of a joint's error that its cause may leave
_CLEARER = 1.5  # least ratio of the errors that wrong masses leave to those that drift leaves
_NOTICED = 0.03  # least error of a joint that is looked at, as a share of its range
_MOSTLY = 0.5  # of the mean square error: what friction must explain
_LACKS = 0.5  # most of the model's friction that an arm without it has


FRICTION = Mistake(
    "friction",
    "Friction",
    "the error is mostly friction and offset, which the model lacks",
    "take a model with friction, or make one: ids identify RECORDING --robot NAME --out arm.yaml, or "
    "with --urdf FILE instead of --robot NAME",
)
_NO_FRICTION = replace(
    FRICTION,
    reason="the error is mostly the model's friction, which the efforts lack",
    remedy="give --no-friction: a simulated arm may have none, and some controllers compensate it",
)
_GUIDED = Mistake(
    "guided",
    "Somebody guides the arm",
    "measured minus computed torques are against the motion in every joint: somebody guides the arm by hand",
    "record a motion in which nobody touches the arm",
    gain=1.3,  # hands don't push evenly
)


def rivals(view: View, fitting: Fitting) -> Iterator[Rival]:
    """Torques that act with the motion in all joints, as friction of the wrong sign would; limits."""
    yield view.rival("guided", _GUIDED, qd=-view.qd)
    yield from limits(view, fitting)


def limits(view: View, fitting: Fitting) -> Iterator[Rival]:
    """Efforts that stay at their greatest value while the model, with friction, needs more."""
    at_limit, _ = _at_limit(view, fitting)
    if at_limit.any():
        yield _limited(view, at_limit)


def _at_limit(view: View, fitting: Fitting) -> tuple[Mask, Mask]:
    """(N, n) efforts at a limit, and (n,) the joints in which they show it by themselves."""
    measured = view.samples.flat(view.samples.measured)
    flat = {sign: _flat(view, fitting, sign * measured) for sign in (1.0, -1.0)}
    wanted = view.computed + fitting.friction_of(_limited(view, flat[1.0] | flat[-1.0]))
    at_limit, shown = np.zeros_like(flat[1.0]), np.zeros(measured.shape[1], bool)
    for sign, mask in flat.items():
        beyond = (mask * sign * (wanted - measured)).sum(axis=0) / np.maximum(mask.sum(axis=0), 1)
        piled = _piled(view, fitting, sign, mask)
        at_limit |= mask & (piled | (beyond > _NOTICED * fitting.size))
        shown |= piled
    return at_limit, shown


def _flat(view: View, fitting: Fitting, effort: Floats) -> Mask:
    """(N, n) efforts at their greatest value, of joints that move while they are."""
    limit, speed = effort.max(axis=0), np.abs(view.qd)
    flat = effort > limit - _band(view, fitting)
    share = flat.mean(axis=0)
    moving = (flat * speed).sum(axis=0) >= 0.05 * speed.max(axis=0) * flat.sum(axis=0)
    fits = (limit > 0) & moving & (share >= _SHARE[0]) & (share <= _SHARE[1])
    return np.asarray(flat & fits)


def _piled(view: View, fitting: Fitting, sign: float, flat: Mask) -> Mask:
    """(n,) joints whose efforts pile up at the limit as those of no motion do, while computed torques change.

    Near the greatest value of a sine are as many values as in the three bands of that width beside it.
    """
    effort, band = sign * view.samples.flat(view.samples.measured), _band(view, fitting)
    beside = (effort > effort.max(axis=0) - 4 * band) & ~flat
    changes = np.std(view.computed, axis=0, where=flat | ~flat.any(axis=0))
    return np.asarray((flat.mean(axis=0) > _PILE * beside.mean(axis=0)) & (changes > 2 * band))


def _band(view: View, fitting: Fitting) -> Floats:
    """(n,) efforts within it of the greatest one are at the limit: at least a step of those that are rounded."""
    steps = np.abs(np.diff(view.samples.measured, axis=1))
    step = np.where(steps > 0, steps, np.inf).min(axis=(0, 1))
    band = np.clip(2 * fitting.noise, _FLAT, 10 * _FLAT) * fitting.size
    return np.asarray(np.maximum(band, np.where(np.isfinite(step), step, 0.0)))


def _limited(view: View, at_limit: Mask) -> Rival:
    """Efforts lack the torque beyond a limit; at a limit friction doesn't show, so the fit's is removed."""
    missing = view.samples.flat(view.samples.measured) - view.computed
    columns = (missing, view.qd, np.sign(view.qd), np.ones_like(missing))
    free = [[np.inf]] * 3
    return view.rival(
        "saturation",
        partial(_saturated, view, at_limit),
        own=tuple(at_limit * column for column in columns),
        own_low=-np.array([[0.0], *free]),
        own_high=np.array([[1.0], *free]),
    )


def _saturated(view: View, at_limit: Mask, _: Floats, own: Floats) -> Mistake | None:
    found = at_limit.any(axis=0) & (own[0] > _CUT)
    if not found.any():
        return None
    j = int(np.argmax(found))
    limit = view.samples.flat(view.samples.measured)[at_limit[:, j], j]
    return Mistake(
        "saturation",
        "",
        f"joint {view.names[j]}: efforts stay at {limit[np.argmax(np.abs(limit))]:.4g} in "
        f"{100 * at_limit[:, j].mean():.0f} % of the samples while the model asks for more: the drive or the sensor is "
        "at its limit",
        "record a slower motion, or one with less load",
        view.samples.named(found),
        own=np.where(found, own, 0.0),
    )


def couplings(view: View) -> Iterator[Rival]:
    """A joint whose effort has that of another motor in it, friction included."""
    measured = view.samples.flat(view.samples.measured)
    for j in map(int, np.flatnonzero(view.informative)):
        for k in (k for k in range(len(view.names)) if k != j):
            column = np.zeros_like(measured)
            column[:, j] = measured[:, k]
            words = partial(_coupled, (view.names[j], view.names[k]))
            yield view.rival("coupling", words, columns=(column,))


def _coupled(pair: tuple[str, str], ratio: Floats, _: Floats) -> Mistake:
    value = printed(ratio[0], 2)
    return Mistake(
        "coupling",
        "",
        f"joint {pair[0]}: its effort has {value:g} times that of joint {pair[1]} in it: a gear couples the two",
        "convert efforts and positions of the motors to those of the joints where the recording is made",
        pair,
        value=value,
        shared=np.array([value]),
    )


def friction(view: View, fitting: Fitting, after: float) -> Mistake | None:
    """Friction that the model lacks, or has and the arm doesn't. after: the error that fitted friction leaves."""
    error = view.samples.flat(view.samples.measured) - view.computed
    error = (error - error.mean(axis=0)) / fitting.size  # an offset isn't friction
    before = float(fitting.mean((error**2).reshape(fitting.shape).mean(axis=1)))
    if before < _NOTICED or after**2 > (1 - _MOSTLY) * before**2:
        return None
    if view.friction is None:
        return FRICTION
    own = view.friction / fitting.size
    real = own + fitting.friction_of(view.rival("friction")) / fitting.size
    own, real = own - own.mean(axis=0), real - real.mean(axis=0)
    return _NO_FRICTION if (own * real).sum() < _LACKS * (own**2).sum() else None


def of_joints(view: View, fitting: Fitting, plain: Floats) -> Mistake | None:
    """A limit of efforts, or friction that drifts, in a joint that others outvote.

    plain: (K, n) squares with friction alone.
    """
    at_limit, shown = _at_limit(view, fitting)
    if at_limit.any():
        rival = _limited(view, at_limit)
        found = shown | _better(fitting, plain, fitting.errors(rival), _NOTICED / 2)
        numbers = np.where(found, fitting.numbers(rival)[1], 0.0)
        if finding := rival.finding(np.zeros(0), numbers):
            return finding
    return _drift(view, fitting, plain)


def _better(fitting: Fitting, plain: Floats, squares: Floats, noticed: float) -> Mask:
    """(n,) joints whose errors are noticed, and are much smaller with a cause."""
    before, after = (
        np.sqrt(np.maximum(s.mean(axis=0) - fitting.noise**2, 0.0)) for s in (plain, squares)
    )
    return np.asarray((before > noticed) & (after < _LEAVES * before))


def _drift(view: View, fitting: Fitting, plain: Floats) -> Mistake | None:
    """Friction or offset that changes along the recording.

    Gravity of wrong masses may change with time too, where the motion is slow.
    """
    time = view.samples.time.reshape(-1, 1)
    if np.ptp(time) < _LONG:
        return None
    share, base = (time - time.mean()) / np.ptp(time), view.computed
    parts = [share * c for c in (view.qd, np.sign(view.qd), np.ones_like(view.qd))]
    others = [np.tile(base[:, k : k + 1], (1, base.shape[1])) for k in range(base.shape[1])]
    drifting, masses = (fitting.errors(view.rival("", own=tuple(own))) for own in (parts, others))
    clearer = _CLEARER**2 * drifting.mean(axis=0) < masses.mean(axis=0)
    names = view.samples.named(_better(fitting, plain, drifting, _NOTICED) & clearer)
    if not names:
        return None
    return Mistake(
        "drift",
        "Friction",
        f"friction or offset of {listed(names)} changes along the recording, as it does while gears warm up",
        "move the robot for half an hour before recording, or leave out the beginning with --from",
        names,
    )

# SPDX-License-Identifier: Apache-2.0
"""Efforts of another sign, unit or meaning than torques: the motion is right."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.wording import listed
from inverse_dynamics.evaluation.causes.rival import Rival, Told, printed

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats, Mask
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting

_SAME = 1.15  # ratio of scales that masses which a maker has rounded may give
_NAMED = 0.06  # relative distance from a unit's scale that they may give
_CURRENTS = (0.002, 1.0)  # A per N m behind the gears of arms
_TOO_SMALL = 0.3  # of the torques: more than what is ever wrong with masses
_HEAVY = 0.2  # of the greatest torque
_UNITS = {  # per N m
    1000.0: "N mm",
    100.0: "N cm",
    10.1972: "kgf cm",
    0.101972: "kgf m",
    8.85075: "lbf in",
    0.737562: "lbf ft",
    141.612: "ozf in",
    0.001: "kN m",
}
_SHARES = {1.0: "shares", 100.0: "per cent", 1000.0: "per mille"}


def rivals(view: View, fitting: Fitting) -> Iterator[Rival]:
    """Signs, a common scale, a scale of each joint, and gravity taken off."""
    yield from _signs(view, fitting)
    yield common(view)
    none, zero = np.zeros_like(view.computed), np.zeros(len(view.names))
    yield Rival(
        "scales",
        none,
        view.qd,
        lambda _, own: _each(view, own[0]),
        own=(view.computed,),
        own_low=(zero,),
        own_high=(zero + np.inf,),
        includes=("effort_scale",),
    )
    sign = 1.0 if view.arm.compared_without_gravity else -1.0
    yield Rival(
        "no_gravity", view.computed + sign * view.gravity, view.qd, lambda *_: _no_gravity(sign)
    )


def _no_gravity(sign: float) -> Told:
    meaning = "torque" if sign > 0 else "torque_without_gravity"
    return Told(
        "no_gravity",
        "Gravity is subtracted from the efforts",
        "the error is the gravity torque: "
        + (
            "efforts include it" if sign > 0 else "the robot's driver subtracts it from its efforts"
        ),
        f"give --effort-is {meaning}",
    )


def _signs(view: View, fitting: Fitting) -> Iterator[Rival]:
    """All efforts reversed, or those of the joints that fit better so."""
    as_is, turned = Rival("", view.computed, view.qd), Rival("", -view.computed, -view.qd)
    errors = [np.sqrt(fitting.errors(rival).mean(axis=0)) for rival in (as_is, turned)]
    decided = view.informative & (np.abs(np.log(errors[1] / errors[0])) > np.log(_SAME))
    flipped = decided & (errors[1] < errors[0])
    if flipped.any():
        everything = bool((flipped == decided).all()) and (flipped.sum() > 1 or len(flipped) == 1)
        yield _turned(view, flipped, everything=everything)


def each_reversed(view: View) -> Iterator[Rival]:
    """The efforts of one joint, and those of all."""
    for j in map(int, np.flatnonzero(view.informative)):
        yield _turned(view, np.arange(len(view.names)) == j, everything=False)
    yield _turned(view, view.informative, everything=True)


def _turned(view: View, flipped: Mask, *, everything: bool) -> Rival:
    sign = np.where(flipped | everything, -1.0, 1.0)
    names = () if everything else view.samples.named(flipped)
    whose = listed(names) + (" are" if len(names) > 1 else " is")
    told = Told(
        "effort_sign" if everything else "effort_direction",
        "A joint is reversed",
        "torques match if the efforts of all joints are reversed"
        if everything
        else f"torques match if the effort of {whose} reversed",
        "change the sign of "
        + ("all efforts" if everything else "this effort" if len(names) == 1 else "these efforts")
        + " where the recording is made",
        names,
        value=-1.0,
    )
    return Rival(
        told.kind,
        sign * view.computed,
        sign * view.qd,
        lambda *_: told,
        effort=lambda computed: sign * computed,
    )


def common(view: View) -> Rival:
    """One scale of all efforts."""
    return Rival(
        "effort_scale",
        np.zeros_like(view.computed),
        view.qd,
        lambda shared, _: _common(shared[0]),
        columns=(view.computed,),
        low=(0.0,),
        high=(np.inf,),
    )


def _common(scale: float) -> Told | None:
    if scale <= 0 or abs(np.log(scale)) < np.log(_SAME):
        return None
    unit, scale = _unit(scale)
    return Told(
        "effort_scale",
        "Efforts in another unit",
        f"efforts are {scale:.4g} times the torques in every joint"
        + (f": they are in {unit}" if unit else ""),
        f"divide efforts by {scale:.4g} where the recording is made",
        value=scale,
        shared=np.array([scale]),
    )


def too_small(view: View) -> tuple[Told, ...]:
    """Efforts that are far smaller than torques wherever those are large, whatever their shape."""
    measured = np.quantile(np.abs(view.samples.flat(view.samples.measured)), 0.95, axis=0)
    torque = np.quantile(np.abs(view.computed), 0.95, axis=0)
    heavy = torque > _HEAVY * torque.max()
    share = measured[heavy] / torque[heavy]
    if heavy.sum() < 2 or not 0 < np.max(share) <= _TOO_SMALL or view.arm.compared_without_gravity:
        return ()
    reason = (
        f"efforts are {1 / np.max(share):.2g} to {1 / np.maximum(np.min(share), 1e-6):.2g} times smaller than torques "
        "where those are large: "
    )
    currents = Told(
        "currents",
        "Efforts are motor currents",
        f"{reason}they may be motor currents",
        "give --effort-is current, and drive_gains unless the solver knows them",
    )
    no_gravity = _no_gravity(-1.0)
    moving = np.quantile(np.abs(view.computed - view.gravity), 0.95, axis=0)
    if (measured < _TOO_SMALL * moving)[heavy].any():
        return (currents,)
    return currents, replace(no_gravity, reason=f"{reason}the robot's driver may subtract gravity")


def _unit(scale: float) -> tuple[str, float]:
    """The unit of a scale and its exact value, or "" and the scale as printed."""
    for exact, unit in _UNITS.items():
        if abs(scale / exact - 1) < _NAMED:
            return unit, exact
    return "", printed(scale)


def _each(view: View, scales: Floats) -> Told | None:
    """Scales of their own: of currents, of limits, of a unit of the joints that turn."""
    tell = view.informative
    if not (scales[tell] > 0).all():
        return None
    off = tell & (np.abs(np.log(np.maximum(scales, 1e-12))) > np.log(1.5))
    if not off.any():
        return None
    rounded = np.array([printed(s) for s in scales])
    limits = view.arm.effort_limits
    if limits is not None and np.isfinite(limits[tell]).all():
        shares = scales * limits
        for exact, what in _SHARES.items():
            if (np.abs(shares[tell] / exact - 1) < 2 * _NAMED).all():
                own = np.where(np.isfinite(limits), exact / limits, rounded)
                return _scales(view, tell, own, f"{what} of the effort limits")
    if ((scales[tell] > _CURRENTS[0]) & (scales[tell] < _CURRENTS[1])).all():
        return _currents(rounded, tell)
    turning = tell & ~view.prismatic
    if view.prismatic.any() and turning.any():
        unit, exact = _unit(float(np.median(scales[turning])))
        if unit and (np.abs(scales[turning] / exact - 1) < _NAMED).all():
            own = np.where(view.prismatic, rounded, exact)
            return _scales(view, off, own, f"in {unit}")
    milli = scales[tell] / 1000
    in_ma = bool(((milli > _CURRENTS[0]) & (milli < _CURRENTS[1])).all())
    return _scales(view, off, rounded, "motor currents in mA" if in_ma else "")


def _currents(scales: Floats, tell: Mask) -> Told:
    return Told(
        "currents",
        "Efforts are motor currents",
        "measured efforts have the shape of the torques at another scale in every joint "
        f"({listed([f'{s:.3g}' for s in scales[tell]])}): they may be motor currents",
        "give --effort-is current, and drive_gains unless the solver knows them",
        value=[float(s) for s in scales],
        own=scales[None],
    )


def _scales(view: View, off: Mask, scales: Floats, what: str) -> Told:
    names = view.samples.named(off)
    numbers = listed([f"{s:.4g}" for s in scales[off]])
    return Told(
        "effort_scale",
        "Efforts in another unit",
        f"efforts of {listed(names)} are {numbers} times the torques"
        + (f": they are {what}" if what else ""),
        f"divide them by {numbers} where the recording is made",
        () if off[view.informative].all() else names,
        value=[float(s) for s in scales],
        own=scales[None],
    )

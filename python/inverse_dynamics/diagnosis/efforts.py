# SPDX-License-Identifier: Apache-2.0
"""Efforts of another sign, unit or meaning than torques, and columns that belong to other joints or are reversed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis.rival import Mistake, Rival, printed
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.diagnosis.fit import Fitting
    from inverse_dynamics.diagnosis.pieces import View

_SAME = 1.15  # ratio of scales that masses which a maker has rounded may give
_NAMED = 0.06  # relative distance from a unit's scale that they may give
_CURRENTS = (0.002, 0.5)  # A per N m behind the gears of arms
_ALIKE = 12.0  # ratio of the greatest to the least gain of an arm's motors
_TOO_SMALL = 0.3  # of the torques: more than what is ever wrong with masses
_HEAVY = 0.2  # of the greatest torque
_FOLLOWS = 0.5  # correlation of efforts with torques that they may be a share of
_UNRELATED = 0.4  # correlation with any joint's torque up to which efforts are something else
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
_CURRENT = Mistake(
    "currents",
    "Efforts are motor currents",
    "",
    "give --effort-is current, and drive_gains unless the solver knows them",
)


def rivals(view: View, fitting: Fitting) -> Iterator[Rival]:
    """Signs, a common scale, a scale of each joint, and gravity taken off."""
    yield from _signs(view, fitting)
    yield common(view)
    nothing, own = np.zeros_like(view.computed), (view.computed,)
    words, includes = partial(_each, view), ("effort_scale",)
    yield view.rival("scales", words, base=nothing, own=own, own_low=0.0, includes=includes)
    sign = 1.0 if view.arm.compared_without_gravity else -1.0
    yield view.rival("no_gravity", _no_gravity(sign), base=view.computed + sign * view.gravity)


def _no_gravity(sign: float) -> Mistake:
    why = "efforts include it" if sign > 0 else "the robot's driver subtracts it from its efforts"
    return Mistake(
        "no_gravity",
        "Gravity is subtracted from the efforts",
        f"the error is the gravity torque: {why}",
        f"give --effort-is {'torque' if sign > 0 else 'torque_without_gravity'}",
    )


def _signs(view: View, fitting: Fitting) -> Iterator[Rival]:
    """All efforts reversed, or those of the joints that fit better so."""
    both = [view.rival("", base=sign * view.computed, qd=sign * view.qd) for sign in (1.0, -1.0)]
    errors = [np.sqrt(fitting.errors(rival).mean(axis=0)) for rival in both]
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
    if everything:
        whose, which = "efforts of all joints are", "all efforts"
    elif len(names) == 1:
        whose, which = f"effort of {names[0]} is", "this effort"
    else:
        whose, which = f"effort of {listed(names)} are", "these efforts"
    finding = Mistake(
        "effort_sign" if everything else "effort_direction",
        "A joint is reversed",
        f"torques match if the {whose} reversed",
        f"change the sign of {which} where the recording is made"
        + ("; of a table: --scale effort=-1" if everything else ""),
        names,
        value=-1.0,
    )
    base, qd = sign * view.computed, sign * view.qd
    return view.rival(
        finding.kind, finding, base=base, qd=qd, effort=lambda computed: sign * computed
    )


def common(view: View) -> Rival:
    """One scale of all efforts."""
    nothing, columns = np.zeros_like(view.computed), (view.computed,)
    return view.rival("effort_scale", _common, base=nothing, columns=columns, low=0.0)


def _common(shared: Floats, _: Floats) -> Mistake | None:
    scale = float(shared[0])
    if scale <= 0 or abs(np.log(scale)) < np.log(_SAME):
        return None
    unit, scale = _unit(scale)
    return Mistake(
        "effort_scale",
        "Efforts in another unit",
        f"efforts are {scale:.4g} times the torques in every joint"
        + (f": they are in {unit}" if unit else ""),
        f"divide efforts by {scale:.4g} where the recording is made; of a table: --scale "
        f"effort={1 / scale:.4g}",
        value=scale,
        shared=np.array([scale]),
    )


def unlike(view: View) -> tuple[Mistake, ...]:
    """Efforts that are far smaller than torques where those are large, and efforts that don't follow torques."""
    efforts = view.samples.flat(view.samples.measured)
    measured = np.quantile(np.abs(efforts), 0.95, axis=0)
    torque = np.quantile(np.abs(view.computed), 0.95, axis=0)
    heavy = torque > _HEAVY * torque.max()
    if heavy.sum() < 2:
        return ()
    moving = view.computed - view.gravity
    related = max(np.abs(_correlations(efforts, of)[heavy]).max() for of in (view.computed, moving))
    if related < _UNRELATED:
        return (_unrelated(view, heavy, float(related)),)
    share = measured[heavy] / torque[heavy]
    if not 0 < np.max(share) <= _TOO_SMALL or view.arm.compared_without_gravity:
        return ()
    least, most = 1 / np.max(share), 1 / np.maximum(np.min(share), 1e-6)
    factors = f"{printed(least, 2):g} to {printed(most, 2):g}"
    reason = f"efforts are {factors} times smaller than torques where those are large: "
    found: list[Mistake] = []

    def follows(of: Floats) -> float:
        return float(np.median(np.diag(_correlations(efforts, of))[heavy]))

    if most <= _ALIKE * least and follows(view.computed) > _FOLLOWS:
        found.append(replace(_CURRENT, reason=f"{reason}they may be motor currents"))
    greatest = np.quantile(np.abs(moving), 0.95, axis=0)
    rubs = max(follows(moving), follows(np.sign(view.qd))) > _UNRELATED  # what gravity leaves
    if rubs and not (measured < _TOO_SMALL * greatest)[heavy].any():
        reason += "the robot's driver may subtract gravity"
        found.append(replace(_no_gravity(-1.0), reason=reason))
    return tuple(found)


def _correlations(a: Floats, b: Floats) -> Floats:
    """(n, n) of the columns of two tables; 0 where one is constant."""
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    size = np.sqrt(np.outer((a**2).sum(axis=0), (b**2).sum(axis=0)))
    return np.asarray(a.T @ b / np.maximum(size, 1e-300))


def _unrelated(view: View, heavy: Mask, correlation: float) -> Mistake:
    return Mistake(
        "unrelated",
        "Efforts that don't follow the model",
        f"efforts of {listed(view.samples.named(heavy))} don't follow the torques of the motion (correlation "
        f"{correlation:.2g} at most): they may be external torques, friction where the driver subtracts gravity, or of "
        "another motion",
        "record the torques of the joints: of a Franka tau_J, not tau_ext_hat_filtered; of a KUKA the measured ones",
        value=printed(correlation, 2),
    )


def _unit(scale: float) -> tuple[str, float]:
    """The unit of a scale and its exact value, or "" and the scale as printed."""
    for exact, unit in _UNITS.items():
        if abs(scale / exact - 1) < _NAMED:
            return unit, exact
    return "", printed(scale)


def _each(view: View, _: Floats, own: Floats) -> Mistake | None:
    """Scales of their own: of currents, of limits, of a unit of the joints that turn."""
    scales, shown = own[0], view.informative
    if not (scales[shown] > 0).all():
        return None
    off = shown & (np.abs(np.log(np.maximum(scales, 1e-12))) > np.log(1.5))
    if not off.any():
        return None
    rounded = np.array([printed(s) for s in scales])
    limits = view.arm.effort_limits
    if limits is not None and np.isfinite(limits[shown]).all():
        shares = scales * limits
        for exact, what in _SHARES.items():
            if (np.abs(shares[shown] / exact - 1) < 2 * _NAMED).all():
                stated = np.where(np.isfinite(limits), exact / limits, rounded)
                return _scales(view, shown, stated, f"{what} of the effort limits")
    if _are_currents(scales[shown]):
        numbers = listed([f"{s:.3g}" for s in rounded[shown]])
        reason = (
            f"measured efforts have the shape of the torques at another scale in every joint ({numbers}): "
            "they may be motor currents"
        )
        return replace(_CURRENT, reason=reason, value=rounded.tolist(), own=rounded[None])
    turning, sliding = shown & ~view.prismatic, shown & view.prismatic
    if turning.any() and sliding.any() and _one(scales[sliding]):
        unit, exact = _unit(float(np.median(scales[turning])))
        if unit and (np.abs(scales[turning] / exact - 1) < _NAMED).all():
            return _scales(view, off, np.where(view.prismatic, rounded, exact), f"in {unit}")
    if _are_currents(scales[shown] / 1000):
        return _scales(view, off, rounded, "motor currents in mA")
    # a free number for each joint is no mechanism; one for some of them is
    others = shown & ~off
    as_stated = np.abs(np.log(scales[others])) < np.log(_SAME)
    if not _one(scales[off]) or not as_stated.all() or not others.any():
        return None
    return _scales(view, off, rounded, "")


def _one(scales: Floats) -> bool:
    """Whether they are one scale."""
    return float(scales.max()) <= _SAME * float(scales.min())


def _are_currents(scales: Floats) -> bool:
    """Whether motors have such gains: in a range, and of one arm not too different."""
    within = (scales > _CURRENTS[0]) & (scales < _CURRENTS[1])
    return bool(within.all()) and float(scales.max()) <= _ALIKE * float(scales.min())


def _scales(view: View, off: Mask, scales: Floats, what: str) -> Mistake:
    names = view.samples.named(off)
    numbers = listed([f"{s:.4g}" for s in scales[off]])
    return Mistake(
        "effort_scale",
        "Efforts in another unit",
        f"efforts of {listed(names)} are {numbers} times the torques"
        + (f": they are {what}" if what else ""),
        f"divide them by {numbers} where the recording is made",
        () if off[view.informative].all() else names,
        value=scales.tolist(),
        own=scales[None],
    )


def columns(view: View, _: object = None) -> Iterator[Rival]:
    """Two joints exchanged, or their efforts; a joint reversed."""
    for i, j in combinations(range(len(view.names)), 2):
        alike = view.prismatic[i] == view.prismatic[j]
        if alike and (view.informative[i] or view.informative[j]):
            yield from _exchanged(view, i, j)
    for j in map(int, np.flatnonzero(view.informative)):
        yield _reversed(view, j)


def _exchanged(view: View, i: int, j: int) -> Iterator[Rival]:
    order = np.arange(len(view.names))
    order[[i, j]] = j, i
    pair = (view.names[i], view.names[j])

    def recorded(computed: Floats) -> Floats:
        return computed[:, order]

    motion = tuple(map(recorded, view.motion))
    in_order = Mistake(
        "order",
        "Joints in another order",
        f"torques match if joints {pair[0]} and {pair[1]} have each other's columns",
        "give the recording's names in the order of the chain: --joints, or `joints:`",
        pair,
    )
    base = recorded(view.arm.compared(*motion))
    yield view.rival("order", in_order, base=base, motion=motion, effort=recorded)
    efforts = replace(
        in_order,
        kind="effort_order",
        reason=f"torques match if joints {pair[0]} and {pair[1]} have each other's efforts",
        remedy="correct this where the recording is made: positions are in order, efforts aren't",
    )
    base, qd = recorded(view.computed), recorded(view.qd)
    yield view.rival("effort_order", efforts, base=base, qd=qd, effort=recorded)


def _reversed(view: View, j: int) -> Rival:
    sign = np.where(np.arange(len(view.names)) == j, -1.0, 1.0)
    finding = Mistake(
        "direction",
        "A joint is reversed",
        f"joint {view.names[j]}: torques match if its position, velocity and effort are reversed",
        "change the sign where the recording is made, or the <axis> in the description",
        (view.names[j],),
        value=-1.0,
    )
    motion = tuple(sign * values for values in view.motion)
    base = sign * view.arm.compared(*motion)
    return view.rival("direction", finding, base=base, motion=motion, effort=lambda c: sign * c)

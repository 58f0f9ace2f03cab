# SPDX-License-Identifier: Apache-2.0
"""What no model of an arm can have: efforts at a limit, coupled joints, friction that drifts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.wording import listed
from inverse_dynamics.evaluation.causes.rival import Rival, Told

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats, Mask
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting

_FLAT = 2e-3  # of a joint's range: efforts within it of the greatest one are at the limit
_SHARE = (0.02, 0.9)  # of the samples, at a limit
_CUT = 0.5  # of what the model asks for beyond the limit, that is missing
_LONG = 15.0  # s: in less, friction that changes is nothing but wrong
_LEAVES = 0.6  # most of a joint's error that its cause may leave
_NOTICED = 0.03  # least error of a joint that is looked at, as a share of its range


def rivals(view: View, fitting: Fitting) -> Iterator[Rival]:
    """Efforts that stay at their greatest value while the model asks for more."""
    measured, speed = view.samples.flat(view.samples.measured), np.abs(view.qd)
    missing, at_limit = np.zeros_like(measured), np.zeros_like(measured)
    limits: dict[int, tuple[float, float]] = {}
    for j in range(measured.shape[1]):
        for sign in (1.0, -1.0):
            effort = sign * measured[:, j]
            limit = effort.max()
            band = np.clip(2 * fitting.noise[j], _FLAT, 10 * _FLAT) * fitting.size[j]
            flat = effort > limit - band
            resting = speed[flat, j].mean() < 0.05 * speed[:, j].max()
            if limit > 0 and not resting and _SHARE[0] <= flat.mean() <= _SHARE[1]:
                cut = measured[flat, j] - view.computed[flat, j]
                if -sign * cut.mean() > _NOTICED * fitting.size[j]:
                    missing[flat, j], at_limit[flat, j] = cut, 1.0
                    limits.setdefault(j, (sign * limit, flat.mean()))
    if limits:
        # a limit has no friction: what the fit adds of it is taken off
        own = (missing, *(at_limit * c for c in (view.qd, np.sign(view.qd), 1.0)))
        none, free = np.zeros(measured.shape[1]), np.full(measured.shape[1], np.inf)
        yield Rival(
            "saturation",
            view.computed,
            view.qd,
            lambda _, found: _saturated(view, limits, found),
            own=own,
            own_low=(none, -free, -free, -free),
            own_high=(none + 1.0, free, free, free),
        )


def _saturated(view: View, limits: dict[int, tuple[float, float]], own: Floats) -> Told | None:
    found = [j for j in limits if own[0, j] > _CUT]
    if not found:
        return None
    limit, share = limits[found[0]]
    return Told(
        "saturation",
        "",
        f"joint {view.names[found[0]]}: efforts stay at {limit:.4g} in {100 * share:.0f} % of the samples while "
        "the model asks for more: the drive or the sensor is at its limit",
        "record a slower motion, or one with less load",
        tuple(view.names[j] for j in found),
        own=np.where(np.isin(np.arange(own.shape[1]), found), own, 0.0),
    )


def couplings(view: View) -> Iterator[Rival]:
    """A joint whose effort has that of another motor in it, friction included."""
    measured = view.samples.flat(view.samples.measured)
    for j in map(int, np.flatnonzero(view.informative)):
        for k in (k for k in range(len(view.names)) if k != j):
            column = np.zeros_like(measured)
            column[:, j] = measured[:, k]
            tell = partial(_coupled, (view.names[j], view.names[k]))
            yield Rival("coupling", view.computed, view.qd, tell, (column,), (-np.inf,), (np.inf,))


def _coupled(pair: tuple[str, str], ratio: Floats, _: Floats) -> Told:
    value = float(f"{ratio[0]:.2g}")
    return Told(
        "coupling",
        "",
        f"joint {pair[0]}: its effort has {value:g} times that of joint {pair[1]} in it: a gear couples the two",
        "convert efforts and positions of the motors to those of the joints where the recording is made",
        pair,
        value=value,
        shared=np.array([value]),
    )


def of_joints(view: View, fitting: Fitting, plain: Floats) -> Told | None:
    """A limit of efforts, or friction that drifts, in a joint that others outvote.

    plain: (K, n) squares with friction alone.
    """
    for rival in rivals(view, fitting):
        found = _better(fitting, plain, fitting.errors(rival), _NOTICED / 2)
        numbers = np.where(found, fitting.numbers(rival)[1], 0.0)
        if found.any() and (told := rival.tell(np.zeros(0), numbers)):
            return told
    return _drift(view, fitting, plain)


def _better(fitting: Fitting, plain: Floats, squares: Floats, noticed: float) -> Mask:
    """(n,) joints whose errors are noticed, and are much smaller with a cause."""
    before, after = (
        np.sqrt(np.maximum(s.mean(axis=0) - fitting.noise**2, 0.0)) for s in (plain, squares)
    )
    return np.asarray((before > noticed) & (after < _LEAVES * before))


def _drift(view: View, fitting: Fitting, plain: Floats) -> Told | None:
    """Friction or offset that changes along the recording.

    What wrong masses give of gravity may change with time too, where the motion is slow.
    """
    time = view.samples.time.reshape(-1, 1)
    if np.ptp(time) < _LONG:
        return None
    share, base = (time - time.mean()) / np.ptp(time), view.computed
    parts = [share * c for c in (view.qd, np.sign(view.qd), np.ones_like(view.qd))]
    others = [np.tile(base[:, k : k + 1], (1, base.shape[1])) for k in range(base.shape[1])]
    drifting, masses = (fitting.errors(_free(view, own)) for own in (parts, others))
    found = _better(fitting, plain, drifting, _NOTICED) & (
        2 * 2 * drifting.mean(axis=0) < masses.mean(axis=0)
    )
    names = tuple(n for n, f in zip(view.names, found, strict=True) if f)
    if not names:
        return None
    return Told(
        "drift",
        "Friction",
        f"friction or offset of {listed(names)} changes along the recording, as it does while gears warm up",
        "move the robot for half an hour before recording, or leave out the beginning with --from",
        names,
    )


def _free(view: View, own: list[Floats]) -> Rival:
    most = (np.full(len(view.names), np.inf),) * len(own)
    low = tuple(-x for x in most)
    return Rival("", view.computed, view.qd, lambda *_: None, (), (), (), tuple(own), low, most)

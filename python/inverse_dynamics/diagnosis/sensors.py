# SPDX-License-Identifier: Apache-2.0
"""Sensors that are off: the zero of a joint's position or of a torque, efforts one column on, or late."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis.rival import Mistake, Rival, printed

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.diagnosis.fit import Fitting
    from inverse_dynamics.diagnosis.pieces import View

_STEP = 1e-4  # rad: torques are linear in it
_TURNS = 12  # zeros from which torques are linear in a further shift
_NEAR = 0.3  # rad; of that shift
_LEAST_ZERO = 2.0  # degrees: a smaller error is a maker's
_UNSEEN = 1e-6  # of the greatest torque: zeros of an upright first joint change nothing
_OFFSET = 0.1  # of a joint's range; friction may have less
_GAIN = 3.0  # least ratio of the errors before and after: zeros hide among inexact masses
_DELAYS = np.geomspace(0.015, 0.3, 12)  # s


def rivals(view: View, fitting: Fitting) -> Iterator[Rival]:
    """The zero of each joint that turns, zeros of torques, columns that are shifted, a delay."""
    for joint in map(int, np.flatnonzero(~view.prismatic)):
        yield from _zeros(view, joint)
    ones = (np.ones_like(view.computed),)
    # a slider that points down has a constant load, too
    for unit in np.eye(len(view.names))[view.informative & ~view.prismatic]:
        most = np.where(unit, np.inf, 0.0)
        words = partial(_offset, view, fitting)
        yield view.rival("effort_zero", words, own=ones, own_low=-most, own_high=most)
    yield from _shifted(view)
    yield from _delayed(view)


def _zeros(view: View, joint: int) -> Iterator[Rival]:
    q, qd, qdd = view.motion
    unit = np.eye(len(view.names))[joint]
    for turn in range(_TURNS):
        zero = 2 * np.pi * turn / _TURNS
        base = view.arm.compared(q + zero * unit, qd, qdd)
        slope = (view.arm.compared(q + (zero + _STEP) * unit, qd, qdd) - base) / _STEP
        if np.abs(slope).max() <= _UNSEEN * np.abs(view.computed).max():
            return
        words = partial(_zero, view.names[joint], zero)
        yield view.rival("zero", words, base=base, columns=(slope,), low=-_NEAR, high=_NEAR)


def _zero(name: str, zero: float, shift: Floats, _: Floats) -> Mistake | None:
    angle = np.degrees(zero + shift[0])
    angle = printed((angle + 180) % 360 - 180)
    if abs(angle) < _LEAST_ZERO:
        return None
    return Mistake(
        "zero",
        "The zero of a joint",
        f"joint {name}: torques match if its positions are {abs(angle):g}° too {'small' if angle > 0 else 'large'}",
        "home the joint again, or correct its zero in the driver, or the <origin rpy> of the joint in the description",
        (name,),
        value=angle,
        shared=shift,
        gain=_GAIN,
    )


def _offset(view: View, fitting: Fitting, _: Floats, own: Floats) -> Mistake | None:
    joint = int(np.argmax(np.abs(own[0])))
    off = printed(own[0, joint])
    if abs(off) < _OFFSET * fitting.range[joint]:
        return None
    name = view.names[joint]
    return Mistake(
        "effort_zero",
        "The zero of a torque sensor",
        f"efforts of {name} are {abs(off):g} N m too {'large' if off > 0 else 'small'} all the time",
        f"zero its torque sensor with the arm unloaded, or subtract {off:g} where the recording is made",
        (name,),
        value=off,
        own=np.where(own, off, 0.0),
        gain=_GAIN,
    )


def _shifted(view: View) -> Iterator[Rival]:
    """Efforts of all joints, one column to the left or to the right."""
    if len(view.names) < 3:  # of two it is an exchange
        return
    for by, other in ((1, "before"), (-1, "behind")):
        mistake = Mistake(
            "effort_order",
            "Joints in another order",
            f"torques match if each joint has the effort of the joint {other} it",
            "correct this where the recording is made: a column is missing, or there is one too many",
        )
        base, qd = np.roll(view.computed, by, axis=1), np.roll(view.qd, by, axis=1)
        yield view.rival("effort_order", mistake, base=base, qd=qd)


def _delayed(view: View) -> Iterator[Rival]:
    """Torques and velocities of a moment ago."""
    period = float(np.median(np.diff(view.samples.time, axis=1)))
    if not period > 0:
        return
    q, qd, qdd = view.motion
    jerk = view.samples.flat(np.gradient(view.samples.qdd, period, axis=1))
    for delay in _DELAYS:
        before = (
            q - delay * qd + delay**2 / 2 * qdd - delay**3 / 6 * jerk,
            qd - delay * qdd + delay**2 / 2 * jerk,
            qdd - delay * jerk,
        )
        mistake = Mistake(
            "effort_delay",
            "Efforts that are late",
            f"efforts are about {1000 * delay:.0f} ms late, or smoothed",
            "shift them where the recording is made, and filter positions and velocities like efforts",
            value=printed(delay, 2),
        )
        yield view.rival("effort_delay", mistake, base=view.arm.compared(*before), qd=before[1])

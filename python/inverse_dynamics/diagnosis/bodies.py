# SPDX-License-Identifier: Apache-2.0
"""Another arm than the model's: mounted otherwise, with a load, or with other masses. The motion is right.

Torques are linear in the components of gravity, in the mass and first moment of a load (but for a small moment of
inertia), and in the mass of each link.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis.rival import Mistake, Rival, printed

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.diagnosis.arm import ArmModel, Carrier
    from inverse_dynamics.diagnosis.pieces import View

_LENGTH = (8.0, 12.0)  # m/s^2 of gravity, with masses that are wrong by a fifth
_MOST = 3.0  # times the model's gravity
_ALONG, _ACROSS = 0.25, 0.15  # of gravity: masses off by a tenth leave less, across it next to none
_LEAST_ANGLE = 4.0  # degrees: below it, flexible bases and wrong centers of mass look like a mount
_MASS = (0.02, 1.0)  # of the arm's: less is within what makers know of it, no arm lifts more
_REACH = 1.0  # m between the tip and a load's center of mass
_BESIDE = 0.02  # of the greatest torque of the load: in the last joint, if it is beside its axis
_FACTORS = (0.01, 100.0)  # of a mass with a slip of the pen: a decimal, a unit
_ROUGH = 0.25  # relative: of a maker's estimates
_MOST_FACTOR = 12.0  # a decimal: beyond it, hardly a mass is wrong alone
_LEAST_FACTOR = 1.8  # of a mass, either way: smaller ones are a maker's estimate


def rivals(view: View, _: object = None) -> Iterator[Rival]:
    """A mount, a load, a mass."""
    yield from mounts_and_loads(view)
    arm = view.arm
    if arm.links is None or arm.compared_without_gravity:
        return
    low, high = _FACTORS[0] - 1, _FACTORS[1] - 1
    for k, part in enumerate(arm.links(*view.motion)):
        words = partial(_mass, view, k % len(arm.link_names))
        yield view.rival("mass", words, columns=(part,), low=low, high=high)


def mounts_and_loads(view: View) -> Iterator[Rival]:
    """Gravity in another direction; a body at the tip that the model lacks."""
    arm = view.arm
    if arm.pulled is not None and arm.gravity_direction is not None:
        words = partial(
            _subtracted if arm.compared_without_gravity else _mount, arm.gravity_direction
        )
        columns, includes = tuple(arm.pulled(view.motion[0])), ("no_gravity",)
        yield view.rival("gravity", words, columns=columns, includes=includes)
    for carrier, parts in zip(arm.carriers, view.loaded, strict=True):
        low = (-carrier.carried, -np.inf, -np.inf, -np.inf)
        words = partial(_load, parts, arm, carrier)
        yield view.rival("payload", words, columns=tuple(parts), low=low)


def rough(view: View) -> Rival:
    """Masses that a maker has estimated: no mistake, and no other cause if they explain as much."""
    if view.arm.links is None:
        return view.rival("rough", own=(view.computed,), own_low=-_ROUGH, own_high=_ROUGH)
    count = len(view.arm.link_names)
    parts = view.arm.links(*view.motion)[:count]
    if view.arm.compared_without_gravity:  # the robot subtracts the gravity of masses of its own
        still = np.zeros_like(view.qd)
        gravity = view.arm.links(view.motion[0], still, still)[:count]
        parts = np.concatenate([parts - gravity, gravity])
    return view.rival("rough", columns=tuple(parts), low=-_ROUGH, high=_ROUGH)


def _mount(own: Floats, change: Floats, _: Floats) -> Mistake | None:
    found = own + change
    length, size = float(np.linalg.norm(found)), float(np.linalg.norm(own))
    cosine = float(found @ own) / max(length * size, 1e-12)
    angle = float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    elsewhere = not _LENGTH[0] <= length <= _LENGTH[1]
    if elsewhere != (angle < _LEAST_ANGLE) or length > _MOST * size:
        return None
    direction = np.round(found if elsewhere else found * 9.81 / length, 2) + 0.0
    option = ",".join(f"{x:g}" for x in direction)
    where = f"{angle:.0f}° from where the model has it"
    mount = "The robot hangs from the ceiling" if angle > 150 else "The robot hangs on a wall"
    return Mistake(
        "gravity",
        "" if elsewhere else mount,
        f"torques match if gravity acts along {option} m/s² in the frame of the root link, "
        + (f"{printed(length / size, 2):g} times the model's" if elsewhere else where),
        f"give --gravity {option}, or `gravity:` in the run configuration",
        value=[float(x) for x in direction],
        shared=direction - own,
    )


def _subtracted(own: Floats, left: Floats, _: Floats) -> Mistake | None:
    """Gravity that is left in efforts without it: the robot subtracts another one, or none."""
    size = max(float(np.linalg.norm(own)), 1e-12)
    along = float(left @ own) / size
    if abs(along) < _ALONG * size and np.linalg.norm(left - along * own / size) < _ACROSS * size:
        return None
    left = np.round(left, 2) + 0.0
    lacking, option = (",".join(f"{x:g}" for x in v) for v in (own - left, left))
    return Mistake(
        "gravity",
        "Gravity is subtracted from the efforts",
        f"torques match if the robot subtracts gravity along {lacking} m/s² in the frame of the root link, where the "
        f"model has {','.join(f'{x:g}' for x in own)}",
        "correct mounting, payload and masses where the robot has them; or, if its efforts include gravity, give "
        f"--effort-is torque --gravity {option}",
        value=[float(x) for x in left],
        shared=left,
        # The remedy must divide the error by this: less than the usual 2, as inexact masses leave some of it.
        # compare.py asks for the same ratio to a fit of inexact masses, _ROUGH_MARGIN.
        gain=1.6,
    )


def _load(
    parts: Floats, arm: ArmModel, carrier: Carrier, body: Floats, _: Floats
) -> Mistake | None:
    tip, carried = carrier.tip or "the tip", carrier.carried
    least, most = (share * arm.mass for share in _MASS)
    if abs(body[0]) <= least or (arm.mass and body[0] > most) or body[0] < -carried - least:
        return None
    if np.linalg.norm(body[1:]) > _REACH * abs(body[0]):
        return None
    mass = printed(body[0])
    center = np.round(body[1:] / body[0], 3) + 0.0
    rounded = np.array([mass, *(mass * center)])
    load = np.tensordot(rounded, parts, axes=1)
    last = float(np.abs(load[:, -1]).max())  # of a tree, which joint is next to the tip isn't known
    beside = not carrier.tip and last > _BESIDE * float(np.abs(load).max())
    where = ",".join(f"{x:g}" for x in center)
    if mass < 0:
        return Mistake(
            "payload",
            "A payload",
            f"torques match if {tip} carries about {-mass:.2g} kg less, at {where} m, than the {carried:.2g} kg "
            "of the payload that is stated",
            "correct the payload that is stated, or leave it out",
            value=[mass, *map(float, center)],
            shared=rounded,
        )
    option = f" and --parameter payload.tip={carrier.tip}" if carrier.tip else ""
    return Mistake(
        "tool" if beside else "payload",
        "A tool the description lacks, and the tip" if beside else "A payload",
        f"torques match if {tip} carries about {mass:.2g} kg at {where} m",
        f"give --payload {mass:g},{where}{option}, or the load's link in the description",
        value=[mass, *map(float, center)],
        shared=rounded,
    )


def _mass(view: View, link: int, change: Floats, _: Floats) -> Mistake | None:
    factor = printed(1 + change[0], 2)
    if not _LEAST_FACTOR <= max(factor, 1 / factor) <= _MOST_FACTOR:
        return None
    name = view.arm.link_names[link]
    return Mistake(
        "mass",
        "A mass of the description is wrong",
        f"torques match if link {name} has {factor:g} times the mass of the description",
        f"correct <mass> of link {name} in the description",
        (view.names[view.arm.link_joints[link]],),
        value=factor,
        shared=np.array([factor - 1]),
    )

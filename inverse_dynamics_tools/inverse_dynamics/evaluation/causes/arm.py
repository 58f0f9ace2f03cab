# SPDX-License-Identifier: Apache-2.0
"""What rivals need of an arm: its torques in motions that a mistake changes, and their parts.

A solver that can't do something excludes fewer rivals.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats, Mask
    from inverse_dynamics.evaluation.causes.samples import Samples

Compute = Callable[["Floats", "Floats", "Floats"], "Floats"]

_INFORMATIVE = 0.02  # of the greatest torque: less is lost in friction and noise


@dataclass(frozen=True)
class ArmModel:
    """What computes torques of motions (N, n); n joints.

    torques: (N, n) with friction. gravity: (N, n) of positions.
    pulled: (3, N, n) torques of positions for 1 m/s^2 of gravity along x, y, z of the root.
    loaded: (4, N, n) torques of motions for 1 kg at the tip, and for first moments of 1 kg m along x, y, z.
    links: (2 n, N, n) torques of motions for the mass of each link, then for its mass and inertia.
    """

    torques: Compute
    gravity: Callable[[Floats], Floats]
    friction: Callable[[Floats, Floats], Floats] | None = None  # of q, qd; None: it has none
    gravity_direction: Floats | None = None  # (3,) m/s^2
    pulled: Callable[[Floats], Floats] | None = None
    loaded: Compute | None = None
    links: Compute | None = None
    link_names: tuple[str, ...] = ()
    mass: float = 0.0  # kg of the links; 0: it isn't known
    compared_without_gravity: bool = False
    joint_types: tuple[str, ...] = ()  # revolute, continuous, prismatic; none: all are revolute
    position_limits: Floats | None = None  # (2, n) rad or m
    effort_limits: Floats | None = None  # (n,) N m or N

    def of_type(self, kind: str, joints: int) -> Mask:
        """(n,) joints of a type."""
        return np.array([t == kind for t in self.joint_types or ("revolute",) * joints])

    def compared(self, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """What measured torques are compared with."""
        torques = self.torques(q, qd, qdd)
        return torques - self.gravity(q) if self.compared_without_gravity else torques


@dataclass(frozen=True)
class View:
    """Samples and arm, and what several rivals need. Arrays: (N, n)."""

    samples: Samples
    arm: ArmModel
    motion: tuple[Floats, Floats, Floats] = field(init=False)

    def __post_init__(self) -> None:
        s = self.samples
        object.__setattr__(self, "motion", (s.flat(s.q), s.flat(s.qd), s.flat(s.qdd)))

    @property
    def names(self) -> tuple[str, ...]:
        """Of the joints."""
        return self.samples.joints

    @cached_property
    def qd(self) -> Floats:
        """Velocities."""
        return self.motion[1]

    @cached_property
    def computed(self) -> Floats:
        """What measured torques are compared with if nothing is wrong."""
        return self.arm.compared(*self.motion)

    @cached_property
    def gravity(self) -> Floats:
        """Torques of gravity."""
        return self.arm.gravity(self.motion[0])

    @cached_property
    def friction(self) -> Floats | None:
        """Of the model."""
        return None if self.arm.friction is None else self.arm.friction(*self.motion[:2])

    @cached_property
    def loaded(self) -> Floats | None:
        """(4, N, n) of a body at the tip."""
        return None if self.arm.loaded is None else self.arm.loaded(*self.motion)

    @cached_property
    def prismatic(self) -> Mask:
        """(n,)."""
        return self.arm.of_type("prismatic", len(self.names))

    @cached_property
    def continuous(self) -> Mask:
        """(n,)."""
        return self.arm.of_type("continuous", len(self.names))

    @cached_property
    def informative(self) -> Mask:
        """(n,) joints that move, and whose torque shows beside that of the others."""
        travel = np.ptp(self.motion[0], axis=0)
        size = np.quantile(np.abs(self.computed - np.median(self.computed, axis=0)), 0.95, axis=0)
        size = np.maximum(size, 0.2 * np.quantile(np.abs(self.computed), 0.95, axis=0))
        return np.asarray((size >= _INFORMATIVE * size.max()) & (travel > 1e-3 * travel.max()))

    def moving(self, q: Floats, qd: Floats, qdd: Floats) -> View:
        """The same efforts, of another motion."""
        q, qd, qdd = (values.reshape(self.samples.q.shape) for values in (q, qd, qdd))
        return View(replace(self.samples, q=q, qd=qd, qdd=qdd), self.arm)

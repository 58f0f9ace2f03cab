# SPDX-License-Identifier: Apache-2.0
"""The arm of an evaluation as rivals need it: its torques in motions that a mistake changes, and their parts.

A solver that can't do something excludes fewer rivals.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from inverse_dynamics._core import FastModel, RobotDescription
from inverse_dynamics.errors import RobotError, SolverError
from inverse_dynamics.robots.descriptions import positions_of
from inverse_dynamics.robots.robots import RIGID_BODY
from inverse_dynamics.robots.solvers import brings_own_model

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.robots.arm import Arm
    from inverse_dynamics.robots.robots import Robot

Compute = Callable[["Floats", "Floats", "Floats"], "Floats"]

_STANDARD = 9.81  # m/s^2
_BODY = "cause"  # among the solver's payloads
_REACH = 0.1  # m: a body's torques are linear in mass and first moment, but for a small moment of inertia


class Carrier(NamedTuple):
    """A tip that bodies are fixed to.

    loaded: (4, N, n) torques of motions for 1 kg at the tip, and for first moments of 1 kg m along x, y, z.
    """

    tip: str  # empty: the only one
    carried: float  # kg of the payloads that the solver has
    loaded: Compute


@dataclass(frozen=True)
class ArmModel:
    """Functions that compute torques of motions (N, n); n joints.

    torques: (N, n) with friction. gravity: (N, n) of positions.
    pulled: (3, N, n) torques of positions for 1 m/s^2 of gravity along x, y, z of the root.
    links: (2 l, N, n) torques of motions for the mass of each link, then for its mass and inertia. link_joints: which
    of the joints, or of those that mimic it, moves each link.
    """

    torques: Compute
    gravity: Callable[[Floats], Floats]
    friction: Callable[[Floats, Floats], Floats] | None = None  # of q, qd; None: it has none
    gravity_direction: Floats | None = None  # (3,) m/s^2
    pulled: Callable[[Floats], Floats] | None = None
    carriers: tuple[Carrier, ...] = ()
    links: Compute | None = None
    link_names: tuple[str, ...] = ()
    link_joints: tuple[int, ...] = ()
    mass: float = 0.0  # kg of the links; 0: it isn't known
    compared_without_gravity: bool = False
    joint_types: tuple[str, ...] = ()  # revolute, continuous, prismatic; none: all are revolute
    position_limits: Floats | None = None  # (2, n) rad or m
    effort_limits: Floats | None = None  # (n,) N m or N
    guessed: bool = False  # masses are made up: torques are no evidence

    def of_type(self, kind: str, joints: int) -> Mask:
        """(n,) joints of a type."""
        return np.array([t == kind for t in self.joint_types or ("revolute",) * joints])

    def compared(self, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """The torques to compare measured ones with."""
        torques = self.torques(q, qd, qdd)
        return torques - self.gravity(q) if self.compared_without_gravity else torques


def arm_model(arm: Arm, *, without_gravity: bool = False) -> ArmModel:
    """The model of an arm's solver. without_gravity: whether efforts are."""
    robot, solver, description = arm.robot, arm.solver, arm.description
    ones = np.ones(len(solver.joint_names))
    rubs = bool(np.any(solver.friction_vector(ones, q=ones)))

    @cache
    def other() -> Solver:  # one that may be changed, of rigid bodies alone
        return arm.solver_with(friction=False)

    @cache
    def turned() -> Solver:
        return _of_description(arm, other())

    def pulled(q: Floats) -> Floats:
        before, parts = turned().gravity, []
        try:
            for axis in np.eye(3):
                turned().set_gravity(_STANDARD * axis)  # 1 m/s^2 would give a warning
                parts.append(turned().gravity_vector(q) / _STANDARD)
        finally:
            turned().set_gravity(before)
        return np.array(parts)

    def loaded(tip: str, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        without, parts = other().torques(q, qd, qdd), []
        try:
            for center in (np.zeros(3), *(_REACH * np.eye(3))):
                other().set_payload(_BODY, 1.0, center, tip=tip)
                parts.append(other().torques(q, qd, qdd) - without)
        finally:
            other().remove_payload(_BODY)
        return np.array([parts[0], *((part - parts[0]) / _REACH for part in parts[1:])])

    model = ArmModel(
        solver.torques,
        arm.subtracted.gravity_vector,
        (lambda q, qd: solver.friction_vector(qd, q=q)) if rubs else None,
        compared_without_gravity=without_gravity,
        joint_types=tuple(solver.joint_types),
        guessed=bool(arm.guess),
    )
    with suppress(SolverError):  # solvers needn't be able to
        model = replace(model, gravity_direction=solver.gravity, pulled=pulled)
    with suppress(SolverError):
        bodies, tips = solver.payloads.values(), solver.tip_names
        masses = dict.fromkeys(tips, 0.0)
        for body in bodies:
            masses[body.get("tip", tips[0])] += body["mass"]
        carriers = (
            Carrier(tip if len(tips) > 1 else "", mass, partial(loaded, tip))
            for tip, mass in masses.items()
        )
        model = replace(model, carriers=tuple(carriers))
    with suppress(SolverError, RobotError):
        if description:
            model = _with_description(model, robot, solver, description)
    return model


def _of_description(arm: Arm, own: Solver) -> Solver:
    """Solver whose gravity is rotated: the description's, as identified values may hold for one direction only."""
    if arm.description and brings_own_model(arm.robot):
        given = arm.robot.parameters.items()
        load = {name: v for name, v in given if name.startswith("payload.")}
        with suppress(SolverError):  # it needn't have masses, nor these joints
            found = arm.solver_with(plugin=RIGID_BODY, friction=False, parameters=load)
            if found.joint_names == own.joint_names:
                return found
    return own


def _with_description(model: ArmModel, robot: Robot, solver: Solver, description: str) -> ArmModel:
    """With limits and, where the solver computes from it, the links of a description."""
    limits = solver.limits
    positions = np.array([limits["lower"], limits["upper"]])
    model = replace(model, position_limits=positions, effort_limits=limits["effort"])
    described = RobotDescription(description)
    gravity = None if robot.gravity is None else list(robot.gravity)
    engine = FastModel.from_urdf(description, root=robot.root, tip=robot.tip, gravity=gravity)
    held = any(name.startswith(("attached", "locked_joints.")) for name in robot.parameters)
    if held or robot.model is not None or engine.joint_names != solver.joint_names:
        return model  # the engine's links have other bodies
    own = _mass_parts(engine.parameters.reshape(-1, 10))

    def links(q: Floats, qd: Floats, qdd: Floats) -> Floats:
        columns = engine.regressor(q, qd, qdd).reshape(*q.shape, -1, 10)
        return np.concatenate([np.einsum("njkc,kc->knj", columns, p) for p in own])

    moved, mass = described.chain(engine.link_joints, robot.root), float(own[1][:, 0].sum())
    moves = positions_of(described, solver.joint_names)
    return replace(
        model,
        links=links,
        link_names=tuple(joint.child for joint in moved),
        link_joints=tuple(moves[joint.name][0] for joint in moved),
        mass=mass,
    )


def _mass_parts(links: Floats) -> tuple[Floats, Floats]:
    """(n, 10) what is proportional to the masses, if inertias about centers of mass are kept; and if they aren't."""
    points = np.zeros_like(links)
    for link, point in zip(links, points, strict=True):
        if (mass := link[0]) > 0:
            center = link[1:4] / mass
            inertia = mass * (center @ center * np.eye(3) - np.outer(center, center))
            point[:] = [*link[:4], *inertia[np.triu_indices(3)]]
    return points, links

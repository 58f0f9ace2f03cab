# SPDX-License-Identifier: Apache-2.0
"""The solver of an evaluation as an ArmModel. It leaves out what the solver can't compute."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import RobotError, SolverError
from inverse_dynamics.evaluation.causes.arm import ArmModel
from inverse_dynamics.robot.chain_geometry import chain_geometry
from inverse_dynamics.robot.solvers import open_solver

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.robot.robots import Robot

_STANDARD = 9.81  # m/s^2
_BODY = "cause"  # among the solver's payloads
_REACH = 0.1  # m: a body's torques are linear in mass and first moment, but for a small moment of inertia


def arm_model(
    robot: Robot, solver: Solver, description: str, *, without_gravity: bool = False
) -> ArmModel:
    """What rivals need. description: URDF text, or none; without_gravity: what efforts are."""
    ones = np.ones(len(solver.joint_names))
    rubs = bool(np.any(solver.friction_vector(ones, q=ones)))

    @cache
    def other() -> Solver:  # one that may be changed, of rigid bodies alone
        return open_solver(replace(robot, friction=False), description)

    def friction(q: Floats, qd: Floats) -> Floats:
        return solver.friction_vector(qd, q=q)

    model = ArmModel(
        solver.torques,
        solver.gravity_vector,
        friction if rubs else None,
        compared_without_gravity=without_gravity,
        joint_types=tuple(solver.joint_types),
    )
    with suppress(SolverError):  # solvers needn't be able to
        model = replace(model, gravity_direction=solver.gravity, pulled=_pulled(other))
    with suppress(SolverError):
        _ = solver.payloads
        model = replace(model, loaded=_loaded(other))
    with suppress(SolverError, RobotError):
        if description:
            model = _with_description(model, robot, solver, description)
    return model


def _pulled(other: Callable[[], Solver]) -> Callable[[Floats], Floats]:
    def pulled(q: Floats) -> Floats:
        before, parts = other().gravity, []
        try:
            for axis in np.eye(3):
                other().set_gravity(_STANDARD * axis)  # of 1 m/s^2, a warning would be given
                parts.append(other().gravity_vector(q) / _STANDARD)
        finally:
            other().set_gravity(before)
        return np.array(parts)

    return pulled


def _loaded(other: Callable[[], Solver]) -> Callable[[Floats, Floats, Floats], Floats]:
    def loaded(q: Floats, qd: Floats, qdd: Floats) -> Floats:
        without, parts = other().torques(q, qd, qdd), []
        try:
            for center in (np.zeros(3), *(_REACH * np.eye(3))):
                other().set_payload(_BODY, 1.0, center)
                parts.append(other().torques(q, qd, qdd) - without)
        finally:
            other().remove_payload(_BODY)
        return np.array([parts[0], *((part - parts[0]) / _REACH for part in parts[1:])])

    return loaded


def _with_description(model: ArmModel, robot: Robot, solver: Solver, description: str) -> ArmModel:
    """With limits and, where the solver computes from it, the links of a description."""
    from inverse_dynamics._core import FastModel

    chain = chain_geometry(description, robot.root, solver.joint_names)
    limit = [
        [joint.limits.get(name, np.inf) for joint in chain] for name in ("lower", "upper", "effort")
    ]
    model = replace(
        model,
        position_limits=np.array(limit[:2]),
        effort_limits=np.array(limit[2]),
    )
    gravity = None if robot.gravity is None else list(robot.gravity)
    engine = FastModel.from_urdf(description, root=robot.root, tip=robot.tip, gravity=gravity)
    held = any(name.startswith(("attached", "locked_joints.")) for name in robot.parameters)
    if held or robot.model is not None or engine.joint_names != solver.joint_names:
        return model  # the engine's links have other bodies
    own = _mass_parts(engine.parameters.reshape(-1, 10))

    def links(q: Floats, qd: Floats, qdd: Floats) -> Floats:
        columns = engine.regressor(q, qd, qdd).reshape(*q.shape, -1, 10)
        of_joints = [np.einsum("njkc,kc->knj", columns, p) for p in own]
        return np.concatenate(of_joints)

    names = tuple(joint.link for joint in chain)
    return replace(model, links=links, link_names=names, mass=float(own[1][:, 0].sum()))


def _mass_parts(links: Floats) -> tuple[Floats, Floats]:
    """(n, 10) what is proportional to the masses, if inertias about centers of mass are kept; and if they aren't."""
    points = np.zeros_like(links)
    for link, point in zip(links, points, strict=True):
        if (mass := link[0]) > 0:
            center = link[1:4] / mass
            inertia = mass * (center @ center * np.eye(3) - np.outer(center, center))
            point[:] = [*link[:4], *inertia[np.triu_indices(3)]]
    return points, links

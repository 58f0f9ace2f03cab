# SPDX-License-Identifier: Apache-2.0
"""A simulated robot that is what a model says: its friction, and its links and rotor inertias.

    solver = model_solver(robot, description, gravity, payload)
    friction = ModelFriction(solver)                       # any law that the solver has
    bodies = model_bodies(robot, chain, description)       # of a model as `ids identify` writes it

MuJoCo computes the rigid bodies, so that a simulated recording still checks the engine; friction is the solver's.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import FastModel, Solver
from inverse_dynamics.robot.chain_geometry import chain_geometry
from inverse_dynamics.robot.link_parameters import inertia_matrix, pseudo_inertia, turned
from inverse_dynamics.robot.solvers import open_solver
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.model import Bodies, Inertia, Payload, SimulatedRobot

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.robot.robots import Robot
    from inverse_dynamics.simulation.urdf import UrdfChain

_STATES = 20  # in which simulator and solver are compared
_SAME = 1e-7  # of the greatest torque: rounding, of moments about principal axes
_FASTEST = 1.0  # rad/s, of velocities that steps of friction are looked for at
_VELOCITIES = 4001
_NEAR = 1e-7  # rad/s; slopes between closer velocities are rounding


class ModelFriction:
    """Friction of a solver. Laws that depend on the load count the solver's payloads and gravity."""

    def __init__(self, solver: Solver, center: Floats) -> None:
        """center: (n,) rad/s, where the laws are steepest."""
        self._solver, self._center = solver, center
        self.viscous = np.zeros_like(center)  # a controller has all of the law as feed-forward

    @classmethod
    def of(cls, solver: Solver) -> ModelFriction | None:
        """None: the solver has no friction."""
        n = len(solver.joint_names)
        qd = np.linspace(-_FASTEST, _FASTEST, _VELOCITIES)
        torques = solver.friction_vector(np.tile(qd[:, None], n), q=np.zeros((_VELOCITIES, n)))
        if not torques.any():
            return None
        steepest = np.abs(np.diff(torques, axis=0)).argmax(axis=0)
        return cls(solver, 0.5 * (qd[steepest] + qd[steepest + 1]))

    def torques(self, qd: Floats, q: Floats, /) -> Floats:
        """(..., n) at velocities and positions (..., n)."""
        return self._solver.friction_vector(qd, q=q)

    def line(self, qd: Floats, q: Floats, /) -> tuple[Floats, Floats]:
        """Through the friction at the velocity where the law is steepest, such as the step of Coulomb friction."""
        apart = qd - self._center
        apart = np.where(np.abs(apart) < _NEAR, _NEAR, apart)
        here, there, center = self.torques(
            np.array([qd, self._center + apart, self._center]), np.array([q, q, q])
        )
        slope = np.maximum((there - center) / apart, 0.0)
        return slope, here - slope * qd


def model_solver(
    robot: Robot, description: str, gravity: tuple[float, float, float], payload: Payload | None
) -> Solver:
    """The run configuration's solver, with friction, for a robot that is mounted and loaded like this."""
    solver = open_solver(replace(robot, friction=True), description)
    solver.set_gravity(gravity)
    if payload is not None:
        solver.set_payload("simulated payload", payload.mass, payload.center)
    return solver


def model_bodies(robot: Robot, chain: UrdfChain, description: str) -> Bodies:
    """Links and rotor inertias of the run configuration's model. Raises SimulationError, SolverError."""
    if robot.model is None:
        raise SimulationError(
            f"{robot.file}: model: expected a model file, whose links are to be simulated, got none; identify one "
            "with `ids identify`, or simulate its friction alone with --joint-friction model"
        )
    engine = FastModel.from_file(str(robot.model))
    if engine.joint_names != chain.joint_names:
        raise SimulationError(
            f"{robot.model}: expected the joints of the description ({', '.join(chain.joint_names)}), got "
            f"{', '.join(engine.joint_names)}"
        )
    inertia = {}
    geometry = chain_geometry(description, chain.root, chain.joint_names)
    for joint, parameters in zip(geometry, engine.parameters.reshape(-1, 10), strict=True):
        inertia[joint.link] = _inertia(
            turned(parameters, joint.rotation_from_z), f"{robot.model}: link {joint.link}"
        )
    return Bodies(inertia, _rotor_inertia(robot, engine))


def check_same_torques(simulated: SimulatedRobot, robot: Robot, solver: Solver) -> None:
    """Raises SimulationError unless the simulator's rigid bodies are those of the solver."""
    n = len(simulated.dofs)
    q, qd, qdd = np.random.default_rng(0).uniform(-2.0, 2.0, (3, _STATES, n))
    expected = solver.torques(q, qd, qdd) - solver.friction_vector(qd, q=q)
    difference = float(np.abs(simulated.torques(q, qd, qdd) - expected).max())
    if not difference <= _SAME * float(np.abs(expected).max()):
        raise SimulationError(
            f"{robot.model}: expected a model with the joints' places of the description and one body per link, as "
            f"`ids identify` writes it, got one whose torques differ from the simulator's by {difference:.2g} N m; "
            "simulate its friction alone with --joint-friction model"
        )


def _inertia(parameters: Floats, where: str) -> Inertia:
    """Of m, mc, I about the link's origin."""
    mass, first = parameters[0], parameters[1:4]
    if not np.linalg.eigvalsh(pseudo_inertia(parameters))[0] > 0:
        raise SimulationError(
            f"{where}: expected inertia that a body can have, got a pseudo-inertia that isn't positive definite; "
            "simulate the model's friction alone with --joint-friction model"
        )
    center = first / mass
    to_center = mass * (center @ center * np.eye(3) - np.outer(center, center))
    return Inertia(float(mass), center, inertia_matrix(parameters[4:]) - to_center)


def _rotor_inertia(robot: Robot, engine: FastModel) -> Floats:
    """(n,): what torques need for a unit acceleration beyond the links."""
    n = len(engine.joint_names)
    solver = open_solver(replace(robot, urdf=None, root="", tip="", friction=False))
    still, unit = np.zeros((n, n)), np.eye(n)
    links = (
        engine.regressor(still, still, unit) - engine.regressor(still, still, still)
    ) @ engine.parameters
    all_of_it = solver.torques(still, still, unit) - solver.torques(still, still, still)
    return np.maximum(np.diagonal(all_of_it - links), 0.0)

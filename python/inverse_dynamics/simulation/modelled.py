# SPDX-License-Identifier: Apache-2.0
"""The simulated robot of a run configuration; links, rotor inertias and friction may be those of its model.

    simulated = simulated_robot(robot, description_of(robot), joint_friction="model", from_model=True)

MuJoCo computes the rigid bodies, so that a simulated recording still checks the engine; friction is the solver's.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from inverse_dynamics._core import FastModel, RobotDescription, Solver
from inverse_dynamics.decimals import decimal
from inverse_dynamics.evaluation.posture import locked_joints
from inverse_dynamics.robots.descriptions import parse_description, read_description
from inverse_dynamics.robots.link_parameters import inertial_elements, pseudo_inertia, turned
from inverse_dynamics.robots.solvers import open_solver
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.limits import require_limits
from inverse_dynamics.simulation.model import (
    GRAVITY,
    Friction,
    JointFriction,
    Payload,
    SimulatedRobot,
    payloads_of,
)
from inverse_dynamics.simulation.urdf import chain_from_urdf, with_held_joints

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Unpack

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.robots.robots import Robot
    from inverse_dynamics.simulation.model import Gravity
    from inverse_dynamics.simulation.urdf import UrdfChain

_STATES = 20  # in which simulator and solver are compared
_SAME = 1e-7  # of the greatest torque: rounding, of moments about principal axes
_FASTEST = 1.0  # rad/s, of velocities that steps of friction are looked for at
_VELOCITIES = 4001


class ModelFriction(Friction):
    """Friction of a solver. Laws that depend on the load count the solver's payloads and gravity."""

    def __init__(self, solver: Solver, steepest: Floats) -> None:
        """steepest: (n,) rad/s, where the laws are."""
        self._solver, self.steepest = solver, steepest
        self.viscous = np.zeros_like(steepest)  # a controller has all of the law as feed-forward
        self._state = solver.friction_state()

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

    def torques(self, qd: Floats, q: Floats) -> Floats:
        """(..., n) at velocities and positions (..., n)."""
        return self._solver.friction_vector(qd, q=q)

    def restart(self) -> None:
        """Forgets the motion so far."""
        self._state.reset()

    def remembered(self, qd: Floats, q: Floats) -> Floats:
        """(n,) what the motion up to this state adds."""
        self._state.move(q)
        return self._state.torques(qd)


def description_of(robot: Robot) -> str:
    """The robot's description. Raises SimulationError where the run configuration names none, RobotError."""
    if robot.urdf is None:
        raise SimulationError(
            f"{robot.file or robot.name}: names no urdf; a simulation needs the robot's description"
        )
    return read_description(robot.urdf)


def carried_by(solver: Solver) -> tuple[Payload, ...]:
    """All payloads of a solver, those of each tip as one body."""
    bodies: dict[str, list[dict[str, Any]]] = {}
    for body in solver.payloads.values():
        if body["mass"]:
            bodies.setdefault(body.get("tip", ""), []).append(body)
    return tuple(_as_one(of_tip, tip) for tip, of_tip in bodies.items())


def _as_one(bodies: list[dict[str, Any]], tip: str) -> Payload:
    mass = sum(body["mass"] for body in bodies)
    poses = [body["frame"] for body in bodies]
    centers = [
        (pose @ [*body["center_of_mass"], 1.0])[:3]
        for body, pose in zip(bodies, poses, strict=True)
    ]
    center = sum(body["mass"] * c for body, c in zip(bodies, centers, strict=True)) / mass
    inertia = np.zeros((3, 3))
    for body, pose, place in zip(bodies, poses, centers, strict=True):
        R, d = pose[:3, :3], place - center
        inertia += R @ body["inertia"] @ R.T + body["mass"] * (d @ d * np.eye(3) - np.outer(d, d))
    return Payload(mass, tuple(center.tolist()), tuple(inertia[np.triu_indices(3)].tolist()), tip)


class PlantOptions(TypedDict, total=False):
    """What is simulated, beyond the robot's run configuration.

    gravity: m/s^2, in the frame of the root link; None: the run configuration's. payload: at tips; None: those of
    a Solver that is given as robot.
    joint_friction: the friction itself; a number: Coulomb friction that part of each joint's effort limit, and as much
    viscous friction at its velocity limit; "urdf": what <dynamics> says; "model": that of the run configuration's
    solver; None: none, or the model's with `from_model`. from_model: links and rotor inertias are those of the run
    configuration's model, not of the description.
    """

    gravity: Gravity | None
    payload: Payload | Sequence[Payload] | None
    joint_friction: Friction | float | str | None
    from_model: bool


def simulated_robot(
    robot: Robot,
    description: str,
    **plant: Unpack[PlantOptions],
) -> SimulatedRobot:
    """The robot of a run configuration. Errors name the description's file."""
    stated = plant.get("gravity")
    gravity = robot.gravity or GRAVITY if stated is None else stated
    payload, joint_friction = plant.get("payload"), plant.get("joint_friction")
    from_model = plant.get("from_model", False)
    try:
        held = with_held_joints(description, locked_joints(robot))
        chain = chain_from_urdf(held, robot.root, robot.tip)
        solver = None
        if from_model or joint_friction == "model":
            solver = _model_solver(robot, description, gravity, payloads_of(payload))
        friction = _friction(robot, chain, solver, joint_friction)
        urdf, rotor_inertia = held, None
        if from_model:
            urdf, rotor_inertia = modelled_description(robot, chain, held)
        simulated = SimulatedRobot.from_urdf(
            urdf,
            robot.root,
            robot.tip,
            gravity=gravity,
            payload=payload,
            friction=friction,
            rotor_inertia=rotor_inertia,
        )
    except SimulationError as error:
        text = str(error)
        if not text.startswith("robot description"):
            raise
        raise SimulationError(text.replace("robot description", f"{robot.urdf}", 1)) from error
    if solver is not None and from_model:
        check_same_torques(simulated, robot, solver)
    return simulated


def _model_solver(
    robot: Robot, description: str, gravity: Gravity, payloads: Sequence[Payload]
) -> Solver:
    """The run configuration's solver, with friction, for a robot that is mounted and loaded like this."""
    solver = open_solver(replace(robot, friction=True), description)
    solver.set_gravity(gravity)
    if payloads:
        solver.clear_payloads()
    for k, body in enumerate(payloads):
        solver.set_payload(f"simulated {k}", body.mass, body.center, body.inertia, tip=body.tip)
    return solver


def _friction(
    robot: Robot, chain: UrdfChain, solver: Solver | None, given: Friction | float | str | None
) -> Friction | None:
    if solver is not None and given in (None, "model"):
        found = ModelFriction.of(solver)
        if found is None and given == "model":
            raise SimulationError(
                f"joint friction: expected a solver with friction, got {robot.plugin}, which has none for "
                f"{robot.name}; name a robot whose model has friction"
            )
        return found
    if not isinstance(given, float | int | str):
        return given
    if given == "urdf":
        return JointFriction(chain.friction, chain.damping)
    try:
        part = decimal(given) if isinstance(given, str) else float(given)
    except ValueError:
        part = np.nan
    if not 0 <= part < 1:
        raise SimulationError(
            f"joint friction: expected a part of the effort limit, 0 to below 1, urdf or model, got {given}"
        )
    require_limits(chain, "joint friction")
    return JointFriction(part * chain.effort, part * chain.effort / chain.velocity)


def modelled_description(robot: Robot, chain: UrdfChain, description: str) -> tuple[str, Floats]:
    """The description with the links of the run configuration's model, and rotor inertias (n,) seen at the joints.

    Links that the model doesn't name have no inertia of their own. Raises SimulationError, SolverError.
    """
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
    geometry = RobotDescription(description).chain(chain.joint_names, chain.root)
    inertials = {
        joint.child: _inertial(
            turned(parameters, joint.rotation_from_z), f"{robot.model}: link {joint.child}"
        )
        for joint, parameters in zip(geometry, engine.parameters.reshape(-1, 10), strict=True)
    }
    tree = parse_description(description)
    for link in tree.findall("link"):
        for stated in link.findall("inertial"):
            link.remove(stated)
        if (inertial := inertials.get(link.get("name", ""))) is not None:
            link.append(inertial)
    return ElementTree.tostring(tree, encoding="unicode"), _rotor_inertia(robot, engine)


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


def _inertial(parameters: Floats, where: str) -> ElementTree.Element:
    """<inertial> of a link."""
    if not np.linalg.eigvalsh(pseudo_inertia(parameters))[0] > 0:
        raise SimulationError(
            f"{where}: expected inertia that a body can have, got a pseudo-inertia that isn't positive definite; "
            "simulate the model's friction alone with --joint-friction model"
        )
    inertial = ElementTree.Element("inertial")
    for tag, attributes in inertial_elements(parameters).items():
        ElementTree.SubElement(inertial, tag, attributes)
    return inertial


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

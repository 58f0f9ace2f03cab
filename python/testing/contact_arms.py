# SPDX-License-Identifier: Apache-2.0
"""Arms in MuJoCo that are pushed and hit: what their sensors say, 1000 times a second.

    arm = ContactArm("panda")
    recorded = arm.record(random_motion(arm, 0, 60.0), 60.0, seed=0)

The plant: bodies of the URDF, the identified robot's friction in the joints, computed torque at 1 kHz. What is
recorded: positions of an encoder with 2^19 steps per turn, no velocities, torques with white noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import mujoco
import numpy as np
import yaml
from example_robots import RIGID_BODY
from simulation_arms import CHAINS, robots_package, urdf_of

from inverse_dynamics import FastModel, Solver
from inverse_dynamics.simulation.model import GRAVITY, _inertia, _read_spec, _write_true_inertia
from inverse_dynamics.simulation.trajectory import FourierTrajectory, WaypointTrajectory
from inverse_dynamics.simulation.urdf import chain_from_urdf

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.simulation.trajectory import Trajectory

PERIOD = 1e-3  # s
ENCODER_STEP = 2 * np.pi / 2**19  # rad
TORQUE_NOISE = {"ur10": 0.3, "panda": 0.1}  # N m, standard deviation
IDENTIFIED = {
    "ur10": "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10",
    "panda": "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria",
}
HOME = {
    "ur10": np.array([0, -1.6, 1.4, -1.2, -1.4, 0.3]),
    "panda": np.array([0, -0.5, 0.2, -2.0, 0.1, 1.8, 0.6]),
}
RANGE = {
    "ur10": np.array([2.0, 1.0, 1.0, 1.5, 1.5, 2.5]),
    "panda": np.array([1.5, 0.9, 1.2, 0.9, 1.5, 1.2, 1.5]),
}
"""How far random motions go from there, either way [rad]."""

_MODELS = {"ur10": "ur10_identified", "panda": "franka_inria_identified"}

ELBOW = {"ur10": "forearm_link", "panda": "fer_link4"}
"""Link whose origin is the elbow."""

_FREQUENCY, _DAMPING = 30.0, 1.0  # rad/s, of computed torque


@dataclass(frozen=True)
class Recorded:
    """N samples, as a controller reads them at the end of each of its periods."""

    q: Floats  # (N, n) rad, of the encoders
    effort: Floats  # (N, n) N m, of the torque sensors: what acted during the period
    force: Floats  # (N, 3) N, what pushed the tip during the period, in the axes of the root link
    contact: NDArray[np.bool_]  # (N,) whether the ball touches the arm


@dataclass(frozen=True)
class Ball:
    """A ball that flies at an arm: 1 J."""

    link: str  # whose origin it hits
    direction: Floats  # (3,) of its flight, of length one, in the root link's axes
    time: float  # s, when it gets there if the arm stands still
    mass: float = 1.0  # kg

    @property
    def speed(self) -> float:
        return float(np.sqrt(2.0 / self.mass))


def random_motion(
    arm: ContactArm, seed: int, duration: float, share: float = 0.5
) -> WaypointTrajectory:
    """From one random posture to the next, with rests between; as fast as `share` of the velocity limits."""
    random = np.random.default_rng((seed, 77))
    postures, times, now = [arm.home], [0.0], 0.0
    while now < duration:
        if random.random() < 0.3:  # rests
            now += random.uniform(0.3, 1.5)
            postures.append(postures[-1])
        else:
            postures.append(arm.home + arm.range * random.uniform(-1, 1, len(arm.home)))
            way = np.abs(postures[-1] - postures[-2]) / (share * arm.velocity)
            now += max(0.4, 1.875 * float(way.max()))  # of a quintic
        times.append(now)
    rests = tuple(range(1, len(times) - 1))
    return WaypointTrajectory.through((), np.array(times), np.array(postures), rests)


def swing(arm: ContactArm, start: Floats, end: Floats) -> FourierTrajectory:
    """From one posture to another and back, again and again, at up to half of the velocity limits."""
    way = end - start
    duration = max(1.0, 1.875 * float(np.abs(2 * way / arm.velocity).max()))
    speed = (0.5 * np.pi / duration * way)[:, None]
    return FourierTrajectory((), 2 * duration, start + way / 2, np.zeros_like(speed), speed)


def still(posture: Floats) -> FourierTrajectory:
    """Rest in one posture."""
    nothing = np.zeros((len(posture), 1))
    return FourierTrajectory((), 1.0, posture, nothing, nothing)


def write_model(name: str, file: Path) -> Path:
    """Bodies of the URDF with the friction of the identified robot, as a model file."""
    root, tip = CHAINS[name]
    bodies = FastModel.from_urdf(urdf_of(name), root=root, tip=tip)
    model = yaml.safe_load(bodies.file_text(name=name, source="tests", validity="tests"))
    for joint, friction in zip(model["joints"], _identified_friction(name), strict=True):
        joint["friction"] = friction
    del model["checks"]  # of the bodies alone
    file.write_text(yaml.safe_dump(model, sort_keys=False))
    return file


def _identified_friction(name: str) -> list[dict[str, float | str]]:
    """Laws with their figures in N m."""
    model = yaml.safe_load((robots_package() / "models" / f"{_MODELS[name]}.yaml").read_text())
    laws = []
    for joint in model["joints"]:
        gain = joint.get("drive_gain", 1.0)
        law = dict(joint["friction"])
        for figure in {"fv", "fo", "fc", "A"} & law.keys():
            law[figure] *= gain
        laws.append(law)
    return laws


class ContactArm:
    """One of the project's arms, with its friction, and a ball that may hit it."""

    def __init__(self, name: str, ball: Ball | None = None) -> None:
        self.name, self.ball = name, ball
        self.home, self.range = HOME[name], RANGE[name]
        chain = chain_from_urdf(urdf_of(name), *CHAINS[name])
        self.velocity, self.tip = chain.velocity, chain.tip
        spec, _ = _read_spec(chain)
        inertia = _inertia(spec)
        for geom in spec.geoms:
            geom.contype = geom.conaffinity = 0
        if ball is not None:
            _add_ball(spec, ball)
        self.model = spec.compile()
        _write_true_inertia(self.model, inertia)
        self.model.dof_damping[:] = 0.0
        self.model.dof_frictionloss[:] = 0.0
        self.model.opt.gravity = GRAVITY
        self.model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
        self.model.opt.timestep = 0.5 * PERIOD
        first = self.model.joint(chain.joint_names[0]).dofadr[0]
        self.dofs = slice(first, first + len(chain.joint_names))  # a chain: one after the other
        self._friction = Solver(IDENTIFIED[name]).friction_vector

    @cached_property
    def solver(self) -> Solver:
        """Bodies of the URDF: what the plant is made of, without friction."""
        return Solver(RIGID_BODY, urdf_of(self.name), *CHAINS[self.name])

    def friction(self, qd: Floats) -> Floats:
        """Of the identified robot: N m, (N, n)."""
        return self._friction(qd)

    def jacobian(self, q: Floats, link: str = "") -> Floats:
        """Of a link's origin, the tip's if none is given: (6, n), linear part first, by MuJoCo."""
        data = mujoco.MjData(self.model)
        data.qpos[self.dofs] = q
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        return self._jacobian(data, self.model.body(link or self.tip).id)

    def _jacobian(self, data: mujoco.MjData, body: int) -> Floats:
        full = np.zeros((6, self.model.nv))
        mujoco.mj_jac(self.model, data, full[:3], full[3:], data.xpos[body], body)
        return full[:, self.dofs]

    def record(
        self,
        reference: Trajectory,
        duration: float,
        seed: int,
        force: Callable[[float], Floats] | None = None,
    ) -> Recorded:
        """What the sensors say while the arm follows a reference; `force` [N] pushes its tip."""
        data = mujoco.MjData(self.model)
        count, n = round(duration / PERIOD), len(self.home)
        time = np.arange(count) * PERIOD
        desired = reference.at(time + 0.5 * PERIOD)
        start = reference.at(np.zeros(1))
        data.qpos[self.dofs], data.qvel[self.dofs] = start[0][0], start[1][0]
        if self.ball is not None:
            self._throw(data)
        forces = np.array([force(t) for t in time]) if force else np.zeros((count, 3))
        q, effort, contact = np.empty((count, n)), np.empty((count, n)), np.zeros(count, bool)
        command = _ComputedTorque(self, desired)
        position, velocity = data.qpos[self.dofs], data.qvel[self.dofs]  # views
        for k in range(count):
            effort[k] = command(k, position, velocity)
            self._advance(data, effort[k], forces[k])
            touching = data.ncon > 0
            self._advance(data, effort[k], forces[k])
            q[k] = position
            contact[k] = self.ball is not None and (touching or data.ncon > 0)
        return self._sensed(q, effort, seed, forces, contact)

    def carry_out(self, motion: Trajectory, duration: float, seed: int) -> Recorded:
        """The same of a motion that is carried out exactly: torques are those of the bodies and of friction."""
        count = round(duration / PERIOD)
        q, qd, qdd = motion.at((np.arange(count) + 0.5) * PERIOD)  # mean torques of the periods
        effort = self.solver.torques(q, qd, qdd) + self._friction(qd)
        q, _, _ = motion.at((np.arange(count) + 1.0) * PERIOD)
        return self._sensed(q, effort, seed, np.zeros((count, 3)), np.zeros(count, bool))

    def torques(self, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """Of one state, without friction, by MuJoCo: (n,) N m."""
        data = mujoco.MjData(self.model)
        data.qpos[self.dofs], data.qvel[self.dofs], data.qacc[self.dofs] = q, qd, qdd
        mujoco.mj_inverse(self.model, data)
        return np.array(data.qfrc_inverse[self.dofs])

    def _sensed(
        self, q: Floats, effort: Floats, seed: int, force: Floats, contact: NDArray[np.bool_]
    ) -> Recorded:
        noise = np.random.default_rng((seed, 5)).standard_normal(effort.shape)
        return Recorded(
            ENCODER_STEP * np.round(q / ENCODER_STEP),
            effort + TORQUE_NOISE[self.name] * noise,
            force,
            contact,
        )

    def _advance(self, data: mujoco.MjData, effort: Floats, force: Floats) -> None:
        """Half a period, with the friction that acts at its end: stable however steep friction is."""
        model, dofs = self.model, self.dofs
        mujoco.mj_step1(model, data)
        tip = model.body(self.tip).id
        push = self._jacobian(data, tip)[:3].T @ force if force.any() else 0.0
        mujoco.mj_fullM(model, data, self._H)
        rate = model.opt.timestep * np.linalg.inv(self._H[dofs, dofs])
        torque = effort + push + data.qfrc_constraint[dofs] - data.qfrc_bias[dofs]
        before = np.array(data.qvel[dofs])
        f = self._friction(_slowed(before + rate @ torque, rate, self._friction, before))
        data.qfrc_applied[dofs] = effort + push - f
        mujoco.mj_step2(model, data)

    @cached_property
    def _H(self) -> Floats:
        return np.zeros((self.model.nv, self.model.nv))

    def _throw(self, data: mujoco.MjData) -> None:
        mujoco.mj_kinematics(self.model, data)
        ball = self.ball
        target = data.body(ball.link).xpos
        joint = self.model.joint("ball")
        way = ball.speed * ball.time + _BALL_RADIUS + _LINK_RADIUS
        data.qpos[joint.qposadr[0] :][:3] = target - way * ball.direction
        data.qvel[joint.dofadr[0] :][:3] = ball.speed * ball.direction


def _slowed(
    free: Floats, rate: Floats, friction: Callable[[Floats], Floats], start: Floats
) -> Floats:
    """The velocity v at which `v = free - rate f(v)`, by Newton's method with halved steps."""
    v, f = start, friction(start)
    error = v - free + rate @ f
    for _ in range(50):
        if np.abs(error).max() < 1e-7:  # rad/s
            break
        slope = (friction(v + 1e-6) - f) / 1e-6
        change = np.linalg.solve(np.eye(len(v)) + rate * slope, error)
        part = 1.0
        while True:
            f_next = friction(v - part * change)
            next_error = v - part * change - free + rate @ f_next
            if np.abs(next_error).max() < np.abs(error).max() or part < 1e-3:
                break
            part /= 2
        v, f, error = v - part * change, f_next, next_error
    return v


_BALL_RADIUS, _LINK_RADIUS = 0.05, 0.06  # m


def _add_ball(spec: mujoco.MjSpec, ball: Ball) -> None:
    sphere = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "contype": 0, "conaffinity": 0}
    spec.body(ball.link).add_geom(name="hit", size=[_LINK_RADIUS, 0, 0], **sphere)
    body = spec.worldbody.add_body(
        name="ball",
        gravcomp=1.0,
        mass=ball.mass,
        inertia=[0.4 * ball.mass * _BALL_RADIUS**2] * 3,
        explicitinertial=True,
    )
    body.add_freejoint(name="ball")
    body.add_geom(name="ball", size=[_BALL_RADIUS, 0, 0], **sphere)
    spec.add_pair(name="hit", geomname1="hit", geomname2="ball", solref=[0.005, 0.3], condim=1)


class _ComputedTorque:
    """The robot's own controller: it knows its state better than the sensors tell us."""

    def __init__(self, arm: ContactArm, desired: tuple[Floats, Floats, Floats]) -> None:
        self._solver, self._desired = arm.solver, desired
        self._friction = arm.friction(desired[1])

    def __call__(self, k: int, q: Floats, qd: Floats) -> Floats:
        q_desired, qd_desired, qdd_desired = (series[k] for series in self._desired)
        a = (
            qdd_desired
            + _FREQUENCY**2 * (q_desired - q)
            + 2 * _DAMPING * _FREQUENCY * (qd_desired - qd)
        )
        return self._solver.torques(q, qd, a) + self._friction[k]

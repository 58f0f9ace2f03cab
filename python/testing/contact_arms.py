# SPDX-License-Identifier: Apache-2.0
"""Arms in MuJoCo that are pushed and hit: what their sensors say, 1000 times a second.

    arm = ContactArm("panda")
    recorded = arm.record(random_motion(arm, 0, 60.0), 60.0, seed=0)

Bodies of the URDF, the identified robot's friction in the joints, computed torque at 1 kHz. What is recorded:
positions of an encoder with 2^19 steps per turn, no velocities, torques with white noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np
import yaml
from example_robots import FRANKA, RIGID_BODY, UR10
from simulation_arms import CHAINS, HOME, robots_package, urdf_of

from inverse_dynamics import FastModel, Solver
from inverse_dynamics.simulation.model import SimulatedRobot
from inverse_dynamics.simulation.modelled import ModelFriction
from inverse_dynamics.simulation.physics import drive
from inverse_dynamics.simulation.trajectory import FourierTrajectory, WaypointTrajectory

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.simulation.trajectory import Trajectory

PERIOD = 1e-3  # s
ENCODER_STEP = 2 * np.pi / 2**19  # rad
TORQUE_NOISE = {"ur10": 0.3, "panda": 0.1}  # N m, standard deviation
IDENTIFIED = {"ur10": UR10, "panda": FRANKA}
RANGE = {
    "ur10": np.array([2.0, 1.0, 1.0, 1.5, 1.5, 2.5]),
    "panda": np.array([1.5, 0.9, 1.2, 0.9, 1.5, 1.2, 1.5]),
}
"""How far random motions go from HOME, either way [rad]."""

ELBOW = {"ur10": "forearm_link", "panda": "fer_link4"}
"""Link whose origin is the elbow."""

_MODELS = {"ur10": "ur10_identified", "panda": "franka_inria_identified"}
_FREQUENCY, _DAMPING = 30.0, 1.0  # rad/s, of computed torque
_RADIUS, _STIFFNESS = 0.11, 4e5  # m, of ball and link together; N/m, so that they touch for 5 ms


@dataclass(frozen=True)
class Recorded:
    """N samples, as a controller reads them at the end of each of its periods."""

    q: Floats  # (N, n) rad, of the encoders
    effort: Floats  # (N, n) N m, of the torque sensors: what acted during the period
    force: Floats  # (N, 3) N on tip or link during the period, in the axes of the root link


@dataclass(frozen=True)
class Ball:
    """A ball of 1 kg that flies at an arm: 1 J."""

    link: str  # whose origin it hits
    direction: Floats  # (3,) of its flight, of length one, in the root link's axes
    time: float  # s, when it gets there if the arm stands still

    def forces(self, target: Floats) -> Callable[[Floats], Floats]:
        """Force on the link [N] in each period, from its place at the beginning (3,), which is first at target."""
        velocity = np.sqrt(2.0) * self.direction
        position = target - self.time * velocity - _RADIUS * self.direction

        def force(place: Floats) -> Floats:
            apart = place - position
            distance = np.linalg.norm(apart)
            pushed = _STIFFNESS * max(0.0, _RADIUS - distance) * apart / distance
            velocity[:] -= PERIOD * pushed
            position[:] += PERIOD * velocity
            return pushed

        return force


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


def write_model(name: str, file: Path) -> Path:
    """Bodies of the URDF with the friction of the identified robot in N m, as a model file."""
    root, tip = CHAINS[name]
    bodies = FastModel.from_urdf(urdf_of(name), root=root, tip=tip)
    model = yaml.safe_load(bodies.file_text(name=name, source="tests", validity="tests"))
    identified = robots_package() / "models" / f"{_MODELS[name]}.yaml"
    for joint, known in zip(
        model["joints"], yaml.safe_load(identified.read_text())["joints"], strict=True
    ):
        gain = known.get("drive_gain", 1.0)
        joint["friction"] = {
            key: gain * figure if key in {"fv", "fo", "fc", "A"} else figure
            for key, figure in known["friction"].items()
        }
    del model["checks"]  # of the bodies alone
    file.write_text(yaml.safe_dump(model, sort_keys=False))
    return file


class ContactArm:
    """One of the project's arms, with its friction."""

    def __init__(self, name: str) -> None:
        self.name, self.home, self.range = name, HOME[name], RANGE[name]
        self.solver = Solver(RIGID_BODY, urdf_of(name), *CHAINS[name])  # bodies, no friction
        identified = Solver(IDENTIFIED[name])
        self.friction = identified.friction_vector
        self.robot = SimulatedRobot.from_urdf(
            urdf_of(name), *CHAINS[name], friction=ModelFriction.of(identified)
        )
        self.velocity, self.tip = self.robot.chain.velocity, self.robot.chain.tips[0]

    def place(self, q: Floats, link: str = "") -> tuple[Floats, Floats]:
        """Of a link's origin, the tip's if none is given: position (3,) and Jacobian (6, n), by MuJoCo."""
        model, data = self.robot.model, self.robot.new_data()
        data.qpos[self.robot.dofs] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        body = model.body(link or self.tip).id
        J = np.zeros((6, model.nv))
        mujoco.mj_jac(model, data, J[:3], J[3:], data.xpos[body], body)
        return data.xpos[body], J[:, self.robot.dofs]

    def record(
        self,
        reference: Trajectory,
        duration: float,
        seed: int,
        force: Callable[[float], Floats] | None = None,
        ball: Ball | None = None,
    ) -> Recorded:
        """What the sensors say while the arm follows a reference; `force` [N] pushes its tip."""
        count = round(duration / PERIOD)
        q_desired, qd_desired, qdd_desired = reference.at((np.arange(count + 1) + 0.5) * PERIOD)
        friction = self.friction(qd_desired)
        (start,), (speed,), _ = reference.at(np.zeros(1))
        hit = ball.forces(self.place(start, ball.link)[0]) if ball else None
        link = ball.link if ball else self.tip
        states, effort = np.empty((2, count + 1, len(self.home)))
        forces = np.zeros((count + 1, 3))

        def command(k: int, q: Floats, qd: Floats) -> Floats:
            # the robot's own controller knows its state better than the sensors tell us
            a = qdd_desired[k] + _FREQUENCY**2 * (q_desired[k] - q)
            a += 2 * _DAMPING * _FREQUENCY * (qd_desired[k] - qd)
            states[k], effort[k] = q, self.solver.torques(q, qd, a) + friction[k]
            place, J = self.place(q, link)
            forces[k] = hit(place) if hit else force(k * PERIOD) if force else 0.0
            return effort[k] + J[:3].T @ forces[k]

        drive(self.robot, command, start, speed, rate=round(1 / PERIOD), ticks=count + 1)
        return self._sensed(states[1:], effort[:-1], seed, forces[:-1])

    def carry_out(self, motion: Trajectory, duration: float, seed: int) -> Recorded:
        """The same of a motion that is carried out exactly: torques are those of the bodies and of friction."""
        count = round(duration / PERIOD)
        q, qd, qdd = motion.at((np.arange(count) + 0.5) * PERIOD)  # mean torques of the periods
        effort = self.solver.torques(q, qd, qdd) + self.friction(qd)
        q, _, _ = motion.at((np.arange(count) + 1.0) * PERIOD)
        return self._sensed(q, effort, seed, np.zeros((count, 3)))

    def _sensed(self, q: Floats, effort: Floats, seed: int, force: Floats) -> Recorded:
        noise = np.random.default_rng((seed, 5)).standard_normal(effort.shape)
        q = ENCODER_STEP * np.round(q / ENCODER_STEP)
        return Recorded(q, effort + TORQUE_NOISE[self.name] * noise, force)

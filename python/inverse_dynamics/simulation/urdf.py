# SPDX-License-Identifier: Apache-2.0
"""The chain of a URDF, with the limits that MuJoCo drops.

    chain = chain_from_urdf(Path("ur10.urdf").read_text(), root="base_link", tip="tool0")
    chain.joint_names, chain.lower, chain.urdf

The engine's reader checks the description and chooses the chain. MuJoCo's own reader makes bodies, joints and inertia,
so that the simulator is independent of the engine that it checks.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import FastModel, RobotDescription
from inverse_dynamics.errors import RobotError, SolverError
from inverse_dynamics.robots.descriptions import parse_description
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from inverse_dynamics.arrays import Floats


@dataclass(frozen=True)
class UrdfChain:
    """A chain of movable joints from root to tip, and the URDF made ready for MuJoCo.

    n joints. A limit that the URDF doesn't state is infinite.
    """

    name: str
    root: str
    tip: str
    joint_names: tuple[str, ...]
    moving_links: tuple[str, ...]  # n, the link right behind each joint
    lower: Floats  # (n,) rad (prismatic m)
    upper: Floats  # (n,)
    velocity: Floats  # (n,) rad/s (prismatic m/s)
    effort: Floats  # (n,) N m (prismatic N)
    acceleration: Floats  # (n,) rad/s^2 (prismatic m/s^2), of speeding up and slowing down
    jerk: Floats  # (n,) rad/s^3 (prismatic m/s^3)
    damping: Floats  # (n,) N m s/rad, stated in <dynamics>
    friction: Floats  # (n,) N m, stated in <dynamics>
    urdf: str  # joints beside the chain are locked, meshes are left out
    notes: tuple[str, ...]  # what was left out, in words


def chain_from_urdf(text: str, root: str = "", tip: str = "") -> UrdfChain:
    """The chain from link `root` to link `tip`; empty names mean the URDF's root and its only leaf.

    Movable joints that don't lie between the two are locked at zero. Raises SimulationError.
    """
    try:
        robot = parse_description(text)
        names = FastModel.from_urdf(text, root=root, tip=tip).joint_names
        described = RobotDescription(text)
        joints = described.chain(names, root)
    except (SolverError, RobotError) as error:
        reason = str(error).removeprefix("robot description: ")
        reason = reason.removesuffix(", or set allow_massless to true")  # MuJoCo can't
        raise SimulationError(f"robot description: {reason}") from error

    def limits(name: str, absent: float) -> Floats:
        return np.array([joint.limits.get(name, absent) for joint in joints])

    return UrdfChain(
        name=described.name,
        root=root or described.root,
        tip=tip or described.tip(names[-1]),
        joint_names=names,
        moving_links=tuple(joint.child for joint in joints),
        lower=limits("lower", -np.inf),
        upper=limits("upper", np.inf),
        velocity=limits("velocity", np.inf),
        effort=limits("effort", np.inf),
        acceleration=np.minimum(limits("acceleration", np.inf), limits("deceleration", np.inf)),
        jerk=limits("jerk", np.inf),
        damping=np.array([joint.damping for joint in joints]),
        friction=np.array([joint.friction for joint in joints]),
        notes=_prepare_for_mujoco(robot, names),
        urdf=ElementTree.tostring(robot, encoding="unicode"),
    )


def with_held_joints(text: str, positions: Mapping[str, float]) -> str:
    """The description with joints fixed at positions [rad, m]. Raises SimulationError."""
    if not positions:
        return text
    try:
        robot, described = parse_description(text), RobotDescription(text).joints
    except RobotError as error:
        raise SimulationError(f"robot description: {error}") from error
    of_name = {joint.name: joint for joint in described}
    if unknown := [name for name in positions if name not in of_name]:
        raise SimulationError(
            f"robot description: locked_joints: expected joints of the description, got {listed(unknown)}"
        )
    for element in robot.findall("joint"):
        name = element.get("name", "")
        if name not in positions:
            continue
        joint, q = of_name[name], positions[name]
        R, p, cross = joint.pose[:3, :3], joint.pose[:3, 3], np.cross(np.eye(3), joint.axis)
        if joint.type == "prismatic":
            p = p + R @ joint.axis * q
        else:  # Rodrigues
            R = R @ (np.eye(3) + np.sin(q) * cross + (1 - np.cos(q)) * cross @ cross)
        origin = element.find("origin")
        origin = ElementTree.SubElement(element, "origin") if origin is None else origin
        origin.set("xyz", " ".join(map(repr, p.tolist())))
        origin.set("rpy", " ".join(map(repr, _roll_pitch_yaw(R))))
        element.set("type", "fixed")
    return ElementTree.tostring(robot, encoding="unicode")


def _roll_pitch_yaw(R: Floats) -> list[float]:
    """Angles about fixed axes; yaw first, so that they fit together where pitch is a right angle."""
    yaw = np.arctan2(R[1, 0], R[0, 0])
    c, s = np.cos(yaw), np.sin(yaw)
    pitch = np.arctan2(-R[2, 0], c * R[0, 0] + s * R[1, 0])
    roll = np.arctan2(s * R[0, 2] - c * R[1, 2], c * R[1, 1] - s * R[0, 1])
    return [float(roll), float(pitch), float(yaw)]


def _prepare_for_mujoco(robot: ElementTree.Element, chain: tuple[str, ...]) -> tuple[str, ...]:
    """Leaves out meshes, which need files; locks joints beside the chain."""
    notes = []
    for joint in robot.findall("joint"):
        if joint.get("type") != "fixed" and joint.get("name") not in chain:
            joint.set("type", "fixed")
            notes.append(f"joint {joint.get('name')} is locked at zero")
    for link in robot.findall("link"):
        for kind in ("visual", "collision"):
            for shape in link.findall(kind):
                if shape.find("geometry/mesh") is None:
                    continue
                link.remove(shape)
                if kind == "collision":
                    notes.append(f"link {link.get('name')}: a collision mesh is not used")
    return tuple(notes)

# SPDX-License-Identifier: Apache-2.0
"""The chain or tree of a URDF, with the limits that MuJoCo drops.

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

from inverse_dynamics._core import RobotDescription, Solver
from inverse_dynamics.errors import RobotError, SolverError
from inverse_dynamics.robots.descriptions import parse_description, positions_of
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Container, Mapping, Sequence

    from inverse_dynamics._core import DescribedJoint
    from inverse_dynamics.arrays import Floats


@dataclass(frozen=True)
class UrdfChain:
    """A chain of movable joints from root to tip, or a tree, and the URDF made ready for MuJoCo.

    n joints that mimic no other. A limit that the URDF doesn't state is infinite.
    """

    name: str
    root: str
    tips: tuple[str, ...]  # several of a tree; the first is meant where none is named
    joint_names: tuple[str, ...]
    moves: dict[str, tuple[int, float, float]]  # as positions_of() has it, of all joints that move
    moving_links: tuple[str, ...]  # the link right behind each of them
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

    def joints_to(self, tip: str) -> tuple[str, ...]:
        """Names of the joints that move a tip, from the root on."""
        above = _joints_to((tip,), RobotDescription(self.urdf))
        return tuple(name for name in reversed(above) if name in self.moves)


def chain_from_urdf(text: str, root: str = "", tip: str = "") -> UrdfChain:
    """The chain from link `root` to link `tip`, or the tree to several; as Solver() takes them.

    Movable joints that don't lie between the two are locked at zero, or where they are by following those. Raises
    SimulationError.
    """
    try:
        robot = parse_description(text)
        solver = Solver(urdf=text, root=root, tip=tip)
        names, stated = solver.joint_names, solver.limits
        described = RobotDescription(text)
    except (SolverError, RobotError) as error:
        reason = str(error).removeprefix("robot description: ")
        reason = reason.removesuffix(", or set allow_massless to true")  # MuJoCo can't
        raise SimulationError(f"robot description: {reason}") from error

    joints = _joints_to(solver.tip_names, described)
    moves = positions_of(described, names)
    moves = {name: move for name, move in moves.items() if name in joints}
    movable = {joint.name: joint for joint in described.joints if joint.type != "fixed"}
    at_zero = positions_of(described, [n for n, joint in movable.items() if joint.mimic is None])
    beside = {n: q for n, (*_, q) in at_zero.items() if q and n in movable and n not in moves}
    if beside:
        robot = parse_description(with_held_joints(text, beside))

    def limit(name: str) -> Floats:
        return np.asarray(stated.get(name, np.full(len(names), np.inf)))

    damping, friction = np.zeros((2, len(names)))
    for name, (i, factor, _) in moves.items():
        damping[i] += factor**2 * joints[name].damping
        friction[i] += abs(factor) * joints[name].friction
    return UrdfChain(
        name=described.name,
        root=root or described.root,
        tips=solver.tip_names,
        joint_names=names,
        moves=moves,
        moving_links=tuple(joints[name].child for name in moves),
        lower=limit("lower"),
        upper=limit("upper"),
        velocity=limit("velocity"),
        effort=limit("effort"),
        acceleration=np.minimum(limit("acceleration"), limit("deceleration")),
        jerk=limit("jerk"),
        damping=damping,
        friction=friction,
        notes=(
            *_prepare_for_mujoco(robot, moves),
            *(
                f"joint {name} is locked at {place:g}, as it mimics"
                for name, place in beside.items()
            ),
        ),
        urdf=ElementTree.tostring(robot, encoding="unicode"),
    )


def _joints_to(tips: Sequence[str], robot: RobotDescription) -> dict[str, DescribedJoint]:
    """The joints above the tips, by name."""
    by_child = {joint.child: joint for joint in robot.joints}
    found = {}
    for link in tips:
        while (joint := by_child.get(link)) is not None:
            found[joint.name], link = joint, joint.parent
    return found


def with_held_joints(text: str, positions: Mapping[str, float]) -> str:
    """The description with joints, and those that mimic them, fixed at positions [rad, m]. Raises SimulationError."""
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
    values = [*positions.values()]
    positions = {
        name: factor * values[i] + offset
        for name, (i, factor, offset) in positions_of(RobotDescription(text), [*positions]).items()
    }
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
        for mimic in element.findall("mimic"):
            element.remove(mimic)
    return ElementTree.tostring(robot, encoding="unicode")


def _roll_pitch_yaw(R: Floats) -> list[float]:
    """Angles about fixed axes; yaw first, so that they fit together where pitch is a right angle."""
    yaw = np.arctan2(R[1, 0], R[0, 0])
    c, s = np.cos(yaw), np.sin(yaw)
    pitch = np.arctan2(-R[2, 0], c * R[0, 0] + s * R[1, 0])
    roll = np.arctan2(s * R[0, 2] - c * R[1, 2], c * R[1, 1] - s * R[0, 1])
    return [float(roll), float(pitch), float(yaw)]


def _prepare_for_mujoco(robot: ElementTree.Element, chain: Container[str]) -> tuple[str, ...]:
    """Leaves out meshes, which need files; locks joints beside the chain."""
    notes = []
    for joint in robot.findall("joint"):
        if joint.get("type") != "fixed" and joint.get("name") not in chain:
            joint.set("type", "fixed")
            for mimic in joint.findall("mimic"):
                joint.remove(mimic)
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

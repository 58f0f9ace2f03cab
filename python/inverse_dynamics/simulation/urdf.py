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

if TYPE_CHECKING:
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

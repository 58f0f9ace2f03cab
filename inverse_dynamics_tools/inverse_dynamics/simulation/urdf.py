# SPDX-License-Identifier: Apache-2.0
"""What the simulator needs to know of a URDF beyond what MuJoCo reads by itself.

    chain = chain_from_urdf(Path("ur10.urdf").read_text(), root="base_link", tip="tool0")
    chain.joint_names, chain.lower, chain.urdf

MuJoCo's own reader makes bodies, joints and inertia, so that the simulator is independent of the engine it is used to
check. Here stand the choice of the chain, the limits, and the numbers MuJoCo changes or drops while reading.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.wording import harmless, listed, shown
from inverse_dynamics.robot.chain_geometry import rotation_of
from inverse_dynamics.robot.descriptions import fixed_above, link_of, numbers_of, parse_description
from inverse_dynamics.simulation.errors import SimulationError

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats

_MOVING = {"revolute", "continuous", "prismatic"}
_IMPOSSIBLE = {"planar", "floating"}


@dataclass(frozen=True)
class Inertia:
    """Inertia of one link as the URDF states it: mass [kg], tensor [kg m^2] about the center of mass."""

    mass: float
    center: Floats  # (3,) m, in the link's frame
    tensor: Floats  # (3, 3), along the axes of the link's frame


NO_INERTIA = Inertia(0.0, np.zeros(3), np.zeros((3, 3)))


@dataclass(frozen=True)
class UrdfChain:
    """A chain of movable joints from root to tip, and the URDF made ready for MuJoCo.

    n joints. A limit the URDF doesn't state is infinite.
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
    damping: Floats  # (n,) N m s/rad, what <dynamics> says
    friction: Floats  # (n,) N m, what <dynamics> says
    inertia: dict[str, Inertia]  # by link
    urdf: str  # joints beside the chain are locked, meshes are left out
    notes: tuple[str, ...]  # what was left out, in words


def chain_from_urdf(text: str, root: str = "", tip: str = "") -> UrdfChain:
    """The chain from link `root` to link `tip`; empty names mean the URDF's root and its only leaf.

    Movable joints that don't lie between the two are locked at zero.
    """
    robot = parse_description(text, raised=SimulationError)
    links = [link.get("name", "") for link in robot.findall("link")]
    joints = robot.findall("joint")
    _check_names("link", links)
    _check_names("joint", [joint.get("name", "") for joint in joints])
    for joint in joints:
        _check_joint(joint, links)
    joint_above = {link_of(joint, "child"): joint for joint in joints}
    if len(joint_above) < len(joints):
        raise SimulationError("robot description: expected a tree, got a link below two joints")
    tree_root = _tree_root(links, joint_above)
    root = root or tree_root
    tip = tip or _only_leaf(links, joint_above)
    for role, link in (("root", root), ("tip", tip)):
        if link not in links:
            raise SimulationError(
                f"robot description: there is no {role} link {shown(link)}; links: {listed(links, 20)}"
            )
    for joint in joint_above.values():
        for tag, attribute in (("origin", "xyz"), ("origin", "rpy"), ("axis", "xyz")):
            _vector(joint.find(tag), attribute)
    chain = _movable_joints(root, tip, joint_above)
    if not chain:
        raise SimulationError(f"robot description: no joint moves between '{root}' and '{tip}'")
    names = tuple(joint.get("name", "") for joint in chain)
    limits = [joint.find("limit") for joint in chain]
    dynamics = [joint.find("dynamics") for joint in chain]
    inertia = _inertia_of_links(robot)
    notes = _prepare_for_mujoco(robot, set(names))
    bounded = np.array([joint.get("type") != "continuous" for joint in chain])
    return UrdfChain(
        name=robot.get("name", ""),
        root=root,
        tip=tip,
        joint_names=names,
        moving_links=tuple(link_of(joint, "child") for joint in chain),
        lower=np.where(bounded, _numbers(limits, "lower", -np.inf), -np.inf),
        upper=np.where(bounded, _numbers(limits, "upper", np.inf), np.inf),
        velocity=_numbers(limits, "velocity", np.inf),
        effort=_numbers(limits, "effort", np.inf),
        damping=_numbers(dynamics, "damping", 0.0),
        friction=_numbers(dynamics, "friction", 0.0),
        inertia=inertia,
        urdf=ElementTree.tostring(robot, encoding="unicode"),
        notes=notes,
    )


def _check_names(kind: str, names: list[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if not name or name in seen:
            got = f"{shown(name)} twice" if name else "none"
            raise SimulationError(
                f"robot description: {kind}: expected a name of its own, got {got}"
            )
        seen.add(name)


def _check_joint(joint: ElementTree.Element, links: list[str]) -> None:
    where = f"robot description: joint {harmless(joint.get('name'))}"
    for role in ("parent", "child"):
        if link_of(joint, role) not in links:
            got = shown(link_of(joint, role))
            raise SimulationError(f"{where}: {role}: expected a link of the description, got {got}")
    kind = joint.get("type", "")
    if kind not in {*_MOVING, *_IMPOSSIBLE, "fixed"}:
        raise SimulationError(
            f"{where}: expected a type, such as revolute or fixed, got {shown(kind)}"
        )


def _tree_root(links: list[str], joint_above: dict[str, ElementTree.Element]) -> str:
    roots = [link for link in links if link not in joint_above]
    if len(roots) != 1:
        raise SimulationError(
            "robot description: expected one link without a joint above it, "
            f"got {len(roots)}: {listed(roots)}"
        )
    return roots[0]


def _only_leaf(links: list[str], joint_above: dict[str, ElementTree.Element]) -> str:
    """The leaf, or any of several that lie below the same movable joints."""
    parents = {link_of(joint, "parent") for joint in joint_above.values()}
    leaves = [link for link in links if link not in parents]
    paths = {
        tuple(j.get("name", "") for j in _movable_joints(None, leaf, joint_above))
        for leaf in leaves
    }
    if len(paths) != 1:
        raise SimulationError(
            f"robot description: several tips are possible: {listed(leaves, 20)}; name one as `tip`"
        )
    return leaves[-1]


def _movable_joints(
    root: str | None, tip: str, joint_above: dict[str, ElementTree.Element]
) -> list[ElementTree.Element]:
    """Movable joints from root (None: the URDF's root) to tip, in that order."""
    found = []
    link, ends = tip, {} if root is None else fixed_above(root, joint_above)
    for _ in range(len(joint_above) + 1):
        if link in ends or link not in joint_above:
            break
        joint = joint_above[link]
        kind = joint.get("type", "")
        if kind in _IMPOSSIBLE or (kind in _MOVING and joint.find("mimic") is not None):
            what = "mimic" if joint.find("mimic") is not None else kind
            raise SimulationError(
                f"robot description: joint {joint.get('name')}: expected revolute, continuous, "
                f"prismatic or fixed, got {what}"
            )
        if kind in _MOVING:
            found.append(joint)
        link = link_of(joint, "parent")
    if root is not None and link not in ends:
        raise SimulationError(
            f"robot description: tip '{tip}' is not below root '{root}' or a link that it is fixed to; a "
            "simulated robot stands on the root of its description: choose a root nearer to that"
        )
    return found[::-1]


def _numbers(elements: list[ElementTree.Element | None], attribute: str, absent: float) -> Floats:
    """One attribute of each element; `absent` where element or attribute is missing."""
    return np.array(
        [
            absent
            if element is None or element.get(attribute) is None
            else _vector(element, attribute, 1)[0]
            for element in elements
        ]
    )


def _vector(element: ElementTree.Element | None, attribute: str, length: int = 3) -> Floats:
    """Numbers of an attribute; zeros where element or attribute is missing."""
    text = None if element is None else element.get(attribute)
    if element is None or text is None:
        return np.zeros(length)
    return np.array(numbers_of(element, attribute, length, SimulationError))


def _inertia_of_links(robot: ElementTree.Element) -> dict[str, Inertia]:
    found = {}
    for link in robot.findall("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        origin, mass, tensor = (inertial.find(tag) for tag in ("origin", "mass", "inertia"))
        if mass is None or tensor is None:
            raise SimulationError(
                f"robot description: link {link.get('name')}: <inertial> needs <mass> and <inertia>"
            )
        xx, xy, xz, yy, yz, zz = (
            _vector(tensor, key, 1)[0] for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        )
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        rotation = rotation_of(_vector(origin, "rpy"))
        found[link.get("name", "")] = Inertia(
            mass=_vector(mass, "value", 1)[0],
            center=_vector(origin, "xyz"),
            tensor=rotation @ matrix @ rotation.T,
        )
    return found


def _prepare_for_mujoco(robot: ElementTree.Element, chain: set[str]) -> tuple[str, ...]:
    """Leaves out meshes, which need files; locks joints beside the chain."""
    notes = []
    for joint in robot.findall("joint"):
        if joint.get("type") in _MOVING and joint.get("name") not in chain:
            joint.set("type", "fixed")
            notes.append(f"joint {joint.get('name')} is locked at zero")
    for link in robot.findall("link"):
        for visual in link.findall("visual"):
            if visual.find("geometry/mesh") is not None:
                link.remove(visual)
        for collision in link.findall("collision"):
            if collision.find("geometry/mesh") is not None:
                link.remove(collision)
                notes.append(f"link {link.get('name')}: a collision mesh is not used")
    return tuple(notes)

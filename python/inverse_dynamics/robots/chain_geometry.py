# SPDX-License-Identifier: Apache-2.0
"""Where the joints of a description's chain are: what a model file states as `placements`.

    chain = chain_geometry(Path("ur10.urdf").read_text(), "base_link", solver.joint_names)
    chain[0].xyz, chain[0].rpy, chain[0].axis

Fixed joints between two movable ones are lumped into the placement of the second. Numbers are those of
the description, unless fixed joints have to be multiplied.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import RobotError
from inverse_dynamics.robots.descriptions import (
    fixed_above,
    link_of,
    numbers_of,
    numbers_or,
    parse_description,
    root_link,
)
from inverse_dynamics.robots.located_yaml import read_mapping
from inverse_dynamics.wording import shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from inverse_dynamics.arrays import Floats


@dataclass(frozen=True)
class JointGeometry:
    """A movable joint of a chain: its frame in that of the link above, and its axis in its own."""

    name: str
    type: str  # revolute, continuous or prismatic
    link: str  # that it moves
    xyz: Floats  # (3,) m, in the frame of the parent link of the chain
    rpy: Floats  # (3,) rad: roll, pitch, yaw about fixed axes
    axis: Floats  # (3,) of length 1, in the joint's frame
    limits: Mapping[str, float] = field(default_factory=dict)  # lower, upper, velocity, effort

    @property
    def pose(self) -> Floats:
        """(4, 4) of the link's frame in that of the parent link, at q = 0."""
        return _pose(self.xyz, self.rpy)

    @property
    def rotation_from_z(self) -> Floats:
        """R_UE (3, 3): E is the engine's frame of the link, whose z is the axis; U the description's.

        The same turn as in chain_dynamics (joint_frame.cpp), where link parameters are stated in E.
        """
        axis = self.axis
        if axis[2] < 0:
            flip = np.array([1.0, -1.0, -1.0])
            return flip[:, None] * _turn_from_z(flip * axis)
        return _turn_from_z(axis)


def chain_geometry(
    description: str, root: str, joint_names: Sequence[str]
) -> tuple[JointGeometry, ...]:
    """The joints of these names, each the next movable one below the one before. Raises RobotError.

    root: the link at which the chain begins; "": the description's root.
    """
    robot = parse_description(description)
    above = {link_of(joint, "child"): joint for joint in robot.findall("joint")}
    by_name = {joint.get("name"): joint for joint in above.values()}
    parent = root or root_link(description)
    chain = []
    for name in joint_names:
        joint = by_name.get(name)
        if joint is None:
            raise RobotError(f"robot description: expected a joint {shown(name)}, got none")
        xyz, rpy = _placement(*_path(above, parent, joint))
        parent = link_of(joint, "child")
        kind = joint.get("type", "")
        chain.append(JointGeometry(name, kind, parent, xyz, rpy, _axis(joint), _limits(joint)))
    return tuple(chain)


def model_limits(file: Path) -> list[dict[str, float]]:
    """Stated limits of the joints of a model file, which a solver has read."""
    joints = read_mapping(file, RobotError).required("joints").entries()
    stated = [joint.mapping().optional("limits") for joint in joints]
    names = ("lower", "upper", "velocity", "effort")
    return [
        {name: one.number() for name in names if (one := limits.mapping().optional(name))}
        if limits
        else {}
        for limits in stated
    ]


def rotation_of(rpy: Floats) -> Floats:
    """(3, 3) R = RotZ(yaw) RotY(pitch) RotX(roll), as URDF defines it. rpy: (3,) rad."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def roll_pitch_yaw(rotation: Floats) -> Floats:
    """(3,) rad of a rotation matrix: the inverse of rotation_of()."""
    R = rotation
    yaw = np.arctan2(R[1, 0], R[0, 0])
    pitch = np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))
    # of RotZ(yaw)' R, exact for any yaw where the pitch is near 90 degrees
    s, c = np.sin(yaw), np.cos(yaw)
    roll = np.arctan2(s * R[0, 2] - c * R[1, 2], c * R[1, 1] - s * R[0, 1])
    return np.array([roll, pitch, yaw])


def _path(
    above: Mapping[str, Element], parent: str, joint: Element
) -> tuple[list[Element], list[Element]]:
    """Fixed joints up from a link, the topmost first, and from there down to a joint, with that joint."""
    up = fixed_above(parent, above)
    path = [joint]
    while (link := link_of(path[0], "parent")) not in up:
        step = above.get(link)
        if step is None or len(path) > len(above):
            raise RobotError(
                f"robot description: joint {joint.get('name')}: expected it below link {parent}, or below one "
                "that is fixed to it; choose a root nearer to that of the description"
            )
        path.insert(0, step)
    return up[link], path


def _placement(up: Sequence[Element], down: Sequence[Element]) -> tuple[Floats, Floats]:
    if len(down) == 1 and not up:  # the numbers of the description, not rounded
        return _origin(down[0])
    to_start, to_joint = (_product(joints) for joints in (up, down))
    pose: Floats = np.array(np.linalg.solve(to_start, to_joint), dtype=np.float64)
    return pose[:3, 3], roll_pitch_yaw(pose[:3, :3])


def _product(joints: Sequence[Element]) -> Floats:
    pose = np.eye(4)
    for joint in joints:
        pose = pose @ origin_pose(joint)
    return pose


def origin_pose(element: Element) -> Floats:
    """(4, 4) of the <origin> of a joint or a shape."""
    return _pose(*_origin(element))


def _origin(element: Element) -> tuple[Floats, Floats]:
    origin, zero = element.find("origin"), (0.0, 0.0, 0.0)
    return np.array(numbers_or(origin, "xyz", zero)), np.array(numbers_or(origin, "rpy", zero))


def _axis(joint: Element) -> Floats:
    axis = np.array(numbers_or(joint.find("axis"), "xyz", (1.0, 0.0, 0.0)))
    return np.asarray(axis / np.linalg.norm(axis))


def _limits(joint: Element) -> dict[str, float]:
    """Stated limits; a velocity or effort of zero states none."""
    limit = joint.find("limit")
    if limit is None:
        return {}
    bounds = () if joint.get("type") == "continuous" else ("lower", "upper")
    names = [name for name in (*bounds, "velocity", "effort") if limit.get(name) is not None]
    found = {name: numbers_of(limit, name, 1)[0] for name in names}
    return {name: value for name, value in found.items() if name in bounds or value > 0}


def _pose(xyz: Floats, rpy: Floats) -> Floats:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation_of(rpy), xyz
    return pose


def _turn_from_z(axis: Floats) -> Floats:
    """The least turn that takes z to the axis, which isn't below the horizon."""
    x, y, z = axis
    cross = np.array([[0, 0, x], [0, 0, y], [-x, -y, 0]], float)  # of z x axis
    turn: Floats = np.eye(3) + cross + cross @ cross / (1 + z)
    return turn

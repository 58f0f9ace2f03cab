# SPDX-License-Identifier: Apache-2.0
"""A robot's links and shapes as the report's 3D view wants them, read from a URDF.

    links = scene_from_urdf(Path("ur10.urdf").read_text(), ["shoulder_pan_joint", ...])

Only boxes, cylinders and spheres are drawn: a mesh lives in a file beside the URDF, and the report is one file.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inverse_dynamics.errors import RobotError
from inverse_dynamics.robot.descriptions import numbers_of, parse_description

Matrix = NDArray[np.float64]
DEFAULT_COLOR = (0.72, 0.75, 0.79)


def scene_from_urdf(urdf: str, joints: Sequence[str]) -> list[dict[str, Any]]:
    """Links in an order in which parents come first; empty where the URDF has nothing to draw.

    `joints`: names of the joints that move, in the order of the recorded positions; all others stay at zero.
    A link: parent (index or -1), joint (index in `joints` or -1), kind, axis, pose in its parent (4 x 4, column by
    column, m) and shapes: kind, size (as in the URDF, m), pose in the link, color (red, green, blue in 0..1).
    """
    robot = parse_description(urdf)
    shapes = _shapes_by_link(robot)
    if not any(shapes.values()):
        return []
    by_parent: dict[str, list[ElementTree.Element]] = {}
    children = set()
    for joint in robot.findall("joint"):
        by_parent.setdefault(_link_of(joint, "parent"), []).append(joint)
        children.add(_link_of(joint, "child"))
    index = {name: i for i, name in enumerate(joints)}
    links: list[dict[str, Any]] = []
    waiting: list[tuple[str, int, ElementTree.Element | None]] = [
        (name, -1, None) for name in shapes if name not in children
    ]
    while waiting:
        name, parent, above = waiting.pop(0)
        if len(links) > len(shapes):
            raise RobotError("robot description: expected a tree, got a link below two joints")
        links.append(_link(parent, above, index, shapes.get(name, [])))
        here = len(links) - 1
        waiting.extend((_link_of(child, "child"), here, child) for child in by_parent.get(name, []))
    return links


def _link_of(joint: ElementTree.Element, role: str) -> str:
    element = joint.find(role)
    return "" if element is None else element.get("link", "")


def _link(
    parent: int,
    joint: ElementTree.Element | None,
    index: dict[str, int],
    shapes: list[dict[str, Any]],
) -> dict[str, Any]:
    axis = [0.0, 0.0, 1.0]
    if joint is not None:
        axis = _numbers(joint.find("axis"), "xyz", 3, (1.0, 0.0, 0.0))
    length = math.hypot(*axis) or 1.0
    return {
        "parent": parent,
        "joint": -1 if joint is None else index.get(joint.get("name", ""), -1),
        "kind": "fixed" if joint is None else joint.get("type", "fixed"),
        "axis": [component / length for component in axis],
        "pose": _columns(_pose(None if joint is None else joint.find("origin"))),
        "shapes": shapes,
    }


def _shapes_by_link(robot: ElementTree.Element) -> dict[str, list[dict[str, Any]]]:
    colors = {
        material.get("name", ""): color
        for material in robot.iter("material")
        if (color := _color(material)) is not None
    }
    result: dict[str, list[dict[str, Any]]] = {}
    for link in robot.findall("link"):
        found = [_shape(visual, colors) for visual in link.findall("visual")]
        result[link.get("name", "")] = [shape for shape in found if shape is not None]
    return result


def _shape(visual: ElementTree.Element, colors: dict[str, list[float]]) -> dict[str, Any] | None:
    geometry = visual.find("geometry")
    if geometry is None or len(geometry) == 0:
        return None
    element = geometry[0]
    sizes = {
        "box": {"size": 3},
        "cylinder": {"radius": 1, "length": 1},
        "sphere": {"radius": 1},
    }
    if element.tag not in sizes:
        return None
    material = visual.find("material")
    color = None
    if material is not None:
        color = _color(material) or colors.get(material.get("name", ""))
    return {
        "kind": element.tag,
        "size": [
            number
            for key, count in sizes[element.tag].items()
            for number in numbers_of(element, key, count, RobotError)
        ],
        "pose": _columns(_pose(visual.find("origin"))),
        "color": color or list(DEFAULT_COLOR),
    }


def _color(material: ElementTree.Element) -> list[float] | None:
    element = material.find("color")
    return None if element is None else _numbers(element, "rgba", 4, (*DEFAULT_COLOR, 1.0))[:3]


def _numbers(
    element: ElementTree.Element | None, key: str, count: int, default: Sequence[float]
) -> list[float]:
    if element is None or element.get(key) is None:
        return list(default)
    return numbers_of(element, key, count, RobotError)


def _pose(origin: ElementTree.Element | None) -> Matrix:
    """X: the pose of an <origin>: fixed-axis roll, pitch, yaw."""
    roll, pitch, yaw = _numbers(origin, "rpy", 3, (0.0, 0.0, 0.0))
    cr, sr, cp, sp, cy, sy = (
        function(angle) for angle in (roll, pitch, yaw) for function in (math.cos, math.sin)
    )
    pose = np.eye(4)
    pose[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    pose[:3, 3] = _numbers(origin, "xyz", 3, (0.0, 0.0, 0.0))
    return pose


def _columns(pose: Matrix) -> list[float]:
    return [round(float(value), 9) for value in pose.T.ravel()]

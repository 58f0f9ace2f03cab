# SPDX-License-Identifier: Apache-2.0
"""A robot's links and shapes as the report's 3D view wants them, read from a URDF.

    scene = read_scene(Path("ur10.urdf"), ["shoulder_pan_joint", ...])
    scene.links, scene.notes

Boxes, cylinders, spheres and meshes (meshes.py). Links whose shapes can't be drawn get a skeleton instead:
a bar to each joint below, and a drum about the axis of each joint that moves.
"""

from __future__ import annotations

import base64
import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inverse_dynamics._core import DescribedJoint, RobotDescription
from inverse_dynamics.decimals import decimal
from inverse_dynamics.errors import RobotError
from inverse_dynamics.installation.extras import MissingPackageError
from inverse_dynamics.robots.descriptions import (
    parse_description,
    positions_of,
    read_description,
)
from inverse_dynamics.show.meshes import MeshError, MeshPart, find_mesh, read_mesh
from inverse_dynamics.wording import counted, harmless, shown

Matrix = NDArray[np.float64]
DEFAULT_COLOR = (0.72, 0.75, 0.79)
BONE_COLOR = (0.62, 0.66, 0.71)
JOINT_COLOR = (0.36, 0.45, 0.56)
MOST_MESHES = 500  # of a robot
MOST_TRIANGLES = 24_000  # of a robot's meshes together: 0.4 MB of a page


@dataclass(frozen=True)
class Scene:
    """Links in an order in which parents come first, and what of them isn't drawn as described.

    A link: parent (index or -1), joint (index of the joints that move or -1), factor and offset (the joint's position
    is factor q + offset: 1 and 0 unless it mimics that joint), kind, axis, pose in its parent
    (4 x 4, column by column, m) and shapes: kind, pose in the link, color (red, green, blue in 0..1), and
    size (as in the URDF, m) or, of a mesh, what encoded_mesh() gives.
    """

    links: list[dict[str, Any]] = field(default_factory=list)
    notes: tuple[str, ...] = ()


def read_scene(file: Path, joints: Sequence[str]) -> Scene:
    """The scene of a .urdf or .xacro file with the meshes that it names. Raises RobotError.

    joints: names of the joints that move, in the order of the recorded positions; all others stay at zero.
    """
    return scene_of(read_description(file), joints, file.parent)


def scene_of(urdf: str, joints: Sequence[str], directory: Path) -> Scene:
    """The scene of a URDF's text; names of meshes are relative to the directory."""
    robot = RobotDescription(urdf)
    moves = positions_of(robot, joints)
    reader = _Shapes(parse_description(urdf), directory)
    by_parent: dict[str, list[DescribedJoint]] = {}
    for joint in robot.joints:
        by_parent.setdefault(joint.parent, []).append(joint)
    links: list[dict[str, Any]] = []
    bare: list[bool] = []  # of each link: whether something of it isn't drawn
    waiting: list[tuple[str, int, DescribedJoint | None]] = [(robot.root, -1, None)]
    for name, parent, above in waiting:  # grows
        links.append(_link(parent, above, moves, reader.by_link[name]))
        bare.append(name in reader.missing)
        here = len(links) - 1
        waiting += [(child.child, here, child) for child in by_parent.get(name, [])]
    if not any(link["shapes"] for link in links):
        bare = [True] * len(links)
    _add_skeleton(links, bare)
    return Scene(links if any(link["shapes"] for link in links) else [], reader.notes())


def _add_skeleton(links: list[dict[str, Any]], bare: Sequence[bool]) -> None:
    """Bars and drums for the links that are bare: in proportion to the robot's reach."""
    places = [np.array(link["pose"]).reshape(4, 4).T for link in links]
    lengths = [math.hypot(*map(float, place[:3, 3])) for place in places]
    if not max(lengths, default=0.0) < 1e6:  # m: numbers of no robot
        return
    reach = sum(lengths[1:]) or 1.0
    thick = 0.025 * min(reach, 4.0 * max(lengths, default=1.0) or reach)
    for i, link in enumerate(links):
        if link["joint"] >= 0 and bare[i]:
            size = [1.5 * thick, 3.2 * thick]
            turn = _pose_along(np.zeros(3), np.array(link["axis"]))
            link["shapes"].append(_plain("cylinder", size, turn, JOINT_COLOR))
        above = link["parent"]
        if above >= 0 and bare[above] and lengths[i] > 0.2 * thick:
            end = places[i][:3, 3]
            bar = _pose_along(end / 2, end / lengths[i])
            links[above]["shapes"] += [
                _plain("cylinder", [thick, lengths[i]], bar, BONE_COLOR),
                _plain("sphere", [thick], _pose_along(end, np.array([0.0, 0.0, 1.0])), BONE_COLOR),
            ]


def _plain(kind: str, size: list[float], pose: Matrix, color: Sequence[float]) -> dict[str, Any]:
    size = [round(number, 6) for number in size]
    return {"kind": kind, "size": size, "pose": _columns(pose), "color": list(color)}


def _pose_along(place: Matrix, z: Matrix) -> Matrix:
    """A pose there whose z axis has that direction, of length 1."""
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    pose[:3, 3] = place
    return pose


def encoded_mesh(vertices: Matrix, triangles: NDArray[np.int64]) -> dict[str, Any]:
    """A mesh as text: middle + step * 16-bit integers, and 16-bit indices; base64, little-endian."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = (low + high) / 2
    step = float((high - low).max()) / 2 / 32767 or 1e-9
    return {
        "middle": [float(value) for value in middle],
        "step": step,
        "vertices": base64_of(np.rint((vertices - middle) / step), "<i2"),
        "triangles": base64_of(triangles, "<u2"),
    }


def base64_of(array: NDArray[Any], dtype: str) -> str:
    """The numbers, of a type that scripts of pages read."""
    return base64.b64encode(np.ascontiguousarray(array, dtype=dtype).tobytes()).decode("ascii")


def _link(
    parent: int,
    joint: DescribedJoint | None,
    moves: Mapping[str, tuple[int, float, float]],
    shapes: list[dict[str, Any]],
) -> dict[str, Any]:
    link = {"parent": parent, "joint": -1, "kind": "fixed", "axis": [0.0, 0.0, 1.0]}
    pose = np.eye(4)
    if joint is not None:
        link["joint"], link["factor"], link["offset"] = moves.get(joint.name, (-1, 1.0, 0.0))
        link["kind"] = joint.type
        link["axis"] = joint.axis.tolist()
        pose = joint.pose
    return {**link, "pose": _columns(pose), "shapes": shapes}


class _Shapes:
    """Shapes of each link, and those that can't be drawn."""

    def __init__(self, robot: ElementTree.Element, directory: Path) -> None:
        self._directory = directory
        self._colors = {
            material.get("name", ""): color
            for material in robot.iter("material")
            if (color := _color(material)) is not None
        }
        self._mesh_count = sum(1 for _ in robot.iterfind("link/visual/geometry/mesh"))
        self._parts: dict[Path, list[MeshPart]] = {}  # a file may be drawn several times
        self.missing: dict[str, str] = {}  # why, by link
        self.by_link: dict[str, list[dict[str, Any]]] = {}
        for link in robot.findall("link"):
            name = link.get("name", "")
            self.by_link[name] = []
            for visual in link.findall("visual"):
                self.by_link[name] += self._shapes(visual, name)

    def notes(self) -> tuple[str, ...]:
        """What isn't drawn, and the first reason."""
        if not self.missing:
            return ()
        reason = next(iter(self.missing.values()))
        count = counted(len(self.missing), "link")
        return (f"{count} drawn as a skeleton: {harmless(reason, 300)}",)

    def _shapes(self, visual: ElementTree.Element, link: str) -> list[dict[str, Any]]:
        geometry = visual.find("geometry")
        if geometry is None or len(geometry) == 0:
            return []
        element, pose, color = geometry[0], _pose(visual.find("origin")), self._color_of(visual)
        if element.tag == "mesh":
            try:
                return self._meshes(element, pose, color)
            except (MeshError, MissingPackageError) as error:
                self.missing[link] = str(error)
        if element.tag not in _SIZES:
            return []
        size = [
            number
            for key, count in _SIZES[element.tag].items()
            for number in _numbers(element, key, count)
        ]
        shape = {"kind": element.tag, "size": size}
        return [{**shape, "pose": _columns(pose), "color": color or list(DEFAULT_COLOR)}]

    def _meshes(
        self, element: ElementTree.Element, pose: Matrix, color: list[float] | None
    ) -> list[dict[str, Any]]:
        scale = np.array(_numbers_or(element, "scale", (1.0, 1.0, 1.0)))
        if self._mesh_count > MOST_MESHES:
            raise MeshError(f"expected at most {MOST_MESHES} meshes, got {self._mesh_count}")
        file = find_mesh(element.get("filename", ""), self._directory)
        if file not in self._parts:
            self._parts[file] = read_mesh(file, MOST_TRIANGLES // self._mesh_count)
        return [
            {
                "kind": "mesh",
                "size": [1.0, 1.0, 1.0],
                "pose": _columns(pose),
                "color": color or part.color or list(DEFAULT_COLOR),
                **encoded_mesh(scale * part.vertices, part.triangles),
            }
            for part in self._parts[file]
        ]

    def _color_of(self, visual: ElementTree.Element) -> list[float] | None:
        material = visual.find("material")
        if material is None:
            return None
        return _color(material) or self._colors.get(material.get("name", ""))


_SIZES = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
}


def _color(material: ElementTree.Element) -> list[float] | None:
    element = material.find("color")
    return None if element is None else _numbers_or(element, "rgba", (*DEFAULT_COLOR, 1.0))[:3]


def _columns(pose: Matrix) -> list[float]:
    return [round(float(value), 9) for value in pose.T.ravel()]


def _numbers(element: ElementTree.Element, attribute: str, length: int) -> list[float]:
    """Finite numbers of an attribute that is there."""
    text = element.get(attribute, "")
    try:
        numbers = [decimal(word) for word in text.split()]
    except ValueError:
        numbers = []
    if len(numbers) != length or not all(map(math.isfinite, numbers)):
        what = "a finite number" if length == 1 else f"{length} finite numbers"
        raise RobotError(
            f"robot description: <{element.tag} {attribute}=...>: expected {what}, got {shown(text)}"
        )
    return numbers


def _numbers_or(
    element: ElementTree.Element | None, attribute: str, absent: Sequence[float]
) -> list[float]:
    """Finite numbers of an attribute, as many as `absent`, which stands for one that isn't there."""
    if element is None or element.get(attribute) is None:
        return list(absent)
    return _numbers(element, attribute, len(absent))


def _pose(origin: ElementTree.Element | None) -> Matrix:
    """(4, 4) of an <origin>: R = RotZ(yaw) RotY(pitch) RotX(roll)."""
    pose = np.eye(4)
    pose[:3, 3] = _numbers_or(origin, "xyz", (0.0, 0.0, 0.0))
    rpy = _numbers_or(origin, "rpy", (0.0, 0.0, 0.0))
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    pose[:3, :3] = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return pose

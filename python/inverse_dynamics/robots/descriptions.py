# SPDX-License-Identifier: Apache-2.0
"""Robot descriptions: the text of a URDF file, or of a .xacro file after xacro."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import RobotError
from inverse_dynamics.installation.extras import require
from inverse_dynamics.robots.reading import read_bytes
from inverse_dynamics.wording import harmless, shown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from inverse_dynamics._core import RobotDescription

_MOST_LEVELS = 50


class _DocumentTypeError(Exception):
    """Entities are defined in it: a few lines may stand for gigabytes, or for another file."""


def read_description(file: Path) -> str:
    """URDF text of a .urdf or .xacro file, or of a .yaml file of Denavit-Hartenberg parameters.

    Arguments of xacro may stand behind the name: `arm.urdf.xacro prefix:=left_`. Raises RobotError,
    MissingPackageError.
    """
    name, xacro, arguments = f"{file}".partition(".xacro ")
    file = Path(name + xacro.rstrip()) if xacro else file
    if not os.path.isfile(file):  # Path.is_file() raises where the path is too long
        what = "is a directory" if os.path.isdir(file) else "no such file"
        raise RobotError(f"{file}: {what}; expected a robot description (URDF or .xacro)")
    if file.suffix == ".xacro":
        return _expanded(file, arguments.split())
    data = read_bytes(file, "a URDF", RobotError)
    if not data.strip():
        raise RobotError(f"{file}: is empty; expected a URDF")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise RobotError(f"{file}: isn't text in UTF-8; expected a URDF") from error
    if file.suffix in (".yaml", ".yml"):
        from inverse_dynamics.robots.dh_tables import urdf_of_dh

        return urdf_of_dh(text, f"{file}")
    if not text.lstrip().startswith("<"):
        raise RobotError(f"{file}: isn't XML; expected a URDF, got {shown(text.strip(), 20)}")
    return text


def positions_of(
    robot: RobotDescription, joints: Sequence[str]
) -> dict[str, tuple[int, float, float]]:
    """Positions of these joints and those that mimic them, by name, as (i, factor, offset): factor q[i] + offset."""
    moves = {name: (i, 1.0, 0.0) for i, name in enumerate(joints)}
    for _ in robot.joints:  # a joint may mimic one that mimics another
        for joint in robot.joints:
            if joint.mimic is not None and joint.name not in moves and joint.mimic[0] in moves:
                leader, multiplier, offset = joint.mimic
                i, factor, start = moves[leader]
                moves[joint.name] = (i, multiplier * factor, multiplier * start + offset)
    return moves


def parse_description(text: str, where: object = "robot description") -> Element:
    """The element <robot> of a URDF, its quaternions as angles. Raises RobotError for what isn't one."""
    import xml.etree.ElementTree as ElementTree

    class Builder(ElementTree.TreeBuilder):
        def doctype(self, *_: object) -> None:
            raise _DocumentTypeError

    try:
        robot = ElementTree.fromstring(text, ElementTree.XMLParser(target=Builder()))
    except _DocumentTypeError:
        raise RobotError(
            f"{where}: expected no document type, got one; no URDF needs it: remove it"
        ) from None
    except (ElementTree.ParseError, ValueError) as error:
        raise RobotError(f"{where}: isn't a robot description: no XML ({error})") from error
    if robot.tag != "robot":
        raise RobotError(
            f"{where}: expected the element <robot>, got <{harmless(robot.tag)}>; give a URDF"
        )
    level = [robot]
    for _ in range(_MOST_LEVELS):
        level = [element for parent in level for element in parent]
    if level:
        raise RobotError(f"{where}: expected at most {_MOST_LEVELS} levels of elements, got more")
    for origin in robot.iter("origin"):
        quaternion = origin.attrib.pop("quat_xyzw", "")
        if quaternion and robot.get("version") in (
            "1.1",
            "1.2",
        ):  # others ignore it, as urdfdom does
            origin.set("rpy", _angles(quaternion, where))
    return robot


def _angles(quaternion: str, where: object) -> str:
    """Roll, pitch, yaw of `x y z w`."""
    try:
        x, y, z, w = map(float, quaternion.split())
        length = math.hypot(x, y, z, w)
        x, y, z, w = x / length, y / length, z / length, w / length
    except (ValueError, ZeroDivisionError):
        raise RobotError(
            f"{where}: <origin quat_xyzw=...>: expected a rotation, four numbers, got {shown(quaternion)}"
        ) from None
    yaw = math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z))
    c, s = math.cos(yaw), math.sin(yaw)
    pitch = math.atan2(2 * (w * y - x * z), c * (1 - 2 * (y * y + z * z)) + s * 2 * (x * y + w * z))
    roll = math.atan2(
        s * 2 * (x * z + w * y) - c * 2 * (y * z - w * x),
        c * (1 - 2 * (x * x + z * z)) - s * 2 * (x * y - w * z),
    )
    return f"{roll!r} {pitch!r} {yaw!r}"


def _expanded(file: Path, arguments: Sequence[str]) -> str:
    require(f"{file}:", "xacro")
    tool = Path(__file__).with_name("xacro_tool.py")
    result = subprocess.run(
        [sys.executable, str(tool), str(file), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode != 0:
        lines = result.stderr.strip().splitlines() or [f"exit code {result.returncode}"]
        raise RobotError(f"{file}: xacro can't expand it: {harmless('; '.join(lines), 500)}")
    return result.stdout

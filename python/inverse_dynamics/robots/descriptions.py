# SPDX-License-Identifier: Apache-2.0
"""Robot descriptions: the text of a URDF file, or of a .xacro file after xacro."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.decimals import decimal
from inverse_dynamics.errors import RobotError
from inverse_dynamics.installation.extras import require
from inverse_dynamics.robots.reading import read_bytes
from inverse_dynamics.wording import harmless, shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from xml.etree.ElementTree import Element

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.errors import UserError

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


def parse_description(
    text: str, where: object = "robot description", raised: type[UserError] = RobotError
) -> Element:
    """The element <robot> of a URDF. Raises that error for what isn't one."""
    import xml.etree.ElementTree as ElementTree

    class Builder(ElementTree.TreeBuilder):
        def doctype(self, *_: object) -> None:
            raise _DocumentTypeError

    try:
        robot = ElementTree.fromstring(text, ElementTree.XMLParser(target=Builder()))
    except _DocumentTypeError:
        raise raised(
            f"{where}: expected no document type, got one; no URDF needs it: remove it"
        ) from None
    except (ElementTree.ParseError, ValueError) as error:
        raise raised(f"{where}: isn't a robot description: no XML ({error})") from error
    if robot.tag != "robot":
        raise raised(
            f"{where}: expected the element <robot>, got <{harmless(robot.tag)}>; give a URDF"
        )
    level = [robot]
    for _ in range(_MOST_LEVELS):
        level = [element for parent in level for element in parent]
    if level:
        raise raised(f"{where}: expected at most {_MOST_LEVELS} levels of elements, got more")
    return robot


def numbers_of(
    element: Element,
    attribute: str,
    length: int,
    raised: type[UserError] = RobotError,
    where: str = "robot description",
) -> list[float]:
    """Finite numbers of an attribute that is there."""
    text = element.get(attribute, "")
    try:
        numbers = [decimal(word) for word in text.split()]
    except ValueError:
        numbers = []
    if len(numbers) != length or not all(map(math.isfinite, numbers)):
        what = "a finite number" if length == 1 else f"{length} finite numbers"
        raise raised(
            f"{where}: <{element.tag} {attribute}=...>: expected {what}, got {shown(text)}"
        )
    return numbers


def numbers_or(
    element: Element | None,
    attribute: str,
    absent: Sequence[float],
    raised: type[UserError] = RobotError,
    where: str = "robot description",
) -> list[float]:
    """Finite numbers of an attribute, as many as `absent`, which stands for one that isn't there."""
    if element is None or element.get(attribute) is None:
        return list(absent)
    return numbers_of(element, attribute, len(absent), raised, where)


def link_of(joint: Element, role: str) -> str:
    """Name of the parent or child link of a joint; "": none is stated."""
    element = joint.find(role)
    return "" if element is None else element.get("link", "")


def fixed_above(link: str, joint_above: Mapping[str, Element]) -> dict[str, list[Element]]:
    """A link and those that it is fixed to above it, each with the joints from there down to the link.

    joint_above: by child link.
    """
    found: dict[str, list[Element]] = {link: []}
    while (joint := joint_above.get(link)) is not None and joint.get("type") == "fixed":
        below, link = found[link], link_of(joint, "parent")
        if link in found:
            break  # a loop
        found[link] = [joint, *below]
    return found


def effort_limits(file: Path | None, description: str, joint_names: Sequence[str]) -> Floats:
    """(n,) N m (prismatic N) of the URDF; infinite for a joint without one, or with zero.

    file: where the description is from, for errors. Raises RobotError if it isn't XML, or if a
    limit isn't a number.
    """
    found = {j.get("name"): j.find("limit") for j in _joints(file, description)}
    limits = [
        numbers_or(found.get(name), "effort", (np.inf,), where=f"{file}: joint {name}")[0]
        for name in joint_names
    ]
    return np.where(np.array(limits) > 0, limits, np.inf)


def carried_joints(description: str, chain: Sequence[str], root: str = "") -> dict[str, str]:
    """Units (rad, m) of the joints that move by themselves beside a chain, on a link that it moves.

    chain: names of its joints; root: the link it starts at; none: the description's. Raises RobotError
    if it isn't XML.
    """
    movable: dict[str, tuple[str, str]] = {}
    next_to: dict[str, list[str]] = {}
    for joint in _joints(None, description):
        parent, child = (link_of(joint, role) for role in ("parent", "child"))
        name, kind = joint.get("name", ""), joint.get("type")
        if not parent or not child or name in chain:
            continue
        next_to.setdefault(parent, []).append(child)
        next_to.setdefault(child, []).append(parent)
        if kind in ("revolute", "continuous", "prismatic") and joint.find("mimic") is None:
            movable[name] = (parent, "m" if kind == "prismatic" else "rad")
    still = [root or root_link(description)]
    for link in still:  # grows by what is connected to the root without a joint of the chain
        still += [other for other in next_to.get(link, ()) if other not in still]
    return {name: unit for name, (link, unit) in movable.items() if link not in still}


def tip_link(file: Path | None, chain: Sequence[str]) -> str:
    """The link that a chain without a stated tip ends at: farthest behind its last joint, by fixed joints.

    Raises RobotError.
    """
    return (
        "" if file is None else tip_of(parse_description(read_description(file), file), chain[-1])
    )


def tip_of(robot: Element, joint_name: str) -> str:
    """The link farthest behind a joint, by fixed joints; "": there is no such joint."""
    fixed: dict[str, list[str]] = {}
    last = ""
    for joint in robot.iter("joint"):
        child = link_of(joint, "child")
        if joint.get("name") == joint_name:
            last = child
        elif joint.get("type") == "fixed":
            fixed.setdefault(link_of(joint, "parent"), []).append(child)
    links = [last]
    while behind := [child for link in links for child in fixed.get(link, ())]:
        links = behind
    return links[0]


def root_link(description: str) -> str:
    """The first link that no joint moves or fixes; "": there is none."""
    robot = parse_description(description)
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    roots = [link.get("name", "") for link in robot.iterfind("link")]
    return next((name for name in roots if name not in children), "")


def _joints(file: Path | None, description: str) -> list[Element]:
    return list(parse_description(description, file).iter("joint")) if description else []


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

# SPDX-License-Identifier: Apache-2.0
"""An identified model as a URDF, and its friction as MJCF defaults.

    text = urdf_text(found)

The description that was started from, with the inertia of the moving links replaced. A link of the model is a
link of the description with all that is fixed to it: its <inertial> becomes that of the whole, and what is
fixed to it has none any more. Friction goes into <dynamics> as far as that can hold it; a
comment says what it can't. Everything else stays: comments, shapes, limits, order.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from io import StringIO
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from inverse_dynamics.errors import RobotError
from inverse_dynamics.results.model_files import identified_model, urdf_of
from inverse_dynamics.results.yaml_text import yaml_number
from inverse_dynamics.robot.chain_geometry import chain_geometry
from inverse_dynamics.robot.descriptions import parse_description, read_description
from inverse_dynamics.robot.link_parameters import about_center, turned

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.identification.result import Identification

_LOAD_STATES = 2000  # that the mean load of a joint is taken over
_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def urdf_text(found: Identification) -> str:
    """The description with the identified inertia and friction. Raises RobotError."""
    text = read_description(urdf_of(found))
    parse_description(text)  # refuses what isn't a URDF
    before, body, after = _around_root(text)
    robot = _parsed(body)
    geometry = chain_geometry(text, found.robot.root, found.joints)
    lumped = _lumped_links(robot, found.joints, [joint.link for joint in geometry])
    for joint, parameters in zip(geometry, found.model.parameters, strict=True):
        in_link = turned(parameters, joint.rotation_from_z)
        _set_inertial(_named(robot, "link", joint.link), in_link)
        for link in lumped[joint.link]:
            _remove_inertial(_named(robot, "link", link))
    for name, (damping, friction) in zip(found.joints, _damping_and_friction(found), strict=True):
        _set_dynamics(_named(robot, "joint", name), damping, friction)
    robot.insert(0, ElementTree.Comment(_comment(found, lumped)))
    robot[0].tail = robot.text or "\n"
    return f"{before}{ElementTree.tostring(robot, encoding='unicode')}{after}"


def mjcf_text(found: Identification) -> str:
    """MJCF <default> classes, one per joint: armature, damping and frictionloss."""
    lines = [
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        f"<!-- {_comment(found, {})} -->",
        "<mujoco>",
        "  <default>",
    ]
    for j, (name, (damping, friction)) in enumerate(
        zip(found.joints, _damping_and_friction(found), strict=True)
    ):
        armature = yaml_number(found.model.rotor_inertia[j])
        lines += [
            f"    <default class={quoteattr(name)}>",
            f'      <joint armature="{armature}" damping="{yaml_number(damping)}" '
            f'frictionloss="{yaml_number(friction)}"/>',
            "    </default>",
        ]
    return "\n".join([*lines, "  </default>", "</mujoco>", ""])


def _around_root(text: str) -> tuple[str, str, str]:
    """The text before the root element, the element, and the text after it."""
    prolog = re.match(r"(\s|<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>]*>)*", text, re.DOTALL)
    begin = prolog.end() if prolog else 0
    end = text.rindex("</robot>") + len("</robot>")
    return text[:begin], text[begin:end], text[end:]


def _parsed(body: str) -> ElementTree.Element:
    """With comments, and with the names of namespaces."""
    for _, (prefix, uri) in ElementTree.iterparse(StringIO(body), ["start-ns"]):
        ElementTree.register_namespace(prefix, uri)
    builder = ElementTree.TreeBuilder(insert_comments=True, insert_pis=True)
    return ElementTree.fromstring(body, ElementTree.XMLParser(target=builder))


def _named(robot: ElementTree.Element, tag: str, name: str) -> ElementTree.Element:
    for element in robot.findall(tag):
        if element.get("name") == name:
            return element
    raise RobotError(f"robot description: expected a {tag} {name}, got none")


def _lumped_links(
    robot: ElementTree.Element, joints: Sequence[str], moving: Sequence[str]
) -> dict[str, list[str]]:
    """By link of the chain: those that are part of its body in the model."""
    children: dict[str, list[str]] = {}
    for joint in robot.findall("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if joint.get("name") not in joints and parent is not None and child is not None:
            children.setdefault(parent.get("link", ""), []).append(child.get("link", ""))
    found = {}
    for link in moving:
        waiting, parts = list(children.get(link, [])), []
        while waiting:
            part = waiting.pop(0)
            parts.append(part)
            waiting += children.get(part, [])
        found[link] = [part for part in parts if part not in moving]
    return found


def _set_inertial(link: ElementTree.Element, parameters: Floats) -> None:
    """Mass, center of mass, and inertia about it, in the axes of the link."""
    center, tensor = about_center(parameters)
    inertial = link.find("inertial")
    if inertial is None:
        inertial = ElementTree.Element("inertial")
        inertial.tail = link.text
        link.insert(0, inertial)
    tail, indent = inertial.tail, inertial.text
    inertial.clear()
    inertial.tail, inertial.text = tail, indent
    six = tensor[np.triu_indices(3)]
    for tag, attributes in (
        ("origin", {"xyz": " ".join(map(yaml_number, center)), "rpy": "0 0 0"}),
        ("mass", {"value": yaml_number(parameters[0])}),
        ("inertia", {key: yaml_number(x) for key, x in zip(_KEYS, six, strict=True)}),
    ):
        ElementTree.SubElement(inertial, tag, attributes).tail = indent
    inertial[-1].tail = link.text


def _remove_inertial(link: ElementTree.Element) -> None:
    inertial = link.find("inertial")
    if inertial is not None:
        link.remove(inertial)


def _set_dynamics(joint: ElementTree.Element, damping: float, friction: float) -> None:
    dynamics = joint.find("dynamics")
    if dynamics is None:
        dynamics = ElementTree.SubElement(joint, "dynamics")
        if len(joint) > 1:
            dynamics.tail, joint[-2].tail = joint[-2].tail, joint.text
    dynamics.set("damping", yaml_number(damping))
    dynamics.set("friction", yaml_number(friction))


def _damping_and_friction(found: Identification) -> list[tuple[float, float]]:
    """fv, and the height of the step at the mean load of the recordings."""
    q = np.concatenate([block.q for block in found.blocks])
    q = q[:: max(1, len(q) // _LOAD_STATES)]
    still = np.zeros_like(q)
    gravity = identified_model(found).regressor(q, still, still) @ found.model.parameters.ravel()
    load = np.abs(gravity).mean(axis=0)
    return [
        (float(law["fv"]), float(law["fc"] + law.get("fl", 0.0) * load[j]))
        for j, law in enumerate(found.model.friction)
    ]


def _comment(found: Identification, lumped: Mapping[str, Sequence[str]]) -> str:
    left_out = [
        text
        for text, there in (
            ("the width of the step", True),
            ("offsets", bool(np.any(found.offsets))),
            ("the shift of the step", bool(np.any(found.shifts))),
            (
                "that friction grows with load (the step is that of the mean load)",
                any(law.get("fl") for law in found.model.friction),
            ),
            (
                "that friction falls with velocity (Stribeck)",
                any(law.get("fs") for law in found.model.friction),
            ),
        )
        if there
    ]
    parts = [f"{link} has {', '.join(names)} in it" for link, names in lumped.items() if names]
    sentences = [
        f"Inertia and friction by `ids identify` from {', '.join(p.name for p in found.recordings)}.",
        "Masses of single links are mostly those of the description before: torques don't determine them.",
        f"Not held here: {'; '.join(left_out)}.",
    ]
    if lumped:
        sentences.append("Rotor inertia has no place in a URDF either.")
    if parts:
        sentences.append(f"Lumped, so that their own inertia is gone: {'; '.join(parts)}.")
    return " ".join(sentences).replace("--", "- -")

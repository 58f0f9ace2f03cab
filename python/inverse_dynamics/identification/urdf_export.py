# SPDX-License-Identifier: Apache-2.0
"""An identified model as a URDF, and as an MJCF.

    text = urdf_text(found)

The description that was started from, with the inertia of the moving links replaced. A link of the model is a
link of the description with all that is fixed to it: its <inertial> becomes that of the whole, and what is
fixed to it has none any more. Everything else stays: comments, shapes, limits, order. The MJCF has the
moving links alone. Friction goes into both as far as they can hold it; a comment says what they can't.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from io import StringIO
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import RobotDescription
from inverse_dynamics.errors import RobotError
from inverse_dynamics.identification.result import identified_model, urdf_of
from inverse_dynamics.outputs.yaml_text import yaml_number
from inverse_dynamics.robots.descriptions import parse_description, read_description
from inverse_dynamics.robots.link_parameters import about_center, inertial_elements, turned
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from inverse_dynamics._core import DescribedJoint
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.result import Identification

_STATES = 2000  # of the recordings, over which the nearest friction is found
_RAMP = 1.25  # widths of tanh(v / width), over which the nearest ramp rises


def urdf_text(found: Identification) -> str:
    """The description with the identified inertia and friction. Raises RobotError."""
    text = read_description(urdf_of(found))
    parse_description(text)  # refuses what isn't a URDF
    before, body, after = _around_root(text)
    robot = _parsed(body)
    moving = identified_model(found).link_joints
    geometry = RobotDescription(text).chain(moving, found.robot.root)
    lumped = _lumped_links(robot, moving, [joint.child for joint in geometry])
    for joint, parameters in zip(geometry, found.model.parameters, strict=True):
        in_link = turned(parameters, joint.rotation_from_z)
        _set_inertial(_named(robot, "link", joint.child), in_link)
        for link in lumped[joint.child]:
            _remove_inertial(_named(robot, "link", link))
    fitted = _damping_and_friction(found, np.zeros(len(found.joints)))
    for name, (damping, friction) in zip(found.joints, fitted, strict=True):
        _set_dynamics(_named(robot, "joint", name), damping, friction)
    robot.insert(0, ElementTree.Comment(_comment(found, lumped)))
    robot[0].tail = robot.text or "\n"
    return f"{before}{ElementTree.tostring(robot, encoding='unicode')}{after}"


def mjcf_text(found: Identification) -> str:
    """A MuJoCo model of the moving links, with a motor at each joint. Raises RobotError.

    Joints have armature and friction by a <default> class each, for use in another model too.
    """
    ramps = np.array([_RAMP * law["width"] for law in found.model.friction])
    model = identified_model(found)
    H = model.inertia_matrix(np.zeros(len(found.joints)))
    description = RobotDescription(read_description(urdf_of(found)))
    geometry = {j.name: j for j in description.chain(model.link_joints, found.robot.root)}
    if follow := [name for name in geometry if name not in found.joints]:
        raise RobotError(
            f"robot {found.robot.name}: an MJCF is written of joints that mimic no other, got {listed(follow)}; "
            "take the URDF"
        )
    mujoco = ElementTree.Element("mujoco", model=found.robot.name)
    mujoco.append(ElementTree.Comment(f" {_comment(found, {})} "))
    ElementTree.SubElement(mujoco, "compiler", angle="radian", eulerseq="XYZ")
    option = ElementTree.SubElement(mujoco, "option", integrator="implicitfast")
    if found.robot.gravity is not None:  # MuJoCo's own points down too
        option.set("gravity", _numbers(found.robot.gravity))
    defaults = ElementTree.SubElement(mujoco, "default")
    world = ElementTree.SubElement(mujoco, "worldbody")
    bodies: dict[str, ElementTree.Element] = {}
    motors = ElementTree.SubElement(mujoco, "actuator")
    links = dict(zip(geometry, found.model.parameters, strict=True))
    for name, rotor, (damping, friction), slowness in zip(
        found.joints,
        found.model.rotor_inertia,
        _damping_and_friction(found, ramps),
        2 * ramps / np.diag(np.linalg.inv(H)),
        strict=True,
    ):
        values = {"armature": rotor, "damping": damping, "frictionloss": friction}
        written = {key: yaml_number(value) for key, value in values.items()}
        if friction > 0:  # a constraint without impedance: a ramp up to its greatest force
            written["solreffriction"] = _numbers((slowness / friction, 1.0))
            written["solimpfriction"] = _numbers((1e-4, 1e-4))
        ElementTree.SubElement(
            ElementTree.SubElement(defaults, "default", {"class": name}), "joint", written
        )
        ElementTree.SubElement(motors, "motor", name=name, joint=name)
    waiting = list(geometry.values())
    while waiting:  # parents before children, as bodies are in each other
        joint = waiting.pop(0)
        if any(joint.parent == other.child for other in waiting):
            waiting.append(joint)
            continue
        in_link = turned(links[joint.name], joint.rotation_from_z)
        bodies[joint.child] = _mjcf_body(bodies.get(joint.parent, world), joint, in_link)
    ElementTree.indent(mujoco)
    license_line = "<!-- SPDX-License-Identifier: Apache-2.0 -->"
    return f"{license_line}\n{ElementTree.tostring(mujoco, encoding='unicode')}\n"


def _mjcf_body(
    parent: ElementTree.Element, joint: DescribedJoint, parameters: Floats
) -> ElementTree.Element:
    """The link that a joint moves."""
    body = ElementTree.SubElement(
        parent, "body", name=joint.child, pos=_numbers(joint.xyz), euler=_numbers(joint.rpy)
    )
    center, tensor = about_center(parameters)
    six = tensor[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)]
    ElementTree.SubElement(
        body,
        "inertial",
        mass=yaml_number(parameters[0]),
        pos=_numbers(center),
        fullinertia=_numbers(six),
    )
    ElementTree.SubElement(
        body,
        "joint",
        {"name": joint.name, "class": joint.name, "axis": _numbers(joint.axis)},
        type="slide" if joint.type == "prismatic" else "hinge",
    )
    if {"lower", "upper"} <= joint.limits.keys():
        body[-1].set("range", _numbers((joint.limits["lower"], joint.limits["upper"])))
    return body


def _numbers(values: Iterable[float]) -> str:
    return " ".join(yaml_number(float(value)) for value in values)


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
    inertial = link.find("inertial")
    if inertial is None:
        inertial = ElementTree.Element("inertial")
        inertial.tail = link.text
        link.insert(0, inertial)
    tail, indent = inertial.tail, inertial.text
    inertial.clear()
    inertial.tail, inertial.text = tail, indent
    for tag, attributes in inertial_elements(parameters, yaml_number).items():
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


def _damping_and_friction(found: Identification, ramps: Floats) -> list[tuple[float, float]]:
    """Of the law `damping qd + friction step(qd)` that is nearest to the model's over the recorded states.

    ramps: (n,) rad/s (prismatic m/s), over which each step rises.
    """
    q, qd = (np.concatenate([getattr(block, key) for block in found.blocks]) for key in ("q", "qd"))
    every = slice(None, None, max(1, len(q) // _STATES))
    q, qd, still = q[every], qd[every], np.zeros_like(q[every])
    engine = identified_model(found)
    law = engine.torques(q, qd, still) - engine.regressor(q, qd, still) @ engine.parameters
    return [
        _nearest(np.column_stack((v, np.clip(v / max(ramp, 1e-9), -1, 1))), torque - offset)
        for v, torque, offset, ramp in zip(qd.T, law.T, found.offsets, ramps, strict=True)
    ]


def _nearest(columns: Floats, torque: Floats) -> tuple[float, float]:
    """Least squares with two coefficients that aren't negative."""
    both = np.linalg.lstsq(columns, torque, rcond=None)[0]
    if both.min() < 0:
        alone = columns.T @ torque / np.maximum((columns**2).sum(axis=0), np.finfo(float).tiny)
        both = np.where(np.arange(2) == both.argmax(), np.maximum(alone, 0.0), 0.0)
    return float(both[0]), float(both[1])


def _comment(found: Identification, lumped: Mapping[str, Sequence[str]]) -> str:
    left_out = [
        text
        for text, there in (
            ("the width of the step", bool(lumped)),
            ("that joints share motors", found.model.coupling is not None),
            ("offsets", bool(np.any(found.offsets))),
            ("the shift of the step", bool(np.any(found.shifts))),
            (
                "that friction grows with load",
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
        "Damping and friction are those nearest to the identified law over the recorded motion.",
    ]
    if left_out:
        sentences.append(f"Not held here: {'; '.join(left_out)}.")
    if lumped:
        sentences.append("Rotor inertia has no place in a URDF either.")
    if parts:
        sentences.append(f"Lumped, so that their own inertia is gone: {'; '.join(parts)}.")
    return " ".join(sentences).replace("--", "- -")

# SPDX-License-Identifier: Apache-2.0
"""The URDFs: figures as published, and shapes that make up one robot."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

PACKAGE = Path(__file__).resolve().parent.parent
ROBOTS = ("ur10", "panda")
MOVABLE = {"revolute", "continuous", "prismatic"}

# Collision shapes hold back 2 mm at the joints, visual shapes meet; 1 mm for the sampling.
GREATEST_GAP = {"visual": 1e-3, "collision": 3.1e-3}


def read(robot: str) -> ElementTree.Element:
    return ElementTree.parse(PACKAGE / "urdf" / f"{robot}.urdf").getroot()


def vector(element: ElementTree.Element | None, key: str) -> np.ndarray:
    text = "0 0 0" if element is None else element.get(key, "0 0 0")
    return np.array([float(word) for word in text.split()])


def pose(origin: ElementTree.Element | None) -> tuple[np.ndarray, np.ndarray]:
    """R, p of an <origin>: R = RotZ(yaw) RotY(pitch) RotX(roll)."""
    (cr, cp, cy), (sr, sp, sy) = (f(vector(origin, "rpy")) for f in (np.cos, np.sin))
    roll = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    pitch = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    yaw = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return yaw @ pitch @ roll, vector(origin, "xyz")


def distance(shape: ElementTree.Element, points: np.ndarray) -> np.ndarray:
    """Signed distance of points (N x 3, link frame) from the surface; negative inside."""
    R, p = pose(shape.find("origin"))
    geometry = shape.find("geometry")[0]
    local = (points - p) @ R
    if geometry.tag == "sphere":
        return np.linalg.norm(local, axis=1) - float(geometry.get("radius"))
    if geometry.tag == "cylinder":
        beyond = np.stack(
            [
                np.hypot(local[:, 0], local[:, 1]) - float(geometry.get("radius")),
                np.abs(local[:, 2]) - float(geometry.get("length")) / 2,
            ],
            axis=1,
        )
    else:
        beyond = np.abs(local) - vector(geometry, "size") / 2
    return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)


def surface(shape: ElementTree.Element, rng: np.random.Generator) -> np.ndarray:
    """Points in and on a shape (N x 3, link frame)."""
    R, p = pose(shape.find("origin"))
    geometry = shape.find("geometry")[0]
    unit = rng.uniform(-1, 1, (4000, 3))
    unit[:2000] /= np.abs(unit[:2000]).max(axis=1, keepdims=True)  # on the surface of a cube
    if geometry.tag == "box":
        local = unit * vector(geometry, "size") / 2
    elif geometry.tag == "sphere":
        directions = rng.normal(size=(4000, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        local = directions * float(geometry.get("radius"))
    else:
        angle = rng.uniform(0, 2 * math.pi, 4000)
        radius = float(geometry.get("radius")) * np.sqrt(np.abs(unit[:, 0]))
        height = unit[:, 2] * float(geometry.get("length")) / 2
        local = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)
    return local @ R.T + p


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_neighbouring_links_meet_wherever_the_joint_stands(robot: str, kind: str) -> None:
    description = read(robot)
    links = {link.get("name"): link for link in description.findall("link")}
    rng = np.random.default_rng(1)
    for joint in description.findall("joint"):
        if joint.get("type") not in MOVABLE:
            continue
        assert joint.find("axis").get("xyz") == "0 0 1"
        parent, child = (links[joint.find(end).get("link")] for end in ("parent", "child"))
        points = np.concatenate([surface(shape, rng) for shape in child.findall(kind)])
        R, p = pose(joint.find("origin"))
        for q in (0.0, 0.7, -1.5):
            Rz = np.array(
                [[math.cos(q), -math.sin(q), 0], [math.sin(q), math.cos(q), 0], [0, 0, 1]]
            )
            in_parent = points @ (R @ Rz).T + p
            gap = min(distance(shape, in_parent).min() for shape in parent.findall(kind))
            assert gap < GREATEST_GAP[kind], f"{joint.get('name')} at {q} rad: {1e3 * gap:.1f} mm"


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_link_with_inertia_has_shapes_of_known_colours(robot: str) -> None:
    description = read(robot)
    colours = {material.get("name") for material in description.findall("material")}
    for link in description.findall("link"):
        shapes = link.findall("visual") + link.findall("collision")
        assert bool(link.findall("visual")) == (link.find("inertial") is not None), link.get("name")
        assert bool(link.findall("visual")) == bool(link.findall("collision")), link.get("name")
        for shape in shapes:
            assert shape.find("geometry")[0].tag in {"box", "cylinder", "sphere"}
        used = {visual.find("material").get("name") for visual in link.findall("visual")}
        assert used <= colours, link.get("name")


@pytest.mark.parametrize("robot", ROBOTS)
def test_there_is_one_root_and_one_leaf(robot: str) -> None:
    description = read(robot)
    links = {link.get("name") for link in description.findall("link")}
    joints = description.findall("joint")
    parents, children = (
        {joint.find(end).get("link") for joint in joints} for end in ("parent", "child")
    )
    expected = {"ur10": ("base_link", "tool0"), "panda": ("fer_link0", "fer_link8")}[robot]
    assert (links - children, links - parents) == ({expected[0]}, {expected[1]})


@pytest.mark.parametrize("robot", ROBOTS)
def test_figures_are_those_of_the_source_digit_by_digit(robot: str) -> None:
    data = os.environ.get("IDS_DATA_DIR", "")
    if not data:
        pytest.skip("IDS_DATA_DIR is not set: it names the folder with the figures as published")
    source = ElementTree.parse(Path(data) / "urdf" / f"{robot}.urdf").getroot()
    ours = read(robot)
    for link in ours.findall("link"):
        compare(link, source, ("inertial/mass", "inertial/origin", "inertial/inertia"))
    for joint in ours.findall("joint"):
        compare(joint, source, ("parent", "child", "origin", "axis", "limit", "dynamics"))
    assert movable_names(ours) == movable_names(source)


def movable_names(description: ElementTree.Element) -> set[str]:
    return {j.get("name") for j in description.findall("joint") if j.get("type") in MOVABLE}


def compare(
    element: ElementTree.Element, source: ElementTree.Element, parts: tuple[str, ...]
) -> None:
    original = source.find(f"{element.tag}[@name='{element.get('name')}']")
    assert original is not None, element.get("name")
    assert original.get("type") == element.get("type"), element.get("name")
    for part in parts:
        expected, got = original.find(part), element.find(part)
        where = f"{element.get('name')}: {part}"
        assert (expected is None) == (got is None), where
        assert expected is None or expected.attrib == got.attrib, where

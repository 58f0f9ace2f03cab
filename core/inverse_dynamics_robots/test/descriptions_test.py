# SPDX-License-Identifier: Apache-2.0
"""The URDFs: one chain each, numbers as published."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent
ROBOTS = ("ur10", "panda")
MOVABLE = {"revolute", "continuous", "prismatic"}


def read(robot: str) -> ElementTree.Element:
    return ElementTree.parse(PACKAGE / "urdf" / f"{robot}.urdf").getroot()


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

# SPDX-License-Identifier: Apache-2.0
"""The run configurations: complete, and true to the robot descriptions they name."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest
import yaml

PACKAGE = Path(__file__).resolve().parent.parent
FILES = sorted((PACKAGE / "robots").glob("*.yaml"))
OWN_SHARE = "package://inverse_dynamics_robots/"

REQUIRED = {"schema", "name", "description", "plugin", "urdf", "root", "tip", "gravity", "topic"}
REQUIRED |= {"joints", "friction", "effort", "accelerations", "source"}
OPTIONAL = {"model", "drive_gains", "parameters", "simulation", "table"}
IN_MODEL = {"urdf", "root", "tip", "gravity", "topic"}  # of identified robots, or the usual one
DOCUMENTATION = PACKAGE.parents[1] / "docs/add_a_robot.md"


def read(file: Path) -> dict[str, Any]:
    return yaml.safe_load(file.read_text(encoding="utf-8"))


def chain_joints(urdf: Path, root: str, tip: str) -> list[str]:
    """Names of the movable joints from root to tip."""
    description = ElementTree.parse(urdf).getroot()
    above = {joint.find("child").get("link"): joint for joint in description.findall("joint")}
    names = []
    link = tip
    while link != root:
        joint = above[link]
        if joint.get("type") != "fixed":
            names.append(joint.get("name"))
        link = joint.find("parent").get("link")
    return names[::-1]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_keys_are_complete_and_known(file: Path) -> None:
    robot = read(file)
    assert set(robot) >= REQUIRED - (IN_MODEL if "model" in robot else set())
    assert set(robot) <= REQUIRED | OPTIONAL
    assert "docs/add_a_robot.md" in file.read_text(encoding="utf-8").partition("\nschema:")[0]


def test_every_key_has_its_row_in_the_documentation() -> None:
    rows = re.findall(r"^\| (`.*?) \|", DOCUMENTATION.read_text(encoding="utf-8"), re.MULTILINE)
    assert set(re.findall(r"`(\w+)`", " ".join(rows))) >= REQUIRED | OPTIONAL


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_files_exist_and_joints_are_those_of_the_chain(file: Path) -> None:
    robot = read(file)
    assert robot["name"] == file.stem
    if "urdf" in robot:
        assert robot["urdf"].startswith(OWN_SHARE)
        urdf = PACKAGE / robot["urdf"].removeprefix(OWN_SHARE)
        assert urdf.is_file()
    if "model" not in robot:
        assert robot["joints"] == chain_joints(urdf, robot["root"], robot["tip"])
        return
    assert robot["model"] == f"../models/{file.stem}.yaml"
    joints = read(file.parent / robot["model"])["joints"]
    assert robot["joints"] == [joint["name"] for joint in joints if "mimic" not in joint]

# SPDX-License-Identifier: Apache-2.0
"""Each package.xml declares what the package's CMakeLists.txt finds: rosdep installs nothing else."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[1]

KEYS = {
    "Eigen3": "eigen",
    "Python3": "python3-dev",
    "SQLite3": "libsqlite3-dev",
    "orocos_kdl": "liborocos-kdl-dev",
    "pybind11": "pybind11-dev",
}
"""rosdep's names of what CMake calls otherwise."""

WITHOUT_KEY = {"CasADi", "MuJoCo", "PinocchioHeaders", "Threads", "benchmark"}
"""Optional packages of PyPI, a benchmark library that may be missing, and what every compiler has."""


def found(package: Path) -> set[str]:
    """Keys of what find_package() names; an interpreter alone is part of every ROS 2."""
    files = [package / "CMakeLists.txt", package / "test" / "CMakeLists.txt"]
    texts = [file.read_text(encoding="utf-8") for file in files if file.is_file()]
    calls = re.findall(r"^\s*find_package\((\w[\w-]*)([^)]*)\)", "\n".join(texts), re.MULTILINE)
    names = {name for name, rest in calls if not rest.endswith("COMPONENTS Interpreter")}
    return {KEYS.get(name, name) for name in names - WITHOUT_KEY}


def test_what_a_plain_colcon_build_needs_is_installed() -> None:
    """Users build packages of their own without ./scripts/build, so with CMake's default, make."""
    packages = subprocess.run(
        ["bash", "-c", 'source scripts/common.bash && echo "${apt_packages[@]}"'],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()
    assert {"g++", "cmake", "make", "colcon"} <= set(packages)


@pytest.mark.parametrize(
    "manifest", sorted(ROOT.glob("*/package.xml")), ids=lambda p: p.parent.name
)
def test_what_cmake_finds_is_declared(manifest: Path) -> None:
    root = ElementTree.parse(manifest).getroot()
    declared = {element.text for element in root if element.tag.endswith("depend")}
    name = root.findtext("name")
    assert found(manifest.parent) - {name} <= declared

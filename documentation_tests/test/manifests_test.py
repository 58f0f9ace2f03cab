# SPDX-License-Identifier: Apache-2.0
"""package.xml of each package: dependencies are rosdep keys and complete, notices of others are there."""

from __future__ import annotations

import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from pages import REPOSITORY

MANIFESTS = sorted(
    file for depth in ("*", "*/*") for file in REPOSITORY.glob(f"{depth}/package.xml")
)
MODELS = sorted(REPOSITORY.glob("core/inverse_dynamics_robots/models/*.yaml"))
OWN = {ElementTree.parse(path).getroot().findtext("name") for path in MANIFESTS}

KEYS_OF_ROSDEP = {
    key
    for line in Path(__file__).with_name("rosdep_keys.txt").read_text(encoding="utf-8").splitlines()
    if not line.startswith("#")
    for key in line.split()
}

# Packages of CMake whose rosdep key is another, and those that come with CMake or the build.
KEYS = {
    "Eigen3": "eigen",
    "MuJoCo": "mujoco_vendor",
    "PinocchioHeaders": "pinocchio",
    "Python3": "python3-dev",
    "SQLite3": "libsqlite3-dev",
    "orocos_kdl": "liborocos-kdl-dev",
    "pybind11": "pybind11-dev",
}
WITHOUT_KEY = {"CasADi", "Threads"}


def dependencies(manifest: Path) -> set[str]:
    root = ElementTree.parse(manifest).getroot()
    return {(element.text or "").strip() for element in root if element.tag.endswith("depend")}


def found_by_cmake(package: Path) -> set[str]:
    files = [package / "CMakeLists.txt", package / "test" / "CMakeLists.txt"]
    text = "".join(file.read_text(encoding="utf-8") for file in files if file.exists())
    # An interpreter alone is part of every ROS 2.
    names = re.findall(r"find_package\(([\w-]+)(?!.*COMPONENTS Interpreter\))", text)
    for loop in re.findall(r"foreach\(package ([^)]+)\)\s+find_package", text):
        names += loop.split()
    return {KEYS.get(name, name) for name in set(names) - WITHOUT_KEY}


@pytest.mark.parametrize("manifest", MANIFESTS, ids=lambda path: path.parent.name)
def test_dependencies_are_keys_of_rosdep(manifest: Path) -> None:
    assert dependencies(manifest) <= KEYS_OF_ROSDEP | OWN


@pytest.mark.parametrize("manifest", MANIFESTS, ids=lambda path: path.parent.name)
def test_the_manifest_names_what_cmake_looks_for(manifest: Path) -> None:
    if manifest.parent.name == "benchmarks":
        pytest.skip("benchmarks aren't released; peers are optional")
    assert found_by_cmake(manifest.parent) <= dependencies(manifest)


@pytest.mark.parametrize("manifest", MANIFESTS, ids=lambda path: path.parent.name)
def test_notices_of_others_are_named_and_there(manifest: Path) -> None:
    licences = ElementTree.parse(manifest).getroot().findall("license")
    assert licences[0].text == "Apache-2.0"
    named = {licence.attrib["file"] for licence in licences if "file" in licence.attrib}
    present = {f"LICENSES/{path.name}" for path in manifest.parent.glob("LICENSES/*")}
    assert named == present


def test_what_a_plain_colcon_build_needs_is_installed() -> None:
    """Users build packages of their own without ./scripts/build, so with CMake's default, make."""
    packages = subprocess.run(
        ["bash", "-c", 'source scripts/common.bash && echo "${apt_packages[@]}"'],
        cwd=REPOSITORY,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()
    assert {"g++", "cmake", "make", "colcon"} <= set(packages)


@pytest.mark.parametrize("model", MODELS, ids=lambda path: path.stem)
def test_the_citation_file_names_the_source_of_each_model(model: Path) -> None:
    text = model.read_text(encoding="utf-8")
    dois = set(re.findall(r"doi (10\.\S+?)[:,.\s]", text))
    # models that we identified name the repository of the recording
    assert len(dois) == (0 if "https://github.com/" in text else 1)
    for doi in dois:
        assert f"doi: {doi}" in (REPOSITORY / "CITATION.cff").read_text(encoding="utf-8")

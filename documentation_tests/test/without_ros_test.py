# SPDX-License-Identifier: Apache-2.0
"""The packages as one CMake project, without ROS: what it builds, what it needs, and how it finds plugins.

Compiles little: `./scripts/without_ros` builds everything, and programs against it.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pages import REPOSITORY, blocks_of, page

PROJECT = REPOSITORY / "inverse_dynamics"
WITHOUT_ROS = REPOSITORY / "core/inverse_dynamics_solver/without_ros"
ENVIRONMENT = {
    name: value
    for name, value in os.environ.items()
    if name not in {"AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "VIRTUAL_ENV"}
}
# What needs ROS 2, or the packages as ament installs them.
OF_WORKSPACES = {
    "inverse_dynamics_benchmarks",
    "inverse_dynamics_controllers",
    "inverse_dynamics_documentation_tests",
    "inverse_dynamics_moveit",
    "inverse_dynamics_msgs",
    "inverse_dynamics_ros",
    "inverse_dynamics_simulation",
}


def run(*command: str | Path, fails: bool = False, **environment: str) -> str:
    """Output of a command, outside of any workspace."""
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env={**ENVIRONMENT, **environment}
    )
    text = done.stdout + done.stderr
    assert (done.returncode != 0) == fails, f"{command}\n{done.returncode}\n{text}"
    return text


def workspace_packages() -> set[str]:
    """Names of the packages beside the project."""
    return {
        re.search("<name>(.*)</name>", file.read_text(encoding="utf-8"))[1]
        for depth in ("*", "*/*")
        for file in REPOSITORY.glob(f"{depth}/package.xml")
    }


@pytest.fixture(scope="module")
def without_python(tmp_path_factory: pytest.TempPathFactory) -> str:
    """PATH with a python3 first that can do nothing, as pyenv and conda put theirs there."""
    python = tmp_path_factory.mktemp("path") / "python3"
    python.write_text("#!/bin/sh\nexit 1\n")
    python.chmod(0o755)
    return f"{python.parent}:{os.environ['PATH']}"


def test_every_package_that_needs_no_ros_is_built_on_request(tmp_path: Path) -> None:
    text = run("cmake", "-S", PROJECT, "-B", tmp_path, "-DINVERSE_DYNAMICS_PACKAGES=a", fails=True)
    known = re.search(r"there is no a, but: ([\w\s]+)", text)
    assert known, text
    assert set(known[1].split()[: len(workspace_packages() - OF_WORKSPACES)]) == (
        workspace_packages() - OF_WORKSPACES
    )


def test_nothing_of_ament_or_pluginlib_is_used(tmp_path: Path, without_python: str) -> None:
    run(
        *("cmake", "-S", PROJECT, "-B", tmp_path, "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"),
        "-DINVERSE_DYNAMICS_PACKAGES=inverse_dynamics_tools",
        f"-DPython3_EXECUTABLE={sys.executable}",
        PATH=without_python,
    )
    pattern = (
        r"class_loader|rcutils|rcpputils|/usr/include/(pluginlib|ament)|(pluginlib|ament\w*)_DIR"
    )
    for file in ("CMakeCache.txt", "compile_commands.json"):
        text = (tmp_path / file).read_text(encoding="utf-8")
        assert "inverse_dynamics_tools" in text
        assert re.findall(pattern, text) == []


def test_packages_are_found_where_they_were_installed(tmp_path: Path) -> None:
    build, prefix, user = tmp_path / "build", tmp_path / "prefix", tmp_path / "user"
    run("cmake", "-S", PROJECT, "-B", build, "-DINVERSE_DYNAMICS_PACKAGES=inverse_dynamics_robots")
    run("cmake", "--install", build, "--prefix", prefix)
    # In a workspace, colcon would take what lies there for packages.
    assert (build / "COLCON_IGNORE").is_file()
    user.mkdir()
    (user / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.18)\n"
        "project(user LANGUAGES NONE)\n"
        "find_package(inverse_dynamics 0.1 REQUIRED COMPONENTS ${components})\n"
        "if(NOT TARGET inverse_dynamics_robots::inverse_dynamics_robots)\n"
        "  message(FATAL_ERROR none)\n"
        "endif()\n"
    )
    configure = ("cmake", "-S", user, "-B", tmp_path, f"-DCMAKE_PREFIX_PATH={prefix}")
    run(*configure, "-Dcomponents=")
    run(*configure, "-Dcomponents=inverse_dynamics_robots")
    # Without components, all that was installed has to be there, with what it needs.
    damaged = "-DCMAKE_DISABLE_FIND_PACKAGE_inverse_dynamics_robots=ON"
    text = run(*configure, "-Dcomponents=", damaged, fails=True)
    assert "missing: inverse_dynamics_robots" in text
    run(*configure, "-Dcomponents=", "-UCMAKE_DISABLE_FIND_PACKAGE_inverse_dynamics_robots")
    text = run(*configure, "-Dcomponents=inverse_dynamics_control", fails=True)
    assert "missing: inverse_dynamics_control" in text
    assert (prefix / "share/inverse_dynamics_robots/urdf/ur10.urdf").is_file()


DESCRIPTION = """<class_libraries>
<library path="shapes_plugin">
  <class name="shapes/Square" type="shapes::Square" base_class_type="shapes::Shape">
    <description>A square.</description>
  </class>
  <class type="shapes::Triangle" base_class_type="shapes::Shape"/>
  <class name="shapes/Cube" type="shapes::Cube" base_class_type="shapes::Solid"/>
  <class name="shapes/WrongBase" type="shapes::Cube" base_class_type="shapes::Shape"/>
</library>
<library path="no_plugin">
  <class name="shapes/OfRos" type="shapes::OfRos" base_class_type="shapes::Shape"/>
</library>
<library path="missing">
  <class name="shapes/Missing" type="shapes::Missing" base_class_type="shapes::Shape"/>
</library>
</class_libraries>
"""


def describe(prefix: Path, package: str, text: str) -> None:
    """Puts a description of plugins below a prefix, as installed packages do."""
    index = prefix / "share/ament_index/resource_index"
    for resource, content in (
        ("packages", ""),
        ("shapes__pluginlib__plugin", f"share/{package}/plugins.xml\n"),
    ):
        (index / resource).mkdir(parents=True, exist_ok=True)
        (index / resource / package).write_text(content)
    (prefix / "share" / package).mkdir()
    (prefix / "share" / package / "plugins.xml").write_text(text)


@pytest.fixture(scope="module")
def shapes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Prefix with a program, its plugins and their description."""
    folder = tmp_path_factory.mktemp("shapes")
    run("cmake", "-S", WITHOUT_ROS / "test", "-B", folder / "build")
    run("cmake", "--build", folder / "build")
    run("cmake", "--install", folder / "build", "--prefix", folder / "prefix")
    describe(folder / "prefix", "shapes", DESCRIPTION)
    return folder / "prefix"


def test_plugins_are_loaded_from_where_the_program_is_installed(shapes: Path) -> None:
    lines = run(
        shapes / "bin/load_shapes",
        *(
            "shapes/Square",
            "shapes::Triangle",
            "shapes/WrongBase",
            "shapes/OfRos",
            "shapes/Missing",
        ),
    ).splitlines()
    assert lines[:5] == [
        "shapes/Missing of shapes, shapes::Missing: ",
        "shapes/OfRos of shapes, shapes::OfRos: ",
        "shapes/Square of shapes, shapes::Square: A square.",
        "shapes/WrongBase of shapes, shapes::Cube: ",
        "shapes::Triangle of shapes, shapes::Triangle: ",
    ]
    assert lines[5:8] == [
        "four corners",
        "three corners",
        "no such class: no class shapes::Cube",
    ]
    assert lines[8].startswith(f"no such library: {shapes}/lib/libno_plugin.so registers")
    assert re.match(f"no such library: {shapes}/lib/libmissing.so: cannot open", lines[9])
    assert lines[10] == f"{shapes}/share/shapes"


def test_sourced_workspaces_come_after_the_installation(shapes: Path, tmp_path: Path) -> None:
    other = DESCRIPTION.replace('name="shapes/', 'name="more/')
    describe(tmp_path, "shapes", DESCRIPTION.replace("A square", "Not this one"))
    describe(tmp_path, "more_shapes", other)
    (tmp_path / "lib").symlink_to(shapes / "lib")
    text = run(shapes / "bin/load_shapes", "more/Square", AMENT_PREFIX_PATH=f":{tmp_path}:/nowhere")
    assert "shapes/Square of shapes, shapes::Square: A square." in text
    assert "more/Square of more_shapes, shapes::Square: A square." in text
    assert "four corners" in text
    assert "Not this one" not in text
    assert text.endswith(f"{shapes}/share/shapes\n")


@pytest.mark.parametrize("description", ["<library", "<!-- nothing -->", None])
def test_a_description_that_cant_be_read_is_reported_and_left_out(
    shapes: Path, tmp_path: Path, description: str | None
) -> None:
    describe(tmp_path, "broken", description or "")
    file = tmp_path / "share/broken/plugins.xml"
    if description is None:
        file.unlink()
    text = run(shapes / "bin/load_shapes", "shapes/Square", AMENT_PREFIX_PATH=str(tmp_path))
    assert "four corners" in text
    assert f"{file}: expected descriptions of plugins: " in text


def test_the_page_shows_the_projects_as_they_are() -> None:
    blocks = blocks_of(page("docs/cmake.md"), "cmake")
    assert len(blocks) == 3
    for _, file, code in blocks:
        assert code in (REPOSITORY / "examples" / file).read_text(encoding="utf-8")

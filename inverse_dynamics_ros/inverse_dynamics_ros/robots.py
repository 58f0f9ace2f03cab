# SPDX-License-Identifier: Apache-2.0
"""Run configurations of inverse_dynamics_robots, and where descriptions of their robots come from.

robot = load_robot("ur10_real")
description = robot_description(robot, "auto")
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

if TYPE_CHECKING:
    from launch.some_substitutions_type import SomeSubstitutionsType

# Where a description may come from, as --show-args says it.
SOURCES = {
    "auto": "xacro where the manufacturer's description package is installed, else urdf",
    "xacro": "the manufacturer's description package, expanded by the tool xacro",
    "urdf": "the plain URDF of inverse_dynamics_robots",
}

# Keys of a run configuration that the launch files understand or may leave aside.
_USED = ("plugin", "urdf", "root", "tip", "gravity", "friction", "joints", "effort", "drive_gains")
_KEYS = {*_USED, "accelerations", "schema", "name", "description", "topic", "source", "simulation"}
_SCHEMA = 1


@dataclass(frozen=True)
class Xacro:
    """A robot's description in its manufacturer's package."""

    package: str
    file: str
    arguments: tuple[str, ...]


# By the file name of the plain URDF that describes the same robot.
_XACROS = {
    "ur10.urdf": Xacro("ur_description", "urdf/ur.urdf.xacro", ("name:=ur10", "ur_type:=ur10")),
    "panda.urdf": Xacro("franka_description", "robots/fer/fer.urdf.xacro", ("hand:=false",)),
}


def robot_names() -> list[str]:
    """Names of the run configurations."""
    directory = Path(get_package_share_directory("inverse_dynamics_robots")) / "robots"
    return sorted(file.stem for file in directory.glob("*.yaml"))


def load_robot(name: str) -> dict[str, Any]:
    """The run configuration of that name; its keys are those of docs/add_a_robot.md.

    Raises ValueError: no such name; not keys with values; a key that the launch files don't know.
    """
    if name not in robot_names():
        raise ValueError(f"robot: expected one of {', '.join(robot_names())}, got '{name}'")
    share = Path(get_package_share_directory("inverse_dynamics_robots"))
    file = share / "robots" / f"{name}.yaml"
    configuration: dict[str, Any] = yaml.safe_load(file.read_text(encoding="utf-8"))
    if not isinstance(configuration, dict):
        raise ValueError(f"{file}: expected keys with values")
    if configuration.get("schema") != _SCHEMA:
        raise ValueError(f"{file}: schema: expected {_SCHEMA}, got {configuration.get('schema')}")
    for key in configuration:
        if key not in _KEYS:
            raise ValueError(f"{file}: {key}: unknown key; known here: {', '.join(sorted(_KEYS))}")
    return configuration


def robot_description(robot: dict[str, Any], source: str) -> tuple[SomeSubstitutionsType, str]:
    """Description of a robot as a launch substitution, and in words where it is from.

    source: one of SOURCES. Raises PackageNotFoundError: xacro is asked for, but not the package.
    """
    from launch.substitutions import Command, FindExecutable

    package, _, path = robot["urdf"].removeprefix("package://").partition("/")
    file = Path(get_package_share_directory(package)) / path
    xacro = _XACROS.get(file.name)
    if source != "urdf" and xacro is not None:
        try:
            share = Path(get_package_share_directory(xacro.package))
        except PackageNotFoundError:
            if source == "xacro":
                raise
        else:
            command = [FindExecutable(name="xacro"), " ", str(share / xacro.file)]
            for argument in xacro.arguments:
                command += [" ", argument]
            return Command(command), f"{xacro.package}/{xacro.file}, by xacro"
    why = f" ({xacro.package} is not installed)" if source == "auto" and xacro else ""
    return file.read_text(), f"{package}/{path}{why}"

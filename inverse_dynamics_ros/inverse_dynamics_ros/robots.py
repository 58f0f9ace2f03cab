# SPDX-License-Identifier: Apache-2.0
"""Where descriptions of the project's robots come from.

description, origin = robot_description("ur10_real", "auto")
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

if TYPE_CHECKING:
    from launch.some_substitutions_type import SomeSubstitutionsType

# Where a description may come from, as --show-args says it.
SOURCES = {
    "auto": "xacro where the manufacturer's description package is installed, else urdf",
    "xacro": "the manufacturer's description package, expanded by the tool xacro",
    "urdf": "the plain URDF that the run configuration names",
}


@dataclass(frozen=True)
class Xacro:
    """A robot's description in its manufacturer's package."""

    package: str
    file: str
    arguments: tuple[str, ...]


_UR10 = Xacro("ur_description", "urdf/ur.urdf.xacro", ("name:=ur10", "ur_type:=ur10"))
_PANDA = Xacro("franka_description", "robots/fer/fer.urdf.xacro", ("hand:=false",))
# By the name of the run configuration.
_XACROS = {
    "ur10_real": _UR10,
    "ur10_simulated": _UR10,
    "panda_real": _PANDA,
    "panda_simulated": _PANDA,
}


def robot_description(robot: str, source: str) -> tuple[SomeSubstitutionsType, str]:
    """Description of a robot as a launch substitution, and in words where it is from.

    robot: name of a run configuration. source: one of SOURCES. Empty: the run configuration's.
    Raises PackageNotFoundError: xacro is asked for, but not the package.
    """
    from launch.substitutions import Command, FindExecutable

    xacro = _XACROS[robot]
    if source != "urdf":
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
    why = f" ({xacro.package} is not installed)" if source == "auto" else ""
    return "", f"the run configuration's{why}"

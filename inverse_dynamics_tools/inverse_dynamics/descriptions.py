# SPDX-License-Identifier: Apache-2.0
"""Robot descriptions: the text of a URDF file, or of a .xacro file after the xacro tool."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from inverse_dynamics.errors import RobotError


def read_description(file: Path) -> str:
    """URDF text of a .urdf or .xacro file. Raises RobotError."""
    if not file.is_file():
        raise RobotError(f"{file}: no such file; expected a robot description (URDF or .xacro)")
    if file.suffix == ".xacro":
        return _expanded(file)
    try:
        return file.read_text()
    except OSError as error:
        raise RobotError(f"{file}: can't be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise RobotError(f"{file}: isn't a text file; expected a URDF") from error


def joint_units(
    file: Path | None, description: str, joint_names: tuple[str, ...]
) -> tuple[str, ...]:
    """Unit of each joint's torque: N for a prismatic joint of the URDF, else N m.

    file: where the description is from, for errors. Raises RobotError if it isn't XML.
    """
    import xml.etree.ElementTree as ElementTree

    prismatic = set()
    if description:
        try:
            joints = ElementTree.fromstring(description).iter("joint")
        except ElementTree.ParseError as error:
            raise RobotError(f"{file}: isn't a robot description: no XML ({error})") from error
        prismatic = {j.get("name") for j in joints if j.get("type") == "prismatic"}
    return tuple("N" if name in prismatic else "N m" for name in joint_names)


def _expanded(file: Path) -> str:
    tool = shutil.which("xacro") or shutil.which("xacro", path=str(Path(sys.executable).parent))
    if tool is None:
        raise RobotError(
            f"{file}: needs the tool xacro, which isn't installed; `pip install xacro`, or expand "
            f"it elsewhere: xacro {file.name} > {file.stem}"
        )
    result = subprocess.run([tool, str(file)], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        reason = result.stderr.strip() or f"exit code {result.returncode}"
        raise RobotError(f"{file}: xacro can't expand it: {reason}")
    return result.stdout

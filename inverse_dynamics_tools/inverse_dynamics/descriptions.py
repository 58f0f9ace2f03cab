# SPDX-License-Identifier: Apache-2.0
"""Robot descriptions: the text of a URDF file, or of a .xacro file after the xacro tool."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from inverse_dynamics.joint_log import Floats


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
    joints = _joints(file, description)
    prismatic = {j.get("name") for j in joints if j.get("type") == "prismatic"}
    return tuple("N" if name in prismatic else "N m" for name in joint_names)


def effort_limits(file: Path | None, description: str, joint_names: Sequence[str]) -> Floats:
    """(n,) N m (prismatic N) of the URDF; infinite for a joint without one.

    file: where the description is from, for errors. Raises RobotError if it isn't XML, or if a
    limit isn't a number.
    """
    limits = np.full(len(joint_names), np.inf)
    for joint in _joints(file, description):
        limit = joint.find("limit")
        text = None if limit is None else limit.get("effort")
        if joint.get("name") not in joint_names or text is None:
            continue
        try:
            number = float(text)
        except ValueError:
            raise RobotError(
                f"{file}: joint {joint.get('name')}: limit: expected a number as effort, got "
                f"'{text}'"
            ) from None
        if number > 0:  # zero states none
            limits[list(joint_names).index(joint.get("name", ""))] = number
    return limits


def _joints(file: Path | None, description: str) -> list[Element]:
    import xml.etree.ElementTree as ElementTree

    if not description:
        return []
    try:
        return list(ElementTree.fromstring(description).iter("joint"))
    except ElementTree.ParseError as error:
        raise RobotError(f"{file}: isn't a robot description: no XML ({error})") from error


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

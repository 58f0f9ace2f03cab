# SPDX-License-Identifier: Apache-2.0
"""YAML whose mistakes can be pointed at: every value knows its file, line and key.

    robot = read_mapping(Path("robot.yaml"), RobotError)
    name = robot.required("name").text()
    robot.reject_others()

Read in C++: chain_dynamics/located_yaml.hpp says how strictly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics import _core
from inverse_dynamics._core import YamlMap as Mapping
from inverse_dynamics._core import YamlValue as Value

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.errors import UserError

__all__ = ["Mapping", "Value", "parse_mapping", "read_mapping"]


def read_mapping(file: Path, error: type[UserError]) -> Mapping:
    """Read a YAML file that holds keys with values. error: what is raised, now and by its values."""
    return _core.read_yaml(file, error).mapping()


def parse_mapping(text: str, file: str, error: type[UserError]) -> Mapping:
    """Read the YAML of a file, or of what `file` calls it."""
    return _core.parse_yaml(text.encode("utf-8", "surrogatepass"), file, error).mapping()

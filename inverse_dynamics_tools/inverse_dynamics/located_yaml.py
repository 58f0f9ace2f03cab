# SPDX-License-Identifier: Apache-2.0
"""YAML whose mistakes can be pointed at: every value knows its file, line and key.

    robot = read_mapping(Path("robot.yaml"), RobotError)
    name = robot.required("name").text()
    robot.reject_others()

Strict: what isn't asked for is an error, so is a key that stands twice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn

import yaml

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from inverse_dynamics.errors import UserError


@dataclass
class Value:
    """A value and where it stands."""

    node: yaml.Node
    file: Path
    key: str
    error: type[UserError]

    @property
    def where(self) -> str:
        """`file:line: key`, as error texts begin."""
        place = f"{self.file}:{self.node.start_mark.line + 1}"
        return f"{place}: {self.key}" if self.key else place

    def fail(self, expected: str, remedy: str = "") -> NoReturn:
        """Raise the error that says what was expected here."""
        got = self._shown()
        raise self.error(f"{self.where}: expected {expected}, got {got}{remedy and '; ' + remedy}")

    def data(self) -> Any:
        """The value as plain Python data."""
        return yaml.SafeLoader("").construct_document(self.node)

    def text(self, one_of: Collection[str] = ()) -> str:
        """A text; one of these, if any are given."""
        value = self.data()
        if not isinstance(value, str):
            self.fail("a text")
        if one_of and value not in one_of:
            self.fail(f"one of {', '.join(one_of)}")
        return value

    def number(self) -> float:
        """A finite number."""
        value = self.data()
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.fail("a number")
        if not math.isfinite(value):
            self.fail("a finite number")
        return float(value)

    def integer(self) -> int:
        """An integer."""
        value = self.data()
        if isinstance(value, bool) or not isinstance(value, int):
            self.fail("an integer")
        return value

    def truth(self) -> bool:
        """True or false."""
        value = self.data()
        if not isinstance(value, bool):
            self.fail("true or false")
        return value

    def entries(self, length: int | None = None) -> list[Value]:
        """A list; of this length, if one is given."""
        if not isinstance(self.node, yaml.SequenceNode):
            self.fail("a list" if length is None else f"a list of {length}")
        if length is not None and len(self.node.value) != length:
            self.fail(f"a list of {length}")
        return [
            Value(node, self.file, f"{self.key}[{i}]", self.error)
            for i, node in enumerate(self.node.value)
        ]

    def mapping(self) -> Mapping:
        """Keys with values."""
        if not isinstance(self.node, yaml.MappingNode):
            self.fail("keys with values")
        values: dict[str, Value] = {}
        for key_node, value_node in self.node.value:
            inner = str(key_node.value)
            name = f"{self.key}.{inner}" if self.key else inner
            value = Value(value_node, self.file, name, self.error)
            if inner in values:
                line = key_node.start_mark.line + 1
                raise self.error(f"{self.file}:{line}: {name}: stands here for a second time")
            values[inner] = value
        return Mapping(self, values)

    def _shown(self) -> str:
        if isinstance(self.node, yaml.MappingNode):
            return "keys with values"
        if isinstance(self.node, yaml.SequenceNode):
            return f"a list of {len(self.node.value)}"
        return f"'{self.node.value}'" if self.node.value else "nothing"


@dataclass
class Mapping:
    """Keys with values, and which of them have been asked for."""

    value: Value
    values: dict[str, Value]
    asked: list[str] = field(default_factory=list)

    def required(self, key: str) -> Value:
        """The value of a key that must be there."""
        found = self.optional(key)
        if found is None:
            keys = ", ".join(self.values) or "none"
            raise self.value.error(f"{self.value.where}: the key {key} is missing; keys: {keys}")
        return found

    def optional(self, key: str) -> Value | None:
        """The value of a key, or None if it is absent or null."""
        self.asked.append(key)
        found = self.values.get(key)
        if found is not None and found.node.tag == "tag:yaml.org,2002:null":
            return None
        return found

    def reject_others(self) -> None:
        """Raise the error for a key that nobody has asked for."""
        for key, value in self.values.items():
            if key not in self.asked:
                raise self.value.error(
                    f"{value.where}: unknown key; known here: {', '.join(self.asked)}"
                )


def read_mapping(file: Path, error: type[UserError]) -> Mapping:
    """Read a YAML file that holds keys with values."""
    try:
        node = yaml.compose(file.read_text(), Loader=yaml.SafeLoader)
    except OSError as problem:
        raise error(f"{file}: can't be read ({problem.strerror})") from problem
    except UnicodeDecodeError as problem:
        raise error(f"{file}: isn't a text file; expected YAML") from problem
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark
        line = f":{mark.line + 1}" if mark else ""
        raise error(f"{file}{line}: isn't YAML: {problem.problem}") from problem
    except yaml.YAMLError as problem:
        raise error(f"{file}: isn't YAML: {problem}") from problem
    if node is None:
        raise error(f"{file}: is empty; expected keys with values")
    return Value(node, file, "", error).mapping()

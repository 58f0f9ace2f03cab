# SPDX-License-Identifier: Apache-2.0
"""YAML whose mistakes can be pointed at: every value knows its file, line and key.

    robot = read_mapping(Path("robot.yaml"), RobotError)
    name = robot.required("name").text()
    robot.reject_others()

Strict: what isn't asked for is an error, so is a key that stands twice. Values without quotes have
the types of the core schema of YAML 1.2: `1:30` and `1_000` are texts, `yes` is one too, `1e-3` is a
number. Tags, aliases and other encodings than UTF-8 are errors.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NoReturn

import yaml

from inverse_dynamics.base.decimals import DECIMAL
from inverse_dynamics.base.wording import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from inverse_dynamics.errors import UserError

Scalar = bool | int | float | str

_MOST_BYTES = 4 * 2**20
_MOST_VALUES = 200_000
_MOST_LEVELS = 50
_NULLS = {"", "~", "null", "Null", "NULL"}
_TRUTHS = {
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
_INTEGER = re.compile(r"[-+]?[0-9]+")
_NO_CHARACTER = re.compile("[\0\ud800-\udfff]")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


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

    @property
    def is_list(self) -> bool:
        """Whether entries() may be called."""
        return isinstance(self.node, yaml.SequenceNode)

    @property
    def is_mapping(self) -> bool:
        """Whether mapping() may be called."""
        return isinstance(self.node, yaml.MappingNode)

    @property
    def is_null(self) -> bool:
        """Whether there is a key, but nothing behind it."""
        return self._plain in _NULLS

    def scalar(self) -> Scalar:
        """A text, a finite number, an integer, true or false: what it looks like."""
        if not isinstance(self.node, yaml.ScalarNode) or self.is_null:
            self.fail("a text, a number, true or false")
        word = self._plain
        if word is None:
            return str(self.node.value)
        if word in _TRUTHS:
            return _TRUTHS[word]
        if _INTEGER.fullmatch(word):
            return self.integer()
        if DECIMAL.fullmatch(word) or _NOT_FINITE.fullmatch(word):
            return self.number()
        return word

    def text(self, one_of: Collection[str] = ()) -> str:
        """A text; one of these, if any are given."""
        if not isinstance(self.node, yaml.ScalarNode):
            self.fail("a text")
        value = str(self.node.value)
        if one_of and value not in one_of:
            self.fail(f"one of {', '.join(one_of)}", did_you_mean(value, one_of))
        if self._plain is not None and not isinstance(self.scalar(), str):
            self.fail("a text", "put it in quotes")
        return value

    def number(self) -> float:
        """A finite number."""
        word = self._plain
        if word is None or not (DECIMAL.fullmatch(word) or _NOT_FINITE.fullmatch(word)):
            self.fail("a number")
        value = math.nan if _NOT_FINITE.fullmatch(word) else float(word)
        if not math.isfinite(value):
            self.fail("a finite number")
        return value

    def integer(self) -> int:
        """An integer of 64 bits."""
        word = self._plain
        if word is None or not _INTEGER.fullmatch(word):
            self.fail("an integer")
        if len(word) > 20 or not -(2**63) <= int(word) < 2**63:
            self.fail("an integer of at most 64 bits")
        return int(word)

    def truth(self) -> bool:
        """True or false."""
        if self._plain not in _TRUTHS:
            self.fail("true or false")
        return _TRUTHS[self._plain]

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
            if not isinstance(key_node, yaml.ScalarNode):
                Value(key_node, self.file, self.key, self.error).fail("a text as a key")
            inner = str(key_node.value)
            name = f"{self.key}.{inner}" if self.key else inner
            value = Value(value_node, self.file, name, self.error)
            if inner in values:
                line = key_node.start_mark.line + 1
                raise self.error(f"{self.file}:{line}: {name}: stands here for a second time")
            values[inner] = value
        return Mapping(self, values)

    @property
    def _plain(self) -> str | None:
        """What stands there without quotes."""
        plain = isinstance(self.node, yaml.ScalarNode) and self.node.style is None
        return str(self.node.value) if plain else None

    def _shown(self) -> str:
        if isinstance(self.node, yaml.MappingNode):
            return "keys with values"
        if isinstance(self.node, yaml.SequenceNode):
            return f"a list of {len(self.node.value)}"
        if not self.key:
            return "a text"  # a whole file, perhaps a wrong one
        return shown(self.node.value) if self.node.value else "nothing"


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
        return None if found is None or found.is_null else found

    def reject_others(self) -> None:
        """Raise the error for a key that nobody has asked for."""
        for key, value in self.values.items():
            if key not in self.asked:
                known = ", ".join(dict.fromkeys(self.asked))
                hint = did_you_mean(key, self.asked)
                raise self.value.error(
                    f"{value.where}: unknown key{hint and f'; {hint}'}; known here: {known}"
                )


def read_mapping(file: Path, error: type[UserError]) -> Mapping:
    """Read a YAML file that holds keys with values."""
    return parse_mapping(_text_of(file, error), file, error)


def parse_mapping(text: str, file: Path, error: type[UserError]) -> Mapping:
    """Read the YAML of a file."""
    try:
        node = yaml.compose(text, Loader=_Loader)
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark
        line = f":{mark.line + 1}" if mark else ""
        raise error(f"{file}{line}: isn't YAML: {problem.problem}") from problem
    except yaml.reader.ReaderError as problem:
        line = f":{text.count(chr(10), 0, problem.position) + 1}"
        got = shown(chr(problem.character))
        raise error(f"{file}{line}: isn't YAML: the character {got} isn't allowed") from problem
    if node is None:
        raise error(f"{file}: is empty; expected keys with values")
    return Value(node, file, "", error).mapping()


def _text_of(file: Path, error: type[UserError]) -> str:
    try:
        with file.open("rb") as stream:
            data = stream.read(_MOST_BYTES + 1)
    except OSError as problem:
        raise error(f"{file}: can't be read ({problem.strerror})") from problem
    if len(data) > _MOST_BYTES:
        raise error(f"{file}: expected YAML of at most {_MOST_BYTES >> 20} MiB, got a longer file")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data.count(b"\n", 0, problem.start) + 1
        raise error(
            f"{file}:{line}: isn't text in UTF-8; expected YAML; save it in that encoding"
        ) from problem


class _Loader(yaml.BaseLoader):
    """Composes nodes without any types, and refuses what no configuration needs."""

    levels = 0
    values = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        refused = ""
        if isinstance(event, yaml.AliasEvent):
            refused = f"the alias *{event.anchor} isn't supported; write out what it stands for"
        elif getattr(event, "tag", None) is not None:
            refused = f"the tag {shown(event.tag)} isn't supported; leave it out"
        elif self.levels == _MOST_LEVELS:
            refused = f"expected at most {_MOST_LEVELS} levels, got more"
        elif self.values == _MOST_VALUES:
            refused = f"expected at most {_MOST_VALUES} values, got more"
        if refused:
            raise yaml.MarkedYAMLError(problem=refused, problem_mark=event.start_mark)
        self.levels += 1
        self.values += 1
        node = super().compose_node(parent, index)
        self.levels -= 1
        return node

    def scan_flow_scalar_non_spaces(self, double: bool, start_mark: yaml.Mark) -> list[str]:
        try:
            found = super().scan_flow_scalar_non_spaces(double, start_mark)
        except (ValueError, OverflowError):  # of chr()
            found = ["\0"]
        if any(map(_NO_CHARACTER.search, found)):
            self._refuse(
                "an escape stands for NUL, a surrogate or a code above 10ffff; write the character "
                "itself"
            )
        return list(found)

    def scan_yaml_directive_number(self, start_mark: yaml.Mark) -> int:
        if self.prefix(10).isdecimal():
            self._refuse("expected a version of at most 9 digits")
        return int(super().scan_yaml_directive_number(start_mark))

    def _refuse(self, problem: str) -> NoReturn:
        raise yaml.MarkedYAMLError(problem=problem, problem_mark=self.get_mark())

# SPDX-License-Identifier: Apache-2.0
"""Spoils a YAML file one line at a time, whatever it says."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from mutations import spoiled_numbers, typos

if TYPE_CHECKING:
    from collections.abc import Iterator

_KEY = re.compile(r"^(?P<before>\s*(?:- )?)(?P<key>\w+):(?P<value>.*)$")
_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")
# Beside what is never a number: what YAML 1.1 takes for one.
_NUMBERS_OF_YAML_1_1 = {"sexagesimal": "1:30", "binary": "0b11"}


class Spoiled(NamedTuple):
    """A text with one fault; line: where it is, from 1."""

    name: str
    line: int
    text: str


def spoiled(text: str) -> Iterator[Spoiled]:
    """Each key misspelt, left out, twice; the first number of each line as none."""
    lines = text.splitlines()
    prose = _prose(lines)
    for index, line in enumerate(lines):
        if line.lstrip().startswith("#") or index in prose:
            continue
        for name, changed in _changes(line):
            whole = "\n".join([*lines[:index], *changed, *lines[index + 1 :], ""])
            yield Spoiled(f"line {index + 1}, {name}", index + 1, whole)


def _prose(lines: list[str]) -> set[int]:
    """Indices of the lines of block scalars: no fault of theirs is one of the file."""
    prose: set[int] = set()
    begun = None  # indentation of the key whose text goes on
    for index, line in enumerate(lines):
        indentation = len(line) - len(line.lstrip())
        if begun is not None and (indentation > begun or not line.strip()):
            prose.add(index)
            continue
        begun = indentation if line.rstrip().endswith((">", ">-", "|")) else None
    return prose


def _changes(line: str) -> Iterator[tuple[str, list[str]]]:
    found = _KEY.match(line)
    if found:
        before, key, value = found["before"], found["key"], found["value"]
        for what, typo in typos(key).items():
            yield f"{key}: {what}", [f"{before}{typo}:{value}"]
        if value.strip() and not value.strip().startswith((">", "|")):
            yield f"{key}: twice", [line, f"{' ' * len(before)}{key}:{value}"]
    content = line.split("  #")[0]
    number = _NUMBER.search(content, content.find(":") + 1)
    if number:
        for what, text in {**spoiled_numbers(number[0]), **_NUMBERS_OF_YAML_1_1}.items():
            # Nothing at all would be a value that isn't given.
            written = text if text.strip() else f'"{text}"'
            yield f"{number[0]}: {what}", [line[: number.start()] + written + line[number.end() :]]


# What isn't a file with keys and values at all: name and bytes.
NOT_A_MAPPING: dict[str, bytes] = {
    "empty": b"",
    "only a comment": b"# nothing\n",
    "a comma": b",",
    "a comma and keys": b", schema: 1\n",
    "a quoted heading of a table": b'"time","position.a","velocity.a"\n1,2,3\n',
    "a heading of a table": b"time,position.a\n1,2\n",
    "a list": b"- 1\n- 2\n",
    "a text": b"robot",
    "tabs": b"schema:\t1\n\tname: a\n",
    "two documents": b"schema: 1\n---\nschema: 1\n",
    "binary": bytes(range(256)),
    "NUL bytes": b"schema: 1\n\0\0\0",
    "UTF-16": "schema: 1\n".encode("utf-16"),
    "Latin-1": "name: Müller\n".encode("latin-1"),
    "deep nesting": b"[" * 100_000,
    "deep mappings": b"{a: " * 20_000,
    "unclosed quote": b'name: "arm\n',
    "a tag of Python": b"!!python/object/apply:os.system [true]\n",
    "a float that is none": b"schema: !!float abc\n",
    "400 digits": b"schema: " + b"9" * 400 + b"\n",
    "aliases that expand each other": b"a: &a [x, x]\n"
    + b"".join(
        b"%c: &%c [%b]\n" % (c, c, b", ".join([b"*%c" % (c - 1)] * 9)) for c in b"bcdefghij"
    ),
    "an alias of itself": b"a: &a [*a]\n",
    "URDF": b'<?xml version="1.0"?>\n<robot name="arm"/>\n',
}

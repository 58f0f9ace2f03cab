# SPDX-License-Identifier: Apache-2.0
"""Words of texts, and texts made fit for a terminal."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

TERMINAL = "INVERSE_DYNAMICS_IDS"
"""Set in the environment of the command `ids` and its workers: messages name its options."""

# A command, which stays as it is; or an option, perhaps with its value.
_OPTION = re.compile(
    r"`[^`]*`|\bids [a-z]+ [^;,]*| \(ids: --[a-z-]+\)|"
    r"(?<![\w-])--([a-z][a-z-]+)(?: \(\w+=\))?"
    r"(?: ('[^']*'|(?:(?<=effort-is )|(?<=clock )|(?<=friction )|(?<=accept ))(?!(?:and|or)\b)[a-z_]+|"
    r"[\w.]+=\.\.\.|[A-Z]+(?:,[A-Z]+)*(?![\w=])|"
    r"[^\s;:)]*[=\d/](?:[^\s;:)]*[^\s;:),.])?|[^\s;:,]+(?=:)))?"
)
_ARGUMENTS = {
    "from": "start",
    "to": "end",
    "parameter": "parameters",
    "known-payload": "known_payloads",
    "without-rule": "without_rules",
}
_SWITCHES = {"overwrite": "True", "optimise": "True", "no-friction": "False", "from-model": "True"}
_OF_LIMITS = ("torque", "velocity")  # of retime()
_LISTS = ("scale", "accept", "without-rule", "known-payload", "hold-out")
_NUMBERS = re.compile(r"[-+.\de]+(,[-+.\de]+)*|[A-Z]+(,[A-Z]+)*")
_BODY = re.compile(r"([^,]+),([^,]+,[^,]+,[^,]+)")
_LONGEST_WORD = 1000  # characters
_LONGEST_TEXT = 10_000
_WORD = re.compile(rf"\S{{{_LONGEST_WORD + 1},}}")


def counted(count: int, noun: str) -> str:
    """A number of things: `1 joint`, `6 joints`."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def solver_name(plugin: str) -> str:
    """A solver's short name for tables: its package's name without the common ending.

    `kdl` for kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL.
    """
    package = plugin.partition("/")[0]
    return package.removesuffix("_inverse_dynamics_solver") or plugin


def shown(text: object, longest: int = 60) -> str:
    """A text from a file, for an error message: quoted, short, without control characters."""
    return f"'{harmless(text, longest)}'"


def harmless(text: object, longest: int = 60) -> str:
    """The same without quotes."""
    quoted = repr(str(text)[: longest + 1])[1:-1].replace("\\'", "'")
    return quoted if len(str(text)) <= longest else f"{quoted[:longest]}..."


def listed(names: Sequence[str], most: int = 6) -> str:
    """The first few names from a file for an error message."""
    others = f" and {len(names) - most} others" if len(names) > most else ""
    return ", ".join(harmless(name) for name in names[:most]) + others


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """`did you mean tool0?`, or "" where nothing that is known is like the word."""
    from difflib import get_close_matches

    if len(word) > _LONGEST_WORD:
        return ""
    plain, word = {other.lstrip("-"): other for other in known}, word.lstrip("-")
    close = get_close_matches(word, plain, cutoff=0.65)
    best = min(close, key=lambda other: abs(len(other) - len(word)), default="")
    return f"did you mean {plain[best]}?" if best else ""


def not_built(package: str) -> str:
    """Why a package isn't there that is built on request only, and how to build it."""
    return (
        f"package {package}: not in any sourced workspace, as it is built only on request: "
        f"{how_to_build(package)}"
    )


def how_to_build(package: str) -> str:
    """The commands that build a package and make it known."""
    return (
        f"`./scripts/build --packages-select {package}` in the workspace, then "
        "`source install/local_setup.bash`"
    )


def printable(text: str) -> str:
    """The text without what a terminal acts on: control characters become escapes.

    Lines stay lines. Lone surrogates (names of files that aren't UTF-8) become escapes too. What
    is printable already is left as it is.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n " else _escape(c) for c in text)


def message(text: str) -> str:
    """A message for the terminal: printable, of bearable length, its further lines indented."""
    text = _WORD.sub(lambda word: _shortened(word[0], _LONGEST_WORD), printable(text).strip())
    first, *others = _shortened(text, _LONGEST_TEXT).splitlines() or [""]
    return "\n".join([first, *(line if line.startswith(" ") else f"  {line}" for line in others)])


def _shortened(text: str, most: int) -> str:
    if len(text) <= most:
        return text
    return f"{text[: most // 2]} [... {len(text)} characters ...] {text[-most // 4 :]}"


def _escape(character: str) -> str:
    code = ord(character)
    if code < 0x100:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def told(text: str) -> str:
    """A message as it is told here: with options in a terminal, with arguments of functions in Python."""
    return text if TERMINAL in os.environ else in_python(text)


def in_python(text: str) -> str:
    """A message with arguments of functions in place of options: `columns='time=t'` for `--columns 'time=t'`."""
    return _OPTION.sub(_argument, text).replace("'] accept=['", "', '")


def _argument(found: re.Match[str]) -> str:
    option, value = found.groups()
    if option is None:
        return "" if found[0].startswith(" (ids:") else found[0]
    name = _ARGUMENTS.get(option, option.replace("-", "_").removeprefix("no_"))
    if option in _SWITCHES:
        return f"{name}={_SWITCHES[option]}"
    if option in _OF_LIMITS and value is None:
        return f"limits=MotionLimits({name}=...)"
    if value is None:
        begins = found.start() == 0 and found.string[found.end() :].startswith(":")
        return name if begins else f"{name}="
    value = value.strip("'")
    if option == "payload" and (body := _BODY.fullmatch(value)):
        center = body[2].replace(",", ", ")
        return f"parameters={{'payload.mass': {body[1]}, 'payload.center_of_mass': [{center}]}}"
    if option == "parameter":
        key, _, number = value.partition("=")
        return f"{name}={{'{key}': {number}}}"
    if option not in _LISTS and _NUMBERS.fullmatch(value):
        return f"{name}=({value.replace(',', ', ')})" if "," in value else f"{name}={value}"
    return f"{name}=['{value}']" if option in _LISTS else f"{name}='{value}'"

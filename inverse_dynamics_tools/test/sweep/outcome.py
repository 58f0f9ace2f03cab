# SPDX-License-Identifier: Apache-2.0
"""What became of one input, and whether that is right.

An input is refused, accepted with a warning, or accepted because it is right. Anything else is a
fault: a traceback, a signal, too much time or memory, a message without a place, other torques.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

LONGEST_MESSAGE = 2000  # characters
RELATIVE_TOLERANCE = 1e-9  # of the greatest torque

# A list, of topics for one, stands on indented lines of its own.
_CONTROL = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]|\n(?!  )")


@dataclass(frozen=True)
class Outcome:
    """What an entry point did: `refused` (text), `accepted` (warnings, torques) or `failed` (text)."""

    kind: str
    text: str = ""
    warnings: tuple[str, ...] = ()
    torques: tuple[float, ...] = ()


@dataclass(frozen=True)
class Expected:
    """What may become of an input.

    refused, warned, right: whether it may be refused, accepted with a warning, accepted silently.
    place: what a refusal must match (regular expression): file, line, element, key or argument.
    mention: what one of the warnings must match.
    torques: those of the right reading; none: not compared.
    """

    refused: bool = True
    warned: bool = False
    right: bool = False
    place: str = ""
    mention: str = ""
    torques: tuple[float, ...] = ()


@dataclass(frozen=True)
class Case:
    """An input, given to one entry point."""

    name: str
    act: Callable[[], Outcome]
    expected: Expected = field(default_factory=Expected)


@dataclass(frozen=True)
class Verdict:
    """`refused`, `warned`, `right` or `WRONG`, and why."""

    kind: str
    why: str


def judged(outcome: Outcome, expected: Expected) -> Verdict:
    """Whether an outcome is one of the expected ones."""
    if outcome.kind == "failed":
        return Verdict("WRONG", outcome.text)
    if outcome.kind == "refused":
        fault = _fault_of_message(outcome.text, expected)
        return Verdict("WRONG", fault) if fault else Verdict("refused", outcome.text)
    if expected.torques and not _agree(outcome.torques, expected.torques):
        return Verdict("WRONG", f"other torques: {outcome.torques} instead of {expected.torques}")
    mentioned = [text for text in outcome.warnings if re.search(expected.mention, text)]
    if expected.warned and mentioned:
        return Verdict("warned", mentioned[0])
    if expected.right:
        return Verdict("right", "; ".join(outcome.warnings))
    return Verdict("WRONG", f"accepted; warnings: {list(outcome.warnings)}")


def _fault_of_message(text: str, expected: Expected) -> str:
    if not expected.refused:
        return f"refused, but it is right: {text}"
    if _CONTROL.search(text):
        return f"message with control characters or lines that aren't indented: {text!r}"
    if len(text) > LONGEST_MESSAGE:
        return f"message of {len(text)} characters: {text[:200]!r}"
    if not re.search(expected.place, text):
        return f"message without the place ({expected.place}): {text}"
    return ""


def _agree(torques: tuple[float, ...], expected: tuple[float, ...]) -> bool:
    if len(torques) != len(expected):
        return False
    scale = max(map(abs, expected), default=0.0)
    return bool(np.allclose(torques, expected, rtol=0, atol=RELATIVE_TOLERANCE * max(scale, 1e-12)))

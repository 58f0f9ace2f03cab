# SPDX-License-Identifier: Apache-2.0
"""docs/command_line.md says what the program does."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from inverse_dynamics import cli

PAGE = Path(__file__).resolve().parents[2] / "docs" / "command_line.md"


def verbs(parser: argparse.ArgumentParser) -> dict[str, str]:
    """The lines of `ids --help`, without those of packages that are built on request."""
    (action,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    lines = {choice.dest: choice.help for choice in action._choices_actions}
    return {verb: line for verb, line in lines.items() if verb in cli.verb_modules()}


def test_the_table_of_verbs_is_that_of_the_help() -> None:
    first = PAGE.read_text().partition("\n## ")[0]
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", first, re.MULTILINE))
    assert rows == verbs(cli.make_parser())


def test_the_exit_statuses_are_those_of_the_help() -> None:
    rows = re.findall(r"^\| (\d(?:[\w +]*)) \| \w", PAGE.read_text(), re.MULTILINE)
    assert rows == ["0", "1", "2", "3", "128 + N"]
    told = re.search(r"Exit status: (.*)", cli.make_parser().format_help(), re.DOTALL)[1]
    assert sorted(re.findall(r"\b(0|1|2|3|128 \+ N)\b", told)) == sorted(rows)

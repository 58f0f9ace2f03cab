# SPDX-License-Identifier: Apache-2.0
"""docs/command_line.md says what the program does."""

from __future__ import annotations

import argparse
import re
import shlex
from contextlib import suppress
from pathlib import Path

import pytest

from inverse_dynamics import cli

ROOT = Path(__file__).resolve().parents[4]
PAGE = ROOT / "docs" / "command_line.md"


def verbs(parser: argparse.ArgumentParser) -> dict[str, str]:
    """The lines of `ids --help`, without those of packages that are built on request."""
    (action,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    lines = {choice.dest: choice.help for choice in action._choices_actions}
    return {
        verb: line
        for verb, line in lines.items()
        if verb in cli.verb_modules().keys() - cli.BUILT_ON_REQUEST.keys()
    }


def test_the_table_of_verbs_is_that_of_the_help() -> None:
    first = PAGE.read_text().partition("\n## ")[0]
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", first, re.MULTILINE))
    assert rows == verbs(cli.make_parser())


def test_the_exit_statuses_are_those_of_the_help() -> None:
    rows = re.findall(r"^\| (\d(?:[\w +]*)) \| \w", PAGE.read_text(), re.MULTILINE)
    assert rows == ["0", "1", "2", "3", "128 + N"]
    told = re.search(r"Exit status: (.*)", cli.make_parser().format_help(), re.DOTALL)[1]
    assert sorted(re.findall(r"\b(0|1|2|3|128 \+ N)\b", told)) == sorted(rows)


@pytest.mark.parametrize(
    "page", [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")], ids=lambda page: page.name
)
def test_the_program_knows_every_option_that_pages_name(page, capsys) -> None:
    text = re.sub(r"\\\n *", "", page.read_text(encoding="utf-8"))
    for command in re.findall(r"(?:^ *|`)ids ((?!help)[a-z][^`\n#|&>\\]*)", text, re.MULTILINE):
        with suppress(SystemExit):  # of a command without its arguments
            cli.make_parser().parse_args(shlex.split(command))
        assert not re.search("unrecognized|invalid choice", capsys.readouterr().err), command

# SPDX-License-Identifier: Apache-2.0
"""--help on a terminal of 80 columns."""

from __future__ import annotations

import re
import sys

import pytest

from inverse_dynamics import cli
from inverse_dynamics.terminal.help_text import wrapped


@pytest.mark.parametrize("verb", [(), *((verb,) for verb in cli.verb_modules())])
def test_help_has_an_example_and_fits_the_terminal(ids, monkeypatch, verb):
    monkeypatch.setenv("COLUMNS", "80")
    code, out, _ = ids(*verb, "--help")
    assert code == 0
    assert re.search(rf"^  ids {verb[0] if verb else ''}", out, re.MULTILINE)
    assert [line for line in out.splitlines() if len(line) > 80] == []


@pytest.mark.parametrize("verb", [(), *((verb,) for verb in cli.verb_modules())])
def test_short_help_fits_one_screen(ids, monkeypatch, verb):
    monkeypatch.setenv("COLUMNS", "80")
    code, out, _ = ids(*verb, "-h")
    lines = out.splitlines()
    assert code == 0
    assert lines[0].startswith(" ".join(("usage: ids", *verb)))
    assert len(lines) <= 23  # and the prompt
    assert [line for line in lines if len(line) > 80] == []
    assert "--help" in lines[-1]
    assert not re.search(r" (options|overrides of the run configuration|the path):", out)
    _, whole, _ = ids(*verb, "--help")
    assert {*re.findall(r"--[\w-]+", out)} <= {*re.findall(r"--[\w-]+", whole)}


def test_errors_fit_the_terminal(ids, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    for arguments in (["evalute"], ["evaluate", "no.csv", "--urdf", f"{'x' * 30}.urdf"]):
        *_, err = ids(*arguments)
        lines = err.splitlines()
        assert len(lines) > 1
        assert [line for line in lines if len(line) > 80] == []


def test_rows_paragraphs_and_commands_are_told_apart():
    text = (
        "results:\n"
        "  name.json    first second\n"
        "               third\n"
        "  other        x\n"
        "\n"
        "  ids verb --option value \\\n"
        "      --more a_long_value_that_stays_where_it_is\n"
        "      what it is for\n"
        "a paragraph\n"
        "of two lines\n"
    )
    assert wrapped(text, 28) == [
        "results:",
        "  name.json    first second",
        "               third",
        "  other        x",
        "",
        "  ids verb --option value \\",
        "      --more a_long_value_that_stays_where_it_is",
        "      what it is for",
        "a paragraph of two lines",
    ]
    assert wrapped(text, 80)[1] == "  name.json    first second third"

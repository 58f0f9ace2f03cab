# SPDX-License-Identifier: Apache-2.0
"""The code on the page `docs/add_a_solver.md` is code of the example package, letter by letter."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1]
PAGE = PACKAGE.parent / "docs" / "add_a_solver.md"
EXAMPLE = PACKAGE / "examples" / "pendulum_inverse_dynamics_solver"

# A fenced block, its indentation, and the comment above it that names a file of the example.
BLOCK = re.compile(
    r"(?:^ *<!-- file: (?P<file>\S+) -->\n)?^(?P<indent> *)```(?P<language>\w+)\n(?P<code>.*?)^ *```$",
    re.MULTILINE | re.DOTALL,
)


def quotations(page: str) -> list[tuple[str, str, str]]:
    """Language, file (empty if not named) and unindented code of each block of the page."""
    return [
        (match["language"], match["file"] or "", textwrap.dedent(match["code"]))
        for match in BLOCK.finditer(page)
    ]


def page_blocks() -> list[tuple[str, str, str]]:
    if not PAGE.is_file():
        pytest.skip(f"{PAGE} isn't there: this package was taken out of its repository")
    return quotations(PAGE.read_text(encoding="utf-8"))


def test_blocks_are_recognized() -> None:
    page = "1. x\n\n   <!-- file: a.cpp -->\n   ```cpp\n   int a;\n     int b;\n   ```\n\n```console\nls\n```\n"
    assert quotations(page) == [("cpp", "a.cpp", "int a;\n  int b;\n"), ("console", "", "ls\n")]


def test_every_block_of_code_names_its_file() -> None:
    blocks = page_blocks()
    assert {language for language, _, _ in blocks} == {"console", "cpp", "cmake", "xml"}
    for language, file, code in blocks:
        assert (language == "console") == (file == ""), code


def test_blocks_equal_the_files() -> None:
    for _, file, code in page_blocks():
        if file:
            assert code in (EXAMPLE / file).read_text(encoding="utf-8"), (
                f"{file} has no such lines:\n{code}"
            )

# SPDX-License-Identifier: Apache-2.0
"""README.md and docs/index.md show the examples of this package as they stand, and their true output."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from pages import blocks_of, page

PACKAGE = Path(__file__).resolve().parent.parent
PAGES = {"torques.cpp": "docs/index.md", "torques.py": "README.md"}


def code(file: Path) -> str:
    """The file without its license line."""
    return "".join(file.read_text(encoding="utf-8").splitlines(keepends=True)[1:])


@pytest.mark.parametrize(("name", "language"), [("torques.cpp", "cpp"), ("torques.py", "python")])
def test_the_page_shows_the_example_as_it_stands(name: str, language: str) -> None:
    assert code(PACKAGE / name) in [block.code for block in blocks_of(page(PAGES[name]), language)]


@pytest.mark.parametrize(
    ("name", "command"),
    [
        ("torques.cpp", [os.environ.get("TORQUES", "torques")]),
        ("torques.py", [sys.executable, str(PACKAGE / "torques.py")]),
    ],
)
def test_the_page_shows_the_output_of_the_example(name: str, command: list[str]) -> None:
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    (output,) = blocks_of(page(PAGES[name]), "text")
    assert run.stdout == output.code

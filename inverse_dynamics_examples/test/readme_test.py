# SPDX-License-Identifier: Apache-2.0
"""README.md shows the examples of this package as they stand, and their true output."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from pages import blocks_of, page

PACKAGE = Path(__file__).resolve().parent.parent
README = page("README.md")


def code(file: Path) -> str:
    """The file without its license line."""
    return "".join(file.read_text(encoding="utf-8").splitlines(keepends=True)[1:])


@pytest.mark.parametrize(("name", "language"), [("torques.cpp", "cpp"), ("torques.py", "python")])
def test_readme_shows_the_example_as_it_stands(name: str, language: str) -> None:
    assert code(PACKAGE / name) in [block.code for block in blocks_of(README, language)]


@pytest.mark.parametrize(
    ("command", "output"),
    [
        ([os.environ.get("TORQUES", "torques")], 0),
        ([sys.executable, str(PACKAGE / "torques.py")], 1),
    ],
)
def test_readme_shows_the_output_of_the_example(command: list[str], output: int) -> None:
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert run.stdout == blocks_of(README, "text")[output].code

# SPDX-License-Identifier: Apache-2.0
"""Pages show the programs of examples/ as they stand, and their true output."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from pages import REPOSITORY, blocks_of, page

EXAMPLES = REPOSITORY / "examples"
PAGES = {
    "torques.cpp": "docs/index.md",
    "torques.py": "README.md",
    "track_and_stop.cpp": "docs/control.md",
    "notice_contact.cpp": "docs/contact.md",
}


@pytest.mark.parametrize("name", PAGES)
def test_the_page_shows_lines_of_the_example(name: str) -> None:
    example = (EXAMPLES / name).read_text(encoding="utf-8")
    language = "python" if name.endswith(".py") else "cpp"
    assert [block for block in blocks_of(page(PAGES[name]), language) if block.code in example]


@pytest.mark.parametrize("name", PAGES)
def test_the_page_shows_the_output_of_the_example(name: str) -> None:
    program = EXAMPLES / name
    python = [sys.executable, str(program)]
    command = python if name.endswith(".py") else [os.environ[program.stem.upper()]]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert run.stdout == blocks_of(page(PAGES[name]), "text")[0].code

# SPDX-License-Identifier: Apache-2.0
"""The pages `docs/control.md` and `docs/contact.md` show example programs as they stand, and their true output."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLES = [("control", "track_and_stop"), ("contact", "notice_contact")]


def blocks(page: str, language: str) -> list[str]:
    """Code of a page's blocks in a language."""
    file = PACKAGE.parent / "docs" / f"{page}.md"
    if not file.is_file():
        pytest.skip(f"{file} isn't there: this package was taken out of its repository")
    return re.findall(rf"```{language}\n(.*?)```", file.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize(("page", "program"), EXAMPLES)
def test_page_shows_lines_of_the_example(page: str, program: str) -> None:
    example = (PACKAGE / "examples" / f"{program}.cpp").read_text(encoding="utf-8")
    assert len(blocks(page, "cpp")) == 1
    assert blocks(page, "cpp")[0] in example


@pytest.mark.parametrize(("page", "program"), EXAMPLES)
def test_page_shows_the_output_of_the_example(page: str, program: str) -> None:
    run = subprocess.run([os.environ[program.upper()]], capture_output=True, text=True, check=True)
    assert blocks(page, "text")[0] == run.stdout

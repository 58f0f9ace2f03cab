# SPDX-License-Identifier: Apache-2.0
"""The page `docs/control.md` shows the example program as it stands, and its true output."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1]
PAGE = PACKAGE.parent / "docs" / "control.md"


def blocks(language: str) -> list[str]:
    """Code of the page's blocks in a language."""
    if not PAGE.is_file():
        pytest.skip(f"{PAGE} isn't there: this package was taken out of its repository")
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_page_shows_lines_of_the_example() -> None:
    example = (PACKAGE / "examples" / "track_and_stop.cpp").read_text(encoding="utf-8")
    assert len(blocks("cpp")) == 1
    assert blocks("cpp")[0] in example


def test_page_shows_the_output_of_the_example() -> None:
    run = subprocess.run([os.environ["TRACK_AND_STOP"]], capture_output=True, text=True, check=True)
    assert blocks("text")[0] == run.stdout

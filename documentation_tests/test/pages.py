# SPDX-License-Identifier: Apache-2.0
"""Blocks of code on the pages of the documentation, for tests that hold the pages to their word."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

REPOSITORY = Path(__file__).resolve().parents[2]

# A fenced block, its indentation, and the comment above it that names a file.
_BLOCK = re.compile(
    r"(?:^ *<!-- file: (?P<file>\S+) -->\n)?^(?P<indentation> *)```(?P<language>\w+)\n(?P<code>.*?)^ *```$",
    re.MULTILINE | re.DOTALL,
)


class Block(NamedTuple):
    """A fenced block, without its indentation; file: that the comment above names, else empty."""

    language: str
    file: str
    code: str


def blocks_of(text: str, *languages: str) -> list[Block]:
    """Blocks in order of the page; of these languages only, if any are given."""
    blocks = [
        Block(match["language"], match["file"] or "", _without(match["indentation"], match["code"]))
        for match in _BLOCK.finditer(text)
    ]
    return [block for block in blocks if not languages or block.language in languages]


def _without(indentation: str, code: str) -> str:
    """Code without the indentation of its fences."""
    return re.sub(f"^{indentation}", "", code, flags=re.MULTILINE)


def page(name: str) -> str:
    """Text of a page, by its path from the root of the repository."""
    return (REPOSITORY / name).read_text(encoding="utf-8")


# Makes evaluations without the figures that nothing looks at: half a second each.
NO_FIGURES = 'ids() { command ids "$@" $([ "$1" != evaluate ] || echo --figures none); }\n'


def run(block: Block, directory: Path, before: str = "") -> str:
    """Run a block of bash or python word for word; give what it prints. A failure ends the test.

    before: what is run in front of it, in the same shell or program.
    """
    command = {"bash": ["bash", "-euo", "pipefail", "-c"], "python": [sys.executable, "-c"]}
    done = subprocess.run(
        [*command[block.language], before + block.code],
        cwd=directory,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, f"{block.code}\n{done.stdout}\n{done.stderr}"
    return done.stdout

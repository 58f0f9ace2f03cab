# SPDX-License-Identifier: Apache-2.0
"""What studies share: the real robots, tables in Markdown and their place in the pages of docs/."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

ROBOTS = {"ur10_real": "ur10_exciting_trajectory", "panda_real": "panda_exciting_trajectory"}
"""Real robots, and their recordings."""

DOCS = Path(__file__).resolve().parent.parent / "docs"


def row(*cells: object) -> str:
    """One row of a table."""
    return f"| {' | '.join(map(str, cells))} |"


def table(names: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A table with these names of columns."""
    names = list(names)
    return "\n".join([row(*names), "|" + "---|" * len(names), *(row(*cells) for cells in rows)])


def replace_in_page(page: str, study: str, text: str) -> None:
    """Put the text between the comments of a study."""
    begin, end = (f"<!-- scripts/{study}: {place} -->" for place in ("begin", "end"))
    file = DOCS / page
    before, rest = file.read_text(encoding="utf-8").split(begin)
    file.write_text(f"{before}{begin}\n\n{text}\n\n{end}{rest.split(end)[1]}", encoding="utf-8")

# SPDX-License-Identifier: Apache-2.0
"""Measured figures in README.md and docs/ name what backs them. Called by `./scripts/lint claims`.

A section that states a measurement (a time, a ratio of speeds, an error that was found) says how to
repeat it, in one of these ways:

- `<!-- backed by: PATH [PATH...] -->`: tests, programs or data of the repository;
- a table that a program writes between comments that name it (`<!-- ids bench: calls -->`);
- a line `To repeat:` with paths in backquotes.

All paths must exist. Whole pages that a program writes say so in their second line.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parent.parent

# Words that come with a measurement; settings, limits and units alone aren't among them.
MEASUREMENT = re.compile(
    r"\d[\d.]* ?(?:ns|µs)\b"  # times of calls
    r"|\btimes as fast\b|\btimes closer\b"
    r"|\*\*Measured\*\*|^## Measured$"
    r"|\broot mean square(?: errors?)? of\s+\d|\bRMSE of\s+\d|\bfrom \d[\d.]* to \d[\d.]* N m\b"
    r"|\bagrees? with \w+ to \d|\bto \d[\d.]* N m;"
    r"|\bon data that it hasn't seen\b",
    re.MULTILINE,
)
BACKED = re.compile(r"(?<!`)<!--\s+backed\s+by:\s+(.*?)\s+-->", re.DOTALL)
GENERATED = re.compile(r"<!-- (?:ids bench|long_recording\.py|scripts/\w+)\b.*?-->")
REPEAT = re.compile(r"To repeat:(.*?)(?:\n\n|\Z)", re.DOTALL)
WRITTEN = re.compile(r"\A.*\n<!-- Written by (\S+?)\.? -->")


def sections(text: str) -> Iterator[tuple[int, str]]:
    """Line number and text of each part from one heading to the next, without fenced blocks."""
    kept: list[str] = []
    fenced = False
    for line in text.splitlines():
        fence = line.lstrip().startswith("```")
        kept.append("" if fenced or fence else line)
        fenced ^= fence
    begin = 0
    for i in range(1, len(kept) + 1):
        if i == len(kept) or kept[i].startswith("#"):
            yield begin + 1, "\n".join(kept[begin:i])
            begin = i


def paths_of(section: str) -> list[str]:
    """What the section says backs its figures."""
    paths = [
        word for match in BACKED.finditer(section) for word in match[1].replace(",", " ").split()
    ]
    for match in REPEAT.finditer(section):
        paths += re.findall(r"`([\w./-]+/[\w./-]+)`", match[1])
    return paths


def faults_of(text: str, page: str, root: Path = ROOT) -> list[str]:
    """One line for each section whose measurements nothing backs, and for each path that isn't there."""
    faults = []
    written = WRITTEN.match(text)
    for line, section in sections(text):
        paths = paths_of(section)
        faults += [
            f"{page}:{line}: backed by {path}, which doesn't exist"
            for path in paths
            if not (root / path).exists()
        ]
        found = MEASUREMENT.search(section)
        if found and not (written or paths or GENERATED.search(section)):
            at = line + section[: found.start()].count("\n")
            faults.append(
                f"{page}:{at}: '{found[0]}': nothing says how to repeat this measurement: expected in its"
                " section <!-- backed by: PATH -->, a generated table, or 'To repeat: `PATH`'"
            )
    return faults


def main() -> int:
    """Check all pages; 1 if one has a fault."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    faults = [
        fault
        for page in pages
        for fault in faults_of(page.read_text(encoding="utf-8"), str(page.relative_to(ROOT)))
    ]
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

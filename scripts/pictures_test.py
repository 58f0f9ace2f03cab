# SPDX-License-Identifier: Apache-2.0
"""Pictures of the documentation are those of the present sources."""

import json
import re
from pathlib import Path

import pytest
from pictures import PICTURES, RECORD, ROOT, SOURCES, digest, stale


def test_no_picture_is_stale() -> None:
    assert stale() == [], "make them again: ./scripts/pictures " + " ".join(stale())


@pytest.mark.parametrize("name", SOURCES)
def test_a_changed_source_makes_the_picture_stale(name: str, tmp_path: Path) -> None:
    pattern = SOURCES[name][0]
    source = tmp_path / pattern.replace("*", "a")
    source.parent.mkdir(parents=True)
    source.write_text("as it was")
    record = tmp_path / RECORD.relative_to(ROOT)
    record.parent.mkdir(parents=True, exist_ok=True)
    record.write_text(json.dumps({each: digest(each, tmp_path) for each in SOURCES}))
    assert stale(tmp_path) == []
    source.write_text("changed")
    assert stale(tmp_path) == [name]


def test_every_picture_is_shown_and_every_shown_picture_exists() -> None:
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    shown = set()
    for page in pages:
        for target in re.findall(r"!\[[^\]]*\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                shown.add((page.parent / target).resolve())
    made = {file for file in PICTURES.iterdir() if file.suffix in {".png", ".gif", ".svg"}}
    assert shown == made

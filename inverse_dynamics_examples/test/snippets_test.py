# SPDX-License-Identifier: Apache-2.0
"""The code on the page `docs/migration.md` is code of migration_test.cpp, letter by letter."""

from __future__ import annotations

from pathlib import Path

from pages import blocks_of, page


def test_the_code_is_that_of_the_test() -> None:
    (block,) = blocks_of(page("docs/migration.md"))
    assert block.language == "cpp"
    assert block.code in (Path(__file__).parent / block.file).read_text(encoding="utf-8")

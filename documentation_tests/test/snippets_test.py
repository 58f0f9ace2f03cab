# SPDX-License-Identifier: Apache-2.0
"""C++ on pages of the documentation is code of a test that is compiled and run, letter by letter."""

from __future__ import annotations

from pathlib import Path

import pytest
from pages import blocks_of, page


@pytest.mark.parametrize("name", ["docs/migration.md", "docs/payload.md"])
def test_the_code_is_that_of_a_test(name: str) -> None:
    blocks = blocks_of(page(name), "cpp")
    assert blocks
    for block in blocks:
        assert block.code in (Path(__file__).parent / block.file).read_text(encoding="utf-8")

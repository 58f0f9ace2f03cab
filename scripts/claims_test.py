# SPDX-License-Identifier: Apache-2.0
"""Tests of claims.py."""

from pathlib import Path

import pytest
from claims import faults_of

CLAIM = "# Speed\n\nTorques take 96 ns.\n"


def test_a_measurement_that_nothing_backs_is_found() -> None:
    (fault,) = faults_of("# A\n\nText.\n\n" + CLAIM, "page.md")
    assert fault.startswith("page.md:7: '96 ns': nothing says how to repeat")


@pytest.mark.parametrize(
    "backing",
    ["<!-- backed by: a/test.py -->", "<!-- ids bench: calls -->", "To repeat: `a/test.py`."],
)
def test_a_measurement_may_be_backed_in_three_ways(backing: str, tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a/test.py").touch()
    assert faults_of(CLAIM + "\n" + backing + "\n", "page.md", tmp_path) == []


def test_what_backs_a_measurement_must_exist(tmp_path: Path) -> None:
    text = CLAIM + "\n<!-- backed by: a/gone.py -->\n"
    assert faults_of(text, "page.md", tmp_path) == [
        "page.md:1: backed by a/gone.py, which doesn't exist"
    ]


def test_backing_counts_for_its_own_section_only(tmp_path: Path) -> None:
    (tmp_path / "test.py").touch()
    text = CLAIM + "\n## Other\n\n<!-- backed by: test.py -->\n"
    assert len(faults_of(text, "page.md", tmp_path)) == 1


def test_code_states_no_measurement() -> None:
    assert faults_of("# A\n\n```text\n96 ns\n```\n", "page.md") == []

# SPDX-License-Identifier: Apache-2.0
"""docs/retime.md: its commands run word for word; durations and torques are those that the page states."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from pages import blocks_of, page, run

PAGE = page("docs/retime.md")


def test_pick_and_place_takes_the_times_of_the_page(tmp_path: Path) -> None:
    (waypoints,) = blocks_of(PAGE, "yaml")
    (tmp_path / waypoints.file).write_text(waypoints.code)
    for block in blocks_of(PAGE, "bash"):
        run(block, tmp_path)
    empty, loaded = (
        json.loads((tmp_path / name / "retime.json").read_text()) for name in ("fast", "loaded")
    )
    for title, key in (
        ("constant acceleration limit", "duration_by_acceleration"),
        ("torque limits", "duration"),
    ):
        (row,) = (line for line in PAGE.splitlines() if line.startswith(f"| {title} |"))
        stated = [float(cell.removesuffix(" s ")) for cell in row.split("|")[2:4]]
        assert stated == pytest.approx([empty[key], loaded[key]], abs=2e-3)
    for other in (loaded, empty):
        saved = loaded["duration_by_acceleration"] - other["duration"]
        assert f"{saved:.2f} s" in PAGE
    overloaded = json.loads((tmp_path / "overloaded/torques.json").read_text())
    assert f"shows {max(abs(joint['peak']) for joint in overloaded['joints']):.0f} N m of 330" in (
        " ".join(PAGE.split())
    )

# SPDX-License-Identifier: Apache-2.0
"""Recordings that ./scripts/demo fetches."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
TABLE = ROOT / "core/inverse_dynamics_robots/recordings/public.yaml"


def fetched(home: Path, *arguments: object, **environment: str) -> list[str]:
    """What fetch_recordings says, where nothing was fetched before."""
    there = {**os.environ, "XDG_DATA_HOME": str(home), **environment}
    if "IDS_DATA_DIR" not in environment:
        del there["IDS_DATA_DIR"]
    script = 'set -euo pipefail; source scripts/common.bash; enter_install; fetch_recordings "$@"'
    command = ["bash", "-c", script, "demo", *map(str, arguments)]
    run = subprocess.run(command, cwd=ROOT, env=there, capture_output=True, text=True, check=True)
    return (run.stdout + run.stderr).splitlines()


def test_a_place_that_does_not_answer_is_said_in_one_line(tmp_path: Path) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{free.getsockname()[1]}"
    (line,) = fetched(tmp_path, "--from", url)
    assert "No recordings of real robots: " + url in line
    assert line.endswith("can't be reached (Connection refused)")
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_recordings_are_fetched_and_said_from_where(tmp_path: Path) -> None:
    if not (data := os.environ.get("IDS_DATA_DIR")):
        pytest.skip("IDS_DATA_DIR is not set: no recordings of real robots")
    clone = tmp_path / "clone"
    for recording in yaml.safe_load(TABLE.read_text())["recordings"]:
        for file in recording["files"]:
            place = clone / file["source"]
            place.parent.mkdir(parents=True, exist_ok=True)
            name = Path(data) / "bags" / recording["name"] / file["name"]
            licence = Path(data) / "bags/LICENSE.inverse-dynamics-solver"
            shutil.copyfile(name if name.is_file() else licence, place)
    (line,) = fetched(tmp_path / "home", "--from", clone)
    assert f"fetching 1.57 MB (BSD-3-Clause) from file://{clone}" in line
    bags = tmp_path / "home/inverse_dynamics/bags"
    assert sorted(bag.name for bag in bags.iterdir()) == [
        "panda_exciting_trajectory",
        "ur10_exciting_trajectory",
    ]
    assert fetched(tmp_path / "other", IDS_DATA_DIR=data) == []

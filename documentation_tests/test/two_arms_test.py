# SPDX-License-Identifier: Apache-2.0
"""docs/two_arms.md: its commands and its code run word for word."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
import yaml
from pages import REPOSITORY, blocks_of, page, run

sys.path.append(str(REPOSITORY / "python" / "testing"))
from two_arms import JOINTS, written

PAGE = page("docs/two_arms.md")


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the page was followed."""
    directory = tmp_path_factory.mktemp("two_arms")
    written(directory)
    configuration, motion, _ = blocks_of(PAGE, "yaml")
    for name, block in (("two_arms.yaml", configuration), ("swing.yaml", motion)):
        assert f"`{name}`" in PAGE
        (directory / name).write_text(block.code)
    (commands,) = blocks_of(PAGE, "bash")
    run(commands, directory)
    return directory


def test_computed_torques_agree_with_the_simulated_ones(directory: Path) -> None:
    metrics = json.loads((directory / "result/metrics.json").read_text())
    assert tuple(joint["joint"] for joint in metrics["joints"]) == JOINTS
    for joint in metrics["joints"]:
        assert joint["nrmse"] < 0.01  # the accuracy promised of the default filter


def test_the_load_is_that_of_the_tip_named_first(directory: Path) -> None:
    body = yaml.safe_load((directory / "load.yaml").read_text())
    assert body["tip"] == "left_tool"
    assert body["mass"] == pytest.approx(2.0, rel=1e-3)
    assert body["center_of_mass"] == pytest.approx([0, 0, 0.1], abs=1e-3)


def test_the_code_prints_what_the_page_says(directory: Path) -> None:
    (code,), (printed,) = blocks_of(PAGE, "python"), blocks_of(PAGE, "text")
    assert run(code, directory) == printed.code

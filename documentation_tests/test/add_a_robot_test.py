# SPDX-License-Identifier: Apache-2.0
"""docs/add_a_robot.md followed word for word: its files, its commands, what it promises."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from pages import blocks_of, page, run

PAGE = page("docs/add_a_robot.md")


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Where the page was followed, and what its commands printed."""
    directory = tmp_path_factory.mktemp("newcomer")
    (description,) = blocks_of(page("docs/tutorials/my_robot.md"), "xml")
    configuration, payload = blocks_of(PAGE, "yaml")
    (commands,) = blocks_of(PAGE, "bash")
    for name, block in (("my_arm.urdf", description), ("my_arm.yaml", configuration)):
        assert f"`{name}`" in PAGE
        (directory / name).write_text(block.code)
    (directory / "carrying.yaml").write_text(configuration.code + payload.code)
    return directory, run(commands, directory)


def test_the_robot_is_shown(printed: tuple[Path, str]) -> None:
    assert re.search(r"^joints +shoulder, elbow *$", printed[1], re.MULTILINE)


def test_a_payload_is_added(printed: tuple[Path, str]) -> None:
    from inverse_dynamics import load_robot
    from inverse_dynamics.robots.solvers import open_solver

    directory, _ = printed
    description = (directory / "my_arm.urdf").read_text()
    solver = open_solver(load_robot(directory / "carrying.yaml"), description)
    assert solver.payloads["payload"]["mass"] == 2.0
    assert solver.payloads["payload"]["frame"][2, 3] == 0.05
    assert not solver.warnings


def test_the_results_that_the_page_names_are_there(printed: tuple[Path, str]) -> None:
    directory, _ = printed
    named = re.findall(r"`(my_result/[\w.]+)`", PAGE)
    assert sorted(named) == ["my_result/metrics.json", "my_result/torques.png"]
    assert all((directory / name).stat().st_size > 0 for name in named)


def test_computed_torques_agree_with_the_simulated_ones(printed: tuple[Path, str]) -> None:
    metrics = json.loads((printed[0] / "my_result/metrics.json").read_text())
    assert [joint["joint"] for joint in metrics["joints"]] == ["shoulder", "elbow"]
    for joint in metrics["joints"]:
        assert joint["nrmse"] < 0.01  # the accuracy promised of the default filter
        assert joint["max_abs"] < 0.1  # N m, of limits of 60 and 25

# SPDX-License-Identifier: Apache-2.0
"""The tutorials of docs/tutorials followed word for word."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from pages import REPOSITORY, Block, blocks_of, page, run

from inverse_dynamics import load_robot


def test_first_torque_prints_what_the_page_says(tmp_path: Path) -> None:
    text = page("docs/tutorials/first_torque.md")
    code = "".join(block.code for block in blocks_of(text, "python"))
    printed = "".join(block.code for block in blocks_of(text, "text"))
    assert run(Block("python", "", code), tmp_path) == printed


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the page of one's own robot was followed."""
    directory = tmp_path_factory.mktemp("newcomer")
    text = page("docs/tutorials/my_robot.md")
    (description,) = blocks_of(text, "xml")
    (directory / "my_arm.urdf").write_text(description.code)
    for block in blocks_of(text, "python", "bash"):
        run(block, directory)
    return directory


def test_the_friction_of_my_robot_is_what_is_left(followed: Path) -> None:
    for result in ("my_result", "my_named_result"):
        metrics = json.loads((followed / result / "metrics.json").read_text())
        assert [joint["joint"] for joint in metrics["joints"]] == ["shoulder", "elbow"]
        for joint in metrics["joints"]:
            assert 0.3 < joint["rmse"] < 0.42  # N m, of friction of 0.4


def test_my_robot_has_figures_and_a_page(followed: Path) -> None:
    assert (followed / "my_result/torques.png").stat().st_size > 0
    assert "shoulder" in (followed / "my_result/report.html").read_text()


def test_the_control_loop_is_built_and_prints_what_the_page_says(tmp_path: Path) -> None:
    text = page("docs/tutorials/control_loop.md")
    project = REPOSITORY / "examples/control_loop"
    for block in blocks_of(text, "cpp", "cmake"):
        assert block.code in (project / block.file).read_text(), block.code
    subprocess.run(["cmake", "-S", project, "-B", tmp_path], check=True)
    subprocess.run(["cmake", "--build", tmp_path], check=True)
    urdf = load_robot("ur10_simulated").urdf
    assert urdf is not None
    printed = subprocess.run(
        [tmp_path / "control_loop", urdf], check=True, capture_output=True, text=True
    ).stdout
    assert printed == blocks_of(text, "text")[0].code


def test_the_controller_is_configured_as_the_simulation_is() -> None:
    import yaml

    (block,) = blocks_of(page("docs/tutorials/ros2_controller.md"), "yaml")
    shown = yaml.safe_load(block.code)
    file = REPOSITORY / "ros2/inverse_dynamics_simulation/config/ur10.yaml"
    assert _is_part_of(shown, yaml.safe_load(file.read_text(encoding="utf-8")))


def _is_part_of(shown: object, whole: object) -> bool:
    """Every key that is shown has the same value in the whole."""
    if isinstance(shown, dict) and isinstance(whole, dict):
        return all(key in whole and _is_part_of(value, whole[key]) for key, value in shown.items())
    return shown == whole

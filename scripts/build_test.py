# SPDX-License-Identifier: Apache-2.0
"""Tests of what scripts/build and scripts/sweep ask for, with a colcon that only notes it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parent
OPTIONAL = ["inverse_dynamics_benchmarks", "pinocchio_inverse_dynamics_solver"]


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A workspace in which nothing is built."""
    shutil.copytree(SCRIPTS, tmp_path / "scripts", ignore=shutil.ignore_patterns("__pycache__"))
    for file, text in {
        ".venv/bin/colcon": 'printf "%s\\n" "$@" >asked',
        "scripts/setup": "",
    }.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(f"#!/usr/bin/env bash\n{text}\n")
        (tmp_path / file).chmod(0o755)
    (tmp_path / ".venv/bin/python").symlink_to(sys.executable)
    return tmp_path


def asked(workspace: Path, script: str, *arguments: str) -> list[str]:
    """The arguments that colcon gets, but for those of CMake."""
    command = [str(workspace / "scripts" / script), *arguments]
    subprocess.run(command, cwd=workspace, capture_output=True, env=os.environ, check=False)
    words = (workspace / "asked").read_text().splitlines()
    return words[words.index("--parallel-workers") + 2 : words.index("--cmake-args")]


def test_a_plain_build_leaves_the_optional_packages_out(workspace: Path) -> None:
    assert asked(workspace, "build") == ["--packages-ignore", *OPTIONAL]
    assert asked(workspace, "build", "--all") == []


def test_packages_that_the_user_ignores_are_ignored_besides(workspace: Path) -> None:
    words = asked(workspace, "build", "--packages-ignore", "engine", "--packages-up-to", "tools")
    assert words == ["--packages-ignore", *OPTIONAL, "engine", "--packages-up-to", "tools"]


def test_the_sweep_builds_what_it_gives_input_to(workspace: Path) -> None:
    assert asked(workspace, "sweep") == []

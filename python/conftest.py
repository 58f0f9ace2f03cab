# SPDX-License-Identifier: Apache-2.0
"""What tests of the package share: fixtures here, functions in testing/."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

# Tests see what is installed. So this directory, whose package has no extension module, must not be on the path: pytest
# puts it there for this file, and would again for each folder that is a package.
sys.path.remove(str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parent / "testing"))
from example_recordings import motion, recording
from example_robots import RIGID_BODY, URDF

from inverse_dynamics import Identification, Solver, cli, identify

pytest.register_assert_rewrite("command_line", "pages")


@pytest.hookimpl(optionalhook=True)  # since pytest 8; before, tests had no packages above them
def pytest_collect_directory(path: Path, parent: pytest.Collector) -> pytest.Collector:
    """A plain folder, whatever is in it."""
    return pytest.Dir.from_parent(parent, path=path)


@pytest.fixture(scope="session")
def recordings() -> Path:
    """Directory with recordings of real robots; skips where there is none."""
    directory = os.environ.get("IDS_DATA_DIR")
    if not directory:
        pytest.skip("IDS_DATA_DIR is not set: no recordings of real robots")
    return Path(directory) / "bags"


@pytest.fixture(scope="session")
def identified(recordings: Path) -> Callable[[str], Identification]:
    """Models of the real ur10 and panda by name, made once for identification/test/real_arms: ten seconds each."""
    return cache(
        lambda name: identify([recordings / f"{name}_exciting_trajectory"], f"{name}_real")
    )


@pytest.fixture(scope="session")
def solver() -> Solver:
    """Of the description of a UR10."""
    return Solver(RIGID_BODY, urdf=URDF.read_text(), root="base_link", tip="tool0")


@pytest.fixture(scope="session")
def torques(solver: Solver) -> np.ndarray:
    """Of the solver for motion()."""
    return solver.torques(*motion()[:3])


@pytest.fixture(scope="session")
def bag(tmp_path_factory: pytest.TempPathFactory, solver: Solver) -> Path:
    """A recording of a UR10 that is what its description says."""
    path = tmp_path_factory.mktemp("recording") / "motion"
    recording(path, solver)
    return path


@pytest.fixture(autouse=True)
def _no_progress_lines(monkeypatch) -> None:
    """Lines that tell the progress of long work depend on how busy the machine is."""
    monkeypatch.setattr("inverse_dynamics.terminal.screen._FIRST_LINE", float("inf"))


@pytest.fixture
def ids(tmp_path, monkeypatch, capsys):
    """Run `ids` in an empty directory; gives exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")

    def run(*arguments):
        try:
            code = cli.main([str(a) for a in arguments])
        except SystemExit as exit_:  # argparse
            code = exit_.code
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run

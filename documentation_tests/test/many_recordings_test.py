# SPDX-License-Identifier: Apache-2.0
"""docs/many_recordings.md: its commands and its code run word for word; its tables name what there is."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pages import blocks_of, page, run

from inverse_dynamics import JointLog, Solver, write_joint_logs
from inverse_dynamics.evaluation.many_evaluations import COLUMNS

PAGE = page("docs/many_recordings.md")
UR10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the page was followed: two recordings, of which the second has a fault in one joint."""
    directory = tmp_path_factory.mktemp("reader")
    solver = Solver(UR10)
    stamps = 4_000_000 * np.arange(1, 1501, dtype=np.int64)
    speed = 2 * np.pi * np.linspace(0.15, 0.4, 6)
    phase = stamps[:, None] * 1e-9 * speed + np.arange(6)
    q, qd, qdd = np.sin(phase), speed * np.cos(phase), -(speed**2) * np.sin(phase)
    tau = solver.torques(q, qd, qdd)
    log = JointLog(tuple(solver.joint_names), stamps, stamps, q, qd, tau)
    write_joint_logs(directory / "week/monday", {log.topic: log})
    tau[:, 2] *= 0.5
    write_joint_logs(directory / "week/tuesday", {log.topic: replace(log, effort=tau)})
    (command,) = blocks_of(PAGE, "bash")
    assert re.search("^tuesday ", run(command, directory), re.MULTILINE)
    return directory


def test_the_code_of_the_page_prints_what_it_says(directory: Path) -> None:
    (code,) = blocks_of(PAGE, "python")
    (printed,) = blocks_of(PAGE, "text")
    assert run(code, directory) == printed.code


def test_the_files_that_the_page_names_are_there(directory: Path) -> None:
    for name in re.findall(r"^\| (.*?) \|", PAGE, re.MULTILINE):
        for path in re.findall(r"`(results/[\w./]+)`", name):
            assert (directory / path.replace("NAME", "tuesday")).exists(), path


def test_the_columns_that_the_page_names_are_those_of_the_summary() -> None:
    listed = PAGE[PAGE.index("    recording bag robot") : PAGE.index("with `start`")]
    assert listed.split() == list(COLUMNS)

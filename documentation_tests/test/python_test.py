# SPDX-License-Identifier: Apache-2.0
"""docs/python.md: its code runs word for word and prints what the page says."""

from __future__ import annotations

import os
import re
import sys
from inspect import signature
from pathlib import Path

import numpy as np
import pytest
from pages import REPOSITORY, Block, blocks_of, page, run

from inverse_dynamics import Solver, load_robot

PAGE = page("docs/python.md")


def test_the_code_of_the_page_prints_what_it_says(tmp_path: Path) -> None:
    code = "".join(block.code for block in blocks_of(PAGE, "python"))
    printed = "".join(block.code for block in blocks_of(PAGE, "text"))
    assert run(Block("python", "", code), tmp_path) == printed


def test_the_example_of_the_page_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    (example,) = [b for b in blocks_of(PAGE, "bash") if b.code.startswith("python ")]
    assert "shoulder_pan_joint" in run(example, REPOSITORY)


def test_ten_tasks_are_as_short_as_in_pinocchio(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    urdf = load_robot("ur10_simulated").urdf
    assert urdf is not None
    (tmp_path / "arm.urdf").write_bytes(urdf.read_bytes())
    monkeypatch.chdir(tmp_path)
    names = {"Solver": Solver, "rng": np.random.default_rng(1), "tau": np.ones(6), "w": np.ones(6)}
    tasks = re.findall(r"^\| [^|]+ \| `([^`|]+)` \| `([^`|]+)` \|$", PAGE, re.MULTILINE)
    assert len(tasks) == 10
    for ours, pinocchio in tasks:
        exec(ours, names)
        assert len(ours) <= len(pinocchio)


def test_every_argument_is_on_the_page() -> None:
    arguments = set(signature(Solver).parameters) - {"plugin"}
    table = PAGE[PAGE.index("| argument") : PAGE.index("## One state")]
    first_cells = " ".join(line.split("|")[1] for line in table.splitlines() if "`" in line)
    assert set(re.findall(r"`(\w+)`", first_cells)) == arguments

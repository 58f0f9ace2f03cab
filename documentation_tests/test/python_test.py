# SPDX-License-Identifier: Apache-2.0
"""docs/python.md: its code runs word for word and prints what the page says."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import pytest
from pages import REPOSITORY, Block, blocks_of, page, run

from inverse_dynamics import FastModel, Solver

PAGE = page("docs/python.md")


def test_the_code_of_the_page_prints_what_it_says(tmp_path: Path) -> None:
    code = "".join(block.code for block in blocks_of(PAGE, "python"))
    printed = "".join(block.code for block in blocks_of(PAGE, "text"))
    assert run(Block("python", "", code), tmp_path) == printed


def test_the_example_of_the_page_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=os.pathsep)
    (example,) = [b for b in blocks_of(PAGE, "bash") if b.code.startswith("python ")]
    assert "shoulder_pan_joint" in run(example, REPOSITORY)


def test_every_method_is_on_the_page() -> None:
    both = [*vars(Solver).items(), *vars(FastModel).items()]
    public = {name: value for name, value in both if not name.startswith("_")}
    kept = (property, staticmethod)
    methods = {name for name, value in public.items() if not isinstance(value, kept)}
    assert set(re.findall(r"^\| `(\w+)\(", PAGE, re.MULTILINE)) == methods


def test_every_argument_is_on_the_page() -> None:
    signature = (Solver.__init__.__doc__ or "").splitlines()[0]
    arguments = set(re.findall(r"(\w+): ", signature)) - {"self", "plugin"}
    table = PAGE[PAGE.index("| argument") : PAGE.index("## One state")]
    first_cells = " ".join(line.split("|")[1] for line in table.splitlines() if "`" in line)
    assert set(re.findall(r"`(\w+)`", first_cells)) == arguments

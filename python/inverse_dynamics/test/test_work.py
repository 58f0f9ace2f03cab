# SPDX-License-Identifier: Apache-2.0
"""How much a command does before and beside its work: what it imports, what it draws.

Times depend on the machine; what costs time doesn't. `benchmarks/small_recording.py` measures.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

# Imports of tens of milliseconds and more, each.
HEAVY = (
    "PIL",
    "dask",
    "fontTools.subset",
    "importlib.metadata",
    "jinja2",
    "matplotlib",
    "mujoco",
    "numpy",
    "pyarrow",
    "rich",
    "rich.progress",
    "rosbags",
    "scipy",
    "yaml",
    "zipfile",
)
RUN = """\
import sys
before = set(sys.modules)  # whatever this machine imports at each start
from inverse_dynamics.cli import main
try:
    main(sys.argv[2:])
except SystemExit:
    pass
print(*sorted((set(sys.argv[1].split(",")) & set(sys.modules)) - before), file=sys.stderr)
"""


def imported(*command: object, cwd: Path) -> set[str]:
    """Those of HEAVY that a command of ids imports."""
    arguments = [sys.executable, "-c", RUN, ",".join(HEAVY), *map(str, command)]
    finished = subprocess.run(arguments, cwd=cwd, capture_output=True, text=True, check=True)
    return set(finished.stderr.splitlines()[-1].split())


@pytest.mark.parametrize("command", ["--help", "evaluate --help", "simulate --help", "evaluate"])
def test_help_imports_nothing_heavy(command: str, tmp_path: Path) -> None:
    assert imported(*command.split(), cwd=tmp_path) == set()


def test_the_list_of_robots_imports_what_it_reads_and_prints(tmp_path: Path) -> None:
    # Which other wheels bring plugins, importlib.metadata knows; zipfile comes with it.
    allowed = {"importlib.metadata", "numpy", "rich", "zipfile"}
    assert imported("robots", cwd=tmp_path) <= allowed


def test_an_evaluation_without_a_figure_draws_nothing(bag: Path, tmp_path: Path) -> None:
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--figures", "none")
    allowed = {"importlib.metadata", "numpy", "rich", "rosbags", "yaml", "zipfile"}
    assert imported(*command, cwd=tmp_path) <= allowed


def test_a_picture_of_pixels_needs_no_tables_of_fonts(bag: Path, tmp_path: Path) -> None:
    """PDF takes fonts apart; PNG needs the glyphs alone."""
    command = ("evaluate", bag, "--robot", "ur10_simulated")
    assert not {"fontTools.subset", "mujoco", "scipy"} & imported(*command, cwd=tmp_path)

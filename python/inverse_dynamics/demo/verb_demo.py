# SPDX-License-Identifier: Apache-2.0
"""`ids demo`: simulated and real robots on one page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import Options

if TYPE_CHECKING:
    import argparse

    from inverse_dynamics.terminal.screen import Line

PLACE = ("look", 1)
SUMMARY = "simulate and evaluate four robots, show them on one page"
DESCRIPTION = (
    "Simulate a UR10 and a Panda, compute the torques of their motion and, with recordings, of the "
    "real ones; compare them with the measured torques; show it on one page."
)
EPILOG = """\
examples:
  ids demo                                  simulated robots; the real ones too if `ids data` has fetched them
  ids demo --recordings bags --out robots   real ones too, from recordings in the directory bags
  ids demo --quick                          a few seconds of motion: checks the installation

results, written whole or not at all:
  report.html      all robots: 3D view beside the torques, errors, assumptions; needs no network
  ROBOT/           figure (torques.png), errors and series of each robot, as `ids evaluate` writes them
  comparison/      URDF against identified model on the real UR10, as `ids compare` writes it
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.output("DIR", "results (default: demo)", default=Path("demo"), replaces=True)
    options.shared("--json")
    options.add(
        "--recordings DIR",
        "directory with ur10_exciting_trajectory and panda_exciting_trajectory "
        "(default: $IDS_DATA_DIR/bags, else where `ids data` puts them)",
        Path,
    )
    options.add("--quick", "a few seconds of simulated motion")


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.demo.demo import TITLES, find_recordings, run_demo, summary
    from inverse_dynamics.evaluation.tables import robots_table
    from inverse_dynamics.terminal.screen import announce, progress_bar, show

    with progress_bar() as progress:
        demo = run_demo(
            arguments.out,
            recordings=arguments.recordings or find_recordings(),
            overwrite=arguments.overwrite,
            quick=arguments.quick,
            say=announce,
            progress=progress,
        )
    out, comparison = demo.directory, demo.comparison
    robots = {TITLES[name]: evaluation for name, evaluation in demo.evaluations.items()}
    lines: list[Line] = [robots_table(robots)]
    if comparison is not None:
        lines += ["UR10, real: gain by identification", *comparison.lines()]
    lines.append(("note", demo.notes))
    if any(out.glob("*/torques.png")):
        lines.append(("figures", f"{out}/*/torques.png"))
    lines.append(("page", demo.page.absolute()))
    show(arguments, summary(demo.evaluations, demo.notes), [out], lines)

# SPDX-License-Identifier: Apache-2.0
"""`ids compare`: solvers or models on the same recording, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import Options
from inverse_dynamics.terminal.values import names

if TYPE_CHECKING:
    import argparse

    from inverse_dynamics.terminal.screen import Line

PLACE = ("look", 5)
SUMMARY = "put evaluations of one recording side by side"
DESCRIPTION = "Put evaluations of one recording side by side: solvers, models, filters."
EPILOG = """\
examples:
  ids evaluate recording --robot ur10_real --out identified
  ids evaluate recording --robot ur10_real --out urdf \\
      --plugin rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody
  ids compare urdf identified --labels URDF,identified --out comparison
      the gain by identification and friction

results, written whole or not at all:
  comparison.png    measured torque and that of each run, over time; with --figures also .svg, .pdf
  comparison.json   root mean square errors of each joint and run
  report.html       all runs on one page
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.runs("results of `ids evaluate`, two or more")
    options.add(
        "--labels A,B,...",
        "names of the runs (default: what differs between them)",
        names,
        default=(),
    )
    options.output(
        "DIR", "directory for figure and page (default: only the table is printed)", replaces=True
    )
    options.shared("--json")
    options.figures()


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.comparison.comparison import compare
    from inverse_dynamics.comparison.files import CONTENTS, summary, write_comparison
    from inverse_dynamics.comparison.tables import comparison_table
    from inverse_dynamics.evaluation.files import read_evaluation
    from inverse_dynamics.outputs.files import check_output_directory
    from inverse_dynamics.terminal.screen import show
    from inverse_dynamics.terminal.tables import on_screen

    out, overwrite = arguments.out, arguments.overwrite
    if out is not None:
        check_output_directory(out, overwrite=overwrite, contents=CONTENTS, inputs=arguments.runs)
    comparison = compare([read_evaluation(run) for run in arguments.runs], arguments.labels)
    if out is not None:
        write_comparison(comparison, out, overwrite=overwrite, figures=arguments.figures)
    files = [out / f"comparison.{suffix}" for suffix in arguments.figures] if out else []
    lines: list[Line] = [
        on_screen(comparison_table(comparison)),
        ("figure", files),
        ("page", [out / "report.html"] if out else []),
    ]
    show(arguments, summary(comparison), [out], lines)

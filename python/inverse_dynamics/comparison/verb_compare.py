# SPDX-License-Identifier: Apache-2.0
"""`ids compare`: solvers or models on the same recording, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import Options
from inverse_dynamics.terminal.values import names

if TYPE_CHECKING:
    import argparse

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
  series.npz        all of it, for Comparison.load() of Python
  report.html       all runs on one page
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.runs("results of `ids evaluate`, two or more")
    options.add(
        "--labels A,B,...",
        "names of the runs (default: their directories)",
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
    from inverse_dynamics.comparison.comparison import Comparison, compare
    from inverse_dynamics.evaluation.files import read_evaluation
    from inverse_dynamics.terminal.screen import show

    out, overwrite = arguments.out, arguments.overwrite
    if out is not None:
        Comparison.check(out, overwrite=overwrite, inputs=arguments.runs)
    names = [run.absolute().name for run in arguments.runs]
    directories = names if len({*names}) == len(names) else [f"{run}" for run in arguments.runs]
    runs = [read_evaluation(run) for run in arguments.runs]
    comparison = compare(runs, arguments.labels or directories)
    lines = [*comparison.lines()]
    if out is not None:
        comparison.save(out, overwrite=overwrite, figures=arguments.figures)
        figures = [out / f"comparison.{suffix}" for suffix in arguments.figures]
        lines += [("figure", figures), ("page", out / "report.html")]
    show(arguments, comparison.numbers(), [out], lines)

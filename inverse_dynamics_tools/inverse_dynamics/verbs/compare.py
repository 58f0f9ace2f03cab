# SPDX-License-Identifier: Apache-2.0
"""`ids compare`: solvers or models on the same recording, side by side."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.verbs.common import names
from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import add_figures, add_runs, add_verb

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.evaluation.comparison import Comparison

_EPILOG = """\
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


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "compare",
        summary="put evaluations of one recording side by side",
        description="Put evaluations of one recording side by side: solvers, models, filters.",
        epilog=_EPILOG,
        json=True,
    )
    add_runs(parser, ", two or more")
    parser.add_argument(
        "--labels",
        metavar="A,B,...",
        type=names,
        default=(),
        help="names of the runs (default: what differs between them)",
    )
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        help="directory for figure and page (default: only the table is printed)",
    )
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace an older result in that directory, unless it holds other files too",
    )
    add_figures(parser)
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.base.files import check_output_directory
    from inverse_dynamics.evaluation.comparison import compare
    from inverse_dynamics.results.comparisons import CONTENTS, summary, write_comparison
    from inverse_dynamics.results.evaluations import read_evaluation

    if arguments.out is not None:
        check_output_directory(
            arguments.out,
            overwrite=arguments.overwrite,
            contents=CONTENTS,
            inputs=arguments.runs,
        )
    comparison = compare([read_evaluation(run) for run in arguments.runs], arguments.labels)
    if arguments.out is not None:
        write_comparison(
            comparison, arguments.out, overwrite=arguments.overwrite, figures=arguments.figures
        )
    if arguments.json:
        print_json("compare", summary(comparison), filter(None, [arguments.out]))
    else:
        _print(comparison, arguments.out, arguments.figures)


def _print(comparison: Comparison, out: Path | None, figures: Sequence[str]) -> None:
    from inverse_dynamics.verbs.screen import Screen
    from inverse_dynamics.verbs.tables import comparison_table

    console = Screen()
    console.print(comparison_table(comparison))
    if out is not None:
        for suffix in figures:
            console.print(f"figure         {out / f'comparison.{suffix}'}")
        console.print(f"page           {out / 'report.html'}")

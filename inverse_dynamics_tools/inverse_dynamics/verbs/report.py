# SPDX-License-Identifier: Apache-2.0
"""`ids report`: evaluations as one page of HTML."""

from __future__ import annotations

import argparse
from pathlib import Path

from inverse_dynamics.verbs.common import names
from inverse_dynamics.verbs.options import add_runs, add_verb

_EPILOG = """\
examples:
  ids report result                             report.html of one evaluation
  ids report ur10 panda --out robots.html       two on one page

The page is a single file: it needs no network, and can be mailed and printed.
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "report",
        summary="make one HTML page of evaluations: the robot in motion and its torques",
        description="Make one HTML page of evaluations: the robot in motion and its torques.",
        epilog=_EPILOG,
    )
    add_runs(parser)
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=Path,
        default=Path("report.html"),
        help="the page (default: report.html)",
    )
    parser.add_argument("--title", metavar="TEXT", default="", help="headline of the page")
    parser.add_argument(
        "--labels", metavar="A,B,...", type=names, default=(), help="names of the runs"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace an older page")
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.base.files import check_output_file
    from inverse_dynamics.errors import UserError
    from inverse_dynamics.report import report_run, write_page
    from inverse_dynamics.results.evaluations import CONTENTS, read_evaluation
    from inverse_dynamics.verbs.screen import Screen

    check_output_file(
        arguments.out, overwrite=arguments.overwrite, inputs=arguments.runs, results=CONTENTS
    )
    labels = arguments.labels or [""] * len(arguments.runs)
    if len(labels) != len(arguments.runs):
        raise UserError(f"--labels: expected {len(arguments.runs)} names, got {len(labels)}")
    runs = [
        report_run(read_evaluation(directory), label)
        for directory, label in zip(arguments.runs, labels, strict=True)
    ]
    title = arguments.title or f"Measured and computed torques: {', '.join(r.title for r in runs)}"
    write_page(arguments.out, title, runs)
    Screen().print(str(arguments.out))

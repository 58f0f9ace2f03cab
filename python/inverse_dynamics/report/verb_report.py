# SPDX-License-Identifier: Apache-2.0
"""`ids report`: evaluations as one page of HTML."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import Options
from inverse_dynamics.terminal.values import names

if TYPE_CHECKING:
    import argparse

    from inverse_dynamics.show.page import ReportRun

PLACE = ("share", 1)
SUMMARY = "make one page of evaluations: motion and torques"
DESCRIPTION = "Make one HTML page of evaluations: the robot in motion and its torques."
EPILOG = """\
examples:
  ids report result                             report.html of one evaluation
  ids report ur10 panda --out robots.html       two on one page

The page is a single file: it needs no network, and can be mailed and printed.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.runs()
    options.output("FILE", "the page (default: report.html)", default=Path("report.html"))
    options.add("--title TEXT", "headline of the page", default="")
    options.add("--labels A,B,...", "names of the runs", names, default=())


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.errors import UserError
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.evaluation.files import read_evaluation
    from inverse_dynamics.evaluation.page import report_run
    from inverse_dynamics.outputs.files import check_output_file
    from inverse_dynamics.show.page import write_page
    from inverse_dynamics.terminal.screen import Screen, progress_bar

    check_output_file(
        arguments.out,
        overwrite=arguments.overwrite,
        inputs=arguments.runs,
        results=Evaluation.contents,
    )
    labels = arguments.labels or [""] * len(arguments.runs)
    if len(labels) != len(arguments.runs):
        raise UserError(f"--labels: expected {len(arguments.runs)} names, got {len(labels)}")
    pages: list[ReportRun] = []
    with progress_bar() as progress:
        for directory, label in zip(arguments.runs, labels, strict=True):
            progress("drawing", len(pages), len(labels))
            pages.append(report_run(read_evaluation(directory), label))
    title = arguments.title or ", ".join(page.title for page in pages)
    write_page(arguments.out, title, pages)
    Screen().print(str(arguments.out))

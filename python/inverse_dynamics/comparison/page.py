# SPDX-License-Identifier: Apache-2.0
"""A comparison as a page, and as a part of one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from inverse_dynamics.comparison.tables import comparison_table
from inverse_dynamics.evaluation.page import report_run
from inverse_dynamics.show.page import render_page

if TYPE_CHECKING:
    from inverse_dynamics.comparison.comparison import Comparison
    from inverse_dynamics.show.page import ReportRun


def comparison_page(comparison: Comparison) -> str:
    """The page as text."""
    return render_page(comparison.title, [report_comparison(comparison)])


def report_comparison(comparison: Comparison, title: str = "", *, shown: bool = True) -> ReportRun:
    """The first evaluation, with the torques of the others to choose; shown: they are at first."""
    first, *others = comparison.evaluations
    name, *labels = comparison.labels
    run = report_run(first, title or first.bag.name)
    return replace(
        run,
        name=name,
        others={label: e.computed for label, e in zip(labels, others, strict=True)},
        others_shown=shown,
        tables=[comparison_table(comparison), *run.tables],
        assumptions=[*run.assumptions, *((label, e.robot.plugin) for label, e in zip(labels, others, strict=True))],
    )  # fmt: skip

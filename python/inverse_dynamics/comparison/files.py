# SPDX-License-Identifier: Apache-2.0
"""A comparison as a directory of files: `ids compare --help` lists them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from inverse_dynamics.outputs.files import Contents, write_text, written_whole
from inverse_dynamics.outputs.plain import json_text

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.comparison.comparison import Comparison

MARK = "comparison.json"
CONTENTS = Contents(
    MARK, (MARK, "comparison.png", "comparison.svg", "comparison.pdf", "report.html")
)


def write_comparison(
    comparison: Comparison,
    directory: Path,
    *,
    overwrite: bool = False,
    figures: Sequence[str] = ("png",),
    page: bool = True,
) -> None:
    """Write all files of a comparison, or none of them. Raises OutputError.

    figures: of "png", "svg", "pdf". page: whether report.html is among the files.
    """
    from inverse_dynamics.comparison.figure import comparison_figure
    from inverse_dynamics.show.plots import check_formats, save_figure

    check_formats(figures)
    first = comparison.evaluations[0]
    title = f"{first.bag.name}: {' against '.join(comparison.labels)}"
    inputs = [path for e in comparison.evaluations for path in (e.bag, *e.robot.files)]
    with written_whole(directory, overwrite=overwrite, contents=CONTENTS, inputs=inputs) as target:
        write_text(target / MARK, json_text(summary(comparison)))
        files = (target / f"comparison.{f}" for f in figures)
        save_figure(lambda: comparison_figure(comparison), *files)
        if page:
            from inverse_dynamics.comparison.page import report_comparison
            from inverse_dynamics.show.page import write_page

            write_page(target / "report.html", title, [report_comparison(comparison)])


def summary(comparison: Comparison) -> dict[str, Any]:
    """Errors of each run, for JSON."""
    first = comparison.evaluations[0]
    return {
        "schema": 1,
        "bag": str(first.bag),
        "joints": comparison.joint_names,
        "units": first.units,
        "runs": [
            {"label": label, "plugin": evaluation.robot.plugin, "rmse": rmse}
            for label, evaluation, rmse in zip(
                comparison.labels, comparison.evaluations, comparison.rmse, strict=True
            )
        ],
    }

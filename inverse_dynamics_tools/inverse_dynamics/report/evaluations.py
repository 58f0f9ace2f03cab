# SPDX-License-Identifier: Apache-2.0
"""Evaluations and comparisons as the report's page wants them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from inverse_dynamics.base.extras import is_installed
from inverse_dynamics.evaluation.evaluation import CAUSE
from inverse_dynamics.figures import palette
from inverse_dynamics.figures.plots import comparison_figure, svg_of
from inverse_dynamics.figures.scene import Scene, read_scene
from inverse_dynamics.report.figures import error_figure, not_drawn
from inverse_dynamics.report.page import Figure, ReportComparison, ReportRun, ReportTable

if TYPE_CHECKING:
    from inverse_dynamics.evaluation.comparison import Comparison
    from inverse_dynamics.evaluation.evaluation import Evaluation


def report_run(evaluation: Evaluation, title: str = "") -> ReportRun:
    """An evaluation for the page; `title` replaces the robot's name."""
    robot, log = evaluation.robot, evaluation.log
    scene = Scene() if robot.urdf is None else read_scene(robot.urdf, evaluation.joint_names)
    left_out = evaluation.samples.left_out
    causes = [note for note in evaluation.notes if note.startswith(CAUSE)]
    return ReportRun(
        title=title or robot.name,
        description=robot.description,
        solver=robot.plugin,
        time=evaluation.time,
        q=log.q,
        measured=evaluation.measured,
        computed=evaluation.computed,
        table=evaluation.errors,
        other_table=evaluation.errors_of_kept if left_out else (),
        other_table_title=f"The same without {left_out} invalid samples (shaded)",
        assumptions=_assumptions(evaluation),
        cause=causes[-1].removeprefix(CAUSE) if causes else "",
        notes=list(evaluation.notes_without_causes),
        links=scene.links,
        scene_notes=scene.notes,
        left_out=evaluation.samples.left_out_spans(evaluation.log),
        figures=[Figure(_inline(error_figure(evaluation)), _caption(evaluation))],
    )


def _caption(evaluation: Evaluation) -> str:
    text = (
        "Left: errors as a share of each joint's measured range; a box holds the middle half of the "
        "samples, whiskers 90 %. Right: spectra of measured torque and error, mean over the joints, "
        "in the same unit"
    )
    if evaluation.accelerations.cutoff is not None:
        text += "; what lies above the cut-off can't be explained by filtered accelerations"
    return f"{text}."


def report_comparison(
    comparison: Comparison, title: str = "", description: str = ""
) -> ReportComparison:
    """A comparison for the page; empty texts: the recording's name and the labels."""
    first = comparison.evaluations[0]
    svg = not_drawn()
    if is_installed("matplotlib"):
        svg = svg_of(lambda: comparison_figure(comparison))
    return ReportComparison(
        title=title or " against ".join(comparison.labels),
        description=description or f"The same recording, {first.bag.name}, computed in more ways.",
        table=_rmse_table(comparison),
        figure=Figure(
            _inline(svg),
            "Left: measured torque (wide, grey) and what each run computes. Right: computed - measured.",
        ),
    )


def _rmse_table(comparison: Comparison) -> ReportTable:
    units, rmse = comparison.evaluations[0].units, comparison.rmse
    rows = [
        (joint, *values, unit)
        for joint, unit, values in zip(comparison.joint_names, units, rmse.T.tolist(), strict=True)
    ]
    total = len(set(units)) == 1 and len(units) > 1
    if total:
        rows.append(("mean", *rmse.mean(axis=1).tolist(), units[0]))
    headings = ("joint", *comparison.labels, "unit")
    return ReportTable("Root mean square error", headings, rows, total=total)


def _assumptions(evaluation: Evaluation) -> list[tuple[str, str]]:
    robot, log = evaluation.robot, evaluation.log
    gravity = (
        "the model's own"
        if robot.gravity is None
        else "{:g}, {:g}, {:g} m/s²".format(*robot.gravity)
    )
    rows = [
        ("solver", robot.plugin),
        ("model file", robot.model.name if robot.model else ""),
        ("description", robot.urdf.name if robot.urdf else ""),
        ("friction", "as the solver models it" if robot.friction else "left out"),
        ("gravity", gravity),
        ("effort means", evaluation.effort.summary),
        ("accelerations", evaluation.accelerations.summary),
        (
            "recording",
            evaluation.bag.name
            + (f", {log.topic}" if log.topic else "")
            + f", {len(log)} samples, {evaluation.time[-1]:.1f} s",
        ),
        ("source", robot.source),
    ]
    return [(name, text) for name, text in rows if text]


_THEMED = {  # colours of figures, by variable of the page
    palette.PAPER: "paper",
    "#000000": "ink",
    palette.MUTED: "soft",
    palette.GRID: "grid",
    palette.COMPUTED: "computed",
    palette.ERROR: "error",
    **{color: f"run{k}" for k, color in enumerate(palette.RUNS) if k > 0},
}


def _inline(svg: str) -> str:
    """An SVG file as an element of a page, in the page's colours, light or dark."""
    svg = re.sub(r"^.*?(?=<svg)", "", svg, flags=re.DOTALL)

    def themed(style: re.Match[str]) -> str:
        text = style[0]
        for color, variable in _THEMED.items():
            text = re.sub(color, f"var(--{variable}, {color})", text, flags=re.IGNORECASE)
        return text

    return re.sub(r'style="[^"]*"', themed, svg)

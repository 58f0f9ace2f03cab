# SPDX-License-Identifier: Apache-2.0
"""One HTML page, complete in itself (no network), from any number of runs.

write_page(Path("report.html"), "Four robots", [run, ...])
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.outputs.files import write_text_whole
from inverse_dynamics.show import palette
from inverse_dynamics.show.scene import base64_of
from inverse_dynamics.show.tables import ReportTable, joint_table, number
from inverse_dynamics.show.thinning import error_limit, peaks
from inverse_dynamics.wording import printable, solver_name

if TYPE_CHECKING:
    from jinja2 import Template
    from markupsafe import Markup

    from inverse_dynamics._core import JointError
    from inverse_dynamics.arrays import Floats

# Of longer recordings the page draws the lowest and the highest value of each of half as many stretches, so that no
# peak is lost; metrics, bags and tables use every sample. Four robots stay below 10 MB.
MAX_SAMPLES = 12_000
_PIECES = 400  # of a band whose width changes


@dataclass(frozen=True)
class Band:
    """Between two times [s], half the width (n,) of the band about computed torques."""

    start: float
    end: float
    half: Floats


def bands_of(time: Floats, half: Floats) -> list[Band]:
    """A band whose width (N, n) changes with time, as pieces of its mean width."""
    edges = np.unique(np.linspace(0, len(time) - 1, _PIECES + 1).round().astype(int)).tolist()
    return [
        Band(float(time[first]), float(time[after]), half[first:after].mean(axis=0))
        for first, after in pairwise(edges)
    ]


@dataclass(frozen=True)
class ReportRun:
    """One evaluation. Arrays: time N [s], the others N x n; order of joints as `table`."""

    title: str
    description: str
    solver: str
    time: Floats
    q: Floats
    measured: Floats
    computed: Floats
    table: Sequence[JointError]
    assumptions: Sequence[tuple[str, str]]
    name: str = "computed"  # of the computed torques
    links: Sequence[dict[str, Any]] = ()
    tables: Sequence[ReportTable] = ()  # to be unfolded
    notes: Sequence[str] = ()
    others: Mapping[str, Floats] = field(default_factory=dict)  # by title: torques to choose, N x n
    others_shown: bool = False  # at first
    error: Floats | None = None  # N x n of the plots on the right; None: computed - measured
    error_name: str = "error"
    band_name: str = "95 % band"
    bands: Sequence[Band] = ()  # about computed torques, or, where `error` is given, about zero
    left_out: Sequence[tuple[float, float]] = ()  # [s] from, to: samples that are invalid
    contacts: Sequence[tuple[float, float]] = ()  # [s] from, to
    scene_notes: Sequence[str] = ()  # what of the robot isn't drawn as described
    cause: str = ""  # why torques differ, where that was found
    recording: str = ""  # in words
    judged: bool = True  # its errors are shown


@dataclass(frozen=True)
class ReportSummary:
    """What stands before the runs, a table and those below it, and after them: facts, notes, tables to be unfolded."""

    table: ReportTable
    facts_title: str
    facts: Sequence[tuple[str, str]]
    notes: Sequence[str] = ()
    more: Sequence[ReportTable] = ()
    below: Sequence[ReportTable] = ()


def write_page(
    path: Path, title: str, runs: Sequence[ReportRun], notes: Sequence[str] = ()
) -> None:
    """Write the page, whole or not at all; what is there is replaced. Raises OutputError.

    notes: on the page as a whole, as on a robot that is missing.
    """
    write_text_whole(path, render_page(title, runs, notes))


def render_page(
    title: str,
    runs: Sequence[ReportRun],
    notes: Sequence[str] = (),
    summary: ReportSummary | None = None,
) -> str:
    """The page as text."""
    views = [_view(run, i) for i, run in enumerate(runs)]
    return render_players(
        "page.html",
        [_data(run, view["id"]) for run, view in zip(runs, views, strict=True)],
        title=title,
        runs=views,
        glance=_glance(views) if len(views) > 1 and summary is None else None,
        notes=notes,
        summary=summary,
    )


def render_players(name: str, data: Sequence[Mapping[str, Any]], **values: Any) -> str:
    """A page of that name with a player for each section that data describe: see viewer.js."""
    script = "\n".join(map(_asset, ("scene.js", "plots.js", "viewer.js")))
    # JSON that can't end the script element that holds it
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    return template(name).render(script=script, data=text, **values)


def template(name: str) -> Template:
    """A page to be filled in; it has the style, and the filters below."""
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    environment = Environment(
        loader=FunctionLoader(_asset),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        finalize=_printable,
    )
    environment.filters["number"] = number
    environment.filters["breakable"] = _breakable
    environment.globals["style"] = _asset("style.css")
    environment.globals["light"] = _variables(palette.LIGHT)
    environment.globals["dark"] = _variables(palette.DARK)
    return environment.get_template(name)


def _variables(colors: Mapping[str, str]) -> str:
    """As CSS declares them."""
    return " ".join(f"--{name}: {color};" for name, color in colors.items())


def _printable(value: object) -> object:
    """Names without control characters; what is markup already stays."""
    return printable(value) if type(value) is str else value


def _breakable(text: str) -> Markup:
    """Text whose long names may break between their parts; units, as in N m/A, may not."""
    from markupsafe import Markup, escape

    if isinstance(text, Markup):
        return text
    return Markup(re.sub(r"(?<=\w\w)(::|[/_])(?=\w\w)", r"\1<wbr>", str(escape(printable(text)))))


def _asset(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _view(run: ReportRun, index: int) -> dict[str, Any]:
    """A run for the template."""
    rows = list(run.table)
    shares = {row.joint: row.nrmse for row in rows if math.isfinite(row.nrmse)}
    worst = max(shares, key=lambda joint: shares[joint], default=rows[0].joint)
    units, name = {row.unit for row in rows}, f"run-{index + 1}"
    plots = {row.joint: f"{name}-joint-{j}" for j, row in enumerate(rows, 1)}
    named = [joint for joint in plots if joint in run.cause]
    return {
        **vars(run),
        "id": name,
        "solver": solver_name(run.solver),
        "plugin": run.solver,
        "samples": f"{len(run.time):,}",
        "unit": units.pop() if len(units) == 1 else "",
        "mean_rmse": float(np.mean([row.rmse for row in rows])),
        "mean_nrmse": 100 * float(np.mean([*shares.values()])) if shares else math.nan,
        "worst_joint": worst,
        "worst_plot": plots[worst],
        "cause_plot": plots[named[0] if named else worst],
        "worst_nrmse": 100 * shares.get(worst, math.nan),
        "table": joint_table("Errors of each joint", rows),
        "joints": [row.joint for row in rows],
        "thinned": f"{MAX_SAMPLES:,}" if len(run.time) > MAX_SAMPLES else "",
    }


def _glance(views: Sequence[Mapping[str, Any]]) -> ReportTable:
    """All runs."""
    from markupsafe import Markup

    names = ("mean_rmse", "unit", "mean_nrmse", "worst_joint", "worst_nrmse", "solver", "samples")
    return ReportTable(
        "At a glance",
        ("robot", "mean RMSE", "unit", "mean NRMSE [%]", "worst joint", "its NRMSE [%]", "solver", "samples"),
        [
            (
                Markup('<a href="#{}">{}</a>').format(view["id"], printable(view["title"])),
                *(view[name] for name in names),
            )
            for view in views
        ],
    )  # fmt: skip


def _data(run: ReportRun, section: str) -> dict[str, Any]:
    """A run for the script."""
    # The motion in 3D is drawn at screen rate and interpolated: evenly spaced samples serve it.
    stride = math.ceil(len(run.time) / MAX_SAMPLES)
    drawn = np.unique(np.append(np.arange(0, len(run.time), stride), len(run.time) - 1))
    start = run.time[0]
    return {
        "id": section,
        "links": list(run.links),
        "motions": [motion_data(run.time[drawn] - start, run.q[drawn])],
        "plots": [plot for j in range(len(run.table)) for plot in _plots(run, j)],
        "left_out": [[begin - start, end - start] for begin, end in run.left_out],
        "contacts": [[begin - start, end - start] for begin, end in run.contacts],
    }


def motion_data(time: Floats, q: Floats) -> dict[str, Any]:
    """A motion (N,) s, (N, n) for the script."""
    return {"time": base64_of(time, "<f4"), "q": [base64_of(column, "<f4") for column in q.T]}


def series_data(name: str, style: str, time: Floats, values: Floats) -> dict[str, Any]:
    """A series (N,) of a plot for the script. style: a colour of the page."""
    data = {"time": base64_of(time, "<f4"), "values": base64_of(values, "<f4")}
    return {"name": name, "style": style, **data}


def _plots(run: ReportRun, j: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """Torques of a joint, and their errors."""
    start, unit = run.time[0], run.table[j].unit
    measured, error = run.measured[:, j], run.error
    band = [
        {"from": b.start - start, "to": b.end - start, "half": float(b.half[j])} for b in run.bands
    ]
    own = run.computed[:, j] - measured if error is None else error[:, j]
    torques = [_series(run, "measured", "measured", measured)]
    errors = []
    for k, (name, other) in enumerate(run.others.items()):
        hidden, style = {"hidden": not run.others_shown}, f"run{k % 4 + 1}"
        torques.append({**_series(run, name, style, other[:, j]), **hidden})
        error_of_other = _error_series(run, name, style, other[:, j] - measured)
        errors.append({**error_of_other, **hidden})
    torques.append(_series(run, run.name, "computed", run.computed[:, j]))
    errors.append(_error_series(run, run.error_name, "error", own))
    of_torques = band if error is None else []
    return (
        {"label": run.table[j].joint, "unit": unit, "series": torques, "band": of_torques},
        {"label": run.error_name, "unit": unit, "series": errors, "band": band},
    )


def _series(run: ReportRun, name: str, style: str, values: Floats) -> dict[str, Any]:
    """Values for a plot; with times of their own where they are thinned."""
    if len(run.time) > MAX_SAMPLES:
        kept = peaks(values, MAX_SAMPLES)
        return series_data(name, style, run.time[kept] - run.time[0], values[kept])
    return {"name": name, "style": style, "values": base64_of(values, "<f4")}


def _error_series(run: ReportRun, name: str, style: str, values: Floats) -> dict[str, Any]:
    """The same with the limit of its axis."""
    valid = np.ones(len(run.time), dtype=bool)
    for begin, end in run.left_out:
        valid[slice(*np.searchsorted(run.time, (begin, np.nextafter(end, np.inf))))] = False
    limit = error_limit(values[valid]) or 1.0
    return {**_series(run, name, style, values), "limit": limit}

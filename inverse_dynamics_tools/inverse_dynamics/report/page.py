# SPDX-License-Identifier: Apache-2.0
"""One HTML page, complete in itself (no network), from any number of runs.

write_page(Path("report.html"), "Four robots", [run, ...])
"""

from __future__ import annotations

import base64
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.base.files import write_text_whole
from inverse_dynamics.base.wording import printable, solver_name
from inverse_dynamics.figures import palette
from inverse_dynamics.figures.thinning import peaks

if TYPE_CHECKING:
    from jinja2 import Template
    from markupsafe import Markup

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import JointError

# Of longer recordings the page draws the lowest and the highest value of each of half as many stretches, so that no
# peak is lost; metrics, bags and tables use every sample. Four robots stay below 10 MB.
MAX_SAMPLES = 12_000


@dataclass(frozen=True)
class Figure:
    """A static figure of the page."""

    svg: str
    caption: str


@dataclass(frozen=True)
class Band:
    """Between two times [s], half the width (n,) of the band about computed torques."""

    start: float
    end: float
    half: Floats


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
    links: Sequence[dict[str, Any]] = ()
    other_table: Sequence[JointError] = ()
    other_table_title: str = ""
    notes: Sequence[str] = ()
    figures: Sequence[Figure] = field(default_factory=list)
    others: Mapping[str, Floats] = field(default_factory=dict)  # by title: torques to choose, N x n
    bands: Sequence[Band] = ()
    left_out: Sequence[
        tuple[float, float]
    ] = ()  # [s] from, to: samples of other_table's difference
    scene_notes: Sequence[str] = ()  # what of the robot isn't drawn as described
    cause: str = ""  # why torques differ, where that was found


@dataclass(frozen=True)
class ReportTable:
    """A table: rows of texts and numbers, NaN where there is no number; total: the last row sums the others up."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str | float]]
    note: str = ""
    total: bool = False

    @property
    def cells(self) -> list[tuple[str, ...]]:
        """The rows as texts, numbers aligned in each column."""
        return list(zip(*(aligned(column) for column in zip(*self.rows, strict=True)), strict=True))


@dataclass(frozen=True)
class ReportSummary:
    """The part before the runs: a table, facts beside it, notes, and tables to be unfolded."""

    table: ReportTable
    facts_title: str
    facts: Sequence[tuple[str, str]]
    notes: Sequence[str] = ()
    more: Sequence[ReportTable] = ()


@dataclass(frozen=True)
class ReportComparison:
    """Runs of one recording side by side: their errors, and a figure."""

    title: str
    description: str
    table: ReportTable
    figure: Figure


def _joint_table(title: str, errors: Sequence[JointError]) -> ReportTable:
    """Errors of each joint."""
    rows = [(e.joint, e.mae, e.rmse, e.bias, e.unit, 100 * e.nrmse, e.r2) for e in errors]
    return ReportTable(title, ("joint", "MAE", "RMSE", "bias", "unit", "NRMSE [%]", "R²"), rows)


def write_page(
    path: Path,
    title: str,
    runs: Sequence[ReportRun],
    comparisons: Sequence[ReportComparison] = (),
    notes: Sequence[str] = (),
) -> None:
    """Write the page, whole or not at all; what is there is replaced. Raises OutputError.

    notes: what a reader should know of the page as a whole: a robot that is missing, for one.
    """
    write_text_whole(path, render_page(title, runs, comparisons, notes))


def render_page(
    title: str,
    runs: Sequence[ReportRun],
    comparisons: Sequence[ReportComparison] = (),
    notes: Sequence[str] = (),
    summary: ReportSummary | None = None,
) -> str:
    """The page as text."""
    script = "\n".join(_asset(name) for name in ("scene.js", "plots.js", "viewer.js"))
    return template("page.html").render(
        title=title,
        script=script,
        data=_json_for_html([_data(run, i) for i, run in enumerate(runs)]),
        runs=[_view(run, i) for i, run in enumerate(runs)],
        comparisons=comparisons,
        notes=notes,
        summary=summary,
    )


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
    environment.filters["figure"] = _figure
    environment.filters["percents"] = lambda shares: [100.0 * share for share in shares]
    environment.filters["aligned"] = aligned
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
    units = {row.unit for row in rows}
    return {
        **vars(run),
        "id": f"run-{index + 1}",
        "solver": solver_name(run.solver),
        "plugin": run.solver,
        "samples": f"{len(run.time):,}",
        "duration": f"{run.time[-1] - run.time[0]:.1f} s",
        "unit": units.pop() if len(units) == 1 else "",
        "mean_rmse": float(np.mean([row.rmse for row in rows])),
        "mean_nrmse": float(np.mean([*shares.values()])) if shares else math.nan,
        "worst_joint": worst,
        "worst_nrmse": shares.get(worst, math.nan),
        "table": _joint_table("Errors of each joint", rows),
        "other_table": _joint_table(run.other_table_title, run.other_table),
        "joints": [row.joint for row in rows],
        "thinned": f"{MAX_SAMPLES:,}" if len(run.time) > MAX_SAMPLES else "",
    }


def _data(run: ReportRun, index: int) -> dict[str, Any]:
    """A run for the script."""
    # The motion in 3D is drawn at screen rate and interpolated: evenly spaced samples serve it.
    stride = math.ceil(len(run.time) / MAX_SAMPLES)
    keep = np.unique(np.append(np.arange(0, len(run.time), stride), len(run.time) - 1))
    time = run.time - run.time[0]
    error = run.computed - run.measured
    return {
        "id": f"run-{index + 1}",
        "joints": [
            {
                "name": row.joint,
                "unit": row.unit,
                "measured": _series(time, run.measured[:, j]),
                "computed": _series(time, run.computed[:, j]),
                "error": _series(time, error[:, j]),
                "others": [
                    {
                        "name": name,
                        "computed": _series(time, computed[:, j]),
                        "error": _series(time, computed[:, j] - run.measured[:, j]),
                    }
                    for name, computed in run.others.items()
                ],
                "band": [
                    {
                        "from": band.start - run.time[0],
                        "to": band.end - run.time[0],
                        "half": float(band.half[j]),
                    }
                    for band in run.bands
                ],
            }
            for j, row in enumerate(run.table)
        ],
        "left_out": [[begin - run.time[0], end - run.time[0]] for begin, end in run.left_out],
        "time": _base64(time[keep]),
        "q": _base64(run.q[keep].T),
        "links": list(run.links),
    }


def _series(time: Floats, values: Floats) -> dict[str, str]:
    """Values for a plot; with times of their own where they are thinned."""
    if len(time) <= MAX_SAMPLES:
        return {"values": _base64(values)}
    kept = peaks(values, MAX_SAMPLES)
    return {"time": _base64(time[kept]), "values": _base64(values[kept])}


def _base64(values: Floats) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


def _json_for_html(value: Any) -> str:
    """JSON that can't end the script element that holds it."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c")


_MOST_DECIMALS = 8
_FIGURE_SPACE, _PUNCTUATION_SPACE = "\N{FIGURE SPACE}", "\N{PUNCTUATION SPACE}"


def _figure(value: float) -> str:
    """Three significant digits; a dash where there is no number."""
    return aligned([value])[0].rstrip()


def aligned(values: Sequence[str | float]) -> list[str]:
    """The numbers of a column with three significant digits each, their decimal points below each other.

    All plain, or, where one of them would need more than eight decimals, all with exponents. Texts stay.
    """
    numbers = [v for v in values if not isinstance(v, str) and math.isfinite(v) and v != 0.0]
    plain = all(_decimals(value) <= _MOST_DECIMALS for value in numbers)
    texts = [v if isinstance(v, str) else _text(v, plain=plain) for v in values]
    longest = max((len(t.partition(".")[2]) for t in texts if _is_number(t)), default=0)
    return [_padded(text, longest) if _is_number(text) else text for text in texts]


def _decimals(value: float) -> int:
    """How many decimals show three significant digits of a number, which isn't zero."""
    exponent = int(f"{abs(value):.2e}".partition("e")[2])  # of the rounded number: 0.9999 is 1.00
    return max(0, 2 - exponent)


def _text(value: float, *, plain: bool) -> str:
    if not math.isfinite(value):
        return "\N{EN DASH}"
    if not plain:
        return f"{value:.2e}"
    return "0" if value == 0.0 else f"{value:.{_decimals(value)}f}"


def _is_number(text: str) -> bool:
    return text[-1:].isdigit() and text.lstrip("-").replace(".", "", 1).isdigit()


def _padded(text: str, decimals: int) -> str:
    """With spaces as wide as the decimals that other numbers have, which no page may escape."""
    from markupsafe import Markup

    own = len(text.partition(".")[2])
    point = _PUNCTUATION_SPACE if decimals and not own else ""
    return Markup(text + point + _FIGURE_SPACE * (decimals - own))

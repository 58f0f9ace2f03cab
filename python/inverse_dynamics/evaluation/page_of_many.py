# SPDX-License-Identifier: Apache-2.0
"""One page for many recordings of a robot: errors of every joint in each of them, and what failed.

text = render_recordings_page("UR10", summaries, {"tuesday": "no such recording"}, {})
"""

from __future__ import annotations

import math
from datetime import datetime, timezone
from statistics import median
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from inverse_dynamics.show.page import template
from inverse_dynamics.show.tables import aligned
from inverse_dynamics.wording import counted, listed, solver_name

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.evaluation.many_evaluations import EvaluationSummary

_MOST_SHADED = 3.0  # times the median
_EARLIEST = 1e9  # s, September 2001: an earlier stamp is no date


def render_recordings_page(
    title: str,
    summaries: Sequence[EvaluationSummary],
    failures: Mapping[str, str],
    links: Mapping[str, str],
) -> str:
    """The page as text.

    summaries: one or more, of the same joints. failures: recording to message. links: recording to the
    file, in the directory of its name, that the name leads to; none: to the directory.
    """
    columns = list(zip(*([e.rmse for e in s.errors] for s in summaries), strict=True))  # of joints
    middle = [median(column) for column in columns]
    texts = [aligned([*column, m]) for column, m in zip(columns, middle, strict=True)]
    means = [summary.mean_rmse for summary in summaries]
    mean_texts = aligned([*means, median(means)])
    cutoffs = aligned([summary.accelerations.cutoff or math.nan for summary in summaries])
    return template("recordings.html").render(
        title=title,
        facts=_facts(summaries, failures),
        failures=failures.items(),
        joints=summaries[0].errors,
        rows=[
            {
                **_row(summary, middle),
                "texts": [column[k] for column in texts],
                "link": f"{quote(summary.name)}/{links.get(summary.name, '')}",
                "mean": mean_texts[k],
                "cutoff": cutoffs[k],
            }
            for k, summary in enumerate(summaries)
        ],
        median=[column[-1] for column in texts],
        median_mean=mean_texts[-1],
        dated=any(summary.start > _EARLIEST for summary in summaries),
        filtered=any(summary.accelerations.cutoff for summary in summaries),
        one_unit=len({error.unit for error in summaries[0].errors}) == 1,
        most_shaded=f"{_MOST_SHADED:g}",
        notes=_notes(summaries),
    )


def _facts(
    summaries: Sequence[EvaluationSummary], failures: Mapping[str, str]
) -> list[tuple[str, str]]:
    first = summaries[0]
    count = f"{len(summaries)} evaluated" + (f", {len(failures)} failed" if failures else "")
    seconds = sum(summary.duration for summary in summaries)
    efforts = sorted({summary.effort.replace("_", " ") for summary in summaries})
    return [
        ("robot", first.robot),
        ("solver", solver_name(first.plugin)),
        ("recordings", count),
        ("motion", f"{_duration(seconds)}, {sum(s.samples for s in summaries):,} samples"),
        *([("part of each", str(first.window))] if first.window else []),
        ("accelerations", _accelerations(summaries)),
        ("effort means", ", ".join(efforts)),
    ]


def _accelerations(summaries: Sequence[EvaluationSummary]) -> str:
    cutoffs = [s.accelerations.cutoff for s in summaries if s.accelerations.cutoff]
    text = ", ".join(sorted({summary.accelerations.method for summary in summaries}))
    if cutoffs:
        least, most = min(cutoffs), max(cutoffs)
        text += f", cut-off {least:.3g}" + (f" to {most:.3g} Hz" if most > least else " Hz")
    return text


def _row(summary: EvaluationSummary, middle: Sequence[float]) -> dict[str, Any]:
    ratios = [e.rmse / m if m else 1.0 for e, m in zip(summary.errors, middle, strict=True)]
    start = datetime.fromtimestamp(max(summary.start, 0.0), timezone.utc)
    return {
        "name": summary.name,
        "start": f"{start:%Y-%m-%d %H:%M:%S}" if summary.start > _EARLIEST else "\N{EN DASH}",
        "seconds": summary.start,
        "duration": _duration(summary.duration),
        "samples": f"{summary.samples:,}",
        "shades": [_shade(ratio) for ratio in ratios],
        "badness": f"{sum(ratios) / len(ratios):.6g}",
    }


def _shade(ratio: float) -> float:
    """0 up to the median, 1 from _MOST_SHADED times it on, in steps of equal ratios between."""
    if not ratio > 1.0:
        return 0.0
    return min(1.0, math.log(ratio) / math.log(_MOST_SHADED))


def _notes(summaries: Sequence[EvaluationSummary]) -> list[tuple[str, str]]:
    """Each note once, and of which recordings."""
    found: dict[str, list[str]] = {}
    for summary in summaries:
        for note in summary.notes:
            found.setdefault(note, []).append(summary.name)
    everywhere = counted(len(summaries), "recording") if len(summaries) > 1 else ""
    return [
        (note, (everywhere if len(names) == len(summaries) else "") or listed(names))
        for note, names in found.items()
    ]


def _duration(seconds: float) -> str:
    """27.5 s, 12 min 30 s, 5 h 12 min."""
    if seconds < 100:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 100:
        return f"{minutes} min {rest} s"
    return f"{minutes // 60} h {minutes % 60} min"

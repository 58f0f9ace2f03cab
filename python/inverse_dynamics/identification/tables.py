# SPDX-License-Identifier: Apache-2.0
"""An identification as numbers, lines and tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.identification.result import COLUMNS, LAWS
from inverse_dynamics.outputs.plain import plain
from inverse_dynamics.show.tables import IN_BAND, ReportTable, of_joints

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from inverse_dynamics.identification.hold_out import HoldOut
    from inverse_dynamics.identification.result import Choice, DriveGain, Identification, Level
    from inverse_dynamics.show.result import Line

SCHEMA = 1


def identification_numbers(found: Identification) -> dict[str, Any]:
    """Everything but the samples, for JSON."""
    robot = found.robot
    return {
        "schema": SCHEMA,
        "robot": robot.name,
        "plugin": robot.plugin,
        "urdf": None if robot.urdf is None else str(robot.urdf),
        **{
            name: plain(getattr(found, name))
            for name in found.__dataclass_fields__
            if name not in ("robot", "blocks", "factor", "band", "sketch")
        },
        "blocks": [
            {
                "recording": block.recording,
                "from": float(block.time[0]),
                "to": float(block.time[-1]),
                "samples": int(block.counts.sum()),
                "law": block.law,
                "prior_strength": block.prior_strength,
                "delay": block.delay,
                "band": plain(block.band.mean(axis=0)),
                "rmse": {
                    column: plain(np.sqrt((errors**2).mean(axis=0)))
                    for column, errors in block.errors.items()
                },
            }
            for block in found.blocks
        ],
    }


def identification_lines(found: Identification) -> Iterator[Line]:
    """What the screen shows."""
    yield "", found.robot.description or found.robot.name
    yield "recordings", ", ".join(map(str, found.recordings))
    yield from choices_told(found)
    yield "note", found.notes
    yield held_out_table(found, "RMSE on held-out blocks")
    for test in found.hold_out:
        yield held_out_table(found, f"RMSE on {test.recording}", test=test)
        yield "note", [f"{test.recording}: {note}" for note in test.notes]
    yield "finding", [finding.text for finding in found.findings]


def choices_told(found: Identification) -> list[tuple[str, str]]:
    """What was chosen and why: name and sentence."""
    law = _best_of_laws(found.choices)
    prior = {c.prior_strength: c for c in found.choices if c.law == found.law}
    told = [("drive gains", ", ".join(map(_gain_told, found.drive_gains)))]
    return [
        *(told if found.drive_gains else []),
        ("friction law", f"{found.law}: {LAWS.get(found.law, found.law)}{_compared(law)}"),
        (
            "prior strength",
            f"{found.prior_strength:g}: how much the description counts{_compared(prior)}",
        ),
        (
            "torque delay",
            f"{delay_told(found.delay)} than positions, of least error" if found.delay else "none",
        ),
        ("filter", found.filter),
        ("effort means", found.effort),
        ("data", f"{found.samples} samples, {found.duration:.1f} s"),
        *(
            (f"level of {Path(level.recording).name}", _level_told(level, found.units))
            for level in found.levels
        ),
    ]


def _level_told(level: Level, units: Sequence[str]) -> str:
    """Of each joint."""
    offsets = (f"{x:+.3g} {unit}" for x, unit in zip(level.offset, units, strict=True))
    shares = ", ".join(f"{100 * x:+.0f} %" for x in level.share)
    return f"against the other recordings' model: offset {', '.join(offsets)}; friction {shares}"


def delay_told(delay: float) -> str:
    """A delay of efforts behind the states [s], in words."""
    return f"{abs(1e3 * delay):.1f} ms {'later' if delay > 0 else 'earlier'}"


def _gain_told(gain: DriveGain) -> str:
    if gain.half_width is None:
        return f"{gain.joint} {gain.value:.4g} as stated: the known load doesn't determine it"
    stated = "" if gain.stated is None else f" (stated: {gain.stated:.4g})"
    return f"{gain.joint} {gain.value:.4g} +- {gain.half_width:.2g}{stated}"


def _best_of_laws(choices: Iterable[Choice]) -> dict[str, Choice]:
    """The best alternative of each law that was tried."""
    best: dict[str, Choice] = {}
    for choice in choices:
        if choice.law not in best or choice.error < best[choice.law].error or choice.chosen:
            best[choice.law] = choice
    return best


def _compared(best: Mapping[str, Choice] | Mapping[float, Choice]) -> str:
    """Errors of the alternatives."""
    if len(best) < 2:
        return ""
    errors = ", ".join(
        f"{value:g} {choice.error:.3f}"
        if isinstance(value, float)
        else f"{value} {choice.error:.3f}"
        for value, choice in best.items()
    )
    return f"; the simplest within two standard errors of the best (error over noise: {errors})"


def held_out_table(
    found: Identification,
    title: str = "Held-out error",
    note: str = "",
    *,
    test: HoldOut | None = None,
) -> ReportTable:
    """Errors of each joint by each model, and the share within the band: on held-out blocks, or on a recording."""
    rmse, coverage = (
        (found.held_out, found.coverage) if test is None else (test.rmse, test.coverage)
    )
    none = np.full(len(found.joints), np.nan)
    columns = {
        heading: rmse.get(column, none)
        for column, heading in COLUMNS.items()
        if column in found.held_out
    }
    columns[IN_BAND] = 100 * coverage
    return of_joints(title, found.joints, found.units, columns, note, means=columns)

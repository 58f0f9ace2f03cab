# SPDX-License-Identifier: Apache-2.0
"""An identification as one page: what was chosen, held-out errors, and every block as it was predicted."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.evaluation import joint_errors
from inverse_dynamics.identification.knowledge import PARAMETERS, UNITS
from inverse_dynamics.identification.result import COLUMNS
from inverse_dynamics.identification.tables import choices_told, held_out_table
from inverse_dynamics.show.page import (
    ReportRun,
    ReportSummary,
    bands_of,
    render_page,
)
from inverse_dynamics.show.scene import Scene, read_scene
from inverse_dynamics.show.tables import ReportTable
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.identification.result import HeldOutBlock, Identification


def identification_page(found: Identification) -> str:
    """The page as text. Raises RobotError."""
    recordings = list(dict.fromkeys(block.recording for block in found.blocks))
    runs = [_run(found, name, len(recordings) > 1) for name in recordings]
    return render_page(f"{found.robot.name}: identified model", runs, summary=_summary(found))


def _run(found: Identification, recording: str, several: bool) -> ReportRun:
    """The blocks of a recording, one after another, each predicted by models that haven't seen it."""
    blocks = sorted(
        (block for block in found.blocks if block.recording == recording),
        key=lambda block: float(block.time[0]),
    )
    computed = {
        column: np.concatenate([block.computed[column] for block in blocks])
        for column in blocks[0].computed
    }
    measured = np.concatenate([block.measured for block in blocks])
    time = np.concatenate([block.time for block in blocks])
    identified = computed.pop("identified")
    urdf = found.robot.urdf
    scene = Scene() if urdf is None else read_scene(urdf, found.joints)
    return ReportRun(
        title=f"Held-out blocks of {Path(recording).name}" if several else "Held-out blocks",
        description=f"{counted(len(blocks), 'block')}, each predicted by models fitted to the others. Below, "
        "errors of the identified model over all samples, those at a start transient too",
        solver="identified",
        time=time,
        q=np.concatenate([block.q for block in blocks]),
        measured=measured,
        computed=identified,
        name="identified",
        table=joint_errors(found.joints, found.units, identified, measured),
        recording=Path(recording).name,
        assumptions=_block_facts(blocks),
        links=scene.links,
        scene_notes=scene.notes,
        others={COLUMNS[column]: values for column, values in computed.items()},
        bands=bands_of(time, np.concatenate([block.band for block in blocks])),
    )


def _block_facts(blocks: Sequence[HeldOutBlock]) -> list[tuple[str, str]]:
    """Choices for each block, made on the others."""
    return [
        (
            f"{block.time[0]:.1f} to {block.time[-1]:.1f} s",
            f"law {block.law}, prior strength {block.prior_strength:g}, delay {1e3 * block.delay:.1f} ms",
        )
        for block in blocks
    ]


def _summary(found: Identification) -> ReportSummary:
    note = (
        "Root mean square of computed - measured over blocks that no model of the row was fitted to; nothing was "
        "chosen on them either."
    )
    tests = [
        held_out_table(found, f"Error on {test.recording.name}", "; ".join(test.notes), test=test)
        for test in found.hold_out
    ]
    known = (_friction(found), _intervals(found), _prior(found))
    return ReportSummary(
        table=held_out_table(found, note=note),
        facts_title="What was chosen, and why",
        facts=choices_told(found),
        notes=[*(finding.text for finding in found.findings), *found.notes],
        more=[*tests, *(table for table in known if table.rows)],
    )


_FRICTION_UNITS = {
    "fv": "N m s/rad",
    "fl": "1",
    "vs": "rad/s",
    "shift": "rad/s",
    "width": "rad/s",
    "distance": "rad",
}


def _friction(found: Identification) -> ReportTable:
    keys = dict.fromkeys(key for law in found.model.friction for key in law if key != "law")
    units = (f"{key} [{_FRICTION_UNITS.get(key, 'N m')}]" for key in keys)
    model = found.model
    motors = zip(model.rotor_inertia.tolist(), model.torque_deviation.tolist(), strict=True)
    laws = [*zip(found.joints, model.friction, motors, strict=True)]
    laws += [(place, law, (math.nan, math.nan)) for place, law in model.friction_at.items()]
    rows: list[tuple[str | float, ...]] = [
        (place, *(law.get(key, math.nan) for key in keys), *motor) for place, law, motor in laws
    ]
    return ReportTable(
        title="Friction, rotor inertia and 95 % band of each joint",
        headings=("joint", *units, "rotor inertia [kg m²]", "band [N m]"),
        rows=rows,
        note="fv qd + fo + (fc + fl |g(q)| + fm + fs exp(-(qd / vs)²)) tanh((qd + shift) / width); with a distance, fm "
        "and fs lag behind a reversal by about so much; prismatic joints: m for rad, N for N m, kg for kg m². fo and "
        "shift may do work, and differ between recordings.",
    )


def _intervals(found: Identification) -> ReportTable:
    return ReportTable(
        title="What the data determine, with 95 % intervals",
        headings=("number", "value", "±", "unit"),
        rows=[(i.name, i.value, i.half_width, i.unit) for i in found.intervals],
        note="Intervals count how long residuals stay alike, not each sample for itself.",
    )


def _prior(found: Identification) -> ReportTable:
    units = dict(zip(PARAMETERS, UNITS, strict=True))
    return ReportTable(
        title="What the prior decided",
        headings=("link", "number", "prior", "value", "unit", "from the data [%]"),
        rows=[
            (p.link, p.parameter, p.prior, p.value, units[p.parameter], 100 * p.share)
            for p in found.prior_decided
        ],
        note="These numbers are the description's more than the data's: torques don't determine them. "
        "`ids excite --given RECORDING` searches for a motion with more information.",
    )

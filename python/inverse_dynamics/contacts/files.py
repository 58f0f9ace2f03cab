# SPDX-License-Identifier: Apache-2.0
"""Contacts of a recording in a directory: contacts.json, series.npz, contacts.png, report.html."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.contacts.figure import contact_figure
from inverse_dynamics.contacts.page import render_contacts
from inverse_dynamics.outputs.files import Contents, write_text, written_whole
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.show.plots import FORMATS, check_formats, save_figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.contacts.contacts import Contacts

MARK = "contacts.json"
CONTENTS = Contents(
    MARK, (MARK, "series.npz", "report.html", *(f"contacts.{suffix}" for suffix in FORMATS))
)


def write_contacts(
    contacts: Contacts,
    out: Path | str,
    *,
    overwrite: bool = False,
    figures: Sequence[str] = ("png",),
) -> None:
    """Write contacts into a directory, whole or not at all.

    overwrite: replace an older result. figures: formats. Raises OutputError.
    """
    check_formats(figures)
    out = Path(out)
    inputs = (contacts.evaluation.bag, *contacts.evaluation.robot.files)
    with written_whole(out, overwrite=overwrite, contents=CONTENTS, inputs=inputs) as directory:
        write_text(directory / MARK, json_text(summary(contacts)))
        names = ["time", "torques", "valid", "contact"]
        names += ["wrenches", "unseen"] if contacts.wrenches is not None else []
        np.savez(directory / "series.npz", **{name: getattr(contacts, name) for name in names})
        write_text(directory / "report.html", render_contacts(contacts))
        files = (directory / f"contacts.{suffix}" for suffix in figures)
        save_figure(lambda: contact_figure(contacts), *files)


def summary(contacts: Contacts) -> dict[str, Any]:
    """Contacts, thresholds and how they came about, for JSON."""
    evaluation, thresholds = contacts.evaluation, contacts.thresholds
    names = ("torques", "noise", "correlation_time", "peaks", "level", "scale", "shape")
    return {
        "schema": 1,
        "bag": str(evaluation.bag),
        "topic": evaluation.log.topic,
        "robot": evaluation.robot.name,
        "plugin": evaluation.robot.plugin,
        "estimator": contacts.estimator,
        "gain": contacts.gain,
        "tracking": contacts.tracking,
        "measured_velocities": contacts.measured_velocities,
        "friction_band": contacts.friction_band,
        "effort": evaluation.effort.meaning,
        "quiet": contacts.quiet,
        "false_alarms_per_hour": thresholds.false_alarms_per_hour,
        "joints": [
            {"joint": joint, "unit": unit} | {name: getattr(thresholds, name)[j] for name in names}
            for j, (joint, unit) in enumerate(
                zip(evaluation.joint_names, evaluation.units, strict=True)
            )
        ],
        "contacts": contacts.contacts,
        "interruptions": contacts.interruptions,
        "blind": contacts.blind,
        "notes": contacts.notes,
    }

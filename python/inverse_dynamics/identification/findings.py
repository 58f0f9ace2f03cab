# SPDX-License-Identifier: Apache-2.0
"""Warnings about a fit, one sentence each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.identification.knowledge import DOUBT, student_t
from inverse_dynamics.identification.refusals import mean_unit
from inverse_dynamics.identification.result import Finding
from inverse_dynamics.identification.tables import delay_told

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics._core import ArmFitter
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.blocks import Block
    from inverse_dynamics.robots.robots import Robot

_LITTLE_MOTION = 0.1  # rad or m
_FEW_SAMPLES = 20
_STARTS = {"present": "the present model", "urdf": "the description without friction"}


def findings_of_errors(
    fitter: ArmFitter, links: Sequence[str], held: dict[str, Floats], units: Sequence[str]
) -> tuple[Finding, ...]:
    """Findings about links and joints, from the prior and held-out errors."""
    found = [
        Finding("floor", f"link {link}: the description is implausible: the prior has {text}", link)
        for link, text in zip(links, fitter.changes, strict=True)
        if text
    ]
    for j, (joint, unit) in enumerate(zip(fitter.joint_names, units, strict=True)):
        of = min((column for column in _STARTS if column in held), key=lambda c: held[c][j])
        new, old = held["identified"][j], held[of][j]
        if new > old:
            text = (
                f"{joint}: {new:.3g} {unit} on blocks held out, where {_STARTS[of]} has {old:.3g}: the motion tells "
                "too little of the joint; record one in which it is loaded and turns round more often"
            )
            found.append(Finding("worse", text, joint))
    identified = held["identified"].mean()
    baseline = min((held[c].mean(), c) for c in held if c != "identified")
    if identified >= baseline[0]:
        found.append(
            Finding(
                "gain",
                f"no gain: {identified:.3g} {mean_unit(units)} on blocks held out, where column {baseline[1]} has "
                f"{baseline[0]:.3g}; stay with it, or record a longer or richer motion",
            )
        )
    return tuple(found)


def gravity_finding(
    robot: Robot, weights: Sequence[Sequence[Floats]], units: Sequence[str]
) -> Finding:
    """The assumption about efforts without gravity."""
    off = np.sqrt(sum((np.concatenate(link) ** 2).mean(axis=0) for link in weights))
    figures = ", ".join(f"{x:.2g} {unit}" for x, unit in zip(off, units, strict=True))
    name = "the description" if robot.urdf is None else robot.urdf.name
    return Finding(
        "gravity",
        f"efforts lack gravity: the robot is taken to subtract that of {name}, so masses and first moments are its "
        "own, but for what the efforts contradict. Errors that its masses share with those in the robot don't show: "
        f"if each is {100 * DOUBT:g} % off, gravity torques are off by {figures} (RMS by joint), which intervals and "
        "deviations include",
    )


def motion_findings(
    fitter: ArmFitter, delay: float, delays: Floats, blocks: Sequence[Block], independent: Floats
) -> list[Finding]:
    """Findings about the motion, and the delay of the torques.

    delays: s, without each held-out block in turn; a jackknife tells whether the delay is zero.
    """
    found = []
    half = student_t(len(delays)) * float(np.sqrt((len(delays) - 1) * np.var(delays)))
    if abs(delay) > half:
        found.append(
            Finding(
                "delay",
                f"recorded efforts are {delay_told(delay)} than the states, +- {1e3 * half:.2g} ms: fits make up "
                "for it, held-out errors and bands don't, as solvers don't",
            )
        )
    q = np.concatenate([block.q for block in blocks])
    for j, joint in enumerate(fitter.joint_names):
        moved = float(np.ptp(q[:, j]))
        if moved < _LITTLE_MOTION:
            text = (
                f"{joint} moves by {moved:.2g} only: its friction and the inertia that it moves are "
                "those of the prior"
            )
            found.append(Finding("motion", text, joint))
        if independent[j] < _FEW_SAMPLES:
            text = f"{joint}: errors are worth {independent[j]:.0f} independent samples: record for longer"
            found.append(Finding("samples", text, joint))
    return found

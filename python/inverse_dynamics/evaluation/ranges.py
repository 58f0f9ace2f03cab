# SPDX-License-Identifier: Apache-2.0
"""Ranges of motions: within that of a model's data or not, and with continuous joints on one turn."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.arrays import whole_turns
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.evaluation import Evaluation

_BEYOND = (0.05, 0.05, 0.25)  # of what was seen, of q, qd, qdd, that depend on the filter
_MOST_NAMED = 4
_NAMES = ("q", "qd", "qdd")


def outside_of_seen(
    seen: Floats | None,
    motion: Sequence[Floats],
    kept: Mask,
    joints: Sequence[str],
    units: Sequence[str],
    *,
    types: Sequence[str] = (),
) -> str:
    """A sentence on joints that leave the range of identification; "": none does, or it isn't known.

    seen: (3, n, 2), as Solver.seen. motion: q, qd, qdd, (N, n) each; kept: (N,) marks the valid samples.
    units: of the joints' torques. types: as Solver.joint_types; none: no joint is continuous.
    """
    if seen is None or not kept.any():
        return ""
    continuous = np.array([kind == "continuous" for kind in types or [""] * len(joints)])
    outside = []
    where = kept[:, None]
    for name, values, ranges, beyond in zip(_NAMES, motion, seen, _BEYOND, strict=True):
        least = values.min(axis=0, where=where, initial=np.inf)
        greatest = values.max(axis=0, where=where, initial=-np.inf)
        low, high = ranges.T
        if name == "q":  # a continuous joint was seen on another turn, or all around
            turn = whole_turns((low + high - least - greatest) / 2) * continuous
            around = continuous & (high - low >= 2 * np.pi)
            least = np.where(around, low, least + turn)
            greatest = np.where(around, high, greatest + turn)
        margin = beyond * (high - low)
        for j in map(int, np.flatnonzero((least < low - margin) | (greatest > high + margin))):
            unit = ("m" if units[j] == "N" else "rad") + ("", "/s", "/s²")[_NAMES.index(name)]
            outside.append(
                f"{joints[j]} {name} {least[j]:.3g} to {greatest[j]:.3g} {unit} "
                f"(seen {low[j]:.3g} to {high[j]:.3g})"
            )
    if not outside:
        return ""
    return (
        "the motion leaves the range that the model was identified in, where its torques and band are "
        f"extrapolated: {listed(outside, _MOST_NAMED)}"
    )


def on_one_turn(evaluations: Sequence[Evaluation]) -> list[Evaluation]:
    """Recordings of one arm whose continuous joints are on the turn that is nearest to the first recording's.

    Whole turns are added to positions, so that the range of all recordings isn't wider than the motion.
    """
    middles = [(e.log.q.min(axis=0) + e.log.q.max(axis=0)) / 2 for e in evaluations]
    found = []
    for evaluation, middle in zip(evaluations, middles, strict=True):
        turns = whole_turns(middles[0] - middle)
        turns *= [kind == "continuous" for kind in evaluation.joint_types]
        log = evaluation.log
        if turns.any():
            log = replace(log, q=log.q + turns)
        found.append(replace(evaluation, log=log))
    return found

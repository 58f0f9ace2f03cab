# SPDX-License-Identifier: Apache-2.0
"""Recordings whose continuous joints are on the same turn."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.evaluation.evaluation import Evaluation


def on_one_turn(evaluations: Sequence[Evaluation]) -> list[Evaluation]:
    """Recordings of one arm whose continuous joints are on the turn that is nearest to the first recording's.

    Whole turns are added to positions, so that the range of all recordings isn't wider than the motion.
    """
    middles = [(e.log.q.min(axis=0) + e.log.q.max(axis=0)) / 2 for e in evaluations]
    found = []
    for evaluation, middle in zip(evaluations, middles, strict=True):
        turns = np.round((middles[0] - middle) / (2 * np.pi))
        turns *= [kind == "continuous" for kind in evaluation.joint_types]
        log = evaluation.log
        if turns.any():
            log = replace(log, q=log.q + 2 * np.pi * turns)
        found.append(replace(evaluation, log=log))
    return found

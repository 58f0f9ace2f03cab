# SPDX-License-Identifier: Apache-2.0
"""Columns of the recording that belong to other joints, or that are reversed."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.causes.rival import Rival, Told

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting


def rivals(view: View, _: Fitting) -> Iterator[Rival]:
    """Two joints exchanged, or their efforts; a joint reversed."""
    for i, j in combinations(range(len(view.names)), 2):
        if view.prismatic[i] == view.prismatic[j]:
            yield from _exchanged(view, i, j)
    for j in map(int, np.flatnonzero(view.informative)):
        yield _reversed(view, j)


def _exchanged(view: View, i: int, j: int) -> Iterator[Rival]:
    order = list(range(len(view.names)))
    order[i], order[j] = j, i
    pair = (view.names[i], view.names[j])
    columns = Told(
        "order",
        "Joints in another order",
        f"torques match if joints {pair[0]} and {pair[1]} have each other's columns",
        "give the recording's names in the order of the chain: --joints, or `joints:`",
        pair,
    )
    efforts = Told(
        "effort_order",
        "Joints in another order",
        f"torques match if joints {pair[0]} and {pair[1]} have each other's efforts",
        "correct this where the recording is made: positions are in order, efforts aren't",
        pair,
    )
    if view.informative[i] or view.informative[j]:
        # recorded columns of the arm's joints: those of the motion in its order, taken back
        q, qd, qdd = (values[:, order] for values in view.motion)

        def recorded(computed: Floats) -> Floats:
            return computed[:, order]

        yield Rival(
            "order",
            recorded(view.arm.compared(q, qd, qdd)),
            view.qd,
            lambda *_: columns,
            motion=(q, qd, qdd),
            effort=recorded,
        )
        yield Rival(
            "effort_order",
            recorded(view.computed),
            recorded(view.qd),
            lambda *_: efforts,
            effort=recorded,
        )


def _reversed(view: View, j: int) -> Rival:
    sign = np.ones(len(view.names))
    sign[j] = -1.0
    told = Told(
        "direction",
        "A joint is reversed",
        f"joint {view.names[j]}: torques match if its position, velocity and effort are reversed",
        "change the sign where the recording is made, or the <axis> in the description",
        (view.names[j],),
        value=-1.0,
    )
    q, qd, qdd = (sign * values for values in view.motion)
    return Rival(
        "direction",
        sign * view.arm.compared(q, qd, qdd),
        view.qd,
        lambda *_: told,
        motion=(q, qd, qdd),
        effort=lambda computed: sign * computed,
    )

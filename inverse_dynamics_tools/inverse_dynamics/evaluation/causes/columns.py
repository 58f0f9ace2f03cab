# SPDX-License-Identifier: Apache-2.0
"""Columns of the recording that belong to other joints, or that are reversed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.causes.rival import Rival, Told

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.causes.fit import Fitting
    from inverse_dynamics.evaluation.causes.samples import View


def rivals(view: View, _: Fitting) -> Iterator[Rival]:
    """Two joints exchanged, or their efforts; a joint reversed."""
    for i, j in combinations(range(len(view.names)), 2):
        alike = view.prismatic[i] == view.prismatic[j]
        if alike and (view.informative[i] or view.informative[j]):
            yield from _exchanged(view, i, j)
    for j in map(int, np.flatnonzero(view.informative)):
        yield _reversed(view, j)


def _exchanged(view: View, i: int, j: int) -> Iterator[Rival]:
    order = np.arange(len(view.names))
    order[[i, j]] = j, i
    pair = (view.names[i], view.names[j])

    def recorded(computed: Floats) -> Floats:
        return computed[:, order]

    motion = tuple(map(recorded, view.motion))
    columns = Told(
        "order",
        "Joints in another order",
        f"torques match if joints {pair[0]} and {pair[1]} have each other's columns",
        "give the recording's names in the order of the chain: --joints, or `joints:`",
        pair,
    )
    base = recorded(view.arm.compared(*motion))
    yield view.rival("order", columns, base=base, motion=motion, effort=recorded)
    efforts = replace(
        columns,
        kind="effort_order",
        reason=f"torques match if joints {pair[0]} and {pair[1]} have each other's efforts",
        remedy="correct this where the recording is made: positions are in order, efforts aren't",
    )
    base, qd = recorded(view.computed), recorded(view.qd)
    yield view.rival("effort_order", efforts, base=base, qd=qd, effort=recorded)


def _reversed(view: View, j: int) -> Rival:
    sign = np.where(np.arange(len(view.names)) == j, -1.0, 1.0)
    told = Told(
        "direction",
        "A joint is reversed",
        f"joint {view.names[j]}: torques match if its position, velocity and effort are reversed",
        "change the sign where the recording is made, or the <axis> in the description",
        (view.names[j],),
        value=-1.0,
    )
    motion = tuple(sign * values for values in view.motion)
    base = sign * view.arm.compared(*motion)
    return view.rival("direction", told, base=base, motion=motion, effort=lambda c: sign * c)

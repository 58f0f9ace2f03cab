# SPDX-License-Identifier: Apache-2.0
"""Two mistakes at once: one of the columns or of the efforts, and one of the arm."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.causes import columns, efforts, gravity, loads, masses
from inverse_dynamics.evaluation.causes.rival import Rival, Told

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting

_OF_ARM = (gravity, loads, masses)
_LIKELIEST = 3  # mistakes of columns, of those that fit best with any load and any gravity


def rivals(view: View, fitting: Fitting) -> Iterator[Rival]:
    """Pairs; of the mistakes of columns, those that could leave least."""
    firsts = [*efforts.each_reversed(view), *columns.rivals(view, fitting), efforts.common(view)]
    errors = [float(fitting.mean(fitting.errors(_anything(view, f, fitting)))) for f in firsts]
    for i in np.argsort(errors)[:_LIKELIEST]:
        yield from _paired(view, firsts[i], fitting)


def _anything(view: View, first: Rival, fitting: Fitting) -> Rival:
    """The first mistake, under any gravity, with any load."""
    moved = view if first.motion is None else view.moving(*first.motion)
    both = [r for kind in (gravity, loads) for r in kind.rivals(moved, fitting)]
    parts = [part for rival in both for part in rival.columns]
    base = Rival("", moved.computed, moved.qd, columns=tuple(parts))
    return _joined(first, base, base.tell)


def _paired(view: View, first: Rival, fitting: Fitting) -> Iterator[Rival]:
    moved = view if first.motion is None else view.moving(*first.motion)
    for kind in _OF_ARM:
        for second in kind.rivals(moved, fitting):
            yield _joined(first, second, partial(_tell, first, second))


def _joined(first: Rival, second: Rival, tell: object) -> Rival:
    """What the second mistake adds, in columns of efforts that have the first."""
    parts: Sequence[Floats] = [first.effort(part) for part in second.columns]
    base = first.effort(second.base)
    if first.columns:  # a scale, of all that the second says
        parts, base = [base, *parts], np.zeros_like(base)
    free = (np.inf,) * len(parts)
    low = tuple(-x for x in free)
    return Rival("pair", base, first.qd, tell, tuple(parts), low, free)  # type: ignore[arg-type]


def _tell(first: Rival, second: Rival, shared: Floats, none: Floats) -> Told | None:
    scale, numbers = np.zeros(0), shared
    if first.columns:
        if shared[0] <= 0:
            return None
        scale, numbers = shared[:1], shared[1:] / shared[0]
    one, other = first.tell(scale, none), second.tell(numbers, none)
    if one is None or other is None:
        return None
    together = other.shared
    if first.columns:
        together = np.concatenate([one.shared, one.shared * other.shared])
    return replace(one, also=other, shared=together)

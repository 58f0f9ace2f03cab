# SPDX-License-Identifier: Apache-2.0
"""Two mistakes at once: one of the columns or of the efforts, and one of the arm."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis import bodies, efforts
from inverse_dynamics.diagnosis.rival import Mistake, Rival, Words

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.diagnosis.fit import Fitting
    from inverse_dynamics.diagnosis.pieces import View

_LIKELIEST = 3  # mistakes of columns, of those that fit best with any load and any gravity


def rivals(view: View, fitting: Fitting) -> Iterator[Rival]:
    """Pairs; of the mistakes of columns, those that could leave least."""
    firsts = [*efforts.each_reversed(view), *efforts.columns(view), efforts.common(view)]
    errors = [float(fitting.mean(fitting.errors(_with_anything(view, f)))) for f in firsts]
    for i in np.argsort(errors)[:_LIKELIEST]:
        first = firsts[i]
        for second in bodies.rivals(_moved(view, first)):
            yield _joined(first, second, partial(_both, first, second))


def _moved(view: View, first: Rival) -> View:
    return view if first.motion is None else view.moving(*first.motion)


def _with_anything(view: View, first: Rival) -> Rival:
    """The first mistake, under any gravity, with any load."""
    moved = _moved(view, first)
    parts = [part for rival in bodies.mounts_and_loads(moved) for part in rival.columns]
    return _joined(first, moved.rival("", columns=tuple(parts)), None)


def _joined(first: Rival, second: Rival, words: Words) -> Rival:
    """The second mistake, in columns of efforts that have the first."""
    parts: Sequence[Floats] = [first.effort(part) for part in second.columns]
    base = first.effort(second.base)
    if first.columns:  # a scale of everything that the second predicts
        parts, base = [base, *parts], np.zeros_like(base)
    return Rival("pair", base, first.qd, words, tuple(parts))


def _both(first: Rival, second: Rival, shared: Floats, none: Floats) -> Mistake | None:
    scale, numbers = np.zeros(0), shared
    if first.columns:
        if shared[0] <= 0:
            return None
        scale, numbers = shared[:1], shared[1:] / shared[0]
    one, other = first.finding(scale, none), second.finding(numbers, none)
    if one is None or other is None:
        return None
    together = other.shared
    if first.columns:
        together = np.concatenate([one.shared, one.shared * other.shared])
    return replace(one, also=other, shared=together)

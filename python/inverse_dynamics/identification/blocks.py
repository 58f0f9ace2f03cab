# SPDX-License-Identifier: Apache-2.0
"""Recordings as contiguous blocks: ranges of rows of their tables, each differentiated by itself.

So no model is fitted to an acceleration that a filter has made of a block held out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics.identification.result import IdentificationError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.evaluation import Evaluation

    FitBlock = tuple[Floats, Floats, Floats, Floats]
    """q, qd, qdd, tau, (N, n) each: what ArmFitter takes."""

_FEWEST = 20  # samples that a block can be differentiated with

_ARRAYS = ("time", "instants", "used", "q", "qd", "qdd", "tau", "counts", "rests")  # of a block
_REST = 0.01  # of each joint's greatest velocity, which a moving arm's joints aren't all below


@dataclass(frozen=True)
class Block:
    """Samples of a contiguous part of a recording. M samples, n joints."""

    recording: str
    time: Floats  # (M,) s since the recording's first sample
    instants: Floats  # (M,) s; when samples were really taken
    used: Mask  # (M,) samples that don't repeat others
    q: Floats  # (M, n)
    qd: Floats
    qdd: Floats  # from this block's samples alone
    tau: Floats  # measured
    counts: Mask  # (M,) valid samples: no repeats, no start transient
    rests: Mask  # (M,) no joint moves: friction may be anything up to its step

    def __len__(self) -> int:
        return len(self.time)

    def later(self, delay: float) -> Block:
        """The same torques with the states of `delay` [s] before: what they answer to.

        States before the block's first sample aren't known: these samples are invalid.
        """
        if delay == 0:
            return self
        at, known = self.instants - delay, self.instants[self.used]
        q, qd, qdd = (_at(at, known, v[self.used]) for v in (self.q, self.qd, self.qdd))
        within = (at >= known[0]) & (at <= known[-1])
        return replace(self, q=q, qd=qd, qdd=qdd, counts=self.counts & within)

    def parts(self, count: int) -> list[Block]:
        """The block in so many parts, with its accelerations."""
        edges = np.linspace(0, len(self.time), count + 1).round().astype(int)
        return [self._rows(slice(first, after)) for first, after in pairwise(edges)]

    def thinned(self, step: int) -> Block:
        """Each sample whose number is a multiple of step, with its acceleration."""
        return self._rows(slice(None, None, step))

    def moving(self) -> Block:
        """Without the samples at rest."""
        return self._rows(~self.rests) if self.rests.any() else self

    def _rows(self, rows: slice | Mask) -> Block:
        return replace(self, **{name: getattr(self, name)[rows] for name in _ARRAYS})

    @cached_property
    def fitted(self) -> FitBlock:
        """q, qd, qdd, tau of the samples to be fitted to."""
        if self.counts.all():
            return self.q, self.qd, self.qdd, self.tau
        c = self.counts
        return self.q[c], self.qd[c], self.qdd[c], self.tau[c]


def _at(at: Floats, time: Floats, values: Floats) -> Floats:
    columns = [np.interp(at, time, column) for column in values.T]
    return np.ascontiguousarray(np.transpose(columns))


def blocks_outside(evaluation: Evaluation, begin: float, end: float) -> list[Block]:
    """What a recording has before and after a part of it [s], each if it is long enough."""
    first, after = np.searchsorted(evaluation.time, [begin, end]).tolist()
    edges = ((0, first), (after, len(evaluation.time)))
    return [_block(evaluation, slice(a, b)) for a, b in edges if b - a >= _FEWEST]


def blocks_of(evaluation: Evaluation, count: int) -> list[Block]:
    """A recording cut into so many blocks of equally many samples."""
    edges = np.linspace(0, len(evaluation.time), count + 1).round().astype(int)
    if np.diff(edges).min() < _FEWEST:
        raise IdentificationError(
            f"{evaluation.bag}: expected at least {_FEWEST * count} samples, got "
            f"{len(evaluation.time)}; record a longer motion"
        )
    return [_block(evaluation, slice(first, after)) for first, after in pairwise(edges.tolist())]


def _block(evaluation: Evaluation, rows: slice) -> Block:
    log, samples = evaluation.log, evaluation.samples
    used = ~(samples.repeated | samples.non_increasing)
    qdd, instants = _accelerations(evaluation, rows)
    greatest = np.abs(log.qd).max(axis=0)
    return Block(
        recording=f"{evaluation.bag}",
        time=evaluation.time[rows],
        instants=instants,
        used=used[rows],
        q=log.q[rows],
        qd=log.qd[rows],
        qdd=qdd,
        tau=evaluation.measured[rows],
        counts=(used & samples.kept)[rows],
        rests=(np.abs(log.qd[rows]) < _REST * greatest).all(axis=1),
    )


def _accelerations(evaluation: Evaluation, rows: slice) -> tuple[Floats, Floats]:
    """Of a block's samples alone, by the method of the evaluation; and when they were taken."""
    log, how, time = evaluation.log, evaluation.accelerations, evaluation.time[rows]
    if how.method == "given":
        return evaluation.qdd[rows], time
    if how.method == "backward-difference":
        return _core.backward_difference(time, log.qd[rows]), time
    cutoff = 0.0 if how.chosen else how.cutoff or 0.0  # zero: chosen from the block
    motion = time, log.q[rows], log.qd[rows], log.effort[rows]
    return _core.low_pass_accelerations(*motion, cutoff)[:2]


def moving(blocks: Sequence[Block]) -> list[Block]:
    """What models are fitted to: blocks without the samples at rest, those that are long enough.

    At rest friction is whatever holds the arm, anything up to its step. A fit would take it for a step off
    zero velocity, and for gravity.
    """
    found = [block.moving() for block in blocks]
    return [block for block in found if len(block) >= _FEWEST] or list(blocks)


def together(blocks: Sequence[Block]) -> list[FitBlock]:
    """What a fit takes."""
    return [block.fitted for block in blocks]

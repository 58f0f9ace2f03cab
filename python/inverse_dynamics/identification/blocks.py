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

    from inverse_dynamics._core import ArmData, ArmFitter
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.evaluation import Evaluation

    FitBlock = tuple[Floats, Floats, Floats, Floats]
    """q, qd, qdd, tau, (N, n) each: what ArmFitter takes."""

FEWEST = 20  # samples that a block can be differentiated with

_ARRAYS = ("time", "instants", "used", "q", "qd", "qdd", "tau", "counts", "rests")  # of a block
_REST = 0.01  # of each joint's greatest velocity, which a moving arm's joints aren't all below
# times the cut-off of the recording: a block that chooses more takes that of the recording
_HIGHER = 1.3


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
    before: Floats  # (K, n) positions before the block, which friction remembers: where joints turned round

    def __len__(self) -> int:
        return len(self.time)

    def later(self, delay: float, step: int = 1) -> Block:
        """Each `step`-th sample, its torques with the states of `delay` [s] before: what they answer to.

        States before the block's first sample aren't known: these samples are invalid.
        """
        found = self.rows(slice(None, None, step))
        if delay == 0:
            return found
        at, known = found.instants - delay, self.instants[self.used]
        q, qd, qdd = (
            np.ascontiguousarray(np.transpose([np.interp(at, known, c) for c in v[self.used].T]))
            for v in (self.q, self.qd, self.qdd)
        )
        within = (at >= known[0]) & (at <= known[-1])
        return replace(found, q=q, qd=qd, qdd=qdd, counts=found.counts & within)

    def parts(self, count: int) -> list[Block]:
        """The block in so many parts, with its accelerations."""
        edges = np.linspace(0, len(self.time), count + 1).round().astype(int)
        return [
            replace(
                self.rows(slice(first, after)),
                before=_turning(np.concatenate([self.before, self.q[:first]])),
            )
            for first, after in pairwise(edges)
        ]

    def rows(self, rows: slice | Mask) -> Block:
        """Some of the samples, with their accelerations."""
        return replace(self, **{name: getattr(self, name)[rows] for name in _ARRAYS})

    @cached_property
    def fitted(self) -> FitBlock:
        """q, qd, qdd, tau of the samples to be fitted to."""
        if self.counts.all():
            return self.q, self.qd, self.qdd, self.tau
        c = self.counts
        return self.q[c], self.qd[c], self.qdd[c], self.tau[c]


def data_of(fitter: ArmFitter, blocks: Sequence[Block], times: Sequence[Floats] = ()) -> ArmData:
    """The samples of blocks, for fits."""
    return fitter.data(
        [block.fitted for block in blocks],
        times=list(times),
        before=[block.before for block in blocks],
    )


def blocks_of(evaluation: Evaluation, count: int) -> list[Block]:
    """A recording cut into so many blocks of equally many samples."""
    edges = np.linspace(0, len(evaluation.time), count + 1).round().astype(int)
    if np.diff(edges).min() < FEWEST:
        raise IdentificationError(
            f"{evaluation.bag}: expected at least {FEWEST * count} samples, got "
            f"{len(evaluation.time)}; record a longer motion"
        )
    return [block_of(evaluation, slice(first, after)) for first, after in pairwise(edges.tolist())]


def block_of(evaluation: Evaluation, rows: slice) -> Block:
    """Some neighbouring samples of a recording."""
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
        before=_turning(log.q[: rows.start]),
    )


def _turning(q: Floats) -> Floats:
    """The positions (M, n) at which a joint turns round, the first and the last."""
    steps = np.sign(np.diff(q, axis=0))
    turns = np.ones(len(q), dtype=bool)
    turns[1:-1] = (steps[1:] != steps[:-1]).any(axis=1)
    return q[turns]


def _accelerations(evaluation: Evaluation, rows: slice) -> tuple[Floats, Floats]:
    """Of a block's samples alone, by the method of the evaluation; and when they were taken."""
    log, how, time = evaluation.log, evaluation.accelerations, evaluation.time[rows]
    if how.method == "given":
        return evaluation.qdd[rows], time
    if how.method == "backward-difference":
        return _core.backward_difference(time, log.qd[rows]), time
    motion = time, log.q[rows], log.qd[rows], log.effort[rows]
    whole = how.cutoff or 0.0
    if (
        not how.chosen or how.by_efforts
    ):  # where the arm vibrates, efforts of the recording have chosen
        return _core.low_pass_accelerations(*motion, whole)[:2]
    qdd, instants, cutoff, _ = _core.low_pass_accelerations(*motion, 0.0)
    if cutoff > _HIGHER * whole:  # a short block shows less of the noise
        qdd, instants, *_ = _core.low_pass_accelerations(*motion, whole)
    return qdd, instants


def moving(blocks: Sequence[Block]) -> list[Block]:
    """What models are fitted to: blocks without the samples at rest, those that are long enough.

    At rest friction is whatever holds the arm, anything up to its step. A fit would take it for a step off
    zero velocity, and for gravity.
    """
    found = [block.rows(~block.rests) if block.rests.any() else block for block in blocks]
    return [block for block in found if len(block) >= FEWEST] or list(blocks)

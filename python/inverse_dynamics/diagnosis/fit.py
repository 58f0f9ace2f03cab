# SPDX-License-Identifier: Apache-2.0
"""Fits rivals to some pieces of a recording and judges them on the others.

    fit = Fitting(samples, friction=None)
    errors = fit.errors(rival)      # (K, n) mean squares, of pieces that were held out

Friction and offset are free in every rival, within what is physical: friction opposes the motion and takes up
at most a stated share of the measured range, offsets are small. No rival wins by them alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.diagnosis.pieces import Pieces
    from inverse_dynamics.diagnosis.rival import Mistake, Rival

_FRICTION = 0.25  # greatest step, and greatest viscous torque, as a share of the joint's range
_SMALL_FRICTION = 0.5  # of a joint that moves little but itself: its range is friction
_SMALL_JOINT = 0.1  # of the greatest range
_OFFSET = 0.04  # greatest offset, as a share of the joint's range
_STILL = 1e-3  # of the greatest speed: joints that don't move have stiction of any sign
_LEAST_RANGE = 0.05  # of the greatest one: joints of smaller ranges count less
_UNSEEN = 1e-8  # relative: of columns that are rounding
_RIDGE = 1e-9  # relative: of numbers that the motion doesn't tell
_ROUNDS = 30  # a handful, as a rule; then, at most ten times as many, bounds are freed one by one: no circles
_MODEL_FRICTION = 1.0  # the model's own friction may be wrong by as much as itself


class Fitting:
    """Least squares of rivals, on the same pieces for all. K pieces of M samples, n joints."""

    def __init__(self, samples: Pieces, friction: Floats | None = None) -> None:
        """friction: (N, n) of the model, in what rivals predict; its size is free, too."""
        self.samples = samples
        self.shape = samples.q.shape
        measured = samples.flat(samples.measured)
        self.range = _range(measured)
        self.size = np.maximum(self.range, _LEAST_RANGE * max(float(self.range.max()), 1e-12))
        self.noise = _noise(samples.measured) / self.size
        speed = np.abs(samples.flat(samples.qd)).max(axis=0)
        travel = np.ptp(samples.flat(samples.q), axis=0)
        self.moved = (travel > _STILL * max(float(travel.max()), 1e-12)) | (
            speed > _STILL * max(float(speed.max()), 1e-12)
        )
        self.friction = friction
        self.even = np.arange(len(samples.q)) % 2 == 0
        small = self.range < _SMALL_JOINT * self.range.max()
        self.most_friction = np.where(small, _SMALL_FRICTION, _FRICTION) * self.range

    def errors(self, rival: Rival) -> Floats:
        """(K, n) mean squares of each piece, as shares of the ranges squared; fitted to the other pieces."""
        gram = self._gram(rival)
        low, high = self._bounds(rival)
        squares = np.empty((self.shape[0], self.shape[2]))
        for train in (self.even, ~self.even):
            shared, own = _solve(gram[train].sum(axis=0), len(rival.columns), low, high)
            squares[~train] = _squares(gram[~train], shared, own)
        return np.asarray(squares / self.shape[1])

    def numbers(self, rival: Rival) -> tuple[Floats, Floats]:
        """(p,) shared and (m, n) own numbers, fitted to all pieces; friction's are left out."""
        shared, own = self._fitted(rival)
        return shared, own[: len(rival.own)]

    def friction_of(self, rival: Rival) -> Floats:
        """(N, n) friction and offset, fitted to all pieces."""
        _, own = self._fitted(rival)
        columns = np.array(self._friction_columns(rival))
        return np.asarray(np.einsum("cj,cnj->nj", own[len(rival.own) :], columns))

    def _fitted(self, rival: Rival) -> tuple[Floats, Floats]:
        gram = self._gram(rival).sum(axis=0)
        return _solve(gram, len(rival.columns), *self._bounds(rival))

    def mean(self, squares: Floats, weights: Floats | None = None) -> Floats:
        """Root mean square over the joints of errors beyond noise, as shares of ranges. weights: (B, K) of pieces."""
        of_joints = squares.mean(axis=0) if weights is None else weights @ squares
        beyond = np.maximum(of_joints - self.noise**2, 0.0)[..., self.moved]
        return np.asarray(np.sqrt(beyond.mean(axis=-1)))

    def applied(self, rival: Rival, finding: Mistake) -> Rival:
        """The rival with the numbers that its remedy states."""
        rival = replace(rival, low=finding.shared, high=finding.shared)
        return (
            rival
            if finding.own is None
            else replace(rival, own_low=finding.own, own_high=finding.own)
        )

    def _friction_columns(self, rival: Rival) -> list[Floats]:
        width = 0.05 * np.sqrt(np.mean(rival.qd**2, axis=0))
        width = np.where(width > 0, width, 1.0)
        columns = [rival.qd, np.tanh(rival.qd / width), np.ones_like(rival.qd)]
        return columns if self.friction is None else [*columns, self.friction]

    def _bounds(self, rival: Rival) -> tuple[Floats, Floats]:
        """(p + n m,) in the order of _solve(): shared numbers, then each joint's own ones."""
        speed = np.abs(rival.qd).max(axis=0)
        viscous = self.most_friction / np.where(speed > 0, speed, 1.0)
        zero, offset = np.zeros_like(viscous), _OFFSET * self.range
        offset = np.where(self.moved, offset, np.inf)
        low, high = [zero, zero, -offset], [viscous, self.most_friction, offset]
        if self.friction is not None:
            low.append(zero - _MODEL_FRICTION)
            high.append(zero + _MODEL_FRICTION)
        shared, own = len(rival.columns), (len(rival.own), len(zero))

        def joined(of_shared: Any, of_own: Any, of_friction: list[Floats]) -> Floats:
            each = np.vstack([np.broadcast_to(of_own, own), of_friction])
            return np.concatenate([np.broadcast_to(of_shared, shared), each.T.ravel()])

        return joined(rival.low, rival.own_low, low), joined(rival.high, rival.own_high, high)

    def _gram(self, rival: Rival) -> Floats:
        """(K, n, c, c) of [target, shared columns, own columns] of each piece and joint, over its size."""
        target = self.samples.flat(self.samples.measured) - rival.base
        columns = np.array([target, *rival.columns, *rival.own, *self._friction_columns(rival)])
        columns = (columns / self.size).reshape(len(columns), *self.shape)
        by_joint = columns.transpose(1, 3, 0, 2)
        return np.asarray(by_joint @ by_joint.swapaxes(-1, -2))


def _range(values: Floats) -> Floats:
    """(n,) of the efforts of each joint, but for a twentieth: spikes don't count.

    Of a joint that carries the same load all the time, half of that load at least.
    """
    middle = np.median(values, axis=0)
    spread = 2 * np.quantile(np.abs(values - middle), 0.95, axis=0)
    return np.asarray(np.maximum(spread, 0.5 * np.quantile(np.abs(values), 0.95, axis=0)))


def _noise(measured: Floats) -> Floats:
    """(n,) standard deviation of white noise: of second differences, by their median."""
    second = np.diff(measured, 2, axis=1).reshape(-1, measured.shape[-1])
    return np.asarray(np.median(np.abs(second), axis=0) / 0.6745 / np.sqrt(6.0))


def _solve(gram: Floats, shared: int, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Shared (p,) and own (m, n) numbers of least squares within bounds. gram: (n, c, c)."""
    joints, own = gram.shape[0], gram.shape[1] - 1 - shared
    matrix, right = np.zeros((len(low), len(low))), np.empty(len(low))
    common, each = slice(1, 1 + shared), slice(1 + shared, None)
    matrix[:shared, :shared] = gram[:, common, common].sum(axis=0)
    matrix[shared:, :shared] = gram[:, each, common].reshape(joints * own, shared)
    matrix[:shared, shared:] = matrix[shared:, :shared].T
    blocks = matrix[shared:, shared:].reshape(joints, own, joints, own)
    blocks[np.arange(joints), :, np.arange(joints), :] = gram[:, each, each]
    right[:shared] = gram[:, common, 0].sum(axis=0)
    right[shared:] = gram[:, each, 0].ravel()
    x = _bounded(matrix, right, low, high)
    return x[:shared], x[shared:].reshape(joints, own).T


def _bounded(matrix: Floats, right: Floats, low: Floats, high: Floats) -> Floats:
    """Least x' A x / 2 - b' x within bounds: crossed ones are held, and freed where that lessens it.

    Importing scipy's lsq_linear() takes half as long as a whole evaluation.
    """
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    matrix = matrix / np.outer(scale, scale) + _RIDGE * np.eye(len(low))
    right, low, high = right / scale, low * scale, high * scale
    x = np.clip(np.zeros_like(low), low, high)
    can = (low < high) & (scale > _UNSEEN * scale.max())
    free = can.copy()
    for turn in range(10 * _ROUNDS):
        rows = matrix[free]
        rest = right[free] - rows[:, ~free] @ x[~free]
        found = np.linalg.solve(rows[:, free], rest)
        x[free] = np.clip(found, low[free], high[free])
        crossed = (found < low[free]) | (found > high[free])
        if crossed.any():
            free[np.flatnonzero(free)[crossed]] = False
            continue
        downhill = right - matrix @ x
        back = can & ~free & (((x <= low) & (downhill > 1e-9)) | ((x >= high) & (downhill < -1e-9)))
        if not back.any():
            break
        if turn < _ROUNDS:
            free |= back
        else:
            free[np.argmax(np.where(back, np.abs(downhill), 0.0))] = True
    return x / scale


def _squares(gram: Floats, shared: Floats, own: Floats) -> Floats:
    """(K, n) sums of squares that are left."""
    joints = gram.shape[1]
    x = np.column_stack([-np.ones(joints), np.tile(shared, (joints, 1)), own.T])
    return np.asarray(np.maximum(np.einsum("kjab,ja,jb->kj", gram, x, x), 0.0))

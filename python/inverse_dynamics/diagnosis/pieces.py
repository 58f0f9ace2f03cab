# SPDX-License-Identifier: Apache-2.0
"""Short contiguous pieces of a recording, on which causes are compared, and what rivals need of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.diagnosis.rival import Rival, Words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.diagnosis.arm import ArmModel

_PIECES = 48  # even ones are fitted where odd ones judge, and the other way round
_LEAST = 4  # samples of a piece: second differences show its noise
_MOST = 40
_SECONDS = 0.2  # of a piece, where that is more samples: as good as independent, yet smooth
_INFORMATIVE = 0.02  # of the greatest torque: less is lost in friction and noise


@dataclass(frozen=True)
class Pieces:
    """A motion: K pieces of M contiguous samples. (K, M) s; (K, M, n) rad, rad/s, rad/s^2, N m."""

    joints: tuple[str, ...]
    time: Floats
    q: Floats
    qd: Floats
    qdd: Floats
    measured: Floats

    @property
    def comparable(self) -> bool:
        """Whether all of them are finite, and something moves."""
        arrays = (self.q, self.qd, self.qdd, self.measured)
        return all(np.isfinite(v).all() for v in arrays) and bool(np.ptp(self.q, axis=(0, 1)).any())

    def named(self, mask: Mask) -> tuple[str, ...]:
        """Joints where a mask (n,) is true."""
        return tuple(name for name, m in zip(self.joints, mask, strict=True) if m)

    def flat(self, values: Floats) -> Floats:
        """(K M, n)."""
        return values.reshape(-1, values.shape[-1])


def pieces_of(
    joints: Sequence[str],
    time: Floats,
    motion: tuple[Floats, Floats, Floats],
    measured: Floats,
    kept: Mask | None = None,
) -> Pieces | None:
    """Four or more pieces, spread over a recording of N samples; None: it is too short.

    motion: q, qd, qdd; kept: (N,) valid ones.
    """
    valid = np.flatnonzero(np.ones(len(time), dtype=bool) if kept is None else kept)
    count = len(valid)
    period = (time[valid[-1]] - time[valid[0]]) / max(count - 1, 1) if count else 0.0
    wanted = int(_SECONDS / period) if period > 0 else _MOST
    length = min(max(wanted, 2 * _LEAST), _MOST, count // 4)
    if length < _LEAST:
        return None
    starts = np.linspace(0, count - length, min(_PIECES, count // length)).astype(np.int64)
    rows = valid[starts[:, None] + np.arange(length)]
    q, qd, qdd = (values[rows] for values in motion)
    return Pieces(tuple(joints), time[rows], q, qd, qdd, measured[rows])


@dataclass(frozen=True)
class View:
    """Pieces and arm, and what several rivals need. Arrays: (N, n)."""

    samples: Pieces
    arm: ArmModel

    @cached_property
    def motion(self) -> tuple[Floats, Floats, Floats]:
        """q, qd, qdd."""
        s = self.samples
        return s.flat(s.q), s.flat(s.qd), s.flat(s.qdd)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the joints."""
        return self.samples.joints

    @property
    def qd(self) -> Floats:
        """Velocities."""
        return self.motion[1]

    @cached_property
    def computed(self) -> Floats:
        """The torques to compare measured ones with if nothing is wrong."""
        return self.arm.compared(*self.motion)

    @cached_property
    def gravity(self) -> Floats:
        """Torques of gravity."""
        return self.arm.gravity(self.motion[0])

    @cached_property
    def friction(self) -> Floats | None:
        """Of the model."""
        return None if self.arm.friction is None else self.arm.friction(self.motion[0], self.qd)

    @cached_property
    def loaded(self) -> tuple[Floats, ...]:
        """(4, N, n) of a body at each tip."""
        return tuple(carrier.loaded(*self.motion) for carrier in self.arm.carriers)

    @cached_property
    def prismatic(self) -> Mask:
        """(n,)."""
        return self.arm.of_type("prismatic", len(self.names))

    @cached_property
    def informative(self) -> Mask:
        """(n,) joints that move, and whose torque shows beside that of the others."""
        travel = np.ptp(self.motion[0], axis=0)
        size = np.quantile(np.abs(self.computed - np.median(self.computed, axis=0)), 0.95, axis=0)
        size = np.maximum(size, 0.2 * np.quantile(np.abs(self.computed), 0.95, axis=0))
        return np.asarray((size >= _INFORMATIVE * size.max()) & (travel > 1e-3 * travel.max()))

    def rival(self, kind: str, words: Words = None, **changes: Any) -> Rival:
        """A rival that predicts what the model computes, but for the changes."""
        return replace(Rival(kind, self.computed, self.qd, words), **changes)

    def moving(self, q: Floats, qd: Floats, qdd: Floats) -> View:
        """The same efforts, of another motion."""
        q, qd, qdd = (values.reshape(self.samples.q.shape) for values in (q, qd, qdd))
        return View(replace(self.samples, q=q, qd=qd, qdd=qdd), self.arm)

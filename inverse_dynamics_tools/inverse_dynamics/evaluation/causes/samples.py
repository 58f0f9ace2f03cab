# SPDX-License-Identifier: Apache-2.0
"""Short contiguous pieces of a recording, on which causes are compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.base.arrays import Floats, Integers, Mask

_PIECES = 48  # even ones are fitted where odd ones judge, and the other way round
_LEAST = 4  # samples of a piece: its noise is told by second differences
_MOST = 40
_SECONDS = (
    0.2  # of a piece, where it has more samples than _LEAST: as good as independent, yet smooth
)


@dataclass(frozen=True)
class Samples:
    """Samples of a motion: K pieces of M contiguous ones. (K, M) s; (K, M, n) rad, rad/s, rad/s^2, N m."""

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


def rows_of_pieces(time: Floats) -> Integers | None:
    """(K, M) rows of four or more pieces, spread over all samples; None: there are too few."""
    period = (time[-1] - time[0]) / max(len(time) - 1, 1) if len(time) else 0.0
    wanted = int(_SECONDS / period) if period > 0 else _MOST
    length = min(max(wanted, 2 * _LEAST), _MOST, len(time) // 4)
    if length < _LEAST:
        return None
    starts = np.linspace(0, len(time) - length, min(_PIECES, len(time) // length)).astype(np.int64)
    return starts[:, None] + np.arange(length)


def pieces_of(
    joints: Sequence[str],
    time: Floats,
    q: Floats,
    qd: Floats,
    qdd: Floats,
    measured: Floats,
    kept: Mask | None = None,
) -> Samples | None:
    """Pieces of a recording of N samples, as rows_of_pieces() chooses them. kept: (N,) marks valid ones."""
    valid = np.flatnonzero(np.ones(len(time), dtype=bool) if kept is None else kept)
    if (pieces := rows_of_pieces(time[valid])) is None:
        return None
    rows = valid[pieces]
    return Samples(tuple(joints), time[rows], q[rows], qd[rows], qdd[rows], measured[rows])

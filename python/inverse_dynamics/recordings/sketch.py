# SPDX-License-Identifier: Apache-2.0
"""A recording's samples in a few numbers, by which it, or a part of it, is recognised.

    sketch = sketch_of(log)
    has_samples_of(log, sketch)    # True

Each sample is hashed, and the least hashes are kept: those of a part of a recording are among them, too [Broder 1997,
doi 10.1109/SEQUEN.1997.666900]. Digits after the sixth decimal don't count, nor turns of a joint.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from inverse_dynamics.recordings.joint_log import JointLog

_KEPT = 64  # hashes: of a twentieth of the recording about three
_SHARED = 3  # hashes that no other recording has by chance; an arm at rest has one
_DIGITS = 1e6  # of a unit
_ROWS = 50_000  # samples in memory at a time
_ODD = np.uint64(0x9E3779B97F4A7C15)


def sketch_of(log: JointLog) -> tuple[str, ...]:
    """The sketch, of hexadecimal numbers."""
    least = np.empty(0, np.uint64)
    for hashes in _hashes(log):
        least = np.unique(np.concatenate([least, hashes]))[:_KEPT]
    return tuple(f"{x:016x}" for x in least.tolist())


def has_samples_of(log: JointLog, sketch: Sequence[str]) -> bool:
    """Whether a recording has samples of those that were sketched. sketch: of any of several."""
    known = np.array([int(x, 16) for x in sketch], np.uint64)
    found = {x for hashes in _hashes(log) for x in hashes[np.isin(hashes, known)].tolist()}
    return len(found) >= _SHARED


def _hashes(log: JointLog) -> Iterator[NDArray[np.uint64]]:
    """Of positions and efforts as recorded, (N,) in pieces."""
    for first in range(0, len(log), _ROWS):
        rows = slice(first, first + _ROWS)
        values = np.hstack([np.cos(log.q[rows]), log.effort[rows]])
        whole = np.rint(_DIGITS * np.nan_to_num(values)).astype(np.int64).view(np.uint64)
        hashes = np.zeros(len(whole), np.uint64)
        for column in whole.T:
            hashes = (hashes ^ column) * _ODD
            hashes ^= hashes >> np.uint64(29)
        yield hashes

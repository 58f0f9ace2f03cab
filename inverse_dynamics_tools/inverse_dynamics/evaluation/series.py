# SPDX-License-Identifier: Apache-2.0
"""Where the samples of an evaluation go: some thousand at a time.

Arrays have the names that series.npz has for them: time, header_stamps, receive_stamps, (N,); q, qd,
qdd, effort (as recorded), measured, computed, (N, n); masks of Samples, (N,).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from inverse_dynamics.data.joint_log import Storage

    Arrays = Mapping[str, np.ndarray[Any, Any]]


class Recorded(NamedTuple):
    """What samples are of."""

    samples: int  # in all
    joint_names: tuple[str, ...]  # in the recording
    frame_id: str
    storage: Storage


class Series(Protocol):
    """Takes the samples of an evaluation."""

    scratch: Path | None
    """Directory that may hold a file of samples meanwhile; None: the recording is read again."""

    def take(self, recorded: Recorded, arrays: Arrays) -> None:
        """The next samples."""

    def arrays(self) -> Arrays:
        """All of them, after the last one."""


class SeriesInMemory:
    """Keeps the samples."""

    scratch: Path | None = None

    def __init__(self) -> None:
        self._arrays: dict[str, np.ndarray[Any, Any]] = {}
        self._taken = 0

    def take(self, recorded: Recorded, arrays: Arrays) -> None:
        """The next samples."""
        rows = slice(self._taken, self._taken + len(arrays["time"]))
        for name, array in arrays.items():
            if name not in self._arrays:
                self._arrays[name] = np.empty((recorded.samples, *array.shape[1:]), array.dtype)
            self._arrays[name][rows] = array
        self._taken = rows.stop

    def arrays(self) -> Arrays:
        """All of them."""
        return self._arrays

# SPDX-License-Identifier: Apache-2.0
"""A part of a recording, by time.

part = TimeWindow(10.0, 20.0).of(log, "recording")
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from inverse_dynamics.recordings.joint_log import JointLog


@dataclass(frozen=True)
class TimeWindow:
    """From when to when, s since the first sample; both ends belong to it. None: no end.

    Raises BagError: ends that aren't finite, or the second not after the first.
    """

    start: float | None = None
    end: float | None = None

    def __post_init__(self) -> None:
        for name, time in (("--from (start=)", self.start), ("--to (end=)", self.end)):
            if time is not None and not (math.isfinite(time) and abs(time) < 1e9):
                raise BagError(f"{name}: expected a time in s since the first sample, got {time}")
        if self.start is not None and self.end is not None and self.end <= self.start:
            raise BagError(
                f"--to (end=): expected a time after --from (start=), {self.start:g} s, got "
                f"{self.end:g} s"
            )

    def __bool__(self) -> bool:
        """Whether it has an end."""
        return self.start is not None or self.end is not None

    def __str__(self) -> str:
        """`from 10 s to 20 s`."""
        ends = (("from", self.start), ("to", self.end))
        return " ".join(f"{word} {time:.9g} s" for word, time in ends if time is not None)

    @property
    def span(self) -> tuple[float, float]:
        """From when to when, s; infinite: no end."""
        start = -math.inf if self.start is None else self.start
        return start, math.inf if self.end is None else self.end

    def of(self, log: JointLog, where: str) -> JointLog:
        """The samples in the window. where: the recording, for errors' texts. Raises BagError."""
        if not self:
            return log
        since_first = log.stamps - log.stamps[0]
        inside = np.ones(len(log), dtype=bool)
        if self.start is not None:
            inside &= since_first >= round(self.start * 1e9)
        if self.end is not None:
            inside &= since_first <= round(self.end * 1e9)
        if not inside.any():
            least, most = since_first.min() * 1e-9, since_first.max() * 1e-9
            where = ": ".join(filter(None, (where, log.topic)))
            raise BagError(
                f"{where}: expected samples {self} after the first one, got none: those of the "
                f"recording go from {least:.9g} s to {most:.9g} s; choose --from and --to in between"
            )
        arrays = ("header_stamps", "receive_stamps", "q", "qd", "effort", "qdd")
        given = {name: getattr(log, name) for name in arrays}
        part: dict[str, Any] = {k: v if v is None else v[inside] for k, v in given.items()}
        return replace(log, **part)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for a result of these samples."""
        if not self:
            return ()
        return (
            f"only the samples {self} after the recording's first one are evaluated, as asked for; "
            "times of the result count from the first of them",
        )

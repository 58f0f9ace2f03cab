# SPDX-License-Identifier: Apache-2.0
"""How joint accelerations of a recording were estimated, in C++, and what was found in its samples.

The rules are those of inverse_dynamics_evaluation/samples.hpp. What they find is stated in words in
any case; they are acted upon unless they are switched off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from numpy.typing import NDArray

    from inverse_dynamics._core import Evaluated
    from inverse_dynamics.base.arrays import Mask
    from inverse_dynamics.data.joint_log import JointLog

# What each rule does, as --help says it.
RULES = {
    "repeated": "samples that repeat the previous one are left out of the differentiation",
    "non-increasing": "samples whose stamp isn't later than all previous ones are left out of it too",
    "time-base": "stamps that contradict positions and velocities are replaced by equidistant ones",
    "start-transient": "efforts that jump at the very start are left out of the second metrics",
}


@dataclass(frozen=True)
class Accelerations:
    """How accelerations were estimated."""

    method: str  # low-pass, given or backward-difference
    cutoff: float | None = None  # Hz; gain one half there
    chosen: bool = False  # whether the cut-off was chosen from the data
    order: int | None = None  # of the Butterworth filter that runs forwards and backwards
    time_base: str = "stamps"  # when samples were taken: stamps, regular, regular_fresh

    @property
    def summary(self) -> str:
        """In words, as titles and tables show it."""
        from inverse_dynamics import _core

        return _core.acceleration_summary(self.method, self.cutoff, self.chosen)


# Names of the masks of Samples, as files have them.
MASKS = ("repeated", "non_increasing", "start_transient", "isolated", "kept")


@dataclass(frozen=True)
class Samples:
    """What was found in N samples."""

    repeated: Mask  # (N,) repeats the sample before
    non_increasing: Mask  # (N,) not later than all before it
    start_transient: Mask  # (N,) efforts jump as a controller takes over
    isolated: Mask  # (N,) between gaps, in a piece too short to be filtered
    kept: Mask  # (N,) counts in the second metrics
    period: float  # s, mean distance
    jitter: float  # s, root mean square of the stamps' deviation from it

    @property
    def left_out(self) -> int:
        """How many samples the second metrics leave out."""
        return int((~self.kept).sum())

    def left_out_spans(self, log: JointLog, most: int = 500) -> list[tuple[float, float]]:
        """When those were: from the first to the last [s] of samples in succession.

        log: all samples. most: of more spans, the ones of the most samples.
        """
        import numpy as np  # late: --help needs the rules alone

        edges = np.flatnonzero(np.diff(np.concatenate([[True], self.kept, [True]])))
        first, end = edges[::2], edges[1::2]
        longest = np.sort(np.argsort(first - end, kind="stable")[:most])
        begins, ends = log.time_at(first[longest]), log.time_at(end[longest] - 1)
        return list(zip(begins.tolist(), ends.tolist(), strict=True))


def accelerations_of(found: Evaluated) -> Accelerations:
    """How the extension module has estimated them."""
    if found.method != "low-pass":
        return Accelerations(found.method)
    choice = found.filter
    return Accelerations(found.method, choice.cutoff, choice.chosen, choice.order, choice.time_base)


def samples_of(found: Evaluated, series: Mapping[str, NDArray[Any]]) -> Samples:
    """What the extension module has found. series: found.series."""
    masks = {name: series[name] for name in MASKS}
    return Samples(**masks, period=found.period, jitter=found.jitter)

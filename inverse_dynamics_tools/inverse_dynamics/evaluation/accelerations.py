# SPDX-License-Identifier: Apache-2.0
"""What was found in the samples of a recording.

The rules are those of inverse_dynamics_evaluation/samples.hpp. What they find is stated in words in
any case; they are acted upon unless they are switched off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Mask
    from inverse_dynamics.data.joint_log import JointLog

# What each rule does, as --help says it.
RULES = {
    "repeated": "samples that repeat the previous one are left out of the differentiation",
    "non-increasing": "samples whose stamp isn't later than all previous ones are left out of it too",
    "time-base": "stamps that contradict positions and velocities are replaced by equidistant ones",
    "start-transient": "efforts that jump at the very start are left out of the second metrics",
}


_MOST_SPANS = 500

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

    def left_out_spans(self, log: JointLog) -> list[tuple[float, float]]:
        """When those were: from the first to the last [s] of samples in succession.

        log: all samples. Of more than 500 spans, those of the most samples.
        """
        import numpy as np  # late: --help needs the rules alone

        edges = np.flatnonzero(np.diff(np.concatenate([[True], self.kept, [True]])))
        first, end = edges[::2], edges[1::2]
        longest = np.sort(np.argsort(first - end, kind="stable")[:_MOST_SPANS])
        begins, ends = log.time_at(first[longest]), log.time_at(end[longest] - 1)
        return list(zip(begins.tolist(), ends.tolist(), strict=True))

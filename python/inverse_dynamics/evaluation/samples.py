# SPDX-License-Identifier: Apache-2.0
"""Findings about the samples of a recording.

The rules are those of inverse_dynamics_evaluation/samples.hpp. Notes state their findings in any case; a rule
that is switched off changes nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.arrays import stretches

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Mask
    from inverse_dynamics.recordings.joint_log import JointLog

_MOST_SPANS = 500

# Names of the masks of SampleReport, as files have them.
MASKS = ("repeated", "non_increasing", "start_transient", "isolated", "kept")


@dataclass(frozen=True)
class SampleReport:
    """Findings about N samples."""

    repeated: Mask  # (N,) repeats the sample before
    non_increasing: Mask  # (N,) not later than all before it
    start_transient: Mask  # (N,) efforts jump as a controller takes over
    isolated: Mask  # (N,) between gaps, in a piece too short to be filtered
    kept: Mask  # (N,) counts in the second metrics
    period: float  # s, mean distance
    jitter: float  # s, root mean square of the stamps' deviation from it

    @property
    def left_out(self) -> int:
        """Number of samples that the second metrics leave out."""
        return int((~self.kept).sum())

    def left_out_spans(self, log: JointLog) -> list[tuple[float, float]]:
        """When those were: from the first to the last [s] of samples in succession.

        log: all samples. Of more than 500 spans, those of the most samples.
        """
        first, end = stretches(~self.kept)
        longest = np.sort(np.argsort(first - end, kind="stable")[:_MOST_SPANS])
        begins, ends = log.time_at(first[longest]), log.time_at(end[longest] - 1)
        return list(zip(begins.tolist(), ends.tolist(), strict=True))

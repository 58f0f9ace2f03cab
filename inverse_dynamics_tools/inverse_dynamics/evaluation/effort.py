# SPDX-License-Identifier: Apache-2.0
"""What recorded efforts mean, and so what is compared with what.

The meaning is stated by the option, else by the recording's format, else by the run configuration;
`auto` asks the data: causes/meanings.py. Applied in C++: inverse_dynamics_evaluation/effort.hpp.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics._core import Evaluated
    from inverse_dynamics.base.arrays import Floats

# Who stated the meaning, in words.
OPTION = "as given"
FORMAT = "as the recording's format says"
CONFIGURATION = "as the run configuration says"
DATA = "found from the data"


@dataclass(frozen=True)
class Verdict:
    """What the data say efforts mean."""

    best: str  # the meaning that fits best
    sure: bool  # whether no other meaning or mistake fits as well
    summary: str = ""  # errors of the meanings, in words
    reason: str = ""  # why it isn't sure, in words


@dataclass(frozen=True)
class Effort:
    """What recorded efforts mean, and how that is known."""

    meaning: str = "torque"  # one of EFFORT_MEANINGS
    stated_by: str = CONFIGURATION
    drive_gains: tuple[float, ...] = ()  # N m/A (prismatic N/A), of currents
    verdict: Verdict | None = None  # of the data, if they were asked

    def torques(self, effort: Floats) -> Floats:
        """Measured torques (N, n) [N m] of recorded efforts; without gravity if these are."""
        return effort * self.drive_gains if self.meaning == "current" else effort

    @property
    def summary(self) -> str:
        """In words, as tables show it."""
        from inverse_dynamics import _core

        verdict = _core.EffortVerdict(**asdict(self.verdict)) if self.verdict else None
        return _core.effort_summary(self.meaning, self.stated_by, list(self.drive_gains), verdict)


def effort_of(found: Evaluated) -> Effort:
    """What the extension module has decided."""
    v = found.verdict
    verdict = Verdict(v.best, v.sure, v.summary, v.reason) if v else None
    return Effort(found.meaning, found.stated_by, tuple(found.drive_gains), verdict)

# SPDX-License-Identifier: Apache-2.0
"""Which meaning of the recorded efforts fits the data, and how sure that is.

Computed in C++: inverse_dynamics_evaluation/effort_verdict.hpp says how.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics._core import EffortVerdict
    from inverse_dynamics.base.arrays import Floats, Mask


@dataclass(frozen=True)
class Candidate:
    """A meaning, and how far it is from the recorded efforts."""

    meaning: str
    error: float  # RMSE as a share of the recorded range, mean over the joints
    margin: float  # its error over that of the best meaning: 1 for the best
    worse_in: int  # stretches in which the best meaning has a smaller error


@dataclass(frozen=True)
class Verdict:
    """Candidates, the best first, and whether it is sure."""

    candidates: tuple[Candidate, ...]
    sure: bool
    stretches: int
    reason: str = ""  # why it isn't sure, in words

    @property
    def best(self) -> str:
        """The meaning with the smallest error."""
        return self.candidates[0].meaning

    @property
    def rivals(self) -> tuple[str, ...]:
        """Meanings that aren't clearly worse than the best."""
        return tuple(self.in_core().rivals)

    @property
    def summary(self) -> str:
        """In words: errors, and in how many stretches the best is better."""
        return self.in_core().summary

    def in_core(self) -> EffortVerdict:
        """The same of the extension module."""
        from inverse_dynamics import _core

        candidates = [
            _core.EffortCandidate(c.meaning, c.error, c.margin, c.worse_in) for c in self.candidates
        ]
        return _core.EffortVerdict(candidates, self.sure, self.stretches, self.reason)


def verdict_of(found: EffortVerdict) -> Verdict:
    """A verdict of the extension module."""
    candidates = tuple(
        Candidate(c.meaning, c.error, c.margin, c.worse_in) for c in found.candidates
    )
    return Verdict(candidates, found.sure, found.stretches, found.reason)


def compare_meanings(
    computed: Floats,
    gravity: Floats,
    effort: Floats,
    gains: Sequence[float] | None = None,
    kept: Mask | None = None,
) -> Verdict:
    """Compare what each meaning predicts with the recorded efforts.

    computed, gravity: (N, n) N m. effort: (N, n) as recorded. gains: (n,) N m/A, if they are known.
    kept: (N,) marks the valid samples.
    """
    from inverse_dynamics import _core

    return verdict_of(_core.compare_meanings(computed, gravity, effort, list(gains or ()), kept))

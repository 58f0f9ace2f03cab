# SPDX-License-Identifier: Apache-2.0
"""A mistake predicts the recorded efforts: linear in a few unknown numbers.

    recorded effort = base + shared numbers * columns + each joint's own numbers * columns + friction + offset

Each kind of mistake has a file that makes its rivals; fit.py fits them, and compare.py compares them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats

PAGE = "docs/why_dont_my_torques_match.md"


def printed(value: float, digits: int = 3) -> float:
    """A number as remedies state it."""
    return float(f"{value:.{digits}g}")


@dataclass(frozen=True)
class Mistake:
    """A mistake in words, and the numbers of its remedy as printed: all that the remedy changes.

    mistake: the nearest heading of PAGE; "": none is near. shared, own: see Rival.
    """

    kind: str
    mistake: str
    reason: str
    remedy: str
    joints: tuple[str, ...] = ()
    value: Any = None
    shared: Floats = field(default_factory=lambda: np.zeros(0))
    own: Floats | None = None
    gain: float = 2.0  # least ratio of the errors before and after
    also: Mistake | None = None  # a second mistake, of a pair


Words = Callable[["Floats", "Floats"], Mistake | None] | Mistake | None


@dataclass(frozen=True)
class Rival:
    """A mistake. N samples, n joints, p numbers that all joints share, m that each joint has of its own.

    base: (N, n). columns: (p, N, n); low, high: bounds of their numbers. own: (m, N, n), likewise.
    qd: (N, n) velocities that friction opposes, as recorded efforts have it.
    words: the finding, or what finds them from shared numbers (p,) and own ones (m, n): None where no robot can have
    these numbers. None: for comparison alone.
    includes: kinds that are special cases of it. motion, effort: q, qd, qdd that it changes, and computed
    efforts to recorded ones: for pairs.
    """

    kind: str
    base: Floats
    qd: Floats
    words: Words = None
    columns: tuple[Floats, ...] = ()
    low: Any = -np.inf
    high: Any = np.inf
    own: tuple[Floats, ...] = ()
    own_low: Any = -np.inf
    own_high: Any = np.inf
    includes: tuple[str, ...] = ()
    motion: tuple[Floats, ...] | None = None
    effort: Callable[[Floats], Floats] = field(default=lambda efforts: efforts)

    def finding(self, shared: Floats, own: Floats) -> Mistake | None:
        """The finding at these numbers."""
        return self.words(shared, own) if callable(self.words) else self.words

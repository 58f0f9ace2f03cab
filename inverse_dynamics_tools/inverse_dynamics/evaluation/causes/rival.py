# SPDX-License-Identifier: Apache-2.0
"""What a mistake predicts of the recorded efforts: linear in a few unknown numbers.

    recorded effort = base + shared numbers * columns + each joint's own numbers * columns + friction + offset

A file of a kind of mistake makes its rivals; fit.py fits and compare.py compares them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.base.arrays import Floats

PAGE = "docs/why_dont_my_torques_match.md"


def printed(value: float, digits: int = 3) -> float:
    """A number as remedies state it."""
    return float(f"{value:.{digits}g}")


@dataclass(frozen=True)
class Told:
    """A rival in words, and the numbers of its remedy as printed: all that the remedy changes.

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
    also: Told | None = None  # a second mistake, of a pair


@dataclass(frozen=True)
class Rival:
    """A mistake. N samples, n joints, p numbers that all joints share, m that each has of its own.

    base: (N, n). columns: (p, N, n) with low, high (p,). own: (m, N, n) with own_low, own_high (m, n).
    qd: (N, n) velocities that friction is against, as recorded efforts have it.
    tell: shared numbers (p,), own ones (m, n) to words; None where no robot can have them, or for comparison alone.
    includes: kinds that are special cases of it. motion, effort: q, qd, qdd that it changes, and computed
    efforts to recorded ones: for pairs.
    """

    kind: str
    base: Floats
    qd: Floats
    tell: Callable[[Floats, Floats], Told | None] = lambda *_: None
    columns: tuple[Floats, ...] = ()
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    own: tuple[Floats, ...] = ()
    own_low: tuple[Floats, ...] = ()
    own_high: tuple[Floats, ...] = ()
    includes: tuple[str, ...] = ()
    motion: tuple[Floats, Floats, Floats] | None = None
    effort: Callable[[Floats], Floats] = field(default=lambda efforts: efforts)

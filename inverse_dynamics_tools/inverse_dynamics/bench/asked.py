# SPDX-License-Identifier: Apache-2.0
"""What the project asks of its own speed, and whether a measurement reaches it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from inverse_dynamics.bench.measurement import Measurement

REAL = ("ur10", "panda")
GENERATED = ("mixed6", "mixed7", "turning6", "turning7")
IDENTIFIED = {"ur10_identified": "ur10", "panda_identified": "panda"}
CHAINS = tuple(f"mixed{n}" for n in (1, 2, 3, 6, 7, 10, 15, 20, 30))
QUANTITIES = ("torques", "inertia", "coriolis", "gravity", "components")
_THREE = ("inertia", "coriolis", "gravity")
_ENGINE = (("derivatives", 3.0), ("forward_dynamics", 1.0), ("regressor", 1.0))


@dataclass(frozen=True)
class Bound:
    """How many times as fast as the other something is: the least over several."""

    what: str
    other: str
    asked: float
    reached: float | None  # None: not measured
    where: str = ""  # the least is there

    @property
    def holds(self) -> bool:
        """Whether it was measured and is reached."""
        return self.reached is not None and self.reached >= self.asked


def peer_time(result: Measurement, robot: str, quantity: str) -> float | None:
    """Pinocchio's time for a quantity: single call; `components`: its three calls added."""
    quantity = quantity.removesuffix("_batch")
    if quantity != "components":
        return result.time(robot, quantity, "pinocchio")
    times = [result.time(robot, part, "pinocchio") for part in _THREE]
    return sum(t for t in times if t is not None) if None not in times else None


def ratio(slow: float | None, fast: float | None) -> float | None:
    """None where one of them wasn't measured."""
    return None if slow is None or fast is None else slow / fast


def bounds(result: Measurement) -> tuple[Bound, ...]:
    """All of them, those that weren't measured too."""
    return (
        *_single_calls(result),
        *_identified(result),
        *_batches(result),
        *_beside_other_calls(result),
    )


def _single_calls(result: Measurement) -> Iterator[Bound]:
    asked = (("torques", 8.0), ("inertia", 4.0), ("coriolis", 8.0), ("gravity", 8.0))
    for quantity, times in (*asked, ("components", 10.0)):
        yield _of_pinocchio(result, f"{quantity}: UR10, Panda", times, REAL, quantity)
    yield _of_pinocchio(result, "torques: any 6 or 7 joints", 6.0, GENERATED, "torques")
    for quantity, times in _ENGINE:
        robots = (*REAL, *GENERATED)
        yield _of_pinocchio(result, quantity.replace("_", " "), times, robots, quantity)


def _identified(result: Measurement) -> Iterator[Bound]:
    for robot, times in (("ur10_identified", 6.0), ("panda_identified", 5.0)):
        reached = ratio(
            peer_time(result, IDENTIFIED[robot], "torques"), result.time(robot, "torques", "ours")
        )
        yield Bound("torques, identified", "Pinocchio, from the URDF", times, reached, robot)


def _batches(result: Measurement) -> Iterator[Bound]:
    for quantity in QUANTITIES:
        batch = f"{quantity}_batch"
        yield _of_pinocchio(result, f"{quantity}, batch: UR10, Panda", 30.0, REAL, batch)


def _beside_other_calls(result: Measurement) -> Iterator[Bound]:
    large = result.time("ur10", "torques_memory", "ours")
    limits = [
        result.time("ur10", "torques_memory", "sum"),
        result.time("ur10", "torques_batch", "ours"),
    ]
    limit = max(t for t in limits if t is not None) if None not in limits else None
    yield Bound(
        "torques, batch beyond the caches",
        "the slower of memory and batch in cache",
        0.9,
        ratio(limit, large),
    )
    one = result.time("ur10", "torques_many", "ours")
    two = result.time("ur10", "torques_many", "two_threads")
    yield Bound("torques, batch: two threads", "one thread", 1.8, ratio(one, two))
    pairs = ((robot, quantity) for robot in (*REAL, *CHAINS) for quantity in QUANTITIES)
    yield _least(
        "every quantity, 1 to 30 joints",
        "KDL",
        1.0,
        (
            (f"{robot}, {q}", ratio(result.time(robot, q, "kdl"), result.time(robot, q, "ours")))
            for robot, q in pairs
        ),
    )


def _of_pinocchio(
    result: Measurement, what: str, asked: float, robots: Iterable[str], quantity: str
) -> Bound:
    ratios = (
        (robot, ratio(peer_time(result, robot, quantity), result.time(robot, quantity, "ours")))
        for robot in robots
    )
    return _least(what, "Pinocchio", asked, ratios)


def _least(
    what: str, other: str, asked: float, ratios: Iterable[tuple[str, float | None]]
) -> Bound:
    known = [(value, where) for where, value in ratios if value is not None]
    if not known:
        return Bound(what, other, asked, None)
    reached, where = min(known)
    return Bound(what, other, asked, reached, where)

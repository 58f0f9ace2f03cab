# SPDX-License-Identifier: Apache-2.0
"""When the rows of a log were recorded: which columns say it, in which unit, in which order.

time_columns(["stamp.sec", "stamp.nanosec", "q1"])  # ["stamp.sec"]
seconds_of("12:30:00.5")                            # 45000.5
"""

from __future__ import annotations

import re
from collections import defaultdict
from datetime import datetime
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.decimals import decimal
from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.vocabulary import (
    NEUTRAL,
    POSITION,
    TIME,
    TIME_WORDS,
    UNITS,
    UNITS_OF_NAMES,
    VELOCITY,
    unit_of,
    words_of,
)
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.arrays import Floats, Integers

LONGEST_PERIOD = 0.5  # s: no recording of a motion is as slow
_BETWEEN_RUNS, _PERIODS_BETWEEN_RUNS = 1.0, 50.0  # s; what the time base takes for a gap
_UNITS_OF_STEPS = ((5e5, "ns"), (5e2, "us"), (0.0, "ms"))
_EPOCH = (1e9, 2.0**31)  # s since 1970: from 2001 to 2038
_DAY = 86400.0  # s
_AGREEMENT = 0.9  # correlation of steps of positions with those that velocities make
_SHUFFLED = 0.25  # share of steps back in time that neither clocks nor episodes make
# A date or another word, the time of day, fractions, the zone.
_MOMENT = re.compile(
    r"(?:(\d{4}-\d\d-\d\d)[T ]|[\w/.-]+ )?(\d{1,2}:\d\d:\d\d)([.,]\d+|:\d{3})?(Z|[+-]\d\d:\d\d)?",
    re.ASCII,
)


# ---- columns and texts ---------------------------------------------------------------------------


def time_columns(names: Sequence[str]) -> list[str]:
    """Columns that are as good as any for the time: of the fewest words, of the first of TIME_WORDS.

    A name of which the last part alone says it, `log.t`, comes last.
    """
    known = {*TIME_WORDS, *UNITS_OF_NAMES[TIME]}
    ranked = defaultdict(list)
    for name in names:
        for rank, telling in enumerate((name, name.rpartition(".")[2])):
            words = words_of(telling)
            said = [word for word in TIME_WORDS if word in words]
            if said and known.union(NEUTRAL).issuperset(words):
                ranked[rank, len(words), TIME_WORDS.index(said[0])].append(name)
    return ranked[min(ranked)] if ranked else []


def part_of_second(time: str, names: Sequence[str]) -> tuple[str, ...]:
    """`stamp.nanosec`, which belongs to `stamp.sec`; none: there is no such column."""
    *rest, unit = words_of(time) or ("",)
    if unit not in UNITS_OF_NAMES[TIME] or unit_of(TIME, [unit]):
        return ()
    same = [name for name in names if words_of(name)[:-1] == (*rest,)]
    return (*[name for name in same if unit_of(TIME, words_of(name)[-1:])][:1],)


def whole_seconds(columns: Floats, part: str) -> Floats:
    """Seconds (N, 1) of (N, 2) whole ones and parts in the unit of `part`; the first where these are none."""
    seconds, parts = columns[:, :1], columns[:, 1:] * UNITS[unit_of(TIME, words_of(part))]
    return seconds + parts if (parts < 1.0).all() and not (seconds % 1.0).any() else seconds


def seconds_of(text: str) -> float:
    """Seconds of a date, `2026-01-31T12:30:00.5`, since 1970, of a time of day, or `0.5 sec`.

    A date in another notation is passed over. Raises ValueError.
    """
    if text.endswith(" sec"):  # as MATLAB writes durations
        return decimal(text[:-4])
    found = _MOMENT.fullmatch(text)
    if not found:
        raise ValueError(text)
    day, zone = found[1] or "1970-01-01", (found[4] or "Z").replace("Z", "+00:00")
    whole = datetime.fromisoformat(f"{day}T{found[2].zfill(8)}{zone}")
    return whole.timestamp() + float(f"0.{(found[3] or '.0')[1:]}")


# ---- numbers -------------------------------------------------------------------------------------


def beyond_midnight(time: Floats) -> Floats:
    """Times of day, (N,) s, that go on where they restart at midnight; other times as they are."""
    if time.min(initial=0.0) < 0 or time.max(initial=0.0) >= _DAY:
        return time
    return time + _DAY * np.cumsum(np.diff(time, prepend=time[:1]) < -_DAY / 2)


def in_order(time: Floats) -> Integers:
    """Indices that sort (N,) times of shuffled rows; those of other rows as they are."""
    shuffled = len(time) > 1 and (np.diff(time) < 0).mean() > _SHUFFLED
    return np.argsort(time, kind="stable") if shuffled else np.arange(len(time))


def _period(time: Floats) -> tuple[float, str]:
    """Median step of (N,) a time, and the unit in which it is one of a motion."""
    period = float(np.median(np.abs(np.diff(time))))
    return period, next(unit for least, unit in _UNITS_OF_STEPS if period >= least)


def sure_unit(time: Floats, numbers: Mapping[str, Floats]) -> tuple[str, str]:
    """The unit of (N,) a time that isn't in seconds, and how it shows; "": it may be, or doesn't show."""
    period, latest = _period(time)[0], np.abs(time).max()
    if period < LONGEST_PERIOD:
        return "", ""
    units = [unit for _, unit in _UNITS_OF_STEPS if latest * UNITS[unit] < _EPOCH[1]]
    for unit in units:
        if latest * UNITS[unit] >= _EPOCH[0] and period * UNITS[unit] < LONGEST_PERIOD:
            return unit, "its numbers are then dates of this century"
    if VELOCITY in numbers:
        way = np.diff(numbers[POSITION], axis=0)
        driven = (numbers[VELOCITY][1:] + numbers[VELOCITY][:-1]) / 2 * np.diff(time)[:, None]
        lengths = float(np.linalg.norm(way)), float(np.linalg.norm(driven))
        agree = (way * driven).sum() > _AGREEMENT * lengths[0] * lengths[1]
        for unit in units:
            if agree and 0.5 < lengths[0] / (lengths[1] * UNITS[unit]) < 2.0:
                slow = period * UNITS[unit] >= LONGEST_PERIOD
                return ("", "") if slow else (unit, "velocities then agree with positions")
    if units and period >= _UNITS_OF_STEPS[0][0]:
        return "ns", f"steps of {period:g} are too long for other units"
    return "", ""


def check_seconds(where: str, time: Floats, expected: str = "seconds") -> None:
    """Raise BagError if (N,) the time of a motion can't be in seconds."""
    period, unit = _period(time)
    if period >= LONGEST_PERIOD:
        raise BagError(
            f"{where}: {TIME}: expected {expected}, got steps of {period:g}: are they {unit}? Then state "
            f"--scale {TIME}={unit}"
        )
    if np.abs(time).max() >= _EPOCH[1]:
        raise BagError(
            f"{where}: {TIME}: expected seconds, got {np.abs(time).max():g}; count from the start of "
            "the recording, or state their unit with --scale"
        )


def check_increasing(where: str, time: Floats, point: str = "row") -> None:
    """Raise BagError unless each of (N,) times of a plan is later than the one before, as controllers demand."""
    back = np.flatnonzero(~(np.diff(time) > 0)) + 1
    if len(back):
        k = int(back[0])
        more = f", the first of {counted(len(back), 'such place')}" if len(back) > 1 else ""
        raise BagError(
            f"{where}: {TIME}: expected times that increase, got {time[k]:.12g} s in {point} {k + 1} after "
            f"{time[k - 1]:.12g} s{more}; sort or correct them, or time the path: `ids retime`"
        )


def one_after_another(time: Floats) -> tuple[Floats, list[str]]:
    """Time (N,) that goes on where it restarts, as that of a file with several episodes does."""
    steps = np.diff(time)
    back = np.flatnonzero(steps < 0) + 1
    period = float(np.median(np.abs(steps)))
    if not len(back) or (np.abs(time[back] - time[0]) > 2 * period).any():
        return time, []
    between = max(_BETWEEN_RUNS, _PERIODS_BETWEEN_RUNS * period)
    shifts = np.zeros(len(time))
    shifts[back] = between - steps[back - 1]
    note = f"time restarts {counted(len(back), 'time')}: runs are taken one after another, {between:g} s apart"
    return time + np.cumsum(shifts), [note]

# SPDX-License-Identifier: Apache-2.0
"""Which column of a log is which quantity of which joint.

    mapping = match_columns(["time", "q0", "q1", "tau0", "tau1"], ["shoulder", "elbow"])
    mapping.columns["position"]   # ("q0", "q1")

The names alone decide. A column has the quantity that a word of its name says (`q`, `pos`, `tau`, ...)
and belongs to the joint whose name it holds, or whose number: from 0 or from 1, in the order of the
chain. Commanded and external values are passed over. What the names don't say, a user states:

    match_columns(names, joints, stated="time=t, q=axis*_angle, effort=13-18")
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import takewhile
from typing import TYPE_CHECKING, NamedTuple

from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.times import part_of_second, time_columns
from inverse_dynamics.recordings.vocabulary import (
    BARE,
    CURRENT,
    EFFORT,
    KEYS,
    POSITION,
    QUANTITIES,
    TIME,
    UNITS_OF_NAMES,
    foreign,
    quantity_of,
    unit_of,
    words_of,
    words_of_numbered,
)
from inverse_dynamics.wording import listed, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


class Family(NamedTuple):
    """Columns whose names differ in the joint alone."""

    rank: tuple[int, ...]  # the least is the best
    columns: tuple[str, ...]  # in the order of the joints
    unit: str  # that the names state; "": none


def pattern_of(names: Sequence[str]) -> str:
    """What the names have in common, with `*` in the place of the joint; the name if it's one."""
    if len(names) == 1:
        return names[0]
    start = _common_start(names)
    end = _common_start([name[len(start) :][::-1] for name in names])[::-1]
    return f"{start}*{end}"


def _common_start(names: Sequence[str]) -> str:
    letters = takewhile(lambda each: len({*each}) == 1, zip(*names, strict=False))
    return "".join(each[0] for each in letters)


@dataclass(frozen=True)
class Matched:
    """Columns by quantity, in the order of the joints."""

    joints: tuple[str, ...]
    columns: dict[str, tuple[str, ...]]
    units: dict[str, str] = field(default_factory=dict)  # that names state: of UNITS, UNKNOWN_UNITS

    @property
    def exact(self) -> bool:
        """Whether the names are `time` and QUANTITY.JOINT."""
        return self.columns.get(TIME, (TIME,)) == (TIME,) and all(
            names == tuple(f"{quantity}.{joint}" for joint in self.joints)
            for quantity, names in self.columns.items()
            if quantity != TIME
        )

    @property
    def text(self) -> str:
        """One line that says which columns were taken for what."""
        return "; ".join(
            f"{quantity}: {first_to_last(names)}"
            + (f" [{self.units[quantity]}]" if quantity in self.units else "")
            for quantity, names in self.columns.items()
        )


def match_columns(
    names: Sequence[str],
    joints: Sequence[str] = (),
    stated: str = "",
    where: str = "",
    quantities: Sequence[str] = QUANTITIES,
) -> Matched:
    """Columns of time, positions, velocities, accelerations, and efforts or currents.

    names: of all columns. joints: of the chain, in its order; none: those that the columns name, or their
    numbers. stated: `KEY=PATTERN, ...`, which comes before what names say: KEY is a quantity or one of t,
    q, qd, qdd, tau, i; PATTERN the name of a column with `*` in the place of the joint's name or number,
    names separated by spaces, or numbers of columns from 1 on, `2-7`.
    where: the file, for errors. quantities: which of QUANTITIES to look for.

    What isn't found is left out; the caller knows what it needs. Currents are left out, unless they are stated, where
    there are efforts whose names have no foreign word: `torque_enable_1` may be none. Raises BagError: a pattern that
    fits nothing, two sets of columns that fit as well, some joints of a quantity missing.
    """
    given = dict(stated_columns(stated, where))
    joints = tuple(joints) or _joints_of(names, given)
    columns: dict[str, tuple[str, ...]] = {}
    units: dict[str, str] = {}
    time = _chosen_time(given[TIME], names) if TIME in given else time_columns(names)
    unclear: dict[str, list[Family]] = {}
    if time:
        _known(names, time, where, f"{TIME}=")
        columns[TIME] = (time[0], *part_of_second(time[0], names))
        units[TIME] = unit_of(TIME, words_of(time[0]))
    if {*time} - {*columns.get(TIME, ())}:
        unclear[TIME] = [Family((), (name,), "") for name in time]
    found = _families(names, joints)
    sure_efforts = EFFORT in given
    for quantity in quantities:
        if quantity in given:
            columns[quantity] = _matching(given[quantity], names, joints, where)
            units[quantity] = unit_of(quantity, words_of(columns[quantity][0]))
            continue
        if quantity == (EFFORT if CURRENT in given else CURRENT if sure_efforts else ""):
            continue
        _refuse_incomplete(names, joints, quantity, where)
        if best := _best(found[quantity]):
            columns[quantity] = best[0].columns
            units[quantity] = best[0].unit
            sure_efforts = sure_efforts or (quantity == EFFORT and not best[0].rank[1])
        if len(best) > 1:
            unclear[quantity] = best
    if unclear:
        raise _ambiguous(where, unclear)
    return Matched(joints, columns, {kind: unit for kind, unit in units.items() if unit})


def named_positions(names: Sequence[str], joints: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Columns of positions, and the units in their names, of those joints whose names they hold."""
    found: dict[str, tuple[str, str]] = {}
    called = {words_of(joint): joint for joint in joints}
    for name in names:
        for _, pattern, joint in _places(name, called):
            if isinstance(joint, str) and "*" in pattern and quantity_of(pattern) == POSITION:
                found.setdefault(joint, (name, unit_of(POSITION, pattern)))
    return found


# ---- what names say ------------------------------------------------------------------------------


def _families(names: Sequence[str], joints: Sequence[str]) -> dict[str, list[Family]]:
    """Columns of all joints, by quantity."""
    found: dict[str, list[Family]] = defaultdict(list)
    for (kind, pattern), columns in _groups(names, _called(joints)).items():
        numbers = sorted(key for key in columns if isinstance(key, int))
        order: Sequence[str | int] = numbers if kind == 2 else joints
        complete = len(columns) == len(joints) and (kind < 2 or numbers[0] in (0, 1))
        complete = complete and (kind < 2 or numbers[-1] - numbers[0] == len(joints) - 1)
        if complete and (quantity := quantity_of(pattern)):
            ordered = tuple(columns[key] for key in order)
            rank, unit = (kind, *foreign(quantity, pattern)), unit_of(quantity, pattern)
            found[quantity].append(Family(rank, ordered, unit))
    return found


def _groups(
    names: Sequence[str], called: dict[tuple[str, ...], str]
) -> dict[tuple[int, tuple[str, ...]], dict[str | int, str]]:
    """Columns by joint or number, of names that are the same but for it: by kind and pattern of _places()."""
    groups: dict[tuple[int, tuple[str, ...]], dict[str | int, str]] = defaultdict(dict)
    for name in names:
        for kind, pattern, joint in _places(name, called):
            groups[kind, pattern].setdefault(joint, name)
    return groups


def _called(joints: Sequence[str]) -> dict[tuple[str, ...], str]:
    """Words by which a column may name a joint: `shoulder_pan` or `ur_shoulder_pan_joint`."""
    full = {joint: words_of(joint) for joint in joints}
    shared = set.intersection(*map(set, full.values())) if len(joints) > 1 else set()
    short = {j: tuple(w for w in words if w not in shared) for j, words in full.items()}
    says = all(any(map(str.isalpha, words)) for words in short.values())
    if len(set(short.values())) < len(joints) or not says:
        short = {}
    return {words: joint for found in (short, full) for joint, words in found.items() if words}


def _places(
    name: str, called: dict[tuple[str, ...], str]
) -> Iterator[tuple[int, tuple[str, ...], str | int]]:
    """Where a column's name may have a joint: kind (0 exactly, 1 by name, 2 by number), the rest, joint."""
    joints = set(called.values())
    quantity, _, joint = name.partition(".")
    if joint in joints and quantity in KEYS:
        yield 0, (quantity, "*"), joint
        return
    words = words_of(name)
    named = [
        (len(own), at, joint)
        for own, joint in called.items()
        for at in range(len(words) - len(own) + 1)
        if words[at : at + len(own)] == own
    ]
    if named:
        size, at, joint = max(named)
        rest = (*words[:at], "*", *words[at + size :])
        if quantity_of(rest):
            yield 1, rest, joint
            return
    if len(joints) == 1 and (said := quantity_of(words)) and not foreign(said, words)[0]:
        yield 1, words, joints.pop()
    words = words_of_numbered(name)
    for at, word in enumerate(words):
        if word.isdecimal():
            yield 2, (*words[:at], "*", *words[at + 1 :]), int(word)


def quantities_named(names: Sequence[str], file: str) -> set[str]:
    """Quantities that any of the names says, or the file's name together with it."""
    words = [tuple("*" if w.isdecimal() else w for w in words_of_numbered(n)) for n in names]
    telling = [each for each in words if not BARE.issuperset(each)]
    for some in (telling, [(*words_of(file), *each) for each in words], words):
        found = {kind for each in some if (kind := quantity_of(each))}
        if found:
            return found
    return set()


def numbered(names: Sequence[str]) -> dict[str, Family]:
    """By quantity, the best columns that differ in a number, however many they are."""
    found: dict[str, Family] = {}
    for (kind, pattern), columns in _groups(names, {}).items():
        if quantity := quantity_of(pattern):
            family = Family((kind, *foreign(quantity, pattern)), (*columns.values(),), "")
            found[quantity] = min(found.get(quantity, family), family)
    return found


def _chosen_time(pattern: str, names: Sequence[str]) -> list[str]:
    by_number = pattern.isdecimal() and pattern not in names and int(pattern) <= len(names)
    return [names[int(pattern) - 1]] if by_number else [pattern]


def _best(families: list[Family]) -> list[Family]:
    least = min((family.rank for family in families), default=())
    return [family for family in families if family.rank == least]


def _ambiguous(where: str, unclear: dict[str, list[Family]]) -> BagError:
    kinds = "; ".join(
        f"{kind}: expected one set of columns, got {listed([first_to_last(f.columns) for f in families])}"
        for kind, families in unclear.items()
    )
    first = ", ".join(
        f"{kind}={pattern_of(families[0].columns)}" for kind, families in unclear.items()
    )
    return BagError(f"{where}: {kinds}; state the right one, for example: --columns '{first}'")


def _refuse_incomplete(
    names: Sequence[str], joints: Sequence[str], quantity: str, where: str
) -> None:
    """Raise BagError where QUANTITY.JOINT is there for some of the joints only."""
    missing = [joint for joint in joints if f"{quantity}.{joint}" not in names]
    if 0 < len(missing) < len(joints):
        raise BagError(
            f"{where}: joint {missing[0]}: expected a column {quantity}.{missing[0]}, got none"
        )


def _joints_of(names: Sequence[str], given: dict[str, str]) -> tuple[str, ...]:
    """The joints that columns QUANTITY.JOINT name, else the numbers of the largest set of positions."""
    split = [name.partition(".") for name in names]
    named = dict.fromkeys(joint for kind, _, joint in split if joint and kind in UNITS_OF_NAMES)
    if named and POSITION not in given:
        return tuple(named)
    sets = [group for (_, p), group in _groups(names, {}).items() if quantity_of(p) == POSITION]
    return tuple(map(str, range(max(map(len, sets), default=0))))


def first_to_last(names: Sequence[str]) -> str:
    """A few words for columns that follow each other."""
    return names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"


def listed_columns(names: Sequence[str], most: int = 40) -> str:
    """The first few columns, for an error; those that differ in a number by the first and the last."""
    runs: dict[str, list[str]] = defaultdict(list)
    for name in names:
        runs[re.sub(r"\d+", "*", name)].append(name)
    return listed([first_to_last(run) for run in runs.values()], most)


# ---- what users state ----------------------------------------------------------------------------


def quantity_named(key: str, where: str) -> str:
    """The quantity that a key means. Raises BagError."""
    if key not in KEYS:
        raise BagError(f"{where}: expected one of {', '.join(KEYS)}, got {shown(key)}")
    return KEYS[key]


def stated_columns(text: str, where: str) -> Iterator[tuple[str, str]]:
    """Quantities and patterns of `KEY=PATTERN, ...`."""
    for part in filter(None, map(str.strip, text.split(","))):
        key, equals, pattern = map(str.strip, part.partition("="))
        if key not in KEYS or not equals or not pattern:
            raise BagError(
                f"{where}: columns: expected KEY=PATTERN with a KEY of {', '.join(KEYS)}, got {shown(part)}; for "
                "example: time=t, q=q*, qd=dq*, effort=tau*"
            )
        yield KEYS[key], pattern


def _matching(
    pattern: str, names: Sequence[str], joints: Sequence[str], where: str
) -> tuple[str, ...]:
    """One column per joint."""
    if numbers := re.fullmatch(r"(\d+)-(\d+)", pattern):
        chosen = list(names[max(int(numbers[1]) - 1, 0) : int(numbers[2])])
    elif "*" in pattern:
        chosen = _of_wildcard(pattern, names, joints)
    else:
        chosen = pattern.split() if pattern not in names else [pattern]
    _known(names, chosen, where, pattern)
    if len(chosen) != len(joints):
        raise BagError(
            f"{where}: columns: {pattern}: expected a column for each of the joints {listed(joints, 20)}, got "
            f"{len(chosen)}: {listed(chosen, 20)}; the file's columns are {listed_columns(names)}"
        )
    return tuple(chosen)


def _of_wildcard(pattern: str, names: Sequence[str], joints: Sequence[str]) -> list[str]:
    """By the joints' names, else by number: the first ones, if there are more than joints."""
    form = re.compile("(.+)".join(map(re.escape, pattern.split("*", 1))))
    fits = {found[1]: name for name in names if (found := form.fullmatch(name))}
    called = _called(joints)
    named = {called.get(words_of(key)): name for key, name in fits.items()}
    if named.keys() >= {*joints}:
        return [named[joint] for joint in joints]
    numbered = sorted((int(key), name) for key, name in fits.items() if key.isdecimal())
    return [name for _, name in numbered][: len(joints)]


def _known(names: Sequence[str], chosen: Sequence[str], where: str, pattern: str) -> None:
    unknown = [name for name in chosen if name not in names]
    if unknown or not chosen:
        raise BagError(
            f"{where}: columns: {pattern}: expected columns of the file, got {listed(unknown) or 'none'}; "
            f"the file has {listed_columns(names)}"
        )
    if twice := [name for name in chosen if list(names).count(name) > 1]:
        raise BagError(f"{where}: expected each column once, got several named {twice[0]}")

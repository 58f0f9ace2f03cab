# SPDX-License-Identifier: Apache-2.0
"""Recorded motions in tables: text files, Parquet, .npz, .npy, .mat.

    log = read_table_log(open_table(Path("motion.csv")), ["shoulder", "elbow"])

columns.py finds out which column is what. Time in s; rad, rad/s, N m, rad/s^2 (prismatic m, m/s, N,
m/s^2); motor currents in A in place of the efforts. LogFormat states what the file doesn't: other
names, units, signs, a rate. Without velocities, the filtered derivative of the positions is taken.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from inverse_dynamics.base.decimals import LARGEST, decimal
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.wording import counted, listed, shown
from inverse_dynamics.data.array_files import ArrayTable, is_array_file, open_arrays
from inverse_dynamics.data.columns import (
    ACCELERATION,
    CURRENT,
    EFFORT,
    POSITION,
    QUANTITIES,
    TIME,
    UNITS,
    VELOCITY,
    Matched,
    first_to_last,
    listed_columns,
    match_columns,
    named_positions,
    numbered,
    quantities_named,
    quantity_named,
    stated_columns,
    time_columns,
)
from inverse_dynamics.data.csv_table import CsvTable, is_csv, is_number
from inverse_dynamics.data.joint_log import JointLog
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.base.arrays import Floats, Integers
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Clock

_LONGEST_PERIOD = 0.5  # s: no recording of a motion is as slow
_BETWEEN_RUNS, _PERIODS_BETWEEN_RUNS = 1.0, 50.0  # s; what the time base takes for a gap
_UNITS_OF_TIME = ((5e5, "ns"), (5e2, "us"), (0.0, "ms"))
_EPOCH = (1e9, 2.0**31)  # s since 1970: from 2001 to 2038
_AGREEMENT = 0.9  # correlation of steps of positions with those that velocities make
_SHUFFLED = 0.25  # share of steps back in time that neither clocks nor episodes make
_SINGULAR = 1e-9  # of a matrix of gears: its determinant by the lengths of its rows
_MOTION = (POSITION, VELOCITY, ACCELERATION)
_NEEDED_FOR = {
    POSITION: "torques depend on them",
    VELOCITY: "torques depend on them",
    ACCELERATION: "torques can't be computed without them",
    EFFORT: "measured efforts are what computed torques are compared with; where there are none, `ids "
    "torques` computes them",
}


class Table(Protocol):
    """What has named columns of numbers."""

    path: Path
    names: tuple[str, ...]
    incomplete: int  # rows left out by the last read(): a number was missing

    def read(self, columns: Sequence[str], progress: Progress = no_progress) -> Floats:
        """(N, columns) numbers, all of them finite."""


@dataclass(frozen=True)
class LogFormat:
    """What a recording's names don't say. Empty: nothing.

    columns: see match_columns(). scale: texts `KEY=FACTOR` or `KEY=FACTOR,FACTOR,...`, one for each joint:
    what the quantity's numbers are multiplied by, a number or one of UNITS. sign: of each joint, 1 or -1;
    -1 turns its positions, velocities and efforts around. rate: Hz, of a table without time. gears: of motors
    whose states are recorded, `q_motor = G q`: a ratio of each joint, or the rows of G one after the other.
    """

    columns: str = ""
    scale: Sequence[str] = ()
    sign: Sequence[float] = ()
    rate: float | None = None
    gears: Sequence[float] = ()

    @staticmethod
    def of(robot: Any) -> LogFormat:
        """What a run configuration states."""
        return LogFormat(robot.columns, robot.scale, robot.sign, robot.rate, robot.gears)

    def factors(self, where: str) -> dict[str, Floats]:
        """What `scale` states, by quantity. Raises BagError."""
        found = {}
        for text in self.scale:
            key, _, factors = text.partition("=")
            kind = quantity_named(key.strip(), f"{where}: scale")
            found[kind] = np.array([_factor(factor, where) for factor in factors.split(",")])
        return found

    def scaled(
        self, numbers: Mapping[str, Floats], units: Mapping[str, str], joints: int, where: str
    ) -> dict[str, Floats]:
        """Numbers (N, joints) by quantity in SI units. units: those that are known. Raises BagError."""
        stated = self.factors(where)
        if others := [kind for kind in stated if kind not in numbers]:
            raise BagError(
                f"{where}: scale: expected one of {listed([*numbers])}, which the file has, got "
                f"{listed(others)}"
            )
        for kind, unit in units.items():
            if kind not in stated and unit not in UNITS:
                raise BagError(
                    f"{where}: {kind}: expected a known unit, got {unit}: what is one in SI units? State "
                    f"--scale {kind}=FACTOR, or one factor for each joint"
                )
        if self.sign and (len(self.sign) != joints or {*self.sign} - {1.0, -1.0}):
            raise BagError(
                f"{where}: sign: expected 1 or -1 for each of {counted(joints, 'joint')}, got "
                f"{listed([f'{sign:g}' for sign in self.sign], 20)}"
            )
        scaled = {}
        for kind, columns in numbers.items():
            factors = stated.get(kind, np.array([UNITS.get(units.get(kind, ""), 1.0)]))
            if len(factors) not in (1, columns.shape[1]):
                raise BagError(
                    f"{where}: scale: {kind}: expected 1 or {counted(columns.shape[1], 'number')}, got "
                    f"{len(factors)}"
                )
            signs = np.array(self.sign) if self.sign and kind != TIME else 1.0
            scaled[kind] = columns * (factors * signs)
        return self._behind_gears(scaled, joints, where) if self.gears else scaled

    def _behind_gears(
        self, numbers: Mapping[str, Floats], joints: int, where: str
    ) -> dict[str, Floats]:
        """Those of joints, where the numbers are those of motors: q = inv(G) q_motor, tau = G' tau_motor."""
        G = np.array(self.gears)
        if G.size not in (joints, joints**2):
            raise BagError(
                f"{where}: gears: expected {joints} ratios or the {joints**2} numbers of a matrix, got {G.size}"
            )
        G = np.diag(G) if G.size == joints else G.reshape(joints, joints)
        if abs(np.linalg.det(G)) <= _SINGULAR * np.prod(np.linalg.norm(G, axis=1)):
            raise BagError(
                f"{where}: gears: expected a matrix that can be inverted, as each joint has a motor, got "
                f"{listed([f'{x:g}' for x in self.gears], 20)}"
            )
        if CURRENT in numbers and np.count_nonzero(G - np.diag(np.diag(G))):
            raise BagError(
                f"{where}: gears: expected torques of the motors, which a matrix turns into torques of the joints, got "
                "currents; state --columns effort=... and --scale effort=... with the motors' N m/A"
            )
        to_joints = {EFFORT: G, CURRENT: G, TIME: None}
        return {
            kind: columns
            if (by := to_joints.get(kind, np.linalg.inv(G).T)) is None
            else columns @ by
            for kind, columns in numbers.items()
        }


PLAIN = LogFormat()


def _factor(text: str, where: str) -> float:
    try:
        factor = UNITS.get(text.strip().lower()) or decimal(text)
    except ValueError:
        factor = math.nan
    if not math.isfinite(factor) or factor == 0:
        raise BagError(
            f"{where}: scale: expected a number other than 0 or one of {', '.join(UNITS)}, got {shown(text)}"
        )
    return factor


@dataclass(frozen=True)
class Motion:
    """Numbers of a table by quantity, (N, n) each, and time (N,)."""

    joints: tuple[str, ...]
    time: Floats
    numbers: dict[str, Floats]
    notes: tuple[str, ...]


class JoinedTable:
    """Several tables as one: columns of all, at the times of the first one.

    A name that two files have, or that doesn't say its quantity by itself, is `FILE.NAME`. Values
    of a file with other times lie on straight lines between its own. Raises BagError: a file has no time and
    another number of rows, or its time restarts.
    """

    def __init__(self, path: Path, tables: Sequence[Table]) -> None:
        self.path = path
        self.incomplete = 0
        self._tables = tables
        self._times = [next(iter(time_columns(t.names)), "") for t in tables]
        names = Counter(name for table in tables for name in table.names)
        self._origin = {
            (
                name
                if (k, name) == (0, self._times[0]) or (names[name] == 1 and _tells(name))
                else f"{table.path.stem}.{name}"
            ): (k, name)
            for k, (table, time) in enumerate(zip(tables, self._times, strict=True))
            for name in table.names
            if k == 0 or name != time
        }
        self.names = tuple(self._origin)

    def read(self, columns: Sequence[str], progress: Progress = no_progress) -> Floats:
        """(N, columns) numbers."""
        found: dict[str, Floats] = {}
        times: Floats | None = None
        count: int | None = None
        self.incomplete = 0
        for k, (table, time) in enumerate(zip(self._tables, self._times, strict=True)):
            chosen = [name for name in columns if self._origin[name][0] == k]
            names = [self._origin[name][1] for name in chosen] + [time] * bool(time)
            if not names:
                continue
            rows = table.read(names, progress)
            self.incomplete += table.incomplete
            if count is None:
                times, count = (rows[:, -1] if time else None), len(rows)
            elif times is not None and time and not np.array_equal(times, rows[:, -1]):
                _check_increasing(self._tables[0].path, times[_order(times)])
                rows = rows[_order(rows[:, -1])]
                _check_increasing(table.path, rows[:, -1])
                rows = np.column_stack(
                    [np.interp(times, rows[:, -1], each, np.nan, np.nan) for each in rows.T]
                )
            elif len(rows) != count:
                raise BagError(
                    f"{table.path}: expected {counted(count, 'row')}, as {self._tables[0].path} has, or a "
                    f"column of time in both, got {counted(len(rows), 'row')}"
                )
            found.update(zip(chosen, rows.T, strict=False))
        joined = np.column_stack([found[name] for name in columns])
        outside = np.isnan(joined).any(axis=1)
        self.incomplete += int(outside.sum())
        return joined[~outside]


def _tells(name: str) -> bool:
    """Whether the name says its quantity, whatever file it is in."""
    return quantities_named([name], EFFORT) == quantities_named([name], CURRENT)


def _check_increasing(path: Path, time: Floats) -> None:
    if back := int((np.diff(time) < 0).sum()):
        raise BagError(
            f"{path}: expected times that increase, as files of different times are interpolated, got "
            f"{counted(back, 'step')} back; split the files where time restarts"
        )


def is_table(source: Path | Mapping[str, Any]) -> bool:
    """Whether open_table() reads it: arrays, or the name of such a file."""
    return not isinstance(source, Path) or is_csv(source) or is_array_file(source)


def open_table(
    source: Path | Mapping[str, Any], *, topic: str = "", clock: Clock = "auto"
) -> Table:
    """The table of a file, of several, `q.csv+effort.csv`, or of arrays by name.

    Raises BagError, also where a topic or a clock is asked for: a table has none.
    """
    if not isinstance(source, Path):
        return ArrayTable(Path("arrays"), source)
    for option, given in (("topic", topic), ("clock", "" if clock == "auto" else clock)):
        if given:
            raise BagError(
                f"{source}: --{option} {given}: a table has no {option}s, recordings have; leave it out"
            )
    if "+" in f"{source}" and not source.exists():
        return JoinedTable(source, [open_table(Path(part)) for part in f"{source}".split("+")])
    if is_array_file(source):
        return open_arrays(source)
    table = CsvTable(source)
    table.names = _without_fields(table)
    return table


def _without_fields(table: CsvTable) -> tuple[str, ...]:
    """Names of columns; those of `topic echo` by joint: `field.position0` is `position.JOINT`."""
    if table.unnamed and (names := _echoed(table)):
        table.unnamed = ""
        return names
    if "field.name0" not in table.names:
        return table.names
    first = dict(zip(table.names, next(table.rows(), []), strict=False))
    _check_joints(table, [k for k, n in enumerate(table.names) if n.startswith("field.name")])
    renamed = {"%time": "received_ns", "field.header.stamp": "time_ns"}
    for name in table.names:
        if found := re.fullmatch(r"field\.(position|velocity|effort)(\d+)", name):
            renamed[name] = f"{found[1]}.{first.get(f'field.name{found[2]}', found[2])}"
    return tuple(renamed.get(name, name) for name in table.names)


def _echoed(table: CsvTable) -> tuple[str, ...]:
    """Names of columns that `ros2 topic echo --csv` writes of joint states; none if it didn't write them."""
    row = next(table.rows(), [])
    joints = [*takewhile(lambda text: not is_number(text), row[3:])]
    names = ["stamp.sec", "stamp.nanosec", "frame_id", *(f"name.{joint}" for joint in joints)]
    for kind in (POSITION, VELOCITY, EFFORT):
        empty = row[len(names) : len(names) + 1] == [""]
        names += [""] if empty else [f"{kind}.{joint}" for joint in joints]
    if not joints or len(names) != len(row):
        return ()
    _check_joints(table, range(3, 3 + len(joints)))
    return tuple(names)


def _check_joints(table: CsvTable, columns: Sequence[int]) -> None:
    """Raise BagError unless all messages have the joints of the first one, in its order."""
    first: list[str] = []
    for number, fields in enumerate(table.rows(), 1):
        if len(fields) != len(table.names):
            continue  # read() refuses it
        names = [fields[column] for column in columns]
        first = first or names
        if names != first:
            raise BagError(
                f"{table.path}: expected the joints {listed(first)} in all messages, as in the first one, got "
                f"{listed(names)} in message {number}; record one topic per arm, or a recording of ROS"
            )


def parts_joined(paths: Sequence[Path]) -> list[Path]:
    """`A+B` in place of A and B if only together they have positions and efforts; else the paths."""
    if len(paths) < 2 or not all(map(is_table, paths)):
        return list(paths)
    found = [quantities_named(open_table(path).names, path.stem) for path in paths]
    whole = [
        POSITION in kinds and bool(kinds & {EFFORT, CURRENT})
        for kinds in (*found, set().union(*found))
    ]
    return [Path("+".join(map(str, paths)))] if whole.pop() and not any(whole) else list(paths)


def read_table_log(
    table: Table,
    joints: Sequence[str] = (),
    form: LogFormat = PLAIN,
    *,
    progress: Progress = no_progress,
) -> JointLog:
    """Samples of a table. joints: none: those of the file, by number if it has no names.

    Raises BagError.
    """
    motion = read_motion(table, joints, form, (POSITION, EFFORT), progress)
    order = _order(motion.time)
    time = motion.time[order]
    notes = ["rows are sorted by time"] if not np.array_equal(time, motion.time) else []
    numbers = {kind: columns[order] for kind, columns in motion.numbers.items()}
    unit, why = _sure_unit(time, numbers)
    if unit and TIME not in form.factors(f"{table.path}"):
        time = time * UNITS[unit]
        notes.append(f"time is taken to be in {unit}: {why}")
    check_seconds(table, time)
    time, runs = _one_after_another(time)
    stamps: Integers = np.asarray(np.round(time * 1e9), dtype=np.int64)
    derived = add_derivatives(time, numbers, (VELOCITY,))
    measured = CURRENT if CURRENT in numbers else EFFORT
    return JointLog(
        joint_names=motion.joints,
        header_stamps=stamps,
        receive_stamps=stamps,
        q=numbers[POSITION],
        qd=numbers[VELOCITY],
        effort=numbers[measured],
        qdd=numbers.get(ACCELERATION),
        effort_is=CURRENT if measured == CURRENT else "",
        topic="",
        notes=(*motion.notes, *notes, *runs, *derived),
    )


def read_motion(
    table: Table,
    joints: Sequence[str],
    form: LogFormat,
    needed: Sequence[str],
    progress: Progress = no_progress,
) -> Motion:
    """Numbers in SI units of the quantities that the table has; of a motion alone unless efforts are needed.

    Raises BagError if one that is needed is missing; of EFFORT and CURRENT either will do.
    """
    where = f"{table.path}"
    form.factors(where)  # a mistake in it comes first
    wanted = QUANTITIES if EFFORT in needed else _MOTION
    matched = match_columns(table.names, joints, form.columns, where, wanted)
    _check_found(table, matched, needed, form)
    unsure = _unsure_accelerations(matched, form, where) if EFFORT in needed else []
    names = [name for group in matched.columns.values() for name in group]
    rows = table.read(names, progress)
    notes = [*_notes(table, matched), *unsure]
    if len(rows) < 2:
        left_out = f"; {table.incomplete} have an empty field" if table.incomplete else ""
        if empty := [name for name in names if left_out and not len(table.read([name]))]:
            left_out += f": no number is in the columns {listed(empty)}"
        raise BagError(
            f"{where}: expected at least 2 rows after the header, got {len(rows)}{left_out}"
        )
    ends = np.cumsum([len(group) for group in matched.columns.values()])[:-1]
    numbers = dict(zip(matched.columns, np.split(rows, ends, axis=1), strict=True))
    if len(matched.columns.get(TIME, ())) == 2:
        numbers[TIME] = numbers[TIME] @ [[1.0], [1e-9]]
    numbers = form.scaled(numbers, matched.units, len(matched.joints), where)
    if form.rate is not None:
        numbers[TIME] = np.arange(len(rows))[:, None] / form.rate
        notes.append(f"samples are {form.rate:g} per second, as stated")
    time = numbers.pop(TIME)[:, 0]
    _check_size(where, matched, numbers)
    return Motion(matched.joints, time, numbers, tuple(notes))


def read_named_positions(table: Table, joints: Sequence[str], form: LogFormat) -> dict[str, Floats]:
    """Positions (N,) in SI units of those joints that the table has by name. Raises BagError.

    None where the scale is stated joint by joint: it's that of the chain's joints.
    """
    stated = form.factors(f"{table.path}").get(POSITION, np.zeros(0))
    columns = named_positions(table.names, joints)
    if not columns or len(stated) > 1:
        return {}
    rows = table.read([name for name, _ in columns.values()])
    return {
        joint: column * (stated[0] if len(stated) else UNITS.get(unit, 1.0))
        for (joint, (_, unit)), column in zip(columns.items(), rows.T, strict=True)
    }


def _check_found(table: Table, matched: Matched, needed: Sequence[str], form: LogFormat) -> None:
    """Raise BagError unless what is needed is there, and one of efforts and currents."""
    found = matched.columns
    if EFFORT in found and CURRENT in found:
        raise BagError(
            f"{table.path}: expected efforts or currents, got both: {found[EFFORT][0]} and "
            f"{found[CURRENT][0]}; state those to compare with: --columns '{EFFORT}=...'"
        )
    lacking = [k for k in needed if k not in found and not (k == EFFORT and CURRENT in found)]
    unnamed = getattr(table, "unnamed", "")
    if lacking and unnamed and not form.columns:
        raise BagError(
            f"{table.path}: {unnamed}; put a header before the numbers, or state the numbers of the "
            "columns: --columns 'time=1, q=2-7, qd=8-13, effort=14-19'"
        )
    if lacking:
        raise _lacking(table, matched.joints, lacking)
    if TIME not in found and form.rate is None:
        raise BagError(
            f"{table.path}: expected a column of time [s], got {listed_columns(table.names)}; state it with "
            "--columns 'time=NAME', or the samples per second with --rate"
        )


def _lacking(table: Table, joints: Sequence[str], kinds: Sequence[str]) -> BagError:
    """The error of missing columns; it names those that are more or fewer than the joints."""
    others = numbered(table.names)
    sets = [
        f"{counted(len(others[kind].columns), 'column')}, {first_to_last(others[kind].columns)}"
        for kind in kinds
        if kind in others
    ]
    of_joints = f" for {counted(len(joints), 'joint')}, {listed(joints, 20)}" if joints else ""
    patterns = {kind: others[kind].pattern if kind in others else "NAME*" for kind in kinds}
    example = ", ".join(f"{kind}={pattern}" for kind, pattern in patterns.items())
    return BagError(
        f"{table.path}: expected columns of {' and '.join(kinds)}{of_joints}, got "
        f"{'; '.join(sets) or listed_columns(table.names)}; {_NEEDED_FOR[kinds[0]]}; state them with --columns "
        f"'{example}' (* is the joint's name or number, the first ones are taken), or by the numbers of columns, "
        f"'{kinds[0]}=2-{1 + max(1, len(joints))}'"
    )


def _unsure_accelerations(matched: Matched, form: LogFormat, where: str) -> list[str]:
    """Leave out accelerations of a log that nobody states: most are derivatives full of noise."""
    stated = [kind for kind, _ in stated_columns(form.columns, where)]
    columns = matched.columns.get(ACCELERATION, ())
    known = tuple(f"{ACCELERATION}.{joint}" for joint in matched.joints)
    if not columns or columns == known or ACCELERATION in stated:
        return []
    del matched.columns[ACCELERATION]
    return [
        f"accelerations {columns[0]} to {columns[-1]} aren't taken, as recorded ones are mostly noisy; to take "
        f"them: --columns 'qdd={' '.join(columns)}'"
    ]


def _check_size(where: str, matched: Matched, numbers: Mapping[str, Floats]) -> None:
    """Raise BagError for numbers that no motion has."""
    for kind, columns in numbers.items():
        too_large = np.argwhere(np.abs(columns) > LARGEST)
        if len(too_large):
            k, j = (int(i) for i in too_large[0])
            raise BagError(
                f"{where}: {matched.columns[kind][j]}: expected numbers of a motion, in SI units, of at most "
                f"{LARGEST:g}, got {columns[k, j]:g} in row {k + 1}"
            )


def _notes(table: Table, matched: Matched) -> list[str]:
    """What was taken for what, unless names say it exactly; what was left out."""
    used = {name for group in matched.columns.values() for name in group}
    others = [name for name in table.names if name and name not in used]
    notes = []
    if not matched.exact:
        notes.append(f"columns: {matched.text}")
    if others:
        notes.append(f"{counted(len(others), 'column')} left out: {listed_columns(others, 6)}")
    if table.incomplete:
        notes.append(f"{counted(table.incomplete, 'row')} with an empty field left out")
    return notes


def _order(time: Floats) -> Integers:
    """Indices that sort (N,) times of shuffled rows; those of other rows as they are."""
    shuffled = len(time) > 1 and (np.diff(time) < 0).mean() > _SHUFFLED
    return np.argsort(time, kind="stable") if shuffled else np.arange(len(time))


def _period(time: Floats) -> tuple[float, str]:
    """Median step of (N,) a time, and the unit in which it is one of a motion."""
    period = float(np.median(np.abs(np.diff(time))))
    return period, next(unit for least, unit in _UNITS_OF_TIME if period >= least)


def _sure_unit(time: Floats, numbers: Mapping[str, Floats]) -> tuple[str, str]:
    """The unit of (N,) a time that isn't in seconds, and how it shows; "": it may be, or doesn't show."""
    period, latest = _period(time)[0], np.abs(time).max()
    if period < _LONGEST_PERIOD:
        return "", ""
    units = [unit for _, unit in _UNITS_OF_TIME if latest * UNITS[unit] < _EPOCH[1]]
    for unit in units:
        if latest * UNITS[unit] >= _EPOCH[0] and period * UNITS[unit] < _LONGEST_PERIOD:
            return unit, "its numbers are then dates of this century"
    if VELOCITY in numbers:
        way = np.diff(numbers[POSITION], axis=0)
        driven = (numbers[VELOCITY][1:] + numbers[VELOCITY][:-1]) / 2 * np.diff(time)[:, None]
        lengths = float(np.linalg.norm(way)), float(np.linalg.norm(driven))
        agree = (way * driven).sum() > _AGREEMENT * lengths[0] * lengths[1]
        for unit in units:
            if agree and 0.5 < lengths[0] / (lengths[1] * UNITS[unit]) < 2.0:
                slow = period * UNITS[unit] >= _LONGEST_PERIOD
                return ("", "") if slow else (unit, "velocities then agree with positions")
    if units and period >= _UNITS_OF_TIME[0][0]:
        return "ns", f"steps of {period:g} are too long for other units"
    return "", ""


def check_seconds(table: Table, time: Floats) -> None:
    """Raise BagError if (N,) the time of a motion can't be in seconds."""
    period, unit = _period(time)
    if period >= _LONGEST_PERIOD:
        raise BagError(
            f"{table.path}: {TIME}: expected seconds, got steps of {period:g}: are they {unit}? Then state "
            f"--scale {TIME}={unit}"
        )
    if np.abs(time).max() >= 2**31:
        raise BagError(
            f"{table.path}: {TIME}: expected seconds, got {np.abs(time).max():g}; count from the start of "
            "the recording, or state their unit with --scale"
        )


def _one_after_another(time: Floats) -> tuple[Floats, list[str]]:
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


def add_derivatives(
    time: Floats, numbers: dict[str, Floats], wanted: Sequence[str]
) -> tuple[str, ...]:
    """Add those of VELOCITY, ACCELERATION that are missing: (N, n), by the filter of accelerations."""
    missing = [kind for kind in wanted if kind not in numbers]
    if not missing:
        return ()
    from inverse_dynamics import _core

    q = numbers[POSITION]
    # a continuous joint may be reported within one turn; no arm goes half a turn between samples
    turned = np.where(np.abs(np.diff(q, axis=0, prepend=q[:1])).max(axis=0) < 3 * np.pi, 1.0, 0.0)
    steady = turned * np.unwrap(q, axis=0) + (1.0 - turned) * q
    distinct = np.concatenate([[True], np.diff(time) > 0])
    at, steady = time[distinct], steady[distinct]
    raw = np.gradient(steady, at, axis=0) if VELOCITY in missing else numbers[VELOCITY][distinct]
    qdd, _, cutoff, frequency = _core.low_pass_accelerations(at, steady, raw, np.zeros((0, 0)))
    found = {VELOCITY: _core.low_pass(raw, frequency, cutoff), ACCELERATION: qdd}
    for kind in missing:
        numbers[kind] = np.column_stack([np.interp(time, at, column) for column in found[kind].T])
    names = {VELOCITY: "velocities", ACCELERATION: "accelerations"}
    return (
        f"no {' or '.join(names[kind] for kind in missing)}: those of the positions are taken, through a "
        f"zero-phase low-pass of {cutoff:.3g} Hz",
    )

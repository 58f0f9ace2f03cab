# SPDX-License-Identifier: Apache-2.0
"""Recorded motions in tables: text files, Parquet, .npz, .mat.

    log = read_table_log(open_table([Path("motion.csv")]), ["shoulder", "elbow"])

columns.py finds out which column is what. Time in s; rad, rad/s, N m, rad/s^2 (prismatic m, m/s, N,
m/s^2); motor currents in A in place of the efforts. LogFormat states what the file doesn't: other
names, units, signs, a rate. Without velocities, the filtered derivative of the positions is taken.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from inverse_dynamics.base.decimals import LARGEST, decimal
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.wording import counted, listed, shown
from inverse_dynamics.data.array_files import is_array_file, open_arrays
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
    match_columns,
    named_positions,
    quantities_named,
    quantity_named,
    time_columns,
)
from inverse_dynamics.data.csv_table import CsvTable, is_csv
from inverse_dynamics.data.joint_log import JointLog
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.base.arrays import Floats, Integers
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Clock

_LONGEST_PERIOD = 0.5  # s: no recording of a motion is as slow
_BETWEEN_RUNS, _PERIODS_BETWEEN_RUNS = 1.0, 50.0  # s; what the time base takes for a gap
_UNITS_OF_TIME = ((5e5, "ns"), (5e2, "us"), (0.0, "ms"))
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

    def read(
        self,
        columns: Sequence[str],
        largest: Sequence[float] | None = None,
        progress: Progress = no_progress,
    ) -> Floats:
        """(N, columns) numbers."""


@dataclass(frozen=True)
class LogFormat:
    """What a table's names don't say. Empty: nothing.

    columns: see match_columns(). scale: texts `KEY=FACTOR` or `KEY=FACTOR,FACTOR,...`, one for each joint:
    what the quantity's numbers are multiplied by, a number or one of UNITS. sign: of each joint, 1 or -1;
    -1 turns its positions, velocities and efforts around. rate: Hz, of a table without time.
    """

    columns: str = ""
    scale: Sequence[str] = ()
    sign: Sequence[float] = ()
    rate: float | None = None

    @staticmethod
    def of(robot: Any) -> LogFormat:
        """What a run configuration states."""
        return LogFormat(robot.columns, robot.scale, robot.sign, robot.rate)


PLAIN = LogFormat()


@dataclass(frozen=True)
class Motion:
    """Numbers of a table by quantity, (N, n) each, and time (N,)."""

    joints: tuple[str, ...]
    time: Floats
    numbers: dict[str, Floats]
    notes: tuple[str, ...]


class JoinedTable:
    """Several tables as one: columns of all, `FILE.NAME`, at the times of the first one.

    Those of a file with other times lie on straight lines between its own. Raises BagError: a file has no
    time and another number of rows.
    """

    def __init__(self, path: Path, tables: Sequence[Table]) -> None:
        self.path = path
        self._tables = tables
        self._times = [next(iter(time_columns(t.names)), "") for t in tables]
        self._origin = {
            (name if (k, name) == (0, self._times[0]) else f"{table.path.stem}.{name}"): (k, name)
            for k, (table, time) in enumerate(zip(tables, self._times, strict=True))
            for name in table.names
            if k == 0 or name != time
        }
        self.names = tuple(self._origin)

    def read(
        self,
        columns: Sequence[str],
        largest: Sequence[float] | None = None,
        progress: Progress = no_progress,
    ) -> Floats:
        """(N, columns) numbers."""
        limits = dict(zip(columns, largest or [math.inf] * len(columns), strict=True))
        found: dict[str, Floats] = {}
        first: Floats | None = None
        count = 0
        for k, (table, time) in enumerate(zip(self._tables, self._times, strict=True)):
            chosen = [name for name in columns if self._origin[name][0] == k]
            names = [self._origin[name][1] for name in chosen] + [time] * bool(time)
            most = [*(limits[name] for name in chosen), *([math.inf] if time else [])]
            rows = table.read(names, most, progress)
            if k == 0:
                first, count = (rows[:, -1] if time else None), len(rows)
            elif first is not None and time and not np.array_equal(first, rows[:, -1]):
                own = rows[:, -1]
                rows = np.column_stack([np.interp(first, own, column) for column in rows.T])
            elif len(rows) != count:
                raise BagError(
                    f"{table.path}: expected {counted(count, 'row')}, as {self._tables[0].path} has, or a "
                    f"column of time in both, got {counted(len(rows), 'row')}"
                )
            found.update(zip(chosen, rows.T, strict=False))
        return np.column_stack([found[name] for name in columns])


def is_table(path: Path) -> bool:
    """Whether the name is that of a file that open_table() reads."""
    return is_csv(path) or is_array_file(path)


def open_table(path: Path, *, topic: str = "", clock: Clock = "auto") -> Table:
    """The table of a file, or of several: `q.csv+effort.csv`.

    Raises BagError, also where a topic or a clock is asked for: a table has none.
    """
    for option, given in (("topic", topic), ("clock", "" if clock == "auto" else clock)):
        if given:
            raise BagError(
                f"{path}: --{option} {given}: a table has no {option}s, recordings have; leave it out"
            )
    if "+" in f"{path}" and not path.exists():
        return JoinedTable(path, [open_table(Path(part)) for part in f"{path}".split("+")])
    if is_array_file(path):
        return open_arrays(path)
    table = CsvTable(path)
    table.names = _without_fields(table)
    return table


def _without_fields(table: CsvTable) -> tuple[str, ...]:
    """Names of columns; those of `rostopic echo -p` by joint: `field.position0` is `position.JOINT`."""
    if "field.name0" not in table.names:
        return table.names
    first = dict(zip(table.names, next(table.rows(), []), strict=False))
    renamed = {"%time": "received_ns", "field.header.stamp": "time_ns"}
    for name in table.names:
        if found := re.fullmatch(r"field\.(position|velocity|effort)(\d+)", name):
            renamed[name] = f"{found[1]}.{first.get(f'field.name{found[2]}', found[2])}"
    return tuple(renamed.get(name, name) for name in table.names)


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
    motion = read_motion(table, joints, form, (POSITION, EFFORT), QUANTITIES, progress)
    check_seconds(table, motion.time)
    time, runs = _one_after_another(motion.time)
    stamps: Integers = np.asarray(np.round(time * 1e9), dtype=np.int64)
    numbers, notes = motion.numbers, (*motion.notes, *runs)
    measured = CURRENT if CURRENT in numbers else EFFORT
    if VELOCITY not in numbers:
        numbers[VELOCITY], note = _differentiated(time, numbers[POSITION])
        notes = (*notes, note)
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
        notes=notes,
    )


def read_motion(
    table: Table,
    joints: Sequence[str],
    form: LogFormat,
    needed: Sequence[str],
    quantities: Sequence[str],
    progress: Progress = no_progress,
) -> Motion:
    """Numbers in SI units of those quantities that the table has.

    Raises BagError if one that is needed is missing; of EFFORT and CURRENT either will do.
    """
    matched = match_columns(table.names, joints, form.columns, f"{table.path}", quantities)
    _check_found(table, matched, needed, form)
    names = [name for group in matched.columns.values() for name in group]
    scales = _scales(matched, form, f"{table.path}")
    limits = [
        math.inf if kind == TIME or kind in scales else LARGEST
        for kind, group in matched.columns.items()
        for _ in group
    ]
    rows = table.read(names, limits, progress)
    if len(rows) < 2:
        raise BagError(f"{table.path}: expected at least 2 rows after the header, got {len(rows)}")
    ends = np.cumsum([len(group) for group in matched.columns.values()])[:-1]
    numbers = dict(zip(matched.columns, np.split(rows, ends, axis=1), strict=True))
    for kind, factors in scales.items():
        numbers[kind] = numbers[kind] * factors
    time = numbers.pop(TIME, None)
    notes = list(_notes(table, matched))
    if form.rate is not None:
        time = np.arange(len(rows))[:, None] / form.rate
        notes.append(f"samples are {form.rate:g} per second, as stated")
    assert time is not None
    return Motion(matched.joints, time[:, 0], numbers, tuple(notes))


def read_named_positions(table: Table, joints: Sequence[str], form: LogFormat) -> dict[str, Floats]:
    """Positions (N,) in SI units of those joints that the table has by name. Raises BagError.

    None where the scale is stated joint by joint: it's that of the chain's joints.
    """
    stated = dict(_stated_scale(text, f"{table.path}") for text in form.scale).get(POSITION, [])
    columns = named_positions(table.names, joints)
    if not columns or len(stated) > 1:
        return {}
    rows = table.read([name for name, _ in columns.values()])
    return {
        joint: column * _factor(stated[0] if stated else unit or "1", f"{table.path}")
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
    names = listed(table.names, 40)
    of_joints = f" for the joints {listed(matched.joints, 20)}" if matched.joints else ""
    for kind in needed:
        if kind in found or (kind == EFFORT and CURRENT in found):
            continue
        unnamed = getattr(table, "unnamed", "")
        if unnamed and not form.columns:
            raise BagError(
                f"{table.path}: {unnamed}; put a header before the numbers, or state the numbers of the "
                "columns: --columns 'time=1, q=2-7, qd=8-13, effort=14-19'"
            )
        raise BagError(
            f"{table.path}: expected columns of {kind}{of_joints}, got {names}; {_NEEDED_FOR[kind]}; state "
            f"them with --columns '{kind}=NAME*' (* is the joint's name or number)"
        )
    if TIME not in found and form.rate is None:
        raise BagError(
            f"{table.path}: expected a column of time [s], got {names}; state it with --columns "
            "'time=NAME', or the samples per second with --rate"
        )


def _scales(matched: Matched, form: LogFormat, where: str) -> dict[str, Floats]:
    """Factors by quantity, one for each of its columns."""
    scales: dict[str, Floats] = {}
    stated = dict(_stated_scale(text, where) for text in form.scale)
    for kind, columns in matched.columns.items():
        texts = list(stated.pop(kind, [matched.units[kind]] if kind in matched.units else []))
        if len(texts) not in (0, 1, len(columns)):
            raise BagError(
                f"{where}: scale: {kind}: expected 1 or {counted(len(columns), 'number')}, got {len(texts)}"
            )
        if texts:
            scales[kind] = np.array([_factor(text, where) for text in texts])
    if stated:
        raise BagError(
            f"{where}: scale: expected one of {listed([*matched.columns])}, which the file has, got "
            f"{listed([*stated])}"
        )
    if form.sign:
        signs = np.array(form.sign, float)
        if signs.shape != (len(matched.joints),) or not (np.abs(signs) == 1.0).all():
            raise BagError(
                f"{where}: sign: expected 1 or -1 for each of {counted(len(matched.joints), 'joint')}, got "
                f"{listed([f'{sign:g}' for sign in signs], 20)}"
            )
        for kind in matched.columns:
            if kind != TIME:
                scales[kind] = scales.get(kind, np.ones(1)) * signs
    return scales


def _stated_scale(text: str, where: str) -> tuple[str, list[str]]:
    key, _, factors = text.partition("=")
    return quantity_named(key.strip(), f"{where}: scale"), factors.split(",")


def _factor(text: str, where: str) -> float:
    try:
        factor = UNITS.get(str(text).lower()) or decimal(str(text))
    except ValueError:
        factor = math.nan
    if not math.isfinite(factor) or factor == 0:
        raise BagError(
            f"{where}: scale: expected a number other than 0 or one of {', '.join(UNITS)}, got {shown(text)}"
        )
    return factor


def _notes(table: Table, matched: Matched) -> list[str]:
    """What was taken for what, unless names say it exactly; what was left out."""
    used = {name for group in matched.columns.values() for name in group}
    others = [name for name in table.names if name not in used]
    notes = []
    if not matched.exact:
        notes.append(f"columns: {matched.text}")
    if others:
        notes.append(f"{counted(len(others), 'column')} left out: {listed(others)}")
    if incomplete := getattr(table, "incomplete", 0):
        notes.append(f"{counted(incomplete, 'row')} with an empty field left out")
    return notes


def check_seconds(table: Table, time: Floats) -> None:
    """Raise BagError if (N,) the time of a motion can't be in seconds."""
    period = float(np.median(np.abs(np.diff(time))))
    if period >= _LONGEST_PERIOD:
        unit = next(unit for least, unit in _UNITS_OF_TIME if period >= least)
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
    """Time (N,) that goes on where it begins anew, as that of a file with several episodes does."""
    steps = np.diff(time)
    back = np.flatnonzero(steps < 0) + 1
    period = float(np.median(np.abs(steps)))
    if not len(back) or (np.abs(time[back] - time[0]) > 2 * period).any():
        return time, []
    between = max(_BETWEEN_RUNS, _PERIODS_BETWEEN_RUNS * period)
    shifts = np.zeros(len(time))
    shifts[back] = between - steps[back - 1]
    note = f"time begins anew {counted(len(back), 'time')}: runs are taken one after another, {between:g} s apart"
    return time + np.cumsum(shifts), [note]


def _differentiated(time: Floats, q: Floats) -> tuple[Floats, str]:
    """Velocities (N, n) of positions, by the zero-phase low-pass that accelerations get."""
    from inverse_dynamics import _core

    # a continuous joint may be reported within one turn; no arm goes half a turn between samples
    turned = np.where(np.abs(np.diff(q, axis=0, prepend=q[:1])).max(axis=0) < 3 * np.pi, 1.0, 0.0)
    steady = turned * np.unwrap(q, axis=0) + (1.0 - turned) * q
    distinct = np.concatenate([[True], np.diff(time) > 0])
    raw = np.gradient(steady[distinct], time[distinct], axis=0)
    _, _, cutoff, frequency = _core.low_pass_accelerations(
        time[distinct], steady[distinct], raw, np.zeros((0, 0))
    )
    qd = _core.low_pass(raw, frequency, cutoff)
    qd = np.column_stack([np.interp(time, time[distinct], column) for column in qd.T])
    return qd, (
        "no velocities: those of the positions are taken, through a zero-phase low-pass of "
        f"{cutoff:.3g} Hz"
    )

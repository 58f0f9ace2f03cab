# SPDX-License-Identifier: Apache-2.0
"""Recorded motions in tables: text files, Parquet, .npz, .npy, .mat.

    log = read_table_log(open_table(Path("motion.csv")), ["shoulder", "elbow"])

columns.py finds out which column is what. Time in s; rad, rad/s, N m, rad/s^2 (prismatic m, m/s, N,
m/s^2); motor currents in A in place of the efforts. LogFormat states what the file doesn't: other
names, units, signs, a rate. Without velocities, the filtered derivative of the positions is taken.
"""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.decimals import LARGEST
from inverse_dynamics.errors import BagError
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings import times
from inverse_dynamics.recordings.columns import (
    Matched,
    first_to_last,
    listed_columns,
    match_columns,
    named_positions,
    numbered,
    pattern_of,
    stated_columns,
)
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.recordings.log_format import PLAIN, LogFormat
from inverse_dynamics.recordings.vocabulary import (
    ACCELERATION,
    CURRENT,
    EFFORT,
    POSITION,
    QUANTITIES,
    TIME,
    UNITS,
    VELOCITY,
)
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.arrays import Floats, Integers
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.tables import Table

_LARGEST_ANGLE = 100.0  # rad: 16 turns
# Columns of tables with a row for each joint.
_ROW_PER_JOINT = {"joint", "joint_name", "name", "topic"}
_TURNED_BY = (
    'python3 -c "import csv, sys; f, t, j = sys.argv[1:]; d = {}; [d.setdefault(r[t], {t: r[t]}).update({k + chr(46) + '
    "r[j]: r[k] for k in r if k not in (t, j)}) for r in csv.DictReader(open(f))]; w = csv.DictWriter(open('NEW.csv', "
    "'w'), {k: 0 for r in d.values() for k in r}); w.writeheader(); w.writerows(d.values())\""
)
_MOTION = (POSITION, VELOCITY, ACCELERATION)
_NEEDED_FOR = {
    POSITION: "torques depend on them",
    VELOCITY: "torques depend on them",
    ACCELERATION: "torques can't be computed without them",
    EFFORT: "measured efforts are what computed torques are compared with; where there are none, `ids "
    "torques` computes them",
}


@dataclass(frozen=True)
class Motion:
    """Numbers of a table by quantity, (N, n) each, and time (N,)."""

    joints: tuple[str, ...]
    time: Floats
    numbers: dict[str, Floats]
    notes: tuple[str, ...]


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
    order = times.in_order(motion.time)
    time = motion.time[order]
    notes = ["rows are sorted by time"] if not np.array_equal(time, motion.time) else []
    numbers = {kind: columns[order] for kind, columns in motion.numbers.items()}
    unit, why = times.sure_unit(time, numbers)
    if unit and TIME not in form.factors(f"{table.path}"):
        time = time * UNITS[unit]
        notes.append(f"time is taken to be in {unit}: {why}")
    times.check_seconds(f"{table.path}", time)
    time, runs = times.one_after_another(time)
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
    if part := matched.columns.get(TIME, ())[1:]:
        numbers[TIME] = times.whole_seconds(numbers[TIME], *part)
    if not matched.exact and _counts(numbers.get(POSITION, np.zeros(1))):
        matched.units.setdefault(POSITION, "whole numbers beyond 100 (counts, deg, mm?)")
    numbers = form.scaled(numbers, matched.units, len(matched.joints), where)
    if form.rate is not None:
        numbers[TIME] = np.arange(len(rows))[:, None] / form.rate
        notes.append(f"samples are {form.rate:g} per second, as stated")
    time = times.beyond_midnight(numbers.pop(TIME)[:, 0])
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
            f"{found[CURRENT][0]}; state those to compare with: --columns '{EFFORT}={pattern_of(found[EFFORT])}' or "
            f"'{CURRENT}={pattern_of(found[CURRENT])}'"
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
    names, time = table.names, times.time_columns(table.names)
    if time and (joint := [name for name in names if name.lower() in _ROW_PER_JOINT]):
        return BagError(
            f"{table.path}: expected a row for each time, got one for each {joint[0]}; turn it: "
            f"{_TURNED_BY} {shlex.join([str(table.path), time[0], joint[0]])}"
        )
    others = numbered(names)
    sets = [
        f"{counted(len(others[kind].columns), 'column')}, {first_to_last(others[kind].columns)}"
        for kind in kinds
        if kind in others
    ]
    of_joints = f" for {counted(len(joints), 'joint')}, {listed(joints, 20)}" if joints else ""
    patterns = {
        kind: pattern_of(others[kind].columns) if kind in others else "NAME*" for kind in kinds
    }
    example = ", ".join(f"{kind}={pattern}" for kind, pattern in patterns.items())
    return BagError(
        f"{table.path}: expected columns of {' and '.join(kinds)}{of_joints}, got "
        f"{'; '.join(sets) or listed_columns(names)}; {_NEEDED_FOR[kinds[0]]}; state them with --columns "
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


def _counts(positions: Floats) -> bool:
    """Whether they are whole numbers beyond all angles, as encoders count."""
    return np.abs(positions).max() > _LARGEST_ANGLE and not (positions % 1.0).any()


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

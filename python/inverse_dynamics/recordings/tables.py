# SPDX-License-Identifier: Apache-2.0
"""Tables to read motions from: files of text or arrays, several as one, arrays in memory.

table = open_table(Path("q.csv+effort.csv"))
table.read(["time", "q1", "tau1"])  # (N, 3)
"""

from __future__ import annotations

import re
from collections import Counter
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from inverse_dynamics.errors import BagError
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.array_files import ArrayTable, is_array_file, open_arrays
from inverse_dynamics.recordings.columns import quantities_named
from inverse_dynamics.recordings.csv_table import CsvTable, is_csv, is_number
from inverse_dynamics.recordings.times import beyond_midnight, in_order, time_columns
from inverse_dynamics.recordings.vocabulary import CURRENT, EFFORT, POSITION, VELOCITY
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.arrays import DataFrame, Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Clock

# A column of joint states as programs write them: what is before it, the field, the number.
_FIELD = re.compile(r"^(?:field\.)?(.*?)(name|position|velocity|effort)[\W_]?(\d+)\W?$")
_STAMPS = {"%time": "received_ns", "field.header.stamp": "time_ns"}  # of `rostopic echo -p`


class Table(Protocol):
    """What has named columns of numbers."""

    path: Path
    names: tuple[str, ...]
    incomplete: int  # rows left out by the last read(): a number was missing

    def read(self, columns: Sequence[str], progress: Progress = no_progress) -> Floats:
        """(N, columns) numbers, all of them finite."""


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
            if time:
                rows[:, -1] = beyond_midnight(rows[:, -1])
            if count is None:
                times, count = (rows[:, -1] if time else None), len(rows)
            elif times is not None and time and not np.array_equal(times, rows[:, -1]):
                _check_increasing(self._tables[0].path, times[in_order(times)])
                rows = rows[in_order(rows[:, -1])]
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


def is_table(source: Path | Mapping[str, Any] | DataFrame) -> bool:
    """Whether open_table() reads it: arrays, or the name of such a file."""
    return not isinstance(source, Path) or is_csv(source) or is_array_file(source)


def open_table(
    source: Path | Mapping[str, Any] | DataFrame, *, topic: str = "", clock: Clock = "auto"
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
    table.names = _echoed(table) or _by_joint(table)
    return table


def _by_joint(table: CsvTable) -> tuple[str, ...]:
    """Names of columns, `position.JOINT` for `field.position0` or `position[0]` where `name0` is there too."""
    if table.names[:1] == ("header:",):
        raise BagError(
            f"{table.path}: expected a table, got messages in YAML; write them with `ros2 topic echo --csv`, or record "
            "them with `ros2 bag record`"
        )
    fields = [found[0] if (found := _FIELD.findall(name)) else ("", "", "") for name in table.names]
    named = {(before, number) for before, kind, number in fields if kind not in ("name", "")}
    joints = {
        (before, number): text.strip(" '")
        for (before, kind, number), text in zip(fields, table.first, strict=False)
        if kind == "name" and (before, number) in named and not is_number(text)
    }
    table.same = [
        k for k, field in enumerate(fields) if field[1] == "name" and field[::2] in joints
    ]
    return tuple(
        f"{before}{kind}.{joints[before, number]}"
        if (before, number) in joints
        else _STAMPS.get(name, name)
        for name, (before, kind, number) in zip(table.names, fields, strict=True)
    )


def _echoed(table: CsvTable) -> tuple[str, ...]:
    """Names of columns that `ros2 topic echo --csv` writes of joint states; none if it didn't write them."""
    row = table.first if table.unnamed else []
    joints = [*takewhile(lambda text: not is_number(text), row[3:])]
    names = ["stamp.sec", "stamp.nanosec", "frame_id", *(f"name.{joint}" for joint in joints)]
    for kind in (POSITION, VELOCITY, EFFORT):
        empty = row[len(names) : len(names) + 1] == [""]
        names += [""] if empty else [f"{kind}.{joint}" for joint in joints]
    if not joints or len(names) != len(row):
        return ()
    table.unnamed, table.same = "", range(3, 3 + len(joints))
    return tuple(names)


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

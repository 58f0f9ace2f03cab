# SPDX-License-Identifier: Apache-2.0
"""Recorded motions in text files.

A table as any tool can write it, columns in any order:

    time,position.joint_1,velocity.joint_1,effort.joint_1,acceleration.joint_1

time in s; rad, rad/s, N m, rad/s^2 (prismatic m, m/s, N, m/s^2); accelerations may be left out.
Motor currents in A are named current.joint_1, and stand in place of the efforts.

Or what the record tool of UR's RTDE client library writes: `timestamp` in s, `actual_q_0`,
`actual_qd_0`, `actual_current_0` and so on; joints by number, from the base on; efforts are motor
currents in A.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.decimals import LARGEST
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.wording import counted, harmless, listed, shown
from inverse_dynamics.data.csv_table import CsvTable
from inverse_dynamics.data.joint_log import JointLog
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from inverse_dynamics.base.arrays import Floats, Integers
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Clock

TIME = "time"
EFFORT = "effort"
CURRENT = "current"
_QUANTITIES = {
    "position": "rad (prismatic m)",
    "velocity": "rad/s (prismatic m/s)",
    EFFORT: "N m (prismatic N)",
    CURRENT: "A",
    "acceleration": "rad/s^2 (prismatic m/s^2)",
}
_UNIT_AT_END = re.compile(r"\s*[\[(][^\])]*[\])]$")
_REASONS = {
    EFFORT: "; measured efforts are what computed torques are compared with; where there are none,"
    " `ids torques` computes them",
    CURRENT: "; other joints have currents: give those of all joints, or efforts of all joints",
}

_RTDE_TIME = "timestamp"
_RTDE = {"position": "actual_q", "velocity": "actual_qd", CURRENT: "actual_current"}

_LONGEST_PERIOD = 0.5  # s: no recording of a motion is as slow
_UNITS = ((5e5, "nanoseconds", 1e9), (5e2, "microseconds", 1e6), (0.0, "milliseconds", 1e3))


def read_csv_log(
    table: CsvTable, joints: Sequence[str] = (), *, progress: Progress = no_progress
) -> JointLog:
    """Samples of a table. joints: none: those of the file, by number if it has no names.

    Raises BagError.
    """
    rtde = _is_rtde(table.names)
    measured = CURRENT if rtde else _measured(table, joints)
    if rtde:
        joints, columns = _rtde_columns(table, joints)
    else:
        joints, columns = generic_columns(table, joints, ("position", "velocity", measured))
    time_name = _RTDE_TIME if rtde else TIME
    values = read_columns(table, time_name, columns, progress)
    time = values.pop(TIME)[:, 0]
    if len(time) < 2:
        raise BagError(f"{table.path}: expected at least 2 rows after the header, got {len(time)}")
    check_seconds(table, time_name, time)
    stamps: Integers = np.asarray(np.round(time * 1e9), dtype=np.int64)
    return JointLog(
        joint_names=tuple(joints),
        header_stamps=stamps,
        receive_stamps=stamps,
        q=values["position"],
        qd=values["velocity"],
        effort=values[measured],
        qdd=values.get("acceleration"),
        effort_is=CURRENT if measured == CURRENT else "",
        topic="",
        notes=_left_out(
            table, [time_name, *(name for names in columns.values() for name in names)]
        ),
    )


def open_table(path: Path, *, topic: str = "", clock: Clock = "auto") -> CsvTable:
    """The table of a file. Raises BagError, also where a topic or a clock is asked for: it has none."""
    for option, given in (("topic", topic), ("clock", "" if clock == "auto" else clock)):
        if given:
            raise BagError(
                f"{path}: --{option} {given}: a table has no {option}s, recordings have; leave it out"
            )
    return CsvTable(path)


def generic_columns(
    table: CsvTable, joints: Sequence[str], needed: Sequence[str]
) -> tuple[tuple[str, ...], dict[str, list[str]]]:
    """Joints and, by quantity, the columns that hold them; accelerations if any joint has them.

    Raises BagError where a column that is needed is missing.
    """
    _refuse_units(table)
    there = list(
        dict.fromkeys(
            joint
            for kind, _, joint in (name.partition(".") for name in table.names)
            if kind in _QUANTITIES and joint
        )
    )
    if not there:
        raise BagError(
            f"{table.path}: expected columns {TIME}, position.JOINT, velocity.JOINT, effort.JOINT "
            f"(or current.JOINT), or those of UR's RTDE record tool, got {listed(table.names)}; give them "
            "these names, in s, rad, rad/s and N m (or A): docs/tutorials/my_robot.md"
        )
    joints = tuple(joints) or tuple(there)
    if unknown := [joint for joint in joints if joint not in there]:
        raise BagError(
            f"{table.path}: expected the joints {listed(joints, 20)}, got {listed(there, 20)}; "
            f"missing: {listed(unknown, 20)}; give the file's names with --joints, in the order of "
            "the chain"
        )
    columns = {kind: [f"{kind}.{joint}" for joint in joints] for kind in _QUANTITIES}
    given = any(name in table.names for name in columns["acceleration"])
    chosen = {
        kind: names
        for kind, names in columns.items()
        if kind in needed or (kind == "acceleration" and given)
    }
    for kind, names in chosen.items():
        for joint, name in zip(joints, names, strict=True):
            if name not in table.names:
                raise BagError(
                    f"{table.path}: joint {joint}: expected a column {name}, got none"
                    f"{_REASONS.get(kind, '')}"
                )
    return joints, chosen


def _refuse_units(table: CsvTable) -> None:
    """Raise BagError for `position.joint_1 [deg]`: a unit would be taken for part of the name."""
    for name in table.names:
        kind, _, joint = name.partition(".")
        if kind in _QUANTITIES and (unit := _UNIT_AT_END.search(joint)):
            raise BagError(
                f"{table.path}: column {harmless(name)}: expected a joint's name without a unit, got "
                f"{shown(unit[0].strip())}; give numbers in {_QUANTITIES[kind]}, and name the "
                f"column {harmless(name.removesuffix(unit[0]))}"
            )


def read_columns(
    table: CsvTable,
    time_name: str,
    columns: Mapping[str, Sequence[str]],
    progress: Progress = no_progress,
) -> dict[str, Floats]:
    """Numbers by quantity, (N, n) each, and the time (N, 1). Raises BagError."""
    if time_name not in table.names:
        raise BagError(
            f"{table.path}: expected a column {time_name} [s], got {listed(table.names)}"
        )
    groups = {TIME: [time_name], **columns}
    names = [name for group in groups.values() for name in group]
    if twice := [name for name in names if table.names.count(name) > 1]:
        raise BagError(f"{table.path}: expected each column once, got several named {twice[0]}")
    ends = np.cumsum([len(group) for group in groups.values()])[:-1]
    largest = [math.inf] + [LARGEST] * (len(names) - 1)  # check_seconds() sees to the time
    numbers = table.read(names, largest, progress)
    return dict(zip(groups, np.split(numbers, ends, axis=1), strict=True))


def _measured(table: CsvTable, joints: Sequence[str]) -> str:
    """Currents if any of the joints has them, else efforts. Raises BagError where one has both."""
    for joint in joints or [name.partition(".")[2] for name in table.names]:
        effort, current = f"{EFFORT}.{joint}", f"{CURRENT}.{joint}"
        if effort in table.names and current in table.names:
            raise BagError(
                f"{table.path}: joint {joint}: expected a column {effort} or {current}, got both; "
                "rename or remove the one that isn't to be compared"
            )
        if current in table.names:
            return CURRENT
    return EFFORT


def _is_rtde(names: Sequence[str]) -> bool:
    return _RTDE_TIME in names and any(
        name.startswith(("actual_q", "target_q", "actual_current")) for name in names
    )


def _rtde_columns(
    table: CsvTable, joints: Sequence[str]
) -> tuple[tuple[str, ...], dict[str, list[str]]]:
    count = sum(name.rpartition("_")[0] == _RTDE["position"] for name in table.names)
    joints = tuple(joints) or tuple(map(str, range(count)))
    columns = {kind: [f"{base}_{i}" for i in range(len(joints))] for kind, base in _RTDE.items()}
    for kind, names in columns.items():
        if missing := [name for name in names if name not in table.names]:
            targets = [name for name in table.names if name.startswith("target_")]
            only = f"; {listed(targets)} are commanded values, not measured ones"
            raise BagError(
                f"{table.path}: expected the columns {names[0]} to {names[-1]} ({kind}, a joint "
                f"each), missing: {listed(missing)}{only if targets else ''}; have the RTDE "
                f"record tool's configuration list {_RTDE[kind]}"
            )
    if count > len(joints):
        raise BagError(
            f"{table.path}: expected {counted(len(joints), 'joint')}, as the chain has, got {count}; is it "
            "another robot's?"
        )
    return joints, columns


def check_seconds(table: CsvTable, name: str, time: Floats) -> None:
    """Raise BagError if (N,) the time of a motion can't be in seconds."""
    period = float(np.median(np.abs(np.diff(time))))
    if period >= _LONGEST_PERIOD:
        unit, factor = next((unit, by) for least, unit, by in _UNITS if period >= least)
        raise BagError(
            f"{table.path}: column {name}: expected seconds, got steps of {period:g}: are they "
            f"{unit}? Divide the column by {factor:g}"
        )
    if np.abs(time).max() >= 2**31:
        raise BagError(
            f"{table.path}: column {name}: expected seconds, got {np.abs(time).max():g}; count "
            "from the start of the recording"
        )


def _left_out(table: CsvTable, used: Sequence[str]) -> tuple[str, ...]:
    others = [name for name in table.names if name not in set(used)]
    return (f"{counted(len(others), 'column')} left out: {listed(others)}",) if others else ()

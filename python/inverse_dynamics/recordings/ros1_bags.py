# SPDX-License-Identifier: Apache-2.0
"""Joint states from ROS 1 recordings (.bag), by the package rosbags.

    log = read_ros1_log(Path("old.bag"), ["joint_1", "joint_2"])

Messages become columns of a table, one message at a time. Joints of several messages or topics are merged:
those of the others lie on straight lines between their own samples.
"""

from __future__ import annotations

import shlex
from array import array
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.errors import BagError
from inverse_dynamics.installation.extras import require
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.array_files import ArrayTable
from inverse_dynamics.recordings.log_format import PLAIN, LogFormat
from inverse_dynamics.recordings.table_logs import read_table_log
from inverse_dynamics.recordings.vocabulary import EFFORT, POSITION, TIME, VELOCITY
from inverse_dynamics.wording import counted, harmless, listed

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Clock, JointLog

MESSAGE_TYPE = "sensor_msgs/msg/JointState"
_QUANTITIES = (POSITION, VELOCITY, EFFORT)


class _Series:
    """Samples of some joints of one topic, message after message."""

    def __init__(self, topic: str, joints: tuple[str, ...]) -> None:
        self.topic, self.joints = topic, joints
        self.header, self.received = array("q"), array("q")  # ns
        self.numbers = array("d")  # of each message, those of each quantity; NaN where it has none

    def add(self, message: Any, received: int) -> None:
        stamp, order = message.header.stamp, [message.name.index(joint) for joint in self.joints]
        self.header.append(stamp.sec * 10**9 + stamp.nanosec)
        self.received.append(received)
        for values in (message.position, message.velocity, message.effort):
            complete = len(values) == len(message.name)
            self.numbers.extend(values[order] if complete else [np.nan] * len(order))

    def columns(self) -> dict[str, Floats]:
        """(N,) by name; without quantities that no message has."""
        numbers = np.array(self.numbers).reshape(-1, len(_QUANTITIES), len(self.joints))
        names = [f"{kind}.{joint}" for kind in _QUANTITIES for joint in self.joints]
        columns = dict(zip(names, numbers.reshape(len(numbers), -1).T, strict=True))
        return {name: column for name, column in columns.items() if not np.isnan(column).all()}


def is_ros1_bag(path: Path) -> bool:
    """Whether the name is that of a ROS 1 recording."""
    return path.suffix.lower() == ".bag" and path.is_file()


def read_ros1_log(
    path: Path,
    joints: Sequence[str] = (),
    *,
    topic: str = "",
    clock: Clock = "auto",
    form: LogFormat = PLAIN,
    progress: Progress = no_progress,
) -> JointLog:
    """Joint states of one topic; none given: of all that have any of the joints.

    joints: none: those of the first message. Messages without any of them are left out and counted. clock:
    which stamps are the time; auto: those of the header, if there are any. Raises BagError,
    MissingPackageError.
    """
    require("a ROS 1 recording", "rosbags")
    from rosbags.rosbag1 import ReaderError

    try:
        found, others, left_out = _series(path, joints, topic, progress)
    except (ReaderError, OSError, ValueError, AssertionError, KeyError, IndexError) as error:
        raise BagError(
            f"{path}: can't be read as a ROS 1 recording ({harmless(error, 200)}): it is damaged or of "
            f"another kind; `rosbag reindex {shlex.quote(str(path))}` may mend it"
        ) from error
    joints = tuple(joints) or next((series.joints for series in found), ("a robot",))
    whole = [series for series in found if len(series.joints) == len(joints)]
    left_out += sum(len(series.header) for series in found if whole and series not in whole)
    found = whole or found
    held = [joint for series in found for joint in series.joints]
    topics = sorted({series.topic for series in found})
    if missing := [joint for joint in joints if joint not in held]:
        raise BagError(
            f"{path}: expected joint states of {listed(joints, 20)}, got none of {listed(missing, 20)}; "
            f"joints of the recording: {listed([*held, *others], 20)}; give the recording's names with "
            "--joints"
        )
    if len(set(held)) < len(held) and len(topics) > 1:
        raise BagError(
            f"{path}: expected one topic of {MESSAGE_TYPE} with the joints {listed(joints, 20)}, got "
            f"{listed(topics, 20)}; name one with --topic"
        )
    if clock == "auto":
        clock = "header" if all(any(series.header) for series in found) else "receive"
    start, table = _merged(path, found, clock)
    log = read_table_log(
        table, joints, LogFormat(scale=form.scale, sign=form.sign, gears=form.gears)
    )
    notes = log.notes
    if left_out:
        notes = (f"{counted(left_out, 'message')} without all joints left out", *notes)
    stamps = log.header_stamps + start
    return replace(
        log,
        header_stamps=stamps,
        receive_stamps=stamps,
        clock=clock,
        topic=", ".join(topics),
        notes=notes,
    )


def _series(
    path: Path, joints: Sequence[str], topic: str, progress: Progress
) -> tuple[list[_Series], list[str], int]:
    """Samples of the joints, by what messages hold; other joints; messages without any of the joints."""
    from rosbags.rosbag1 import Reader
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    series: dict[tuple[str, tuple[str, ...]], _Series] = {}
    others: dict[str, None] = {}
    left_out = 0
    with Reader(path) as reader:
        chosen = [c for c in reader.connections if c.msgtype == MESSAGE_TYPE]
        chosen = [c for c in chosen if topic in ("", c.topic)]
        if not any(c.msgcount for c in chosen):
            topics = sorted({f"{c.topic} ({c.msgtype})" for c in reader.connections})
            raise BagError(
                f"{path}: expected messages of {MESSAGE_TYPE}{topic and f' on {topic}'}, got none; its "
                f"topics are {listed(topics, 20)}; another type becomes a table by `rostopic echo -p -b "
                f"{shlex.quote(str(path))} TOPIC > log.csv`"
            )
        total = sum(c.msgcount for c in chosen)
        for done, (connection, received, raw) in enumerate(reader.messages(chosen)):
            message: Any = store.deserialize_ros1(raw, connection.msgtype)
            joints = joints or tuple(message.name)
            held = tuple(joint for joint in joints if joint in message.name)
            if held and len(message.position) == len(message.name):
                key = connection.topic, held
                series.setdefault(key, _Series(*key)).add(message, received)
            else:
                others |= dict.fromkeys(message.name)
                left_out += 1
            if done % 1000 == 0:
                progress("reading", done, total)
    return [*series.values()], [*others], left_out


def _merged(path: Path, found: Sequence[_Series], clock: Clock) -> tuple[int, ArrayTable]:
    """Their columns at the times of the first of them, s since its first stamp, which is given in ns."""
    stamps = [np.array(s.received if clock == "receive" else s.header) for s in found]
    start = int(stamps[0][0])
    times = [(each - start) * 1e-9 for each in stamps]
    columns = {TIME: times[0]}
    for series, time in zip(found, times, strict=True):
        for name, column in series.columns().items():
            if series is not found[0]:
                column = np.interp(times[0], time, column, left=np.nan, right=np.nan)
            columns[name] = column
    return start, ArrayTable(path, columns)

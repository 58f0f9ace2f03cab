# SPDX-License-Identifier: Apache-2.0
"""Joint states from and to rosbag2 recordings (sqlite3 and MCAP), without ROS.

    log = read_joint_log("recording", ["joint_1", "joint_2"])
    write_joint_logs("copy", {"/joint_states": log})

Which messages and joints are taken, and which time: inverse_dynamics_evaluation/sample_table.hpp.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import quote

from inverse_dynamics import _core
from inverse_dynamics._core import JointStateWriter, Recording
from inverse_dynamics.errors import BagError
from inverse_dynamics.installation.extras import require
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.joint_log import JointLog, check_clock, check_storage
from inverse_dynamics.wording import harmless

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from rosbags.rosbag2 import Writer

    from inverse_dynamics._core import SampleTable
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Clock, Storage

MESSAGE_TYPE = "sensor_msgs/msg/JointState"

_BLOCK = 4096  # messages written together


class TopicSummary(NamedTuple):
    """What a recording says of one topic."""

    name: str
    message_type: str
    message_count: int


def read_topics(path: Path | str) -> list[TopicSummary]:
    """Topics of a recording, by name."""
    return topics_of(Recording(Path(path)))


def topics_of(recording: Recording) -> list[TopicSummary]:
    """Its topics, by name."""
    return [TopicSummary(*topic) for topic in recording.topics()]


def read_joint_log(
    path: Path | str,
    joints: Sequence[str] = (),
    *,
    topic: str = "",
    clock: Clock = "auto",
    progress: Progress = no_progress,
) -> JointLog:
    """Joint states of one topic of a recording.

    Parameters
    ----------
    path
        A directory with metadata.yaml, or a .db3 or .mcap file.
    joints
        Names, in the order wanted; by default those of the first message.
    topic
        By default the only one with joint states.
    clock
        Which stamp is the time.

    Raises
    ------
    UserError
        BagError.

    Examples
    --------
    >>> from inverse_dynamics import read_joint_log, write_joint_logs
    >>> from inverse_dynamics.demo.demo import stored_recording
    >>> log = read_joint_log(stored_recording("ur10_simulated"), ["elbow_joint"])
    >>> log.q.shape[1], log.storage  # rad, one column
    (1, 'mcap')
    >>> write_joint_logs("copy", {"/joint_states": log})
    >>> bool((read_joint_log("copy").q == log.q).all())
    True
    """
    check_clock(clock)
    recording = Recording(Path(path))
    states = JointStateTopic(recording, recording.topic_of_type(MESSAGE_TYPE, topic))
    return states.read(joints, clock, progress)


class JointStateTopic(NamedTuple):
    """Joint states of a recording that haven't been read."""

    recording: Recording
    topic: str
    effort_is: str = ""  # the format states no meaning
    notes: tuple[str, ...] = ()  # those of reading come with the table

    def read(self, joints: Sequence[str], clock: Clock, progress: Progress) -> JointLog:
        """Read them; the arguments are those of read_joint_log(). Raises BagError."""
        expected = self.recording.expected_messages(self.topic)
        table = self.recording.read_samples(
            self.topic,
            joints,
            clock,
            lambda share: progress("reading", round(share * expected), expected),
        )
        return self.log(table)

    def log(self, table: SampleTable) -> JointLog:
        """What was read, as views of the table."""
        series = table.series
        return JointLog(
            joint_names=tuple(table.joint_names),
            header_stamps=series["header_stamps"],
            receive_stamps=series["receive_stamps"],
            q=series["q"],
            qd=series["qd"],
            effort=series["effort"],
            frame_id=table.frame_id,
            clock=table.clock,
            topic=self.topic,
            storage=self.recording.storage,
            notes=tuple(table.notes),
        )


def write_joint_logs(
    path: Path | str,
    topics: Mapping[str, JointLog],
    *,
    storage: Storage = "sqlite3",
    progress: Progress = no_progress,
) -> None:
    """Write joint states to a new recording, in the current format of rosbag2. Both stamps are kept.

    Parameters
    ----------
    path
        Of the new directory.
    topics
        Topic to joint states; several are interleaved message by message.
    storage
        "sqlite3" or "mcap".

    Raises
    ------
    UserError
        BagError: the path exists or can't be written.
    """
    check_storage(storage)
    logs = list(topics.values())
    total, done = sum(map(len, logs)), 0
    about = [(topic, list(log.joint_names), log.frame_id) for topic, log in topics.items()]
    with _errors_told(path):
        writer = JointStateWriter(Path(path), storage, about)
        for begin in range(0, max(map(len, logs), default=0), _BLOCK):
            rows = slice(begin, begin + _BLOCK)
            stamps = [(log.header_stamps[rows], log.receive_stamps[rows]) for log in logs]
            numbers = [(log.q[rows], log.qd[rows], log.effort[rows]) for log in logs]
            writer.write([(*s, *n) for s, n in zip(stamps, numbers, strict=True)])
            done += sum(len(q) for q, *_ in numbers)
            progress("writing the bag", done, total)
        writer.finish()


def write_torques(
    path: Path,
    storage: Storage,
    topic: str,
    log: JointLog,
    torques: tuple[Floats, Floats],
    *,
    progress: Progress = no_progress,
) -> None:
    """Write a new recording of torques, computed ones as `topic`, measured ones as `topic`_gt.

    Stamps, positions and velocities are those of log. torques: computed and measured, (N, n).

    Raises BagError if the path exists or can't be written.
    """
    computed, measured = torques
    with _errors_told(path):
        _core.write_torques(
            path,
            storage,
            (topic, list(log.joint_names), log.frame_id),
            (log.header_stamps, log.receive_stamps, log.q, log.qd, computed),
            measured,
            progress=lambda share: progress("writing", round(share * len(log)), len(log)),
        )


@contextmanager
def _errors_told(path: Path | str) -> Iterator[None]:
    try:
        yield
    except BagError:
        raise
    except Exception as error:  # a name that can't be encoded
        raise unwritable(path, error) from error


class _UriPath(type(Path())):  # type: ignore[misc]
    """A path that rosbags puts into a URI as it is: in a name, `?`, `#` and `%` mean themselves."""

    def __format__(self, _: str) -> str:
        return quote(os.fsencode(self))


def new_recording(path: Path, storage: Storage) -> Writer:
    """Writer of a new recording of any types, in the current format of rosbag2."""
    require("a recording of trajectories", "rosbags")
    from rosbags.rosbag2 import StoragePlugin, Writer

    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    writer = Writer(path, version=Writer.VERSION_LATEST, storage_plugin=plugin)
    writer.path = _UriPath(path)
    return writer


def unwritable(path: Path | str, error: Exception) -> BagError:
    """What is told where a recording can't be written: mostly, the disk is full."""
    return BagError(
        f"{path}: can't be written ({error_text(error)}); free some space, or name another output "
        "with --out"
    )


def error_text(error: Exception) -> str:
    """First line of what an error says, or its name."""
    lines = str(error).strip().splitlines()
    return harmless(lines[0], 300) if lines else type(error).__name__

# SPDX-License-Identifier: Apache-2.0
"""Joint states from and to rosbag2 recordings (sqlite3 and MCAP), without ROS.

    log = read_joint_log("recording", ["joint_1", "joint_2"])
    write_joint_logs("copy", {"/joint_states": log})

Which messages and joints are taken, and which time: joint_log_builder.py.
"""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from inverse_dynamics.errors import BagError
from inverse_dynamics.joint_log import CLOCKS, no_progress
from inverse_dynamics.joint_log_builder import JointLogBuilder
from inverse_dynamics.joint_state_cdr import MESSAGE_TYPE, Decoder, encode

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray
    from rosbags.interfaces import Connection
    from rosbags.rosbag2 import Reader

    from inverse_dynamics.joint_log import Clock, Integers, JointLog, Progress, Storage
    from inverse_dynamics.joint_state_cdr import Block

_BLOCK = 4096  # messages decoded together


class TopicSummary(NamedTuple):
    """What a recording says of one topic."""

    name: str
    message_type: str
    message_count: int


def read_topics(path: Path | str) -> list[TopicSummary]:
    """Topics of a recording, by name."""
    with _Recording(Path(path)) as recording:
        return recording.topics()


def read_joint_log(
    path: Path | str,
    joints: Sequence[str] = (),
    *,
    topic: str = "",
    clock: Clock = "auto",
    progress: Progress = no_progress,
) -> JointLog:
    """Joint states of one topic, by the rules of joint_log_builder.py.

    path: directory with metadata.yaml, or a .db3 or .mcap file. joints: names, in the order wanted;
    none: those of the first message. topic: none: the only one with joint states. clock: which
    stamp is the time.

    Raises BagError.
    """
    path = Path(path)
    if clock not in CLOCKS:
        raise BagError(f"clock: expected one of {', '.join(CLOCKS)}, got '{clock}'")
    with _Recording(path) as recording:
        connections = recording.joint_state_connections(topic)
        topic = connections[0].topic
        where = f"{path}: {topic}"
        expected = sum(connection.msgcount for connection in connections)
        builder = JointLogBuilder(where, joints, expected)
        decoder = Decoder()
        for messages, received in recording.blocks(connections):
            builder.add(_decoded(decoder, messages, where, builder.messages), received)
            progress("reading", builder.messages, expected)
        if builder.messages < expected:
            raise BagError(
                f"{where}: expected {expected} messages, as its metadata say, got "
                f"{builder.messages}: the file is cut off; copy or record it again"
            )
        if builder.messages == 0:
            raise BagError(
                f"{where}: expected joint states, got no message; was the robot's driver running "
                "while it was recorded?"
            )
        return builder.joint_log(clock, topic, recording.storage)


def _decoded(decoder: Decoder, messages: Sequence[bytes], where: str, before: int) -> list[Block]:
    """Decoded messages; one that can't be decoded is a BagError."""
    try:
        return list(decoder.decode(messages))
    except Exception as error:  # whatever a decoder makes of a damaged message
        raise BagError(
            f"{where}: one of the messages {before + 1} to {before + len(messages)} can't be "
            f"decoded as {MESSAGE_TYPE} ({_text(error)}): the recording is damaged; copy or record "
            "it again"
        ) from error


def write_joint_logs(
    path: Path | str,
    topics: Mapping[str, JointLog],
    *,
    storage: Storage = "sqlite3",
    progress: Progress = no_progress,
) -> None:
    """Write joint states to a new recording, in the current format of rosbag2.

    topics: topic to joint states; several are interleaved message by message. Both stamps are kept.

    Raises BagError if the path exists or can't be written.
    """
    from rosbags.rosbag2 import StoragePlugin, Writer, WriterError
    from rosbags.typesys import Stores, get_typestore

    plugins = {"sqlite3": StoragePlugin.SQLITE3, "mcap": StoragePlugin.MCAP}
    if storage not in plugins:
        raise BagError(f"storage: expected one of {', '.join(plugins)}, got '{storage}'")
    typestore = get_typestore(Stores.ROS2_HUMBLE)
    total = sum(len(log) for log in topics.values())
    done = 0
    try:
        with Writer(
            Path(path), version=Writer.VERSION_LATEST, storage_plugin=plugins[storage]
        ) as writer:
            connections = [
                writer.add_connection(topic, MESSAGE_TYPE, typestore=typestore) for topic in topics
            ]
            longest = max((len(log) for log in topics.values()), default=0)
            for begin in range(0, longest, _BLOCK):
                rows = slice(begin, begin + _BLOCK)
                tables = [_encoded(log, rows) for log in topics.values()]
                for row in range(max(len(table) for _, table in tables)):
                    for connection, (stamps, table) in zip(connections, tables, strict=True):
                        if row < len(table):
                            writer.write(connection, stamps[row], table[row].tobytes())
                            done += 1
                progress("writing the bag", done, total)
    except (WriterError, OSError) as error:
        raise BagError(f"{path}: can't be written ({_text(error)})") from error


def _encoded(log: JointLog, rows: slice) -> tuple[list[int], NDArray[np.uint8]]:
    """Times of reception and serialised messages."""
    table = encode(
        log.joint_names,
        log.frame_id,
        log.header_stamps[rows],
        log.q[rows],
        log.qd[rows],
        log.effort[rows],
    )
    return log.receive_stamps[rows].tolist(), table


class _Recording:
    """A recording being read: finds it, opens it, and turns what can go wrong into BagError."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._reader: Reader

    def __enter__(self) -> _Recording:
        _check_there(self._path)
        from rosbags.rosbag2 import Reader

        try:
            self._reader = Reader(self._path)
            self._reader.open()
        except Exception as error:  # readers of damaged files raise more than they document
            raise self._unreadable(error) from error
        return self

    def __exit__(self, *_: object) -> None:
        self._reader.close()

    @property
    def storage(self) -> Storage:
        files = [self._path] if self._path.is_file() else list(self._path.iterdir())
        return "mcap" if any(".mcap" in f.suffixes for f in files) else "sqlite3"

    def topics(self) -> list[TopicSummary]:
        return [
            TopicSummary(name, info.msgtype or "several types", info.msgcount)
            for name, info in sorted(self._reader.topics.items())
        ]

    def joint_state_connections(self, topic: str) -> list[Connection]:
        """Connections of the topic; none given: of the only topic with joint states."""
        topics = self.topics()
        there = "\n".join(
            f"  {t.name}  {t.message_type}  {t.message_count} messages" for t in topics
        )
        if not topics:
            raise BagError(f"{self._path}: is an empty recording: it has no topic; record it again")
        if not topic:
            candidates = [t.name for t in topics if t.message_type == MESSAGE_TYPE]
            if len(candidates) != 1:
                raise BagError(
                    f"{self._path}: expected one topic of type {MESSAGE_TYPE}, got "
                    f"{len(candidates)}; name it with --topic. The recording has\n{there}"
                )
            topic = candidates[0]
        found = [t for t in topics if t.name == topic]
        if not found:
            raise BagError(
                f"{self._path}: has no topic {topic}; name one it has with --topic:\n{there}"
            )
        if found[0].message_type != MESSAGE_TYPE:
            raise BagError(
                f"{self._path}: topic {topic}: expected type {MESSAGE_TYPE}, got "
                f"{found[0].message_type}; name another topic with --topic:\n{there}"
            )
        return [c for c in self._reader.connections if c.topic == topic]

    def blocks(self, connections: list[Connection]) -> Iterator[tuple[list[bytes], Integers]]:
        """Serialised messages and their times of reception [ns], thousands at a time."""
        messages = self._reader.messages(connections=connections)
        while True:
            try:
                block = list(islice(messages, _BLOCK))
            except Exception as error:  # see __enter__
                raise self._unreadable(error) from error
            if not block:
                return
            received = np.fromiter((m[1] for m in block), dtype=np.int64, count=len(block))
            yield [m[2] for m in block], received

    def _unreadable(self, error: Exception) -> BagError:
        return BagError(
            f"{self._path}: can't be read as a rosbag2 recording ({_text(error)}): expected "
            "sqlite3 or MCAP storage; it is damaged, cut off or of another kind; copy or record it "
            "again"
        )


def _check_there(path: Path) -> None:
    """What can be said of a path before it is opened."""
    if not path.exists():
        raise BagError(
            f"{path}: no such file or directory; expected a rosbag2 recording: a directory with "
            "metadata.yaml, or a .db3 or .mcap file"
        )
    if path.is_dir():
        if (path / "metadata.yaml").exists():
            for log in sorted(path.glob("*.db3-wal")):
                _check_complete(path / log.name.removesuffix("-wal"))
            return
        files = sorted(f.name for f in path.iterdir() if f.suffix in {".db3", ".mcap"})
        remedy = (
            f"give {path / files[0]} itself, or run `ros2 bag reindex {path}`"
            if files
            else "is it another directory?"
        )
        raise BagError(f"{path}: is not a rosbag2 recording: it has no metadata.yaml; {remedy}")
    if path.suffix == ".bag":
        raise BagError(
            f"{path}: is a ROS 1 recording; expected rosbag2; convert it with "
            f"`rosbags-convert --src {path} --dst {path.stem}`"
        )
    if path.suffix not in {".db3", ".mcap"}:
        raise BagError(
            f"{path}: is not a rosbag2 recording: expected a directory with metadata.yaml, or a "
            f".db3 or .mcap file, got '{path.name}'"
        )
    if path.stat().st_size == 0:
        raise BagError(
            f"{path}: is empty (0 bytes); expected a rosbag2 recording; copy or record it again"
        )
    _check_complete(path)


def _check_complete(file: Path) -> None:
    """A recorder that was killed leaves messages in a log beside the database."""
    log = file.with_name(f"{file.name}-wal")
    if log.exists() and log.stat().st_size > 0:
        raise BagError(
            f"{file}: is incomplete: some of its messages are in {log.name} still; put them in with "
            f"`sqlite3 {file} 'PRAGMA wal_checkpoint(TRUNCATE)'`"
        )


def _text(error: Exception) -> str:
    return str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__

# SPDX-License-Identifier: Apache-2.0
"""Raw messages of rosbag2 recordings (sqlite3 and MCAP), and what is said of a file that is none."""

from __future__ import annotations

import os
from contextlib import closing, suppress
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import quote

import numpy as np

from inverse_dynamics.base.wording import counted, harmless, shown
from inverse_dynamics.data.unpacking import UnpackError, check_packed_file, limit_chunks, unpacked
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rosbags.interfaces import Connection
    from rosbags.rosbag2 import Reader

    from inverse_dynamics.base.arrays import Integers
    from inverse_dynamics.data.joint_log import Storage

    _Message = tuple[Connection, int, bytes]

_BLOCK = 4096  # messages read together
_LONGEST_NAME = 300  # characters of a topic or type, in a text
_LATEST = 2**62  # ns: differences of stamps fit 64 bits


class TopicSummary(NamedTuple):
    """What a recording says of one topic."""

    name: str
    message_type: str
    message_count: int


class UriPath(type(Path())):  # type: ignore[misc]
    """A path that rosbags puts into a URI as it is: in a name, `?`, `#` and `%` mean themselves."""

    def __format__(self, _: str) -> str:
        return quote(os.fsencode(self))


class BagReader:
    """A recording being read: finds it, opens it, and turns what can go wrong into BagError."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._reader: Reader
        self._packed = False

    def __enter__(self) -> BagReader:
        _check_there(self._path)
        from rosbags.rosbag2 import Reader

        limit_chunks()
        try:
            for file in self._path.iterdir() if self._path.is_dir() else ():
                check_packed_file(file)
            self._reader = Reader(UriPath(self._path))
            self._reader.open()
        except Exception as error:  # readers of damaged files raise more than they document
            raise self._unreadable(error) from error
        # Packed messages are unpacked here, within limits.
        about = self._reader.storage.metadata
        self._packed = about.compression_mode == "message"
        if self._packed:
            self._reader.storage.metadata = about._replace(compression_mode=None)
        try:
            for connection in self._reader.connections:
                self._check(connection)
        except BagError:
            self._reader.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._reader.close()

    def _check(self, connection: Connection) -> None:
        """Raise BagError for what somebody has written into metadata or tables."""
        form = getattr(connection.ext, "serialization_format", "cdr")
        count = connection.msgcount
        wrong = [
            (what, expected, got)
            for what, expected, got, right in (
                ("name", "a text", connection.topic, isinstance(connection.topic, str)),
                ("type", "a text", connection.msgtype, isinstance(connection.msgtype, str)),
                ("serialization", "cdr", form, form == "cdr"),
                ("messages", "their number", count, isinstance(count, int) and 0 <= count < 2**63),
            )
            if not right
        ]
        for what, expected, got in wrong:
            raise BagError(
                f"{self._path}: topic {harmless(connection.topic)}: {what}: expected {expected}, got "
                f"{shown(got)}; was the recording edited? Copy or record it again"
            )

    @property
    def storage(self) -> Storage:
        """What the recording is kept in."""
        files = [self._path] if self._path.is_file() else list(self._path.iterdir())
        return "mcap" if any(".mcap" in f.suffixes for f in files) else "sqlite3"

    def topics(self) -> list[TopicSummary]:
        """What there is, by name."""
        return [
            TopicSummary(name, info.msgtype or "several types", info.msgcount)
            for name, info in sorted(self._reader.topics.items())
        ]

    def connections_of_type(self, message_type: str, topic: str = "") -> list[Connection]:
        """Connections of the topic; none given: of the only one with messages of the type."""
        topics = self.topics()
        there = "\n".join(
            f"  {harmless(t.name, _LONGEST_NAME)}  {harmless(t.message_type, _LONGEST_NAME)}  "
            f"{counted(t.message_count, 'message')}"
            for t in topics
        )
        if not topics:
            raise BagError(f"{self._path}: is an empty recording: it has no topic; record it again")
        if not topic:
            candidates = [t.name for t in topics if t.message_type == message_type]
            filled = {t.name for t in topics if t.message_count}
            candidates = [name for name in candidates if name in filled] or candidates
            if len(candidates) != 1:
                raise BagError(
                    f"{self._path}: expected one topic of type {message_type}, got "
                    f"{len(candidates)}; name it with --topic. The recording has\n{there}"
                )
            topic = candidates[0]
        found = [t for t in topics if t.name == topic]
        if not found:
            raise BagError(
                f"{self._path}: has no topic {topic}; name one it has with --topic:\n{there}"
            )
        if found[0].message_type != message_type:
            raise BagError(
                f"{self._path}: topic {topic}: expected type {message_type}, got "
                f"{harmless(found[0].message_type)}; name another topic with --topic:\n{there}"
            )
        return [c for c in self._reader.connections if c.topic == topic]

    @property
    def connections(self) -> list[Connection]:
        """What the recording knows of its topics."""
        return list(self._reader.connections)

    def messages(self) -> Iterator[tuple[Connection, int, bytes]]:
        """All messages as they are: connection, time of reception [ns], serialised message.

        Raises BagError where they can't be read.
        """
        try:
            yield from self._unpacked(self._reader.messages())
        except Exception as error:  # see __enter__
            raise self._unreadable(error) from error

    def blocks(self, connections: list[Connection]) -> Iterator[tuple[list[bytes], Integers]]:
        """Serialised messages and their times of reception [ns], thousands at a time.

        Raises BagError where they can't be read, and where they aren't as many as the metadata say.
        """
        topic, expected = connections[0].topic, sum(c.msgcount for c in connections)
        done = 0
        for messages, received in self._blocks(connections):
            wrong = (received < 0) | (received > _LATEST)
            if wrong.any():
                k = int(wrong.argmax())
                raise BagError(
                    f"{self._path}: {topic}, message {done + k + 1}: time of reception: expected 0 to "
                    f"{_LATEST:.2g} ns, got {received[k]}; was the recording edited? Record it again"
                )
            done += len(messages)
            if done > expected:
                break
            yield messages, received
        if done != expected:
            raise BagError(
                f"{self._path}: {topic}: expected {counted(expected, 'message')}, as its metadata "
                f"say, got {done if done < expected else 'more'}: "
                + (
                    "the file is cut off; copy or record it again"
                    if done < expected
                    else "they belong to another recording; run `ros2 bag reindex` on it"
                )
            )

    def _blocks(self, connections: list[Connection]) -> Iterator[tuple[list[bytes], Integers]]:
        messages = self._unpacked(self._reader.messages(connections=connections))
        while True:
            try:
                block = list(islice(messages, _BLOCK))
                received = np.fromiter((m[1] for m in block), dtype=np.int64, count=len(block))
            except Exception as error:  # see __enter__
                raise self._unreadable(error) from error
            if not block:
                return
            yield [m[2] for m in block], received

    def _unpacked(self, messages: Iterator[_Message]) -> Iterator[_Message]:
        if not self._packed:
            return messages
        return ((connection, received, unpacked(raw)) for connection, received, raw in messages)

    def _unreadable(self, error: Exception) -> BagError:
        if isinstance(error, UnpackError):
            return BagError(f"{self._path}: {error}")
        return BagError(
            f"{self._path}: can't be read as a rosbag2 recording ({error_text(error)}): expected "
            "sqlite3 or MCAP storage; it is damaged, cut off or of another kind; copy or record it "
            "again"
        )


def _check_there(path: Path) -> None:
    """What can be said of a path before it is opened."""
    if not os.path.exists(path):  # Path.exists() raises where the path is too long
        raise BagError(
            f"{path}: no such file or directory; expected a rosbag2 recording (a directory with "
            "metadata.yaml, or a .db3 or .mcap file), or a table (.csv or .txt)"
        )
    if path.is_dir():
        if (path / "metadata.yaml").exists():
            for file in sorted(path.glob("*.db3")):
                _check_tables(file)
            for log in sorted(path.glob("*.db3-wal")):
                _check_complete(path / log.name.removesuffix("-wal"))
            return
        files = sorted(f.name for f in path.iterdir() if f.suffix in {".db3", ".mcap"})
        inside = sorted(f.parent for f in path.glob("*/metadata.yaml"))
        if files:
            remedy = f"give {path / files[0]} itself, or run `ros2 bag reindex {path}`"
        elif len(inside) == 1:
            remedy = f"a recording is in it: give {inside[0]}"
        elif inside:
            remedy = f"recordings are in it: give one of {', '.join(map(str, inside))}"
        else:
            remedy = "is it another directory?"
        raise BagError(f"{path}: is not a rosbag2 recording: it has no metadata.yaml; {remedy}")
    if path.suffix == ".bag":
        raise BagError(
            f"{path}: is a ROS 1 recording; expected rosbag2; convert it with "
            f"`rosbags-convert --src {path} --dst {path.stem}`"
        )
    if path.suffix not in {".db3", ".mcap"}:
        raise BagError(
            f"{path}: is not a rosbag2 recording: expected a directory with metadata.yaml, or a "
            f".db3 or .mcap file (or a table, .csv or .txt), got '{path.name}'"
        )
    if path.stat().st_size == 0:
        raise BagError(
            f"{path}: is empty (0 bytes); expected a rosbag2 recording; copy or record it again"
        )
    _check_complete(path)
    if path.suffix == ".db3":
        _check_tables(path)


def _check_tables(file: Path) -> None:
    """Raise BagError for a view in place of a table: it may compute without end."""
    import sqlite3

    query = "SELECT name, type FROM sqlite_master WHERE name IN ('messages', 'topics')"
    with suppress(sqlite3.Error, UnicodeDecodeError):  # the reader will say what is wrong
        database = sqlite3.connect(f"{file.absolute().as_uri()}?immutable=1", uri=True)
        with closing(database):
            for name, kind in database.execute(query).fetchall():
                if kind not in ("table", "index"):
                    raise BagError(
                        f"{file}: expected the table {name}, got a {harmless(kind)}; was the "
                        "recording edited? Copy or record it again"
                    )


def _check_complete(file: Path) -> None:
    """A recorder that was killed leaves messages in a log beside the database."""
    log = file.with_name(f"{file.name}-wal")
    if log.exists() and log.stat().st_size > 0:
        raise BagError(
            f"{file}: is incomplete: some of its messages are in {log.name} still; put them in with "
            f"`sqlite3 {file} 'PRAGMA wal_checkpoint(TRUNCATE)'`"
        )


def error_text(error: Exception) -> str:
    """First line of what an error says, or its name."""
    lines = str(error).strip().splitlines()
    return harmless(lines[0], 300) if lines else type(error).__name__

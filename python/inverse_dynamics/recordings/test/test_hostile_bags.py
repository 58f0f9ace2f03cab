# SPDX-License-Identifier: Apache-2.0
"""Recordings that aren't what they should be: one message with the place, or samples and a note."""

from __future__ import annotations

import re
import shutil
import sqlite3
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from example_recordings import joint_state, write_messages
from simulation_arms import pendulum, write_robot

from inverse_dynamics import Robot, evaluate, load_robot, write_joint_logs
from inverse_dynamics.errors import UserError
from inverse_dynamics.recordings.bags import read_joint_log

SAMPLES = 300
NAMES = ["swing"]


def states(**changes: Callable[[int], object]) -> list[object]:
    """A swing of a pendulum at 100 Hz; changes: fields as functions of the number of the message."""
    fields: dict[str, Callable[[int], object]] = {
        "names": lambda _: NAMES,
        "position": lambda k: [np.sin(0.01 * k)],
        "velocity": lambda k: [np.cos(0.01 * k)],
        "effort": lambda k: [10 * np.cos(0.01 * k)],
        "stamp": lambda k: 10**9 + 10**7 * k,
        **changes,
    }
    return [joint_state(**{name: at(k) for name, at in fields.items()}) for k in range(SAMPLES)]


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_messages(tmp_path_factory.mktemp("good") / "bag", states())


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return load_robot(write_robot(tmp_path_factory.mktemp("robot"), pendulum()))


def refused(bag: Path, robot: Robot, expected: str = "", **options: object) -> None:
    """Evaluation ends in time, with a text that begins with the place and is fit for a terminal."""
    start = time.process_time()
    with pytest.raises(UserError) as caught:
        evaluate(bag, robot, **options)
    text = str(caught.value)
    assert text.startswith(str(bag))
    assert expected in text
    assert len(text) < 2000
    # one line, and one for each topic there is
    assert re.fullmatch(r"[^\x00-\x1f\x7f-\x9f]+(\n  [^\x00-\x1f\x7f-\x9f]+)*", text)
    assert time.process_time() - start < 20.0


# Metadata that somebody has edited: what stands there, and what instead.
BOMB = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{b}: &{b} [{','.join(['*' + a] * 9)}]\n"
    for a, b in zip("abcdefghi", "bcdefghij", strict=True)
)
METADATA = {
    "nothing": (r"(?s).*", ""),
    "a word": (r"(?s).*", "hello"),
    "a list": (r"(?s).*", "[1, 2]"),
    "no key": (r"rosbag2_bagfile_information", "rosbag"),
    "NUL": (r"version", "vers\0ion"),
    "an open bracket": (r"version: 9", "version: [9"),
    "a tag of Python": (r"version: 9", "version: !!python/object/apply:os.getpid []"),
    "deep lists": (r"version: 9", "version: " + "[" * 5000),
    "deep mappings": (r"version: 9", "version: " + "{a: " * 5000),
    "many aliases": (r"version: 9", "version: *j\n" + BOMB),
    "version of words": (r"version: 9", "version: nine"),
    "no version": (r"version: 9", "versio: 9"),
    "version null": (r"version: 9", "version:"),
    "another storage": (r"storage_identifier: sqlite3", "storage_identifier: zip"),
    "the wrong storage": (r"storage_identifier: sqlite3", "storage_identifier: mcap"),
    "no storage": (r"storage_identifier: sqlite3", "storage: sqlite3"),
    "a list as a storage": (r"storage_identifier: sqlite3", "storage_identifier: [sqlite3]"),
    "a missing file": (r"bag.db3", "gone.db3"),
    "a file elsewhere": (r"bag.db3", "../../../../etc/passwd"),
    "files of numbers": (r"- bag.db3", "- 7"),
    "a name of 100 kB": (r"bag.db3", "x" * 100_000),
    "an escape sequence": (r"bag.db3", '"a\\\\x1b[31m.db3"'),
    "too many messages": (r"message_count: 300", "message_count: 301"),
    "too few messages": (r"message_count: 300", "message_count: 299"),
    "no message": (r"message_count: 300", "message_count: 0"),
    "messages in words": (r"message_count: 300", "message_count: many"),
    "messages in a list": (r"message_count: 300", "message_count: [300]"),
    "a negative count": (r"message_count: 300", "message_count: -1"),
    "a huge count": (r"message_count: 300", f"message_count: {'9' * 400}"),
    "a topic without a name": (r"name: /joint_states", "nam: /joint_states"),
    "a topic of numbers": (r"name: /joint_states", "name: 7"),
    "a topic of a list": (r"name: /joint_states", "name: [/joint_states]"),
    "another topic": (r"name: /joint_states", "name: /other"),
    "another type": (r"sensor_msgs/msg/JointState", "std_msgs/msg/String"),
    "an unknown type": (r"sensor_msgs/msg/JointState", "a/b/c/d"),
    "another serialization": (r"serialization_format: cdr", "serialization_format: protobuf"),
    "no time": (r"nanoseconds_since_epoch: \d+", "nanoseconds_since_epoch: now"),
    "a compression": (r"compression_mode: ''", "compression_mode: FILE"),
    "another compression": (
        r"compression_mode: ''",
        "compression_mode: MESSAGE\n  compression_format: lzma",
    ),
}


@pytest.mark.parametrize("name", METADATA)
def test_edited_metadata_are_refused(tmp_path, good, robot, name):
    pattern, instead = METADATA[name]
    bag = Path(shutil.copytree(good, tmp_path / "bag"))
    text = (bag / "metadata.yaml").read_text()
    changed = re.sub(pattern, lambda _: instead, text, count=0 if pattern[0] != "(" else 1)
    assert changed != text
    (bag / "metadata.yaml").write_text(changed)
    refused(bag, robot)


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_metadata_in_another_encoding_are_refused(tmp_path, good, robot, encoding):
    bag = Path(shutil.copytree(good, tmp_path / "bag"))
    text = (bag / "metadata.yaml").read_text().replace("bag.db3", "bäg.db3")
    (bag / "metadata.yaml").write_bytes(text.encode(encoding))
    refused(bag, robot)


SQL = {
    "no table of messages": ("DROP TABLE messages", ""),
    "no table of topics": ("DROP TABLE topics", ""),
    "no messages": ("DELETE FROM messages", "expected 300 messages, as its metadata say, got 0"),
    "fewer messages": (
        "DELETE FROM messages WHERE id > 9",
        "expected 300 messages, as its metadata",
    ),
    "more messages": (
        "INSERT INTO messages (topic_id, timestamp, data) SELECT topic_id, timestamp, data FROM messages",
        "expected 300 messages, as its metadata say, got more",
    ),
    "no topics": ("DELETE FROM topics", "expected 300 messages, as its metadata say, got 0"),
    "messages of no topic": ("UPDATE messages SET topic_id = 99", "expected 300 messages, as its"),
    "stamps of words": ("UPDATE messages SET timestamp = 'now'", ""),
    "stamps beyond 64 bits": ("UPDATE messages SET timestamp = 1e30", ""),
    "a stamp at the end of time": (
        "UPDATE messages SET timestamp = 9223372036854775807 WHERE id = 7",
        "message 7: time of reception: expected 0 to 4.6e+18 ns, got 9223372036854775807",
    ),
    "a stamp at the beginning of time": (
        "UPDATE messages SET timestamp = -9223372036854775808 WHERE id = 7",
        "message 7: time of reception: expected 0 to 4.6e+18 ns, got -9223372036854775808",
    ),
    "data of numbers": (
        "UPDATE messages SET data = 7 WHERE id = 7",
        "message 7: can't be decoded",
    ),
    "data of a gigabyte": (
        "UPDATE messages SET data = CAST(substr(data, 1, 16) || x'ffffff3f' || substr(data, 21) AS BLOB) WHERE id = 7",
        "message 7: can't be decoded",
    ),
    "another serialization": ("UPDATE topics SET serialization_format = 'xml'", ""),
    "another type": ("UPDATE topics SET type = 'std_msgs/msg/String'", ""),
}


@pytest.mark.parametrize("whole", [True, False])
@pytest.mark.parametrize("name", SQL)
def test_edited_database_is_refused(tmp_path, good, robot, name, whole):
    statement, expected = SQL[name]
    bag = Path(shutil.copytree(good, tmp_path / "bag"))
    with sqlite3.connect(bag / "bag.db3") as database:
        database.executescript(statement)
    database.close()
    if whole:
        refused(bag, robot, expected)
    elif (
        "metadata" not in expected and ", as its" not in expected
    ):  # the file alone says how many it has
        refused(bag / "bag.db3", robot, expected)


def test_a_topic_without_messages_does_not_count(tmp_path, good, robot):
    log = read_joint_log(good)
    nothing = read_joint_log(good)
    for name in ("header_stamps", "receive_stamps", "q", "qd", "effort"):
        object.__setattr__(nothing, name, getattr(nothing, name)[:0])
    write_joint_logs(tmp_path / "bag", {"/arm": log, "/other": nothing})
    assert read_joint_log(tmp_path / "bag").topic == "/arm"
    write_joint_logs(tmp_path / "empty", {"/arm": nothing, "/other": nothing})
    with pytest.raises(
        UserError, match="expected one topic of type .*, got 2; name it with topic="
    ):
        read_joint_log(tmp_path / "empty")


def test_a_type_with_several_lines_stays_on_its_line(tmp_path: Path) -> None:
    path = write_messages(tmp_path / "bag", states())
    metadata = path / "metadata.yaml"
    metadata.write_text(
        metadata.read_text().replace("type: sensor_msgs/msg/JointState", 'type: "a\\nb"')
    )
    for topic in ("", "/joint_states"):
        with pytest.raises(UserError) as caught:
            read_joint_log(path, topic)
        assert str(caught.value).splitlines()[1:] == [r"  /joint_states  a\nb  300 messages"]

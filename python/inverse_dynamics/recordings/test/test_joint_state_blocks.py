# SPDX-License-Identifier: Apache-2.0
"""Serialized joint states, read and written, against the rosbags library."""

import numpy as np
import pytest
from example_recordings import JOINT_STATE, STORE, joint_state
from rosbags.rosbag2 import Reader, StoragePlugin, Writer

from inverse_dynamics import write_joint_logs
from inverse_dynamics._core import Recording
from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.joint_log import JointLog

STORAGES = pytest.mark.parametrize("storage", ["sqlite3", "mcap"])


def random_messages(rng: np.random.Generator, count: int) -> list[object]:
    """Messages of many shapes: names, frames and lengths of arrays differ."""
    messages = []
    for k in range(count):
        joints = int(rng.integers(0, 5))
        names = [f"joint_{'x' * int(rng.integers(0, 6))}{i}" for i in range(joints)]
        arrays = [rng.normal(size=int(rng.integers(0, 5))).tolist() for _ in range(3)]
        stamp = int(rng.integers(0, 2**40)) + k
        messages.append(joint_state(names, *arrays, stamp, "base" if k % 3 else ""))
    return messages


def record(path, messages, storage="mcap"):
    """Serialized messages, the k-th received at k ns; written by rosbags."""
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/joint_states", JOINT_STATE, typestore=STORE)
        for k, raw in enumerate(messages):
            writer.write(connection, k, raw)
    return Recording(path).joint_states()


def serialized(message: object, **options: bool) -> bytes:
    return bytes(STORE.serialize_cdr(message, JOINT_STATE, **options))


def deserialized(raw: bytes) -> object:
    """As rosbags reads it, without its check that at most three bytes follow the message."""
    assert raw[:2] in (b"\0\0", b"\0\1")
    definition = STORE.get_msgdef(JOINT_STATE)
    read = definition.deserialize_cdr_le if raw[1] else definition.deserialize_cdr_be
    return read(raw[4:], 0, definition.cls, STORE)[0]


def check_blocks(blocks, messages):
    """Each message is in a block, as rosbags has it."""
    done = 0
    for names, frame_id, stamps, received, *arrays in blocks:
        for i in range(len(stamps)):
            message = messages[done]
            assert names == tuple(message.name)
            assert frame_id == message.header.frame_id
            stamp = message.header.stamp
            assert stamps[i] == stamp.sec * 10**9 + stamp.nanosec
            assert received[i] == done
            for field, numbers in zip(("position", "velocity", "effort"), arrays, strict=True):
                np.testing.assert_array_equal(numbers[i], getattr(message, field))
            done += 1
    assert done == len(messages)


@STORAGES
@pytest.mark.parametrize("little_endian", [True, False])
def test_messages_of_any_shape_are_read_as_rosbags_does(tmp_path, storage, little_endian):
    messages = random_messages(np.random.default_rng(3), 500)
    raw = [serialized(m, little_endian=little_endian) for m in messages]
    check_blocks(record(tmp_path / "bag", raw, storage), messages)


@STORAGES
def test_bytes_after_messages_are_ignored(tmp_path, storage):
    rng = np.random.default_rng(5)
    messages = random_messages(rng, 100)
    raw = [serialized(message) + rng.bytes(rng.integers(0, 20)) for message in messages]
    check_blocks(record(tmp_path / "bag", raw, storage), messages)


def test_a_damaged_message_is_accepted_or_refused_as_by_rosbags(tmp_path):
    rng = np.random.default_rng(0)
    whole = serialized(joint_state(["a", "bcd"], [1, 2], [], [5, 6], 7, "base"))
    accepted = 0
    for k in range(300):
        raw = bytearray(whole)
        for place in rng.integers(0, len(whole), rng.integers(1, 4)):
            raw[place] = rng.integers(256) if k % 2 else int(raw[place]) ^ 1 << int(rng.integers(3))
        blocks = record(tmp_path / f"bag{k}", [bytes(raw)])
        try:
            message = deserialized(bytes(raw))
        except Exception:
            with pytest.raises(BagError, match="message 1: can't be decoded"):
                next(blocks)
        else:
            check_blocks(blocks, [message])
            accepted += 1
    assert 30 < accepted < 270


# What is written.


@STORAGES
@pytest.mark.parametrize("names", [(), ("a",), ("joint_1", "joint_22", "joint_333")])
@pytest.mark.parametrize("frame_id", ["", "base", "base_link"])
def test_what_is_written_is_what_rosbags_writes(tmp_path, storage, names, frame_id):
    rng = np.random.default_rng(0)
    stamps = np.array([0, 1, 1_999_999_999, 1_700_000_000_123_456_789])
    numbers = rng.normal(size=(3, len(stamps), len(names)))
    log = JointLog(names, stamps, stamps + 1, *numbers, frame_id=frame_id)
    write_joint_logs(tmp_path / "ours", {"/torques": log, "/torques_gt": log}, storage=storage)
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    (tmp_path / "theirs").mkdir()
    with Writer(tmp_path / "theirs/ours", version=9, storage_plugin=plugin) as writer:
        topics = [
            writer.add_connection(topic, JOINT_STATE, typestore=STORE)
            for topic in ("/torques", "/torques_gt")
        ]
        for row, stamp in enumerate(stamps.tolist()):
            message = joint_state(list(names), *numbers[:, row], stamp, frame_id)
            for connection in topics:
                writer.write(connection, stamp + 1, serialized(message))
    ours, theirs = tmp_path / "ours", tmp_path / "theirs/ours"
    text = (ours / "metadata.yaml").read_text()
    expected = (theirs / "metadata.yaml").read_text().replace(": rosbags", ": unknown")
    assert text.split() == expected.split()  # rosbags puts long texts onto lines of their own
    suffix = ".mcap" if storage == "mcap" else ".db3"
    for place in ("", f"ours{suffix}"):
        with Reader(ours / place) as a, Reader(theirs / place) as b:
            for mine, other in zip(a.connections, b.connections, strict=True):
                assert mine._replace(owner=None) == other._replace(owner=None)
            messages = zip(a.messages(), b.messages(), strict=True)
            for (first, *one), (second, *two) in messages:
                assert (first.topic, *one) == (second.topic, *two)


@STORAGES
def test_a_long_recording_is_read_by_rosbags_message_by_message(tmp_path, storage):
    count = 12_000  # several chunks, several blocks
    stamps = 10**9 + 10**6 * np.random.default_rng(0).permutation(count)  # not in order
    numbers = np.arange(3.0 * count * 7).reshape(3, count, 7)
    log = JointLog(tuple("abcdefg"), stamps, stamps, *numbers)
    write_joint_logs(tmp_path / "bag", {"/joint_states": log}, storage=storage)
    order = np.argsort(stamps)
    with Reader(tmp_path / "bag") as reader:
        for row, (_, received, raw) in zip(order, reader.messages(), strict=True):
            message = STORE.deserialize_cdr(raw, JOINT_STATE)
            assert received == stamps[row]
            np.testing.assert_array_equal(message.effort, numbers[2, row])
    blocks = list(Recording(tmp_path / "bag").joint_states())
    np.testing.assert_array_equal(np.concatenate([b[3] for b in blocks]), stamps[order])
    np.testing.assert_array_equal(np.concatenate([b[6] for b in blocks]), numbers[2, order])

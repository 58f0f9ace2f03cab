# SPDX-License-Identifier: Apache-2.0
import os
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import JOINT_STATE, STORE, joint_log, joint_state, write_messages
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer

from inverse_dynamics.data.bags import (
    TopicSummary,
    read_joint_log,
    read_topics,
    write_joint_logs,
)
from inverse_dynamics.errors import BagError

TOPIC = "/joint_states"
STORAGES = pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
JOINTS = ("joint_1", "joint_2", "joint_3")


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    write_joint_logs(tmp_path / "bag", {TOPIC: joint_log()})
    return tmp_path / "bag"


def storage_file(bag: Path) -> Path:
    return next(f for f in bag.iterdir() if f.suffix in {".db3", ".mcap"})


def fails(bag: Path, *expected: str, **options: object) -> str:
    """Reading fails with a text that has each of the expected parts, the path first."""
    with pytest.raises(BagError) as caught:
        read_joint_log(bag, **options)
    text = str(caught.value)
    assert text.startswith(str(bag))
    for part in expected:
        assert part in text
    return text


# What is written is read back.


@STORAGES
def test_joint_states_are_read_back_as_they_were_written(tmp_path, storage):
    log = joint_log(9000, frame_id="base")  # more than one block
    write_joint_logs(tmp_path / "bag", {TOPIC: log}, storage=storage)
    for path in (tmp_path / "bag", storage_file(tmp_path / "bag")):
        read = read_joint_log(path, JOINTS, topic=TOPIC)
        for field in ("header_stamps", "receive_stamps", "q", "qd", "effort"):
            np.testing.assert_array_equal(getattr(read, field), getattr(log, field))
        assert read.joint_names == JOINTS
        assert (read.frame_id, read.clock, read.topic, read.storage) == (
            "base",
            "header",
            TOPIC,
            storage,
        )
        assert read.notes == ()


@STORAGES
def test_two_topics_are_interleaved_and_told_apart(tmp_path, storage):
    log = joint_log(10)
    other = replace(log, effort=2 * log.effort)
    write_joint_logs(tmp_path / "bag", {"/torques": other, "/torques_gt": log}, storage=storage)
    kind = "sensor_msgs/msg/JointState"
    assert read_topics(tmp_path / "bag") == [
        TopicSummary("/torques", kind, 10),
        TopicSummary("/torques_gt", kind, 10),
    ]
    np.testing.assert_array_equal(
        read_joint_log(tmp_path / "bag", topic="/torques").effort, other.effort
    )
    with Reader(tmp_path / "bag") as reader:
        topics = [c.topic for c, _, _ in reader.messages(connections=reader.connections)]
    assert topics == ["/torques", "/torques_gt"] * 10


@STORAGES
def test_recordings_have_the_current_metadata_version_and_definitions(tmp_path, storage):
    write_joint_logs(tmp_path / "bag", {TOPIC: joint_log()}, storage=storage)
    metadata = (tmp_path / "bag/metadata.yaml").read_text()
    assert "version: 9" in metadata
    assert f"storage_identifier: {storage}" in metadata
    assert "RIHS01_" in metadata
    with Reader(tmp_path / "bag") as reader:
        assert "float64[] effort" in reader.connections[0].msgdef.data


@STORAGES
def test_a_recording_by_rosbags_alone_is_read(tmp_path, storage):
    messages = [
        joint_state(["b", "a"], [k, -k], [2 * k, 0], [3 * k, 1], (k + 1) * 10**7) for k in range(5)
    ]
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    write_messages(tmp_path / "bag", messages, storage=plugin)
    log = read_joint_log(tmp_path / "bag", ["a", "b"])
    np.testing.assert_array_equal(log.q[:, 0], -np.arange(5))
    np.testing.assert_array_equal(log.q[:, 1], np.arange(5))
    np.testing.assert_array_equal(log.effort[:, 1], 3 * np.arange(5))
    np.testing.assert_allclose(log.time, 0.01 * np.arange(5), atol=1e-15)
    np.testing.assert_array_equal(log.receive_stamps, 10**6 * np.arange(1, 6))


def test_a_recording_without_message_definitions_is_read(bag):
    import sqlite3

    with sqlite3.connect(storage_file(bag)) as database:
        database.execute("DELETE FROM message_definitions")
    assert len(read_joint_log(bag)) == 50


@STORAGES
@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_a_compressed_recording_is_read(tmp_path, storage, mode):
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    writer = Writer(tmp_path / "bag", version=9, storage_plugin=plugin)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection(TOPIC, JOINT_STATE, typestore=STORE)
        for k in range(20):
            message = joint_state(["a"], [k], [0], [0], k)
            writer.write(connection, k, STORE.serialize_cdr(message, JOINT_STATE))
    log = read_joint_log(tmp_path / "bag")
    np.testing.assert_array_equal(log.q[:, 0], np.arange(20))
    assert log.storage == storage


def test_no_topic_given_means_the_only_one_with_joint_states(bag):
    assert read_joint_log(bag).topic == TOPIC


def test_progress_counts_messages_to_the_end(bag):
    calls = []
    read_joint_log(bag, progress=lambda *call: calls.append(call))
    assert calls[-1] == ("reading", 50, 50)


# Which joints, which messages.


def test_extra_joints_are_left_aside_and_order_may_change_between_messages(tmp_path):
    def message(names, k):
        number = {"a": 1.0, "b": 2.0, "gripper": 9.0}
        values = [k + number[n] for n in names]
        return joint_state(names, values, values, values, (k + 1) * 10**7)

    orders = [["gripper", "a", "b"], ["b", "a"], ["a", "gripper", "b"]]
    write_messages(tmp_path / "bag", [message(orders[k % 3], k) for k in range(9)])
    log = read_joint_log(tmp_path / "bag", ["a", "b"])
    np.testing.assert_array_equal(log.q, np.arange(9)[:, None] + [[1.0, 2.0]])
    assert log.notes == ()


def test_messages_of_other_joints_only_are_left_out_and_counted(tmp_path):
    arm = [joint_state(["a"], [k], [0], [0], (2 * k + 1) * 10**7) for k in range(6)]
    gripper = [joint_state(["finger"], [9], [], [], (2 * k + 2) * 10**7) for k in range(6)]
    both = [m for pair in zip(gripper, arm, strict=True) for m in pair]
    write_messages(tmp_path / "bag", both)
    log = read_joint_log(tmp_path / "bag", ["a"])
    np.testing.assert_array_equal(log.q[:, 0], np.arange(6))
    assert log.notes == ("6 of 12 messages left out: they hold none of the joints, but finger",)


def test_missing_joint_is_named_and_found_ones_are_listed(bag):
    fails(
        bag,
        f"{TOPIC}, message 1: expected the joints joint_1, elbow, got joint_1, joint_2, joint_3",
        "missing: elbow; give the recording's names with --joints",
        joints=["joint_1", "elbow"],
    )


def test_joints_that_arrive_in_several_messages_are_not_called_misnamed(tmp_path):
    apart = [
        joint_state([name], [0.0], [0.0], [0.0], (k + 1) * 10**7)
        for k in range(3)
        for name in ("joint_1", "joint_2")
    ]
    write_messages(tmp_path / "bag", apart)
    text = fails(
        tmp_path / "bag",
        "missing: joint_2; joints that arrive in several messages aren't merged: record a topic that has",
        joints=["joint_1", "joint_2"],
    )
    assert "--joints" not in text


def test_recording_of_another_robot_lists_its_joints(bag):
    fails(
        bag,
        "expected the joints shoulder, elbow, got only joint_1, joint_2, joint_3",
        "--joints",
        joints=["shoulder", "elbow"],
    )


def test_joint_missing_in_a_later_message_is_found(tmp_path):
    messages = [joint_state(["a", "b"], [1, 2], [0, 0], [0, 0], k + 1) for k in range(7)]
    messages.append(joint_state(["a"], [1], [0], [0], 8))
    write_messages(tmp_path / "bag", messages)
    fails(tmp_path / "bag", "message 8: expected the joints a, b, got a", joints=["a", "b"])


def test_joint_that_stands_twice_is_an_error(tmp_path):
    write_messages(tmp_path / "bag", [joint_state(["a", "a"], [1, 2], [0, 0], [0, 0], 1)])
    fails(tmp_path / "bag", "message 1: expected each joint once, got a, a", joints=["a"])


def test_joints_asked_for_twice_are_an_error(bag):
    with pytest.raises(BagError, match="joints: expected each name once, got a, a"):
        read_joint_log(bag, ["a", "a"])


@pytest.mark.parametrize(
    ("field", "reason"),
    [
        ("position", "joint positions are needed"),
        ("velocity", "joint velocities are needed"),
        ("effort", "measured efforts are what computed torques are compared with"),
    ],
)
@pytest.mark.parametrize(("length", "shown"), [(0, "an empty array"), (1, "1"), (3, "3")])
def test_arrays_of_another_length_than_the_names_are_an_error(
    tmp_path, field, reason, length, shown
):
    arrays = {"position": [0, 0], "velocity": [0, 0], "effort": [0, 0]}
    messages = [joint_state(["a", "b"], **arrays, stamp=1)]
    messages.append(joint_state(["a", "b"], **{**arrays, field: [0] * length}, stamp=2))
    write_messages(tmp_path / "bag", messages)
    fails(
        tmp_path / "bag",
        f"message 2: {field}: expected 2 numbers, one per name, got {shown}; {reason}",
    )


def test_of_several_mistakes_the_first_message_is_named(tmp_path):
    messages = [joint_state(["a"], [1], [1], [1], k) for k in range(8)]
    messages[3] = joint_state(["a"], [1], [1, 2, 3], [1], 3)  # longer than the others
    messages[5] = joint_state(["a"], [1], [], [1], 5)  # shorter
    write_messages(tmp_path / "bag", messages)
    fails(tmp_path / "bag", "message 4: velocity: expected 1 number, one per name, got 3")


@pytest.mark.parametrize("field", ["q", "qd", "effort"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_an_error(tmp_path, field, value):
    log = joint_log()
    getattr(log, field)[20, 1] = value
    getattr(log, field)[30, 0] = value
    write_joint_logs(tmp_path / "bag", {TOPIC: log})
    name = {"q": "position", "qd": "velocity", "effort": "effort"}[field]
    fails(
        tmp_path / "bag",
        f"message 21: {name} of joint joint_2: expected a finite number, got {value}",
    )


def test_numbers_of_joints_that_are_not_asked_for_may_be_anything(tmp_path):
    log = joint_log()
    log.effort[:, 1] = np.nan
    write_joint_logs(tmp_path / "bag", {TOPIC: log})
    assert np.isfinite(read_joint_log(tmp_path / "bag", ["joint_3", "joint_1"]).effort).all()


# Which time.


def test_stamps_are_taken_as_they_are_by_either_clock(tmp_path):
    log = joint_log(100)
    log.header_stamps[40] = log.header_stamps[39]
    log.header_stamps[70] = log.header_stamps[60] - 5
    write_joint_logs(tmp_path / "bag", {TOPIC: log})
    read = read_joint_log(tmp_path / "bag")
    np.testing.assert_array_equal(read.stamps, log.header_stamps)
    read = read_joint_log(tmp_path / "bag", clock="receive")
    assert read.clock == "receive"
    np.testing.assert_array_equal(read.stamps, log.receive_stamps)
    np.testing.assert_array_equal(read.header_stamps, log.header_stamps)


def test_headers_without_stamps_make_the_time_of_reception_the_time(tmp_path):
    log = joint_log()
    write_joint_logs(tmp_path / "bag", {TOPIC: replace(log, header_stamps=0 * log.header_stamps)})
    read = read_joint_log(tmp_path / "bag")
    assert read.clock == "receive"
    assert read.notes == ("no header has a stamp: the time of reception is used",)
    np.testing.assert_allclose(read.time, 0.01 * np.arange(50), atol=1e-12)


def test_time_has_nanoseconds_even_today(tmp_path):
    log = joint_log()
    today = 1_700_000_000_000_000_000
    write_joint_logs(
        tmp_path / "bag", {TOPIC: replace(log, header_stamps=log.header_stamps + today)}
    )
    np.testing.assert_allclose(
        read_joint_log(tmp_path / "bag").time, 0.01 * np.arange(50), atol=1e-12
    )


def test_unknown_clock_is_an_error(bag):
    with pytest.raises(BagError, match="expected one of auto, header, receive, got 'wall'"):
        read_joint_log(bag, clock="wall")


# What isn't a recording.


def test_missing_recording_is_an_error(tmp_path):
    fails(tmp_path / "bag", "no such file or directory; expected a rosbag2 recording")


def test_directory_without_metadata_names_the_remedy(bag):
    (bag / "metadata.yaml").unlink()
    fails(bag, "has no metadata.yaml", f"give {bag / 'bag.db3'} itself", "ros2 bag reindex")


def test_directory_of_something_else_is_an_error(tmp_path):
    fails(tmp_path, "is not a rosbag2 recording: it has no metadata.yaml")


def test_file_of_another_kind_is_an_error(tmp_path):
    (tmp_path / "motion.csv").write_text("1,2\n")
    fails(tmp_path / "motion.csv", "is not a rosbag2 recording", ".db3 or .mcap", "'motion.csv'")


def test_ros_1_recording_names_the_converter(tmp_path):
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
    fails(tmp_path / "old.bag", "is a ROS 1 recording", "rosbags-convert --src")


@pytest.mark.parametrize("name", ["bag.db3", "bag.mcap"])
def test_empty_file_is_an_error(tmp_path, name):
    (tmp_path / name).touch()
    fails(tmp_path / name, "is empty (0 bytes)")


@pytest.mark.parametrize("name", ["bag.db3", "bag.mcap"])
def test_file_of_noise_is_an_error(tmp_path, name):
    (tmp_path / name).write_bytes(np.random.default_rng(0).bytes(5000))
    fails(tmp_path / name, "can't be read as a rosbag2 recording", "copy or record it again")


@STORAGES
@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.95, 0.999])
@pytest.mark.parametrize("whole_directory", [True, False])
def test_file_that_is_cut_off_is_an_error(tmp_path, storage, share, whole_directory):
    write_joint_logs(tmp_path / "bag", {TOPIC: joint_log(5000)}, storage=storage)
    file = storage_file(tmp_path / "bag")
    os.truncate(file, int(share * file.stat().st_size))
    fails(tmp_path / "bag" if whole_directory else file, "can't be read as a rosbag2 recording")


def test_messages_that_are_cut_off_are_an_error(bag):
    import sqlite3

    with sqlite3.connect(storage_file(bag)) as database:
        database.execute("UPDATE messages SET data = substr(data, 1, 60) WHERE id = 7")
    fails(bag, "message 7: can't be decoded as sensor_msgs/msg/JointState")


def test_fewer_messages_than_the_metadata_say_are_an_error(bag):
    import sqlite3

    with sqlite3.connect(storage_file(bag)) as database:
        database.execute("DELETE FROM messages WHERE id > 30")
    fails(bag, "expected 50 messages, as its metadata say, got 30", "cut off")


def test_recording_of_a_recorder_that_was_killed_names_the_remedy(bag):
    import sqlite3

    file = storage_file(bag)
    database = sqlite3.connect(file)
    database.execute("PRAGMA journal_mode=WAL")
    database.execute("DELETE FROM messages WHERE id > 40")
    database.commit()  # and no checkpoint
    text = "is incomplete: some of its messages are in bag.db3-wal still; put them in with `sqlite3"
    with pytest.raises(BagError, match=text):
        read_joint_log(bag)
    with pytest.raises(BagError, match=text):
        read_joint_log(file)
    database.close()


def test_metadata_that_are_no_yaml_are_an_error(bag):
    (bag / "metadata.yaml").write_text("a: [1, 2")
    fails(bag, "can't be read as a rosbag2 recording")


def test_metadata_of_something_else_are_an_error(bag):
    (bag / "metadata.yaml").write_text("a: 1\n")
    fails(bag, "can't be read as a rosbag2 recording")


def test_missing_storage_file_is_an_error(bag):
    storage_file(bag).unlink()
    fails(bag, "can't be read as a rosbag2 recording", "missing")


def test_recording_without_any_topic_is_an_error(tmp_path):
    write_joint_logs(tmp_path / "bag", {})
    fails(tmp_path / "bag", "is an empty recording: it has no topic")


def test_topic_without_messages_is_an_error(tmp_path):
    write_joint_logs(tmp_path / "bag", {TOPIC: joint_log(0)})
    fails(tmp_path / "bag", f"{TOPIC}: expected joint states, got no message")


def test_missing_topic_lists_what_there_is(bag):
    fails(
        bag,
        "has no topic /robot/joint_states; name one it has with --topic",
        f"  {TOPIC}  sensor_msgs/msg/JointState  50 messages",
        topic="/robot/joint_states",
    )


def test_topic_of_another_type_is_an_error(tmp_path):
    kind = "std_msgs/msg/String"
    text = STORE.types[kind]("hello")
    write_messages(tmp_path / "bag", [text], topic="/chatter", message_type=kind)
    fails(
        tmp_path / "bag",
        "topic /chatter: expected type sensor_msgs/msg/JointState, got std_msgs/msg/String",
        "--topic",
        topic="/chatter",
    )
    fails(tmp_path / "bag", "expected one topic of type sensor_msgs/msg/JointState, got 0")


def test_several_topics_of_joint_states_must_be_told_apart(tmp_path):
    write_joint_logs(tmp_path / "bag", {"/left": joint_log(), "/right": joint_log()})
    fails(tmp_path / "bag", "got 2; name it with --topic", "/left", "/right")


# What can't be written.


def test_existing_recording_is_not_overwritten(bag):
    before = storage_file(bag).read_bytes()
    with pytest.raises(BagError, match="exists already"):
        write_joint_logs(bag, {TOPIC: joint_log(3)})
    assert storage_file(bag).read_bytes() == before


def test_recording_that_can_not_be_written_is_an_error(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(BagError, match="can't be written"):
        write_joint_logs(tmp_path / "file" / "bag", {TOPIC: joint_log()})


def test_unknown_storage_is_an_error(tmp_path):
    with pytest.raises(BagError, match="expected one of sqlite3, mcap, got 'csv'"):
        write_joint_logs(tmp_path / "bag", {TOPIC: joint_log()}, storage="csv")
    assert not (tmp_path / "bag").exists()


def test_storage_file_alone_is_a_recording(bag, tmp_path):
    copy = shutil.copy(storage_file(bag), tmp_path / "alone.db3")
    assert len(read_joint_log(copy)) == 50


# Real recordings.


@pytest.mark.parametrize(
    ("name", "samples", "duration"), [("ur10", 3441, 27.52), ("panda", 727, 24.2)]
)
def test_real_recordings_are_read(recordings, name, samples, duration):
    log = read_joint_log(recordings / f"{name}_exciting_trajectory")
    assert len(log) == samples
    assert log.time[-1] == pytest.approx(duration, abs=0.01)
    assert log.notes == ()

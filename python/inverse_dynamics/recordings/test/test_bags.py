# SPDX-License-Identifier: Apache-2.0
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from example_recordings import STORE, joint_log, write_messages

from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.bags import (
    read_joint_log,
    write_joint_logs,
)

TOPIC = "/joint_states"


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


def test_progress_counts_messages_to_the_end(bag):
    calls = []
    read_joint_log(bag, progress=lambda *call: calls.append(call))
    assert calls[-1] == ("reading", 50, 50)


# Which time.


# What isn't a recording.


def test_file_without_metadata_is_read_and_told(bag):
    (bag / "metadata.yaml").unlink()
    assert read_joint_log(bag).notes[0].startswith("metadata.yaml is missing: 1 file found in")


def test_joint_twice_in_a_message_is_refused(tmp_path):
    one = joint_log()
    names = (*one.joint_names[:-1], one.joint_names[0])
    write_joint_logs(tmp_path / "bag", {TOPIC: replace(one, joint_names=names)})
    for joints in ((), names[:-1]):
        fails(
            tmp_path / "bag",
            "message 1: expected each joint once",
            f"repeated: {names[0]}",
            joints=joints,
        )


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


def test_recording_of_a_recorder_that_was_killed_names_the_remedy(bag):
    import sqlite3

    file = storage_file(bag)
    database = sqlite3.connect(file)
    database.execute("PRAGMA journal_mode=WAL")
    database.execute("UPDATE messages SET timestamp = timestamp + 1")
    database.commit()  # and no checkpoint
    text = "is incomplete: some of its messages are in bag.db3-wal still; put them in with `python3"
    for path in (bag, file):
        with pytest.raises(BagError, match=text) as caught:
            read_joint_log(path)
    subprocess.run(str(caught.value).split("`")[1], shell=True, check=True)
    assert len(read_joint_log(bag)) == 50
    database.close()


def test_missing_storage_file_is_an_error(bag):
    storage_file(bag).unlink()
    fails(bag, "can't be read as a rosbag2 recording", "missing")


def test_topic_of_another_type_is_an_error(tmp_path):
    kind = "std_msgs/msg/String"
    text = STORE.types[kind]("hello")
    write_messages(tmp_path / "bag", [text], topic="/chatter", message_type=kind)
    fails(
        tmp_path / "bag",
        "topic /chatter: expected type sensor_msgs/msg/JointState, got std_msgs/msg/String",
        "topic=",
        topic="/chatter",
    )
    fails(tmp_path / "bag", "expected one topic of type sensor_msgs/msg/JointState, got 0")


# What can't be written.


def test_recording_that_can_not_be_written_is_an_error(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(BagError, match="can't be written"):
        write_joint_logs(tmp_path / "file" / "bag", {TOPIC: joint_log()})


def test_unknown_storage_is_an_error(tmp_path):
    with pytest.raises(BagError, match="expected one of sqlite3, mcap, got 'csv'"):
        write_joint_logs(tmp_path / "bag", {TOPIC: joint_log()}, storage="csv")
    assert not (tmp_path / "bag").exists()

# SPDX-License-Identifier: Apache-2.0
"""ROS 1 recordings, written by the package rosbags."""

import re

import numpy as np
import pytest
from example_recordings import joint_state, write_messages

from inverse_dynamics import read_recording
from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.log_format import LogFormat

rosbag1 = pytest.importorskip("rosbags.rosbag1")
typesys = pytest.importorskip("rosbags.typesys")
STORE = typesys.get_typestore(typesys.Stores.ROS1_NOETIC)
JOINT_STATE = "sensor_msgs/msg/JointState"


def write_bag(path, topics):
    """topics: name to messages: stamp [ns], joint names, positions; velocity 2 q, effort 3 q."""
    types = STORE.types
    with rosbag1.Writer(path) as writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, JOINT_STATE, typestore=STORE)
            for k, (stamp, names, q) in enumerate(messages):
                time = types["builtin_interfaces/msg/Time"](
                    sec=stamp // 10**9, nanosec=stamp % 10**9
                )
                header = types["std_msgs/msg/Header"](seq=k, stamp=time, frame_id="base")
                q = np.array(q, float)
                message = types[JOINT_STATE](header, list(names), q, 2 * q, 3 * q)
                raw = STORE.serialize_ros1(message, JOINT_STATE)
                writer.write(connection, stamp + 5_000_000, raw)


def test_joint_states_are_read_by_name(tmp_path):
    bag = tmp_path / "old.bag"
    messages = [(10**9 + k * 10**7, ("a", "b"), (k, 10 + k)) for k in range(20)]
    messages.insert(3, (10**9 + 25 * 10**6, ("finger",), (0.1,)))
    write_bag(bag, {"/joint_states": messages})
    log = read_recording(bag, ("b", "a"))
    k = np.arange(20.0)
    np.testing.assert_array_equal(log.q, np.column_stack([10 + k, k]))
    np.testing.assert_array_equal(log.effort, 3 * log.q)
    np.testing.assert_array_equal(log.qd, 2 * log.q)
    np.testing.assert_allclose(log.time, 0.01 * k)
    assert (log.clock, log.topic, log.stamps[0]) == ("header", "/joint_states", 10**9)
    assert log.notes == ("1 message without all joints left out",)
    assert read_recording(bag, ("a",), clock="receive").stamps[0] == 10**9 + 5_000_000


def test_joints_of_several_messages_are_merged_by_time(tmp_path):
    bag = tmp_path / "old.bag"
    left = [(10**9 + k * 10**7, ("a",), (k,)) for k in range(20)]
    right = [(10**9 + k * 10**7 + 5 * 10**6, ("b",), (k,)) for k in range(20)]
    write_bag(bag, {"/left": left, "/right": right})
    log = read_recording(bag, ("b", "a"))
    k = np.arange(1.0, 20.0)
    np.testing.assert_allclose(log.q, np.column_stack([k - 0.5, k]))
    assert log.topic == "/left, /right"
    assert log.notes == ("1 row with an empty field left out",)  # before the first of the right


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({}, f"expected one topic of {JOINT_STATE} with the joints a, got /left, /right"),
        (
            {"topic": "/up"},
            f"expected messages of {JOINT_STATE} on /up, got none; its topics are /left",
        ),
        (
            {"topic": "/left", "joints": ("c",)},
            "joints of the recording: a; give the recording's names",
        ),
    ],
)
def test_what_a_bag_does_not_have_is_said(tmp_path, options, expected):
    bag = tmp_path / "old.bag"
    write_bag(bag, {topic: [(1, ("a",), (0,)), (2, ("a",), (1,))] for topic in ("/left", "/right")})
    with pytest.raises(BagError, match=re.escape(expected)):
        read_recording(bag, **options)


def test_a_damaged_bag_is_named(tmp_path):
    bag = tmp_path / "old.bag"
    write_bag(bag, {"/joint_states": [(1, ("a",), (0,))]})
    content = bag.read_bytes()
    for damaged in (content[: len(content) // 2], b"nonsense", b""):
        bag.write_bytes(damaged)
        with pytest.raises(BagError, match=r"old\.bag: can't be read as a ROS 1 recording"):
            read_recording(bag, ("a",))


def test_units_and_signs_are_stated_for_any_recording(tmp_path):
    bag, q = tmp_path / "old.bag", [(0, 90), (1, 180)]
    write_bag(bag, {"/joint_states": [(k + 1, ("a", "b"), q[k]) for k in range(2)]})
    messages = [joint_state(["a", "b"], p, 2 * np.array(p), 3 * np.array(p)) for p in q]
    form = LogFormat(scale=("q=1,deg", "effort=0.5"), sign=(1, -1))
    for path in (bag, write_messages(tmp_path / "new", messages)):
        log = read_recording(path, ("a", "b"), form=form)
        np.testing.assert_allclose(log.q, [[0, -np.pi / 2], [1, -np.pi]])
        np.testing.assert_allclose(log.qd, [[0, -180], [2, -360]])
        np.testing.assert_allclose(log.effort, [[0, -135], [1.5, -270]])
        with pytest.raises(BagError, match=r"scale: expected one of .*position.*, got current"):
            read_recording(path, ("a", "b"), form=LogFormat(scale=("i=2",)))

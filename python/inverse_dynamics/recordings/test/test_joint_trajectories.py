# SPDX-License-Identifier: Apache-2.0
import re

import numpy as np
import pytest
from example_recordings import (
    STORE,
    TOPIC,
    TRAJECTORY,
    joint_state,
    points_of_motion,
    trajectory,
    write_trajectories,
)
from example_robots import JOINTS
from rosbags.rosbag2 import StoragePlugin, Writer

from inverse_dynamics import evaluate, read_recording
from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.joint_trajectories import decode


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_one_message_is_a_recording_with_given_accelerations(tmp_path, torques, storage):
    backwards = [
        (since, *(a[::-1] for a in arrays)) for since, *arrays in points_of_motion(effort=torques)
    ]
    message = trajectory(JOINTS[::-1], backwards, stamp=5 * 10**9)
    bag = write_trajectories(tmp_path / "bag", [message], storage=storage)
    result = evaluate(bag, "ur10_simulated")
    assert result.accelerations.method == "given"
    assert result.log.topic == TOPIC
    assert result.log.frame_id == "base"
    assert result.log.stamps[0] == 5 * 10**9
    assert result.time[-1] == pytest.approx(1499 / 250)
    assert max(error.max_abs for error in result.errors) < 1e-9  # rounding


@pytest.mark.parametrize(("stamp", "clock"), [(10**9, "header"), (0, "receive")])
def test_messages_of_one_point_are_joined_by_their_stamps(tmp_path, stamp, clock):
    messages = [
        trajectory(["a"], [(4, [k], [0], [0], [2 * k])], stamp=stamp and stamp + 10 * k)
        for k in range(5)
    ]
    empty = trajectory(["a"], [])
    log = read_recording(write_trajectories(tmp_path / "bag", [empty, *messages]))
    assert log.clock == clock
    steps = 10 * np.arange(5) if stamp else 10**6 * np.arange(5)
    np.testing.assert_array_equal(log.stamps - log.stamps[0], steps)
    np.testing.assert_array_equal(log.effort[:, 0], 2.0 * np.arange(5))
    assert log.notes[0] == "1 of 6 messages left out: no points"


def test_joint_states_go_first_and_a_topic_that_is_named_before_them(tmp_path):
    path = tmp_path / "bag"
    with Writer(path, version=9) as writer:
        for topic, kind, message in (
            ("/arm", "sensor_msgs/msg/JointState", joint_state(["a"], [1], [1], [1])),
            (TOPIC, TRAJECTORY, trajectory(["a"], [(0, [2], [2], [2], [2])])),
        ):
            connection = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connection, 10, STORE.serialize_cdr(message, kind))
    assert read_recording(path).topic == "/arm"
    assert read_recording(path, topic=TOPIC).qdd[0, 0] == 2
    assert read_recording(path, usual_topic=TOPIC).topic == TOPIC
    assert read_recording(path, usual_topic="/other").topic == "/arm"


ONE = (0, [1], [1], [1], [1])


@pytest.mark.parametrize(
    ("messages", "expected"),
    [
        (
            [trajectory(["a"], [ONE, (1, [1], [], [1], [1])])],
            "message 1, point 2: velocities: expected 1 numbers, one per joint, got 0: none for "
            "joint a; joint velocities are needed",
        ),
        (
            [trajectory(["a"], [ONE, (1, [1], [1], [], [1])])],
            "message 1, point 2: accelerations: expected 1 numbers, one per joint, got 0: none for "
            "joint a; other points have them",
        ),
        ([trajectory(["a"], [(0, [1], [1], [1], [])])], "`ids torques` computes them"),
        (
            [trajectory(["a", "b"], [(0, [1, 1], [1, 1], [1, 1], [1])])],
            "point 1: effort: expected 2 numbers, one per joint, got 1: none for joint b",
        ),
        (
            [trajectory(["a"], [ONE, ONE]), trajectory(["a"], [ONE])],
            "expected one trajectory, or messages of one point each, got 2 messages with up to 2 "
            "points: it isn't known which of them belong together; `ids torques` takes any number",
        ),
        ([trajectory(["a"], [(0, [np.nan], [1], [1], [1])])], "positions of joint a: expected a f"),
        ([trajectory(["b"], [ONE])], "expected the joints a, got b; missing: a; give the"),
        (
            [trajectory(["a", "a"], [(0, *[[1, 1]] * 4)])],
            "expected each joint once, got a, a",
        ),
        ([trajectory(["a"], [])], "expected points, got none in any message"),
        ([], "expected trajectories, got no message"),
    ],
)
def test_what_is_wrong_with_a_trajectory_is_said(tmp_path, messages, expected):
    bag = write_trajectories(tmp_path / "bag", messages)
    with pytest.raises(BagError, match=re.escape(expected)) as caught:
        read_recording(bag, ["a"])
    assert str(caught.value).startswith(f"{bag}: {TOPIC}")


def record(path, raw):
    with Writer(path, version=9) as writer:
        connection = writer.add_connection(TOPIC, TRAJECTORY, typestore=STORE)
        writer.write(connection, 10, raw)
    return path


@pytest.mark.parametrize("little_endian", [True, False])
@pytest.mark.parametrize("more", [0, 4, 8, 100])
def test_bytes_after_a_message_are_ignored(tmp_path, more, little_endian):
    raw = STORE.serialize_cdr(trajectory(["a"], [ONE]), TRAJECTORY, little_endian=little_endian)
    log = read_recording(record(tmp_path / "bag", bytes(raw) + b"\xee" * more))
    assert log.joint_names == ("a",)
    np.testing.assert_array_equal(log.effort, [[1]])


def test_a_message_that_is_cut_off_anywhere_is_refused(tmp_path):
    raw = bytes(STORE.serialize_cdr(trajectory(["a"], [ONE]), TRAJECTORY))
    for size in range(len(raw)):
        with pytest.raises(BagError, match="can't be decoded"):
            decode(raw[:size], "bag", TOPIC, 0)

# SPDX-License-Identifier: Apache-2.0
"""Joint states that are split over topics or messages, in bags that the package rosbags wrote."""

import re

import numpy as np
import pytest
from example_recordings import JOINT_STATE, STORE, joint_state
from rosbags.rosbag2 import StoragePlugin, Writer

from inverse_dynamics import read_recording
from inverse_dynamics.errors import BagError

STORAGES = pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
SMOOTH = 2e-6  # rad: what straight lines over 10 ms leave of 0.3 Hz: (2 pi f h)^2 / 8
START = 10**9  # ns


def states(k, names=("a", "b"), start=START, period=10_000_000, fields="pve"):
    """Message k of some joints, and its stamp: sines whose phase is the name's."""
    stamp = start + k * period
    angle = 1e-9 * stamp + np.array([float(ord(name[0])) for name in names])
    numbers = {"p": np.sin(angle), "v": np.cos(angle), "e": 2 * np.sin(angle)}
    return stamp, joint_state(
        list(names), *(numbers[f] if f in fields else [] for f in "pve"), stamp
    )


def write(path, topics, storage=StoragePlugin.SQLITE3):
    """topics: name to (stamp, message)."""
    with Writer(path, version=9, storage_plugin=storage) as writer:
        there = {t: writer.add_connection(t, JOINT_STATE, typestore=STORE) for t in topics}
        messages = [(stamp, t, m) for t, each in topics.items() for stamp, m in each]
        for stamp, topic, message in sorted(messages, key=lambda each: each[:2]):
            writer.write(there[topic], stamp, STORE.serialize_cdr(message, JOINT_STATE))
    return path


def sines(log, times):
    """What q of a log should be at stamps."""
    return np.sin(1e-9 * times[:, None] + [float(ord(name[0])) for name in log.joint_names])


@STORAGES
def test_joints_on_two_topics_have_the_times_of_the_slower_one(tmp_path, storage):
    left = [states(k, ("a", "b")) for k in range(100)]
    right = [states(k, ("grip", "c"), START - 1_700_000, 3_000_000) for k in range(340)]
    bag = write(tmp_path / "bag", {"/left": left, "/right": right}, storage)
    log = read_recording(bag, ("c", "a", "b"))
    assert log.topic == "/left+/right"
    np.testing.assert_array_equal(log.header_stamps, [stamp for stamp, _ in left])
    np.testing.assert_array_equal(log.q[:, 1:], [m.position for _, m in left])
    np.testing.assert_allclose(log.q, sines(log, log.header_stamps), atol=SMOOTH)
    np.testing.assert_allclose(log.effort, 2 * log.q, atol=1e-12)
    assert log.notes == (
        "joint states are merged: position, velocity, effort of a, b from /left, at its times; "
        "position, velocity, effort of c from /right, on straight lines between its messages",
    )
    for topic in ("/left+/right", "/right+/left"):
        np.testing.assert_array_equal(read_recording(bag, log.joint_names, topic=topic).q, log.q)


@STORAGES
def test_efforts_may_be_on_a_topic_of_their_own(tmp_path, storage):
    motions = [states(k, fields="pv") for k in range(50)]
    efforts = [states(k, ("b", "a"), fields="e") for k in range(50)]
    bag = write(tmp_path / "bag", {"/joint_states": motions, "/torques": efforts}, storage)
    log = read_recording(bag, ("a", "b"), usual_topic="/joint_states")
    np.testing.assert_array_equal(log.effort, 2 * sines(log, log.header_stamps))
    assert log.topic == "/joint_states+/torques"


def test_messages_of_one_topic_are_merged(tmp_path):
    arm = [states(k, (name,)) for k in range(20) for name in "ab"]
    log = read_recording(write(tmp_path / "bag", {"/joint_states": arm}), ("b", "a"))
    np.testing.assert_array_equal(log.q, sines(log, log.header_stamps))
    assert (len(log), log.topic) == (20, "/joint_states")


def test_a_gap_is_not_bridged(tmp_path):
    left = [states(k, ("a",)) for k in range(100)]
    right = [states(k, ("b",), START + 4_000_000) for k in range(100) if not 40 <= k < 42]
    log = read_recording(write(tmp_path / "bag", {"/left": left, "/right": right}), ("a", "b"))
    expected = [k for k in range(1, 100) if not 40 <= k <= 42]
    np.testing.assert_array_equal(log.header_stamps, [left[k][0] for k in expected])
    assert "4 of 100 messages of /left left out, at whose times others have a gap" in log.notes[0]
    assert log.notes[0].endswith("of more than 0.015 s")


def test_no_number_lies_between_two_turns(tmp_path):
    left = [states(k, ("a",)) for k in range(40)]
    right = [states(k, ("b",), START + 3_000_000) for k in range(40)]
    for k, (_, message) in enumerate(right):
        message.position[0] = 3.1 + 0.01 * k - (2 * np.pi if k > 4 else 0)
    log = read_recording(write(tmp_path / "bag", {"/left": left, "/right": right}), ("a", "b"))
    assert np.abs(log.q[:, 1]).min() > 2.75


def test_the_topic_that_has_everything_is_taken(tmp_path):
    bag = write(
        tmp_path / "bag",
        {"/hand": [states(k, ("f",)) for k in range(9)], "/arm": [states(k) for k in range(9)]},
    )
    log = read_recording(bag, ("a", "b"), usual_topic="/joint_states")
    assert (log.topic, log.notes) == ("/arm", ())


@pytest.mark.parametrize(
    ("right", "topic", "expected"),
    [
        (
            {"names": ("b", "c")},
            "",
            "expected position of b on one topic, got it on /left and on /right; name the topics",
        ),
        (
            {"names": ("c",), "start": 5 * START},
            "",
            "/left+/right: expected messages at the same times, got none between two messages of the "
            "others that are no more than 0.015 s apart, by the stamps of header: /left from "
            "1.000000000 s to 1.490000000 s, /right from 5.000000000 s",
        ),
        ({"names": ("d",)}, "/left+/right", "/left+/right: expected effort of c, got none"),
        ({"names": ("c",)}, "/left+/up", "has no topic /up; name one it has with topic="),
        ({"names": ("c",)}, "/left", "missing: c; give the recording's names"),
    ],
)
def test_topics_that_cannot_be_merged_are_refused(tmp_path, right, topic, expected):
    topics = {
        "/left": [states(k) for k in range(50)],
        "/right": [states(k, **right) for k in range(50)],
    }
    with pytest.raises(BagError, match=re.escape(expected)):
        read_recording(write(tmp_path / "bag", topics), ("a", "b", "c"), topic=topic)

# SPDX-License-Identifier: Apache-2.0
"""Joint states from ROS 1 recordings (.bag), by the package rosbags.

log = read_ros1_log(Path("old.bag"), ["joint_1", "joint_2"])
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.base.extras import require
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.wording import counted, harmless, listed
from inverse_dynamics.data.joint_log import JointLog
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Clock

MESSAGE_TYPE = "sensor_msgs/msg/JointState"
SUFFIX = ".bag"


def is_ros1_bag(path: Path) -> bool:
    """Whether the name is that of a ROS 1 recording."""
    return path.suffix.lower() == SUFFIX and path.is_file()


def read_ros1_log(
    path: Path,
    joints: Sequence[str] = (),
    *,
    topic: str = "",
    clock: Clock = "auto",
    progress: Progress = no_progress,
) -> JointLog:
    """Joint states of one topic; none given: of the only one with any.

    joints: none: those of the first message. Messages without all of them are left out and counted.
    clock: which stamps are the time; auto: those of the header, if there are any. Raises BagError,
    MissingPackageError.
    """
    require("a ROS 1 recording", "rosbags")
    from rosbags.rosbag1 import Reader, ReaderError
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    try:
        with Reader(path) as reader:
            connections = [c for c in reader.connections if c.msgtype == MESSAGE_TYPE]
            topic = _only_topic(path, connections, topic, [c.topic for c in reader.connections])
            chosen = [c for c in connections if c.topic == topic]
            total = sum(c.msgcount for c in chosen)
            messages = []
            for connection, received, raw in reader.messages(chosen):
                messages.append((received, store.deserialize_ros1(raw, connection.msgtype)))
                if len(messages) % 1000 == 0:
                    progress("reading", len(messages), total)
    except (ReaderError, OSError, ValueError, AssertionError, KeyError, IndexError) as error:
        raise BagError(
            f"{path}: can't be read as a ROS 1 recording ({harmless(error, 200)}): it is damaged or of "
            f"another kind; `rosbag reindex {path}` may mend it"
        ) from error
    return _log(messages, joints, f"{path}: {topic}", topic, clock)


def _only_topic(path: Path, connections: Sequence[Any], topic: str, others: Sequence[str]) -> str:
    topics = sorted({c.topic for c in connections})
    if topic and topic not in topics:
        raise BagError(
            f"{path}: expected joint states on {topic}, got topics {listed(sorted(set(others)), 20)}"
        )
    if not topic and len(topics) != 1:
        raise BagError(
            f"{path}: expected one topic of {MESSAGE_TYPE}, got {listed(topics, 20) or 'none'}; the "
            f"recording has {listed(sorted(set(others)), 20)}; name one with --topic"
        )
    return topic or topics[0]


def _log(
    messages: Sequence[tuple[int, Any]], joints: Sequence[str], where: str, topic: str, clock: Clock
) -> JointLog:
    if not messages:
        raise BagError(f"{where}: expected joint states, got no message; record it again")
    joints = tuple(joints) or tuple(messages[0][1].name)
    kept = [(t, m) for t, m in messages if _has(m, joints)]
    if not kept:
        names = sorted({name for _, message in messages for name in message.name})
        raise BagError(
            f"{where}: expected messages with positions, velocities and efforts of {listed(joints, 20)}, got "
            f"none; joints of the recording: {listed(names, 20)}; give the recording's names with --joints"
        )
    columns: dict[str, Any] = {"position": [], "velocity": [], "effort": []}
    for _, message in kept:
        order = [message.name.index(joint) for joint in joints]
        for name, rows in columns.items():
            rows.append(getattr(message, name)[order])
    header = np.array([m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for _, m in kept])
    if clock == "auto":
        clock = "header" if header.any() else "receive"
    left_out = len(messages) - len(kept)
    return JointLog(
        joint_names=joints,
        header_stamps=header,
        receive_stamps=np.array([received for received, _ in kept]),
        q=np.array(columns["position"]),
        qd=np.array(columns["velocity"]),
        effort=np.array(columns["effort"]),
        frame_id=kept[0][1].header.frame_id,
        clock=clock,
        topic=topic,
        notes=(f"{counted(left_out, 'message')} without all joints left out",) if left_out else (),
    )


def _has(message: Any, joints: Sequence[str]) -> bool:
    """Whether it has all values of all the joints."""
    return set(joints) <= set(message.name) and all(
        len(values) == len(message.name)
        for values in (message.position, message.velocity, message.effort)
    )

# SPDX-License-Identifier: Apache-2.0
"""Trajectories (trajectory_msgs/JointTrajectory, control_msgs/JointWrenchTrajectory) of rosbag2 recordings.

A message is a trajectory of N points. As a recording, a point is a sample: one message with all
points, or messages of one point each, joined by their stamps. A point's stamp is that of its
message plus its time from start.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import Recording
from inverse_dynamics.decimals import LARGEST
from inverse_dynamics.errors import BagError
from inverse_dynamics.installation.extras import require
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.bags import error_text
from inverse_dynamics.recordings.joint_log import JointLog

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from rosbags.typesys.store import Typestore

    from inverse_dynamics.arrays import Floats, Integers
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Clock, Storage

MESSAGE_TYPE = "trajectory_msgs/msg/JointTrajectory"
WRENCH_TYPE = "control_msgs/msg/JointWrenchTrajectory"  # in ROS 2 from kilted on
FIELDS = ("positions", "velocities", "accelerations", "effort")

_EFFORT_NEEDED = (
    "measured efforts are what computed torques are compared with; where there are none, `ids torques` "
    "computes them"
)


@dataclass(frozen=True)
class JointTrajectory:
    """A message: N points, n joints in its own order; rad, rad/s, rad/s^2, N m (prismatic m, N)."""

    where: str  # file, topic and number of the message, for error texts
    topic: str
    joint_names: tuple[str, ...]
    frame_id: str
    stamp: int  # ns, of the header
    received: int  # ns
    time_from_start: Integers  # (N,) ns
    message_type: str
    message: Any  # as decoded
    points: list[Any]  # (N,) of it: trajectory_msgs/JointTrajectoryPoint

    def __len__(self) -> int:
        return len(self.time_from_start)

    def has(self, field: str) -> bool:
        """Whether any point has numbers in this one of FIELDS."""
        return any(len(getattr(point, field)) for point in self.points)

    def wrenches(self) -> tuple[list[str], Floats]:
        """Frame of each point, and (N, 6) force [N] and torque [N m] that the robot exerts, in it.

        No frame where there is no wrench. Raises BagError: a frame or a number is missing.
        """
        frames, values = [""] * len(self), np.zeros((len(self), 6))
        if self.message_type != WRENCH_TYPE:
            return frames, values
        for k, point in enumerate(self.message.points):
            framed = point.wrench
            force, torque = framed.wrench.force, framed.wrench.torque
            values[k] = force.x, force.y, force.z, torque.x, torque.y, torque.z
            if not values[k].any():
                continue
            frames[k] = framed.frame_id
            if not framed.frame_id or not np.isfinite(values[k]).all():
                raise BagError(
                    f"{self.where}, point {k + 1}: wrench: expected six finite numbers and a frame_id, got "
                    f"{values[k].tolist()} in '{framed.frame_id}'; set frame_id to the link that exerts it"
                )
        return frames, values

    def numbers(self, field: str, joints: Sequence[str], reason: str = "") -> Floats:
        """(N, len(joints)) of one of FIELDS. Raises BagError where a number is missing."""
        names = self.joint_names
        if missing := [joint for joint in joints if joint not in names]:
            raise BagError(
                f"{self.where}: expected the joints {', '.join(joints)}, got {', '.join(names)}; "
                f"missing: {', '.join(missing)}; give the trajectory's names with --joints, in the "
                "order of the chain"
            )
        if len(set(names)) < len(names):
            raise BagError(f"{self.where}: expected each joint once, got {', '.join(names)}")
        columns = [names.index(joint) for joint in joints]
        values = np.empty((len(self), len(joints)))
        for k, point in enumerate(self.points):
            row = getattr(point, field)
            if len(row) != len(names):
                without = f": none for joint {names[len(row)]}" if len(row) < len(names) else ""
                raise BagError(
                    f"{self.where}, point {k + 1}: {field}: expected {len(names)} numbers, one per "
                    f"joint, got {len(row)}{without}{reason and f'; {reason}'}"
                )
            values[k] = row[columns]
        wrong = ~(np.abs(values) <= LARGEST)
        if wrong.any():
            k, j = (int(i) for i in np.argwhere(wrong)[0])
            raise BagError(
                f"{self.where}, point {k + 1}: {field} of joint {joints[j]}: expected a finite number "
                f"of a motion, in SI units, of at most {LARGEST:g}, got {values[k, j]:g}; is it damaged?"
            )
        return values


def read_joint_trajectories(
    path: Path,
    topic: str = "",
    progress: Progress = no_progress,
    types: Sequence[str] = (MESSAGE_TYPE,),
) -> list[JointTrajectory]:
    """Messages of one topic; none given: of the only one with trajectories. Raises BagError.

    types: MESSAGE_TYPE, WRENCH_TYPE.
    """
    recording = Recording(path)
    there = {
        name: kind
        for name, kind, count in recording.topics()
        if kind in types and (count or name == topic)
    }
    if not topic and len(set(there.values())) > 1:
        raise BagError(
            f"{path}: expected one topic with trajectories, got {', '.join(there)}; name it with --topic"
        )
    message_type = there.get(topic, next(iter(there.values()), types[0]))
    topic = recording.topic_of_type(message_type, topic)
    where = f"{path}: {topic}"
    found: list[JointTrajectory] = []
    for _, received, messages in recording.messages(topic):
        for raw, stamp in zip(messages, received, strict=True):
            number = f"{where}, message {len(found) + 1}"
            found.append(decode(raw, number, topic, stamp, message_type))
        progress("reading", len(found), recording.expected_messages(topic))
    if not found:
        raise BagError(f"{where}: expected trajectories, got no message; record it again")
    return found


def decode(
    raw: bytes, where: str, topic: str, received: int, message_type: str = MESSAGE_TYPE
) -> JointTrajectory:
    """Decode a message. Raises BagError."""
    try:
        message = _deserialized(raw, message_type)
    except Exception as error:  # whatever a decoder makes of a damaged message
        raise BagError(
            f"{where}: can't be decoded as {message_type} ({error_text(error)}): the recording is "
            "damaged; copy or record it again"
        ) from error
    points = message.points
    if message_type == WRENCH_TYPE:
        points = [point.point for point in points]
    times = [_nanoseconds(point.time_from_start) for point in points]
    return JointTrajectory(
        where=where,
        topic=topic,
        joint_names=tuple(message.joint_names),
        frame_id=message.header.frame_id,
        stamp=_nanoseconds(message.header.stamp),
        received=received,
        time_from_start=np.array(times, dtype=np.int64),
        message_type=message_type,
        message=message,
        points=points,
    )


def _deserialized(raw: bytes, message_type: str) -> Any:
    """The message that bytes begin with.

    Serializers append bytes of no meaning. ROS's own readers ignore what follows a message; rosbags'
    deserialize_cdr allows three bytes.
    """
    if raw[:2] not in (b"\0\0", b"\0\1"):
        raise ValueError("it doesn't begin with the encapsulation of plain CDR")
    definition = typestore().get_msgdef(message_type)
    read = definition.deserialize_cdr_le if raw[1] else definition.deserialize_cdr_be
    message, _ = read(raw[4:], 0, definition.cls, typestore())
    return message


def of_one_motion(trajectories: Sequence[JointTrajectory], remedy: str) -> list[JointTrajectory]:
    """Those with points. Raises BagError unless one has all points, or each has one."""
    where = trajectories[0].where.rpartition(",")[0]
    filled = [trajectory for trajectory in trajectories if len(trajectory)]
    if not filled:
        raise BagError(f"{where}: expected points, got none in any message; record it again")
    most = max(map(len, filled))
    if len(filled) > 1 and most > 1:
        raise BagError(
            f"{where}: expected one trajectory, or messages of one point each, got {len(filled)} "
            f"messages with up to {most} points: it isn't known which of them belong together; {remedy}"
        )
    return filled


def joint_log_of(
    trajectories: Sequence[JointTrajectory],
    joints: Sequence[str],
    clock: Clock,
    topic: str,
    storage: Storage,
) -> JointLog:
    """The points as samples, with accelerations if they have any. Raises BagError."""
    notes = []
    filled = of_one_motion(trajectories, "`ids torques` takes any number of trajectories")
    if len(filled) < len(trajectories):
        notes.append(
            f"{len(trajectories) - len(filled)} of {len(trajectories)} messages left out: no points"
        )
    joints = tuple(joints) or filled[0].joint_names

    def joined(field: str, reason: str) -> Floats:
        return np.concatenate([each.numbers(field, joints, reason) for each in filled])

    given = any(trajectory.has("accelerations") for trajectory in filled)
    since = np.concatenate([trajectory.time_from_start for trajectory in filled])
    counts = [len(trajectory) for trajectory in filled]
    header = np.repeat([trajectory.stamp for trajectory in filled], counts)
    if clock == "auto":
        clock = "header"
        if len(filled) > 1 and not header.any():
            clock = "receive"
            notes.append("no header has a stamp: the time of reception is used")
    return JointLog(
        joint_names=joints,
        header_stamps=header + since,
        receive_stamps=np.repeat([trajectory.received for trajectory in filled], counts) + since,
        q=joined("positions", "joint positions are needed"),
        qd=joined("velocities", "joint velocities are needed"),
        effort=joined("effort", _EFFORT_NEEDED),
        qdd=joined("accelerations", "other points have them") if given else None,
        frame_id=filled[0].frame_id,
        clock=clock,
        topic=topic,
        storage=storage,
        notes=tuple(notes),
    )


def _nanoseconds(time: Any) -> int:
    return int(time.sec) * 10**9 + int(time.nanosec)


_WRENCH_DEFINITIONS = {
    "control_msgs/msg/WrenchFramed": "string frame_id\ngeometry_msgs/Wrench wrench",
    "control_msgs/msg/JointWrenchTrajectoryPoint": "trajectory_msgs/JointTrajectoryPoint point\n"
    "control_msgs/WrenchFramed wrench",
    WRENCH_TYPE: "std_msgs/Header header\nstring[] joint_names\n"
    "control_msgs/JointWrenchTrajectoryPoint[] points",
}


@cache
def typestore() -> Typestore:
    """Definitions of messages. Those of trajectories are the same in every ROS 2 release."""
    require("a recording of trajectories", "rosbags")
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in _WRENCH_DEFINITIONS.items():
        store.register(get_types_from_msg(text, name))
    return store

# SPDX-License-Identifier: Apache-2.0
"""Recordings, tables and trajectories that tests make for themselves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from example_robots import JOINTS
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from inverse_dynamics import Solver, write_joint_logs
from inverse_dynamics.recordings.joint_log import JointLog

STORE = get_typestore(Stores.ROS2_HUMBLE)
JOINT_STATE = "sensor_msgs/msg/JointState"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
TOPIC = "/planned"


def joint_log(samples: int = 50, joints: int = 3, **changes: object) -> JointLog:
    """A smooth motion at 100 Hz; `changes` replace fields."""
    stamps = 10_000_000 * np.arange(1, samples + 1, dtype=np.int64)
    phase = stamps[:, None] * 1e-9 + np.arange(joints)
    fields = {
        "joint_names": tuple(f"joint_{i + 1}" for i in range(joints)),
        "header_stamps": stamps,
        "receive_stamps": stamps + 500_000,
        "q": np.sin(phase),
        "qd": np.cos(phase),
        "effort": 10.0 * np.sin(2 * phase),
    }
    return JointLog(**{**fields, **changes})


def joint_state(
    names: list[str],
    position: list[float],
    velocity: list[float],
    effort: list[float],
    stamp: int = 0,
    frame_id: str = "",
) -> object:
    """A message as the rosbags library has it."""
    types = STORE.types
    time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    header = types["std_msgs/msg/Header"](stamp=time, frame_id=frame_id)
    arrays = (np.array(a, dtype=np.float64) for a in (position, velocity, effort))
    return types[JOINT_STATE](header, names, *arrays)


def write_messages(
    path: Path,
    messages: list[object],
    *,
    topic: str = "/joint_states",
    message_type: str = JOINT_STATE,
    storage: StoragePlugin = StoragePlugin.SQLITE3,
) -> Path:
    """Record messages one by one, the k-th received at k ms; independent of what is tested."""
    with Writer(path, version=9, storage_plugin=storage) as writer:
        connection = writer.add_connection(topic, message_type, typestore=STORE)
        for k, message in enumerate(messages):
            raw = STORE.serialize_cdr(message, message_type)
            writer.write(connection, (k + 1) * 1_000_000, raw)
    return path


def damaged(content: bytes, count: int, seed: int = 0) -> Iterator[bytes]:
    """The content with bytes replaced, left out or put in a second time; the same for the same seed."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        changed = bytearray(content)
        for _ in range(random.integers(1, 8)):
            place, end = (int(k) for k in np.sort(random.integers(0, len(changed), 2)))
            kind = random.integers(3)
            if kind == 0:
                changed[place] = random.integers(256)
            elif kind == 1:
                del changed[place : min(end, place + 20)]
            else:
                changed[place:place] = changed[place : min(end, place + 50)]
        yield bytes(changed)


def motion(samples: int = 1500, rate: float = 250.0) -> tuple[np.ndarray, ...]:
    """Smooth q, qd, qdd (N, 6) and stamps [ns] of a UR10."""
    stamps = np.round(1e9 / rate * np.arange(1, samples + 1)).astype(np.int64)
    speed = 2 * np.pi * np.array([0.20, 0.15, 0.25, 0.30, 0.35, 0.40])
    phase = stamps[:, None] * 1e-9 * speed + np.arange(6)
    return np.sin(phase), speed * np.cos(phase), -(speed**2) * np.sin(phase), stamps


def recording(path: Path, solver: Solver, **changes: object) -> JointLog:
    """Record the motion with the efforts that a solver computes for it."""
    q, qd, qdd, stamps = motion()
    log = JointLog(JOINTS, stamps, stamps, q, qd, solver.torques(q, qd, qdd))
    log = replace(log, **changes)
    write_joint_logs(path, {log.topic: log})
    return log


def trajectory(names, points, stamp=0):
    """points: (time from start [ns], positions, velocities, accelerations, effort)."""
    types = STORE.types
    made = []
    for since, *arrays in points:
        duration = types["builtin_interfaces/msg/Duration"](
            sec=int(since) // 10**9, nanosec=int(since) % 10**9
        )
        arrays = [np.array(a, dtype=np.float64) for a in arrays]
        made.append(types["trajectory_msgs/msg/JointTrajectoryPoint"](*arrays, duration))
    time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    header = types["std_msgs/msg/Header"](stamp=time, frame_id="base")
    return types[TRAJECTORY](header, list(names), made)


def write_trajectories(path, messages, **options):
    return write_messages(path, messages, topic=TOPIC, message_type=TRAJECTORY, **options)


def points_of_motion(accelerations=True, effort=None):
    q, qd, qdd, stamps = motion()
    none = np.zeros((len(q), 0))
    return list(
        zip(
            stamps - stamps[0],
            q,
            qd,
            qdd if accelerations else none,
            none if effort is None else effort,
            strict=True,
        )
    )


def write_motion(path, joints, time, **kinds):
    """A table of arrays (N, n) by kind: position, velocity, ..."""
    names = ["time", *(f"{kind}.{joint}" for kind in kinds for joint in joints)]
    rows = np.column_stack([time, *kinds.values()])
    np.savetxt(path, rows, "%.17g", ",", header=",".join(names), comments="")
    return path


def write_table(path, columns, delimiter=","):
    """Columns by name; all digits."""
    lines = [delimiter.join(columns)]
    lines += [
        delimiter.join(map(repr, row)) for row in np.column_stack([*columns.values()]).tolist()
    ]
    path.write_text("\n".join(lines) + "\n")


def table_of(effort, accelerations=None):
    """The motion of a UR10, joints from the last to the first."""
    q, qd, _, stamps = motion()
    columns = {"spare": 0.0 * stamps}
    given = {"effort": effort, "velocity": qd, "position": q}
    if accelerations is not None:
        given["acceleration"] = accelerations
    for kind, values in given.items():
        for i in reversed(range(6)):
            columns[f"{kind}.{JOINTS[i]}"] = values[:, i]
    return {**columns, "time": stamps * 1e-9}

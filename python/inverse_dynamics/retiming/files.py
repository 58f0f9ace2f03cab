# SPDX-License-Identifier: Apache-2.0
"""A timed path as a trajectory to send: a JointTrajectory with efforts in a recording, and a table."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.errors import BagError
from inverse_dynamics.outputs.files import move_up, write_text
from inverse_dynamics.recordings.bags import new_recording, unwritable
from inverse_dynamics.recordings.joint_trajectories import MESSAGE_TYPE, typestore

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.recordings.joint_log import Storage
    from inverse_dynamics.retiming.retiming import Retimed

TABLE = "trajectory.csv"
TOPIC = "/joint_trajectory"
FILES = (TABLE, "metadata.yaml", "{name}.db3*", "{name}.mcap")


def write_trajectory(result: Retimed, directory: Path, storage: Storage) -> None:
    """Write the FILES. Raises BagError."""
    bag = directory / directory.name
    try:
        with new_recording(bag, storage) as writer:
            topic = writer.add_connection(TOPIC, MESSAGE_TYPE, typestore=typestore())
            writer.write(topic, 0, typestore().serialize_cdr(message_of(result), MESSAGE_TYPE))
    except Exception as error:  # writers raise more than they document
        raise error if isinstance(error, BagError) else unwritable(directory, error) from error
    move_up(bag)
    write_text(directory / TABLE, table_text(result))


def message_of(result: Retimed) -> Any:
    """The motion as trajectory_msgs/JointTrajectory, of the types of rosbags."""
    types = typestore().types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "")
    point = types["trajectory_msgs/msg/JointTrajectoryPoint"]
    duration = types["builtin_interfaces/msg/Duration"]
    states = (result.q, result.qd, result.qdd, result.efforts)
    points = [
        point(
            *(np.ascontiguousarray(row) for row in rows),
            duration(int(ns // 10**9), int(ns % 10**9)),
        )
        for *rows, ns in zip(*states, np.round(result.time * 1e9).astype(np.int64), strict=True)
    ]
    return types[MESSAGE_TYPE](header, list(result.joint_names), points)


def table_text(result: Retimed) -> str:
    """The motion as a table that `ids torques` reads."""
    names = ("position", "velocity", "acceleration", "effort")
    columns = [f"{name}.{joint}" for name in names for joint in result.joint_names]
    rows = np.column_stack((result.time, result.q, result.qd, result.qdd, result.efforts))
    text = io.StringIO()
    np.savetxt(text, rows, "%.17g", ",", header=",".join(("time", *columns)), comments="")
    return text.getvalue()

# SPDX-License-Identifier: Apache-2.0
"""Files of a timed path: a JointTrajectory with efforts as a recording and a table, numbers, a figure, a page."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.errors import BagError
from inverse_dynamics.outputs.files import Contents, move_up, write_text, written_whole
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.recordings.bags import new_recording, unwritable
from inverse_dynamics.recordings.joint_trajectories import MESSAGE_TYPE, typestore
from inverse_dynamics.retiming.figure import retime_figure
from inverse_dynamics.retiming.page import render_retimed_page
from inverse_dynamics.show.plots import check_formats, save_figure

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from inverse_dynamics.recordings.joint_log import Storage
    from inverse_dynamics.retiming.retiming import Retimed

MARK = "retime.json"
TABLE = "trajectory.csv"
TOPIC = "/joint_trajectory"
PAGE = "report.html"
CONTENTS = Contents(
    MARK, (MARK, TABLE, PAGE, "torques.*", "metadata.yaml", "{name}.db3*", "{name}.mcap")
)


def write_retimed(
    result: Retimed,
    out: Path | str,
    *,
    overwrite: bool = False,
    figures: Sequence[str] = ("png",),
    storage: Storage = "sqlite3",
    inputs: Iterable[Path | None] = (),
) -> None:
    """Write the recording, table, figure and page of a timed path, or none of them.

    Parameters
    ----------
    overwrite
        Replace an older result.
    figures, storage
        As in write_evaluation().
    inputs
        Files that must not be overwritten.

    Raises
    ------
    UserError
        OutputError, BagError.
    """
    out = Path(out)
    check_formats(figures)
    with written_whole(out, overwrite=overwrite, contents=CONTENTS, inputs=inputs) as directory:
        try:
            with new_recording(directory / out.name, storage) as writer:
                topic = writer.add_connection(TOPIC, MESSAGE_TYPE, typestore=typestore())
                writer.write(topic, 0, typestore().serialize_cdr(message_of(result), MESSAGE_TYPE))
        except Exception as error:  # writers raise more than they document
            raise error if isinstance(error, BagError) else unwritable(out, error) from error
        move_up(directory / out.name)
        write_text(directory / TABLE, table_text(result))
        files = (directory / f"torques.{suffix}" for suffix in figures)
        save_figure(lambda: retime_figure(result), *files)
        write_text(directory / PAGE, render_retimed_page(result))
        write_text(directory / MARK, json_text(summary(result)))


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


def summary(result: Retimed) -> dict[str, Any]:
    """Durations, limits and loads, for JSON."""
    peak = np.abs(result.efforts).argmax(axis=0)
    return {
        "schema": 1,
        "robot": result.robot.name,
        "plugin": result.robot.plugin,
        "duration": result.duration,
        "duration_by_acceleration": result.duration + result.seconds_saved,
        "acceleration": result.acceleration,
        **result.energy.numbers,
        "joints": [
            {
                "joint": joint,
                "unit": result.units[j],
                "limit": result.limits.torque[j],
                "band": result.band[j],
                "peak": result.efforts[peak[j], j],
                "peak_time": result.time[peak[j]],
                "peak_velocity": np.abs(result.qd[:, j]).max(),
                "at_limit": result.at_limit[j],
            }
            for j, joint in enumerate(result.joint_names)
        ],
        "notes": result.notes,
    }

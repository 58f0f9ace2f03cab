# SPDX-License-Identifier: Apache-2.0
"""Trajectories with their efforts filled in: what the file had, and nothing else changed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import Recording
from inverse_dynamics.errors import BagError, OutputError
from inverse_dynamics.outputs.files import (
    Contents,
    check_output_directory,
    check_output_file,
    move_up,
    write_text,
    write_text_whole,
    written_whole,
)
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.bags import new_recording, topics_of, unwritable
from inverse_dynamics.recordings.csv_table import CsvTable, is_csv
from inverse_dynamics.recordings.joint_trajectories import JointTrajectory, typestore

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rosbags.interfaces import Connection
    from rosbags.rosbag2 import Writer

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.feedforward.trajectory_torques import TrajectoryTorques
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.robots.robots import Robot


MARK = "torques.json"
CONTENTS = Contents(MARK, (MARK, "metadata.yaml", "{name}.db3*", "{name}.mcap"))


def check_output(path: Path, out: Path, robot: Robot, *, overwrite: bool = False) -> None:
    """Raise OutputError unless the copy of a file `path` may be made at `out`."""
    inputs = (path, *robot.files)
    if is_csv(path):
        if not is_csv(out):
            raise OutputError(
                f"{out}: expected a name ending in .csv or .txt, as {path.name} is a table"
            )
        check_output_file(out, overwrite=overwrite, inputs=inputs)
    else:
        check_output_directory(out, overwrite=overwrite, contents=CONTENTS, inputs=inputs)


def write_trajectory_torques(
    result: TrajectoryTorques,
    out: Path | str,
    *,
    overwrite: bool = False,
    progress: Progress = no_progress,
) -> tuple[str, ...]:
    """Write a copy of the file with the efforts filled in, whole or not at all.

    Other topics of a recording are copied, further columns of a table too; torques.json beside a
    recording says how efforts were computed, and each joint's load.

    Parameters
    ----------
    out
        Of the same kind as the file: a directory for a recording, a file for a table.
    overwrite
        Replace an older result.

    Returns
    -------
    tuple of str
        Notes.

    Raises
    ------
    UserError
        OutputError, BagError.
    """
    out = Path(out)
    check_output(result.path, out, result.robot, overwrite=overwrite)
    if is_csv(result.path):
        write_text_whole(out, "".join(_filled_lines(CsvTable(result.path), result)))
        return ()
    with written_whole(out, overwrite=overwrite, contents=CONTENTS) as directory:
        bag = directory / out.name
        try:
            notes = _write_bag(result, bag, progress)
        except BagError:
            raise
        except Exception as error:  # writers raise more than they document
            raise unwritable(out, error) from error
        move_up(bag)
        write_text(directory / MARK, json_text(result.numbers()))
    return notes


def _write_bag(result: TrajectoryTorques, path: Path, progress: Progress) -> tuple[str, ...]:
    from rosbags.rosbag2 import Reader

    filled = iter(zip(result.trajectories, result.torques, strict=True))
    recording = Recording(result.path)
    total = sum(topic.message_count for topic in topics_of(recording))
    done = 0
    with Reader(result.path) as reader, new_recording(path, recording.storage) as writer:
        # the reader knows definitions and qualities of service; Recording checks messages
        types = {c.topic: c.msgtype for c in reader.connections}
        copies = {c.topic: _copied(writer, c) for c in reader.connections}
        for topics, stamps, messages in recording.all_messages():
            for topic, received, raw in zip(topics, stamps, messages, strict=True):
                copy = copies[topic]
                if copy is None:
                    continue
                if topic == result.topic:
                    trajectory, torques = next(filled)
                    columns = [result.joint_names.index(n) for n in trajectory.joint_names]
                    writer.write(copy, received, _with_effort(trajectory, torques[:, columns]))
                else:
                    writer.write(copy, received, raw)
            done += len(messages)
            progress("writing", done, total)
    return tuple(
        f"topic {topic} left out: the recording doesn't define its type, {types[topic]}"
        for topic, copy in copies.items()
        if copy is None
    )


def _copied(writer: Writer, connection: Connection) -> Connection | None:
    """The same topic in the new recording; None if its type isn't known."""
    from rosbags.interfaces import MessageDefinitionFormat

    known = connection.msgtype in typestore().types
    defined = connection.msgdef.format == MessageDefinitionFormat.MSG and bool(connection.digest)
    if not known and not defined:
        return None
    ext: Any = connection.ext  # of rosbag2
    return writer.add_connection(
        connection.topic,
        connection.msgtype,
        typestore=None if defined else typestore(),
        msgdef=connection.msgdef.data if defined else None,
        rihs01=connection.digest if defined else None,
        serialization_format=ext.serialization_format,
        offered_qos_profiles=ext.offered_qos_profiles,
    )


def _with_effort(trajectory: JointTrajectory, efforts: Floats) -> bytes:
    for point, effort in zip(trajectory.points, efforts, strict=True):
        point.effort = np.ascontiguousarray(effort)
    return bytes(typestore().serialize_cdr(trajectory.message, trajectory.message_type))


def _filled_lines(table: CsvTable, result: TrajectoryTorques) -> Iterable[str]:
    """Lines of the table; columns of efforts replaced where there are any, else put last."""
    names = [f"effort.{joint}" for joint in result.joint_names]
    added = [name for name in names if name not in table.names]
    header = [*table.names, *added]
    columns = [header.index(name) for name in names]
    yield table.line(header)
    for fields, torques in zip(table.rows(), result.torques[0].tolist(), strict=True):
        row = [*fields, *("" for _ in added)]
        for column, torque in zip(columns, torques, strict=True):
            row[column] = repr(torque)
        yield table.line(row)

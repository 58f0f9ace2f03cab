# SPDX-License-Identifier: Apache-2.0
"""Joint states from and to rosbag2 recordings (sqlite3 and MCAP), without ROS.

    log = read_joint_log("recording", ["joint_1", "joint_2"])
    write_joint_logs("copy", {"/joint_states": log})

Which messages and joints are taken, and which time: inverse_dynamics_evaluation/joint_log.hpp.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import JointLogBuilder
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.data.bag_reader import BagReader, TopicSummary, UriPath, error_text
from inverse_dynamics.data.joint_log import CLOCKS, JointLog
from inverse_dynamics.data.joint_state_cdr import MESSAGE_TYPE, Decoder, encode
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray
    from rosbags.rosbag2 import Writer

    from inverse_dynamics._core import RecordedJoints
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Clock, Storage
    from inverse_dynamics.data.joint_state_cdr import Block

_BLOCK = 4096  # messages encoded together


def read_topics(path: Path | str) -> list[TopicSummary]:
    """Topics of a recording, by name."""
    with BagReader(Path(path)) as recording:
        return recording.topics()


def read_joint_log(
    path: Path | str,
    joints: Sequence[str] = (),
    *,
    topic: str = "",
    clock: Clock = "auto",
    progress: Progress = no_progress,
) -> JointLog:
    """Joint states of one topic, by the rules of inverse_dynamics_evaluation/joint_log.hpp.

    path: directory with metadata.yaml, or a .db3 or .mcap file. joints: names, in the order wanted;
    none: those of the first message. topic: none: the only one with joint states. clock: which
    stamp is the time.

    Raises BagError.
    """
    path = Path(path)
    if clock not in CLOCKS:
        raise BagError(f"clock: expected one of {', '.join(CLOCKS)}, got '{clock}'")
    with BagReader(path) as recording:
        connections = recording.connections_of_type(MESSAGE_TYPE, topic)
        topic = connections[0].topic
        where = f"{path}: {topic}"
        expected = sum(connection.msgcount for connection in connections)
        builder = JointLogBuilder(where, joints)
        decoder = Decoder()
        for messages, received in recording.blocks(connections):
            builder.add(_decoded(decoder, messages, where, builder.messages), received)
            progress("reading", builder.messages, expected)
        return _joint_log(builder.finish(clock), topic, recording.storage)


def _joint_log(recorded: RecordedJoints, topic: str, storage: Storage) -> JointLog:
    """The same memory, and where it comes from."""
    return JointLog(
        joint_names=tuple(recorded.joint_names),
        header_stamps=recorded.header_stamps,
        receive_stamps=recorded.receive_stamps,
        q=recorded.q,
        qd=recorded.qd,
        effort=recorded.effort,
        frame_id=recorded.frame_id,
        clock=recorded.clock,
        topic=topic,
        storage=storage,
        notes=tuple(recorded.notes),
    )


def _decoded(decoder: Decoder, messages: Sequence[bytes], where: str, before: int) -> list[Block]:
    """Decoded messages; one that can't be decoded is a BagError."""
    try:
        return list(decoder.decode(messages))
    except Exception as error:  # whatever a decoder makes of a damaged message
        raise BagError(
            f"{where}: one of the messages {before + 1} to {before + len(messages)} can't be "
            f"decoded as {MESSAGE_TYPE} ({error_text(error)}): the recording is damaged; copy or record "
            "it again"
        ) from error


def write_joint_logs(
    path: Path | str,
    topics: Mapping[str, JointLog],
    *,
    storage: Storage = "sqlite3",
    progress: Progress = no_progress,
) -> None:
    """Write joint states to a new recording, in the current format of rosbag2.

    topics: topic to joint states; several are interleaved message by message. Both stamps are kept.

    Raises BagError if the path exists or can't be written.
    """
    from rosbags.typesys import Stores, get_typestore

    if storage not in ("sqlite3", "mcap"):
        raise BagError(f"storage: expected one of sqlite3, mcap, got '{storage}'")
    typestore = get_typestore(Stores.ROS2_HUMBLE)
    total = sum(len(log) for log in topics.values())
    done = 0
    try:
        with new_recording(Path(path), storage) as writer:
            connections = [
                writer.add_connection(topic, MESSAGE_TYPE, typestore=typestore) for topic in topics
            ]
            longest = max((len(log) for log in topics.values()), default=0)
            for begin in range(0, longest, _BLOCK):
                rows = slice(begin, begin + _BLOCK)
                tables = [_encoded(log, rows) for log in topics.values()]
                for row in range(max(len(table) for _, table in tables)):
                    for connection, (stamps, table) in zip(connections, tables, strict=True):
                        if row < len(table):
                            writer.write(connection, stamps[row], table[row].tobytes())
                            done += 1
                progress("writing the bag", done, total)
    except Exception as error:  # sqlite3 and rosbags raise more than they document
        raise unwritable(path, error) from error


def new_recording(path: Path, storage: Storage) -> Writer:
    """Writer of a new recording, in the current format of rosbag2."""
    from rosbags.rosbag2 import StoragePlugin, Writer

    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    writer = Writer(path, version=Writer.VERSION_LATEST, storage_plugin=plugin)
    writer.path = UriPath(path)
    return writer


def unwritable(path: Path | str, error: Exception) -> BagError:
    """What is told where a recording can't be written: mostly, the disk is full."""
    return BagError(
        f"{path}: can't be written ({error_text(error)}); free some space, or name another output "
        "with --out"
    )


def _encoded(log: JointLog, rows: slice) -> tuple[list[int], NDArray[np.uint8]]:
    """Times of reception and serialised messages."""
    table = encode(
        log.joint_names,
        log.frame_id,
        log.header_stamps[rows],
        log.q[rows],
        log.qd[rows],
        log.effort[rows],
    )
    return log.receive_stamps[rows].tolist(), table

# SPDX-License-Identifier: Apache-2.0
"""Any bytes as serialized joint states: they are read, or refused, as by the rosbags library."""

import struct

import atheris
import harness
import numpy as np

with atheris.instrument_imports(include=["inverse_dynamics", "rosbags"]):
    from rosbags.typesys import Stores, get_typestore

    from inverse_dynamics.data.bags import MESSAGE_TYPE, open_recording
    from inverse_dynamics.errors import BagError

STORE = get_typestore(Stores.ROS2_HUMBLE)


def seeds() -> list[bytes]:
    """Messages with no joint, with one, and with two and their names of different lengths."""
    types = STORE.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](5, 6), "base")
    messages = []
    for names in ([], ["a"], ["joint_1", "bcd"]):
        numbers = np.arange(float(len(names)))
        message = types[MESSAGE_TYPE](header, names, numbers, numbers, numbers)
        for little_endian in (True, False):
            raw = STORE.serialize_cdr(message, MESSAGE_TYPE, little_endian=little_endian)
            messages.append(bytes(raw))
    return messages


def text(value: str) -> bytes:
    """As MCAP has it."""
    return struct.pack("<I", len(value)) + value.encode()


def record(kind: int, content: bytes) -> bytes:
    """Of an MCAP file."""
    return struct.pack("<BQ", kind, len(content)) + content


BEGIN = b"\x89MCAP0\r\n" + b"".join(
    (
        record(0x01, text("ros2") + text("")),
        record(0x03, struct.pack("<H", 1) + text(MESSAGE_TYPE) + text("") + text("")),
        record(0x04, struct.pack("<HH", 1, 1) + text("/joint_states") + text("cdr") + text("")),
    )
)
END = record(0x02, bytes(20)) + b"\x89MCAP0\r\n"


def read(data: bytes) -> None:
    """What the library takes is taken, with the same content, and nothing else."""
    message = record(0x05, struct.pack("<HIQQ", 1, 0, 7, 7) + data)
    path = harness.file_of(BEGIN + message + END, "motion.mcap")
    try:
        expected = STORE.deserialize_cdr(data, MESSAGE_TYPE)
    except Exception:
        expected = None
    refusal = block = None
    try:
        (block,) = open_recording(path).joint_states()
    except BagError as error:
        harness.check_error(error, path)
        refusal = error
    assert (block is None) == (expected is None), refusal
    if block is None:
        return
    names, frame_id, stamps, _, *arrays = block
    assert names == tuple(expected.name)
    assert frame_id == expected.header.frame_id
    assert stamps[0] == expected.header.stamp.sec * 10**9 + expected.header.stamp.nanosec
    for name, numbers in zip(("position", "velocity", "effort"), arrays, strict=True):
        np.testing.assert_array_equal(numbers[0], getattr(expected, name), name)


if __name__ == "__main__":
    harness.run(read, seeds())

# SPDX-License-Identifier: Apache-2.0
"""Any bytes as serialised joint states: what is read fast is what the rosbags library reads."""

import atheris
import harness
import numpy as np

with atheris.instrument_imports(include=["inverse_dynamics", "rosbags"]):
    from rosbags.typesys import Stores, get_typestore

    from inverse_dynamics.data.joint_state_cdr import MESSAGE_TYPE, Decoder, encode, layout_of

STORE = get_typestore(Stores.ROS2_HUMBLE)


def seeds() -> list[bytes]:
    """Messages with no joint, with one, and with two and their names of different lengths."""
    stamps = np.array([1_700_000_000_123_456_789])
    messages = []
    for names, frame in (((), ""), (("a",), "base"), (("joint_1", "bcd"), "x")):
        numbers = np.arange(float(len(names)))[None, :]
        messages.append(encode(names, frame, stamps, numbers, numbers, numbers).tobytes())
    return messages


def read(data: bytes) -> None:
    """What the fast reader takes, the library takes too, with the same content."""
    if layout_of(data) is None:
        return  # the library reads it
    (block,) = Decoder().decode([data])
    message = STORE.deserialize_cdr(data, MESSAGE_TYPE)
    assert block.names == tuple(message.name)
    assert block.frame_id == message.header.frame_id
    assert block.stamps[0] == message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
    for name in ("position", "velocity", "effort"):
        np.testing.assert_array_equal(getattr(block, name)[0], getattr(message, name), name)


if __name__ == "__main__":
    harness.run(read, seeds())

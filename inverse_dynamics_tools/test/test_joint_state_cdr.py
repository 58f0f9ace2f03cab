# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from conftest import JOINT_STATE, STORE, joint_state

from inverse_dynamics.data import joint_state_cdr
from inverse_dynamics.data.joint_state_cdr import Decoder, encode, layout_of


def random_messages(rng: np.random.Generator, count: int) -> list[object]:
    """Messages of many shapes: names, frames and lengths of arrays differ."""
    messages = []
    for k in range(count):
        joints = int(rng.integers(0, 5))
        names = [f"joint_{'x' * int(rng.integers(0, 6))}{i}" for i in range(joints)]
        arrays = [rng.normal(size=int(rng.integers(0, 5))).tolist() for _ in range(3)]
        stamp = int(rng.integers(0, 2**40)) + k
        messages.append(joint_state(names, *arrays, stamp, "base" if k % 3 else ""))
    return messages


def serialized(message: object) -> bytes:
    return bytes(STORE.serialize_cdr(message, JOINT_STATE))


def check_block(block, messages):
    for i, row in enumerate(block.rows):
        message = messages[row]
        assert list(block.names) == message.name
        assert block.frame_id == message.header.frame_id
        stamp = message.header.stamp
        assert block.stamps[i] == stamp.sec * 10**9 + stamp.nanosec
        for field in ("position", "velocity", "effort"):
            np.testing.assert_array_equal(getattr(block, field)[i], getattr(message, field))


@pytest.mark.parametrize("seed", range(3))
def test_messages_of_any_shape_are_decoded_as_rosbags_does_each_once(seed):
    messages = random_messages(np.random.default_rng(seed), 300)
    blocks = list(Decoder().decode([serialized(m) for m in messages]))
    for block in blocks:
        check_block(block, messages)
    assert sorted(np.concatenate([b.rows for b in blocks])) == list(range(300))


def test_messages_of_one_layout_are_one_block_whatever_their_padding_holds():
    # After the empty frame, after "a", and before the numbers of velocity and of effort.
    padding = [17, 18, 19, 30, 31, *range(64, 68), *range(88, 92)]
    messages = [joint_state(["a", "bcd"], [k, 1], [2, 3], [4, 5], k) for k in range(20)]
    raw = [bytearray(serialized(m)) for m in messages]
    for k, message in enumerate(raw):
        for i in padding:
            assert message[i] == 0
            message[i] = (17 * k + i) % 256
    blocks = list(Decoder().decode([bytes(m) for m in raw]))
    assert len(blocks) == 1
    check_block(blocks[0], messages)


def test_more_layouts_of_one_size_than_are_remembered_are_told_apart():
    messages = [joint_state([f"joint_{k % 90:03}"], [k], [2], [3], k) for k in range(200)]
    blocks = list(Decoder().decode([serialized(m) for m in messages]))
    for block in blocks:
        check_block(block, messages)
    assert sorted(np.concatenate([b.rows for b in blocks])) == list(range(200))


def test_big_endian_messages_are_decoded_too():
    message = joint_state(["a", "b"], [1, 2], [3, 4], [5, 6], 7_000_000_008, "base")
    raw = bytes(STORE.serialize_cdr(message, JOINT_STATE, little_endian=False))
    assert layout_of(raw) is None
    for block in Decoder().decode([raw, raw]):
        check_block(block, [message, message])


def test_a_decoder_remembers_layouts_from_one_call_to_the_next(monkeypatch):
    looked_at = []

    def counted(message):
        looked_at.append(message)
        return layout_of(message)

    monkeypatch.setattr(joint_state_cdr, "layout_of", counted)
    decoder = Decoder()
    first = [serialized(joint_state(["a"], [1], [2], [3], 4))]
    assert [len(b.rows) for b in decoder.decode(first)] == [1]
    later = [serialized(joint_state(["b"], [1], [2], [3], 4)), *(3 * first)]
    blocks = {b.names: b.rows.tolist() for b in decoder.decode(later)}
    assert blocks == {("a",): [1, 2, 3], ("b",): [0]}
    assert looked_at == [first[0], later[0]]


@pytest.mark.parametrize("length", [3, 10, 20, 40, 60])
def test_a_message_that_is_cut_off_raises(length):
    raw = serialized(joint_state(["a", "b"], [1, 2], [3, 4], [5, 6], 7))
    with pytest.raises(Exception):  # noqa: B017  whatever rosbags raises; bags.py makes one error of it
        list(Decoder().decode([raw[:length]]))


@pytest.mark.parametrize("more", [1, 3, 4, 40])
def test_a_message_with_more_bytes_than_its_fields_and_padding_raises(more):
    raw = serialized(joint_state(["a", "b"], [1, 2], [3, 4], [5, 6], 7)) + bytes(more)
    if more < 4:  # padding to a multiple of 4, which some middleware adds
        assert [b.names for b in Decoder().decode([raw])] == [("a", "b")]
    else:
        with pytest.raises(Exception, match="size mismatch"):
            list(Decoder().decode([raw]))


@pytest.mark.parametrize("name", [b"b\0Y\0\0", b"ab\0\0\0"])
def test_zeros_within_a_name_are_read_as_rosbags_does(name):
    raw = serialized(joint_state(["abcd"], [1], [2], [3], 7))
    raw = raw.replace(b"abcd\0", name)
    (block,) = Decoder().decode([raw])
    check_block(block, [STORE.deserialize_cdr(raw, JOINT_STATE)])


@pytest.mark.parametrize("name", [b"\5\0\0\0abcde\0\0\0", b"\0\0\0\0"])
def test_a_name_without_its_closing_zero_raises(name):
    raw = serialized(joint_state(["abcd"], [1], [2], [3], 7))
    with pytest.raises(Exception, match=r"terminator|string length"):
        list(Decoder().decode([raw.replace(b"\5\0\0\0abcd\0\0\0\0", name)]))


@pytest.mark.parametrize("names", [[], ["a"], ["joint_1", "joint_22", "joint_333"]])
@pytest.mark.parametrize("frame_id", ["", "base", "base_link"])
def test_encoded_messages_are_the_bytes_that_rosbags_writes(names, frame_id):
    rng = np.random.default_rng(0)
    stamps = np.array([0, 1, 1_999_999_999, 1_700_000_000_123_456_789])
    position, velocity, effort = rng.normal(size=(3, len(stamps), len(names)))
    table = encode(names, frame_id, stamps, position, velocity, effort)
    for row, stamp in enumerate(stamps.tolist()):
        message = joint_state(names, position[row], velocity[row], effort[row], stamp, frame_id)
        assert table[row].tobytes() == serialized(message)

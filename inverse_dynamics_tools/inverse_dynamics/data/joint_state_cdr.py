# SPDX-License-Identifier: Apache-2.0
"""Many serialised sensor_msgs/JointState messages as one table.

A recording repeats the same joints in every message: its messages have the same bytes in the same
places but for the stamp and the numbers. The first one says where everything lies (`Layout`); the
others are compared with it and read as columns of a table of bytes, which is much faster than
decoding one by one. A message that differs (other joints, another order, shorter arrays) gets a
layout of its own. One that isn't plain little-endian CDR is left to the rosbags library.

CDR: 4 bytes of encapsulation, then the fields in order, each aligned to its own size, counted from
the fifth byte:

    int32 sec, uint32 nanosec, string frame_id, string[] name, float64[] position, velocity, effort

Strings and arrays begin with their length (uint32); a string's length counts its closing zero.
Bytes of padding mean nothing and may hold anything.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from inverse_dynamics.base.arrays import Floats, Integers

MESSAGE_TYPE = "sensor_msgs/msg/JointState"

_LITTLE_ENDIAN_CDR = b"\x00\x01"
_STAMP = 4  # offset of sec and nanosec
_PADDING_AT_END = 3  # bytes at most: some middleware fills messages up to a multiple of 4
_LAYOUTS_TRIED_PER_BLOCK = 32  # beyond it messages are read one by one


class Block(NamedTuple):
    """Messages with the same names and array lengths, decoded."""

    rows: NDArray[np.intp]  # which of the messages given to `decode`
    names: tuple[str, ...]
    frame_id: str
    stamps: Integers  # ns
    position: Floats  # (messages, numbers), likewise:
    velocity: Floats
    effort: Floats


@dataclass(frozen=True)
class Layout:
    """Where the fields of a message lie, and the bytes another one must share to be alike."""

    size: int
    names: tuple[str, ...]
    frame_id: str
    arrays: tuple[tuple[int, int], ...]  # (offset, count) of position, velocity, effort
    fixed: NDArray[np.intp]  # offsets of the bytes that mean something but aren't stamps or numbers
    fixed_bytes: NDArray[np.uint8]

    def matches(self, table: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Which rows of a table of messages of this size have this layout."""
        alike: NDArray[np.bool_] = (table[:, self.fixed] == self.fixed_bytes).all(axis=1)
        return alike

    def read(self, rows: NDArray[np.intp], table: NDArray[np.uint8]) -> Block:
        """Numbers of messages that have this layout."""
        stamp = np.ascontiguousarray(table[:, _STAMP : _STAMP + 8])
        seconds = stamp[:, :4].copy().view("<i4")[:, 0].astype(np.int64)
        nanoseconds = stamp[:, 4:].copy().view("<u4")[:, 0].astype(np.int64)
        position, velocity, effort = (
            np.ascontiguousarray(table[:, at : at + 8 * count]).view("<f8")
            if count
            else np.empty((len(table), 0))
            for at, count in self.arrays
        )
        stamps = seconds * 10**9 + nanoseconds
        return Block(rows, self.names, self.frame_id, stamps, position, velocity, effort)


def layout_of(message: bytes) -> Layout | None:
    """Layout of one message; None if it isn't plain little-endian CDR or doesn't add up."""
    if message[:2] != _LITTLE_ENDIAN_CDR:
        return None
    at = 12
    fixed: list[int] = [0, 1]

    def count_at(offset: int) -> tuple[int, int]:
        offset += -(offset - 4) % 4
        fixed.extend(range(offset, offset + 4))
        (count,) = struct.unpack_from("<I", message, offset)
        return count, offset + 4

    def string_at(offset: int) -> tuple[str, int]:
        length, offset = count_at(offset)
        if offset + length > len(message):
            raise struct.error("string beyond the end")
        fixed.extend(range(offset, offset + length))
        text = message[offset : offset + length]
        if not text or text.find(b"\0") != length - 1:
            raise struct.error("string that doesn't end with its only zero")
        return text[:-1].decode(), offset + length

    try:
        frame_id, at = string_at(at)
        name_count, at = count_at(at)
        names = []
        for _ in range(name_count):
            name, at = string_at(at)
            names.append(name)
        arrays = []
        for _ in range(3):
            count, at = count_at(at)
            if count:
                at += -(at - 4) % 8
            arrays.append((at, count))
            at += 8 * count
    except (struct.error, UnicodeDecodeError):
        return None
    if not at <= len(message) <= at + _PADDING_AT_END:
        return None
    offsets = np.array(fixed, dtype=np.intp)
    return Layout(
        size=len(message),
        names=tuple(names),
        frame_id=frame_id,
        arrays=tuple(arrays),
        fixed=offsets,
        fixed_bytes=np.frombuffer(message, np.uint8)[offsets],
    )


class Decoder:
    """Decodes serialised messages; remembers the layouts it has met."""

    def __init__(self) -> None:
        self._layouts: dict[int, list[Layout]] = {}

    def decode(self, messages: Sequence[bytes]) -> Iterator[Block]:
        """Blocks that together hold each of the messages once.

        Raises whatever the rosbags library raises for a message that can't be decoded.
        """
        sizes = np.fromiter((len(m) for m in messages), dtype=np.intp, count=len(messages))
        for size in np.unique(sizes):
            rows = np.flatnonzero(sizes == size)
            table = np.frombuffer(b"".join(messages[int(i)] for i in rows), np.uint8)
            yield from self._decode_table(rows, table.reshape(len(rows), size))

    def _decode_table(self, rows: NDArray[np.intp], table: NDArray[np.uint8]) -> Iterator[Block]:
        known = self._layouts.setdefault(table.shape[1], [])
        tried = 0
        while len(rows):
            if tried < len(known):
                layout = known[tried]
            else:
                found = layout_of(table[0].tobytes())
                if found is None:
                    yield _decode_one(rows[:1], table[0].tobytes())
                    rows, table = rows[1:], table[1:]
                    continue
                layout = found
                if len(known) < _LAYOUTS_TRIED_PER_BLOCK:
                    known.append(layout)
            tried += 1
            if tried <= _LAYOUTS_TRIED_PER_BLOCK:
                alike = layout.matches(table)
            else:
                alike = np.arange(len(rows)) == 0
            if alike.all():
                yield layout.read(rows, table)
                return
            if alike.any():
                yield layout.read(rows[alike], table[alike])
                rows, table = rows[~alike], table[~alike]


def encode(
    names: Sequence[str],
    frame_id: str,
    stamps: Integers,
    position: Floats,
    velocity: Floats,
    effort: Floats,
) -> NDArray[np.uint8]:
    """Serialised messages, one a row: little-endian CDR.

    stamps: (N,) ns; position, velocity, effort: (N, numbers).
    """
    arrays = (position, velocity, effort)
    template, offsets = _template(tuple(names), frame_id, tuple(a.shape[1] for a in arrays))
    table = np.tile(np.frombuffer(template, np.uint8), (len(stamps), 1))
    seconds, nanoseconds = np.divmod(stamps, 10**9)
    table[:, _STAMP : _STAMP + 4] = seconds.astype("<i4")[:, None].view(np.uint8)
    table[:, _STAMP + 4 : _STAMP + 8] = nanoseconds.astype("<u4")[:, None].view(np.uint8)
    for at, numbers in zip(offsets, arrays, strict=True):
        if numbers.shape[1]:
            table[:, at : at + 8 * numbers.shape[1]] = np.ascontiguousarray(numbers, "<f8").view(
                np.uint8
            )
    return table


def _template(
    names: tuple[str, ...], frame_id: str, counts: tuple[int, ...]
) -> tuple[bytes, tuple[int, ...]]:
    """A message with zero stamp and zero numbers, and where its arrays begin."""
    out = bytearray(_LITTLE_ENDIAN_CDR + b"\0\0" + bytes(8))

    def pad(size: int) -> None:
        out.extend(bytes(-(len(out) - 4) % size))

    def put_string(text: str) -> None:
        pad(4)
        encoded = text.encode() + b"\0"
        out.extend(struct.pack("<I", len(encoded)) + encoded)

    put_string(frame_id)
    pad(4)
    out.extend(struct.pack("<I", len(names)))
    for name in names:
        put_string(name)
    offsets = []
    for count in counts:
        pad(4)
        out.extend(struct.pack("<I", count))
        if count:
            pad(8)
        offsets.append(len(out))
        out.extend(bytes(8 * count))
    return bytes(out), tuple(offsets)


def _decode_one(row: NDArray[np.intp], message: bytes) -> Block:
    """One message, by the rosbags library."""
    decoded = _typestore().deserialize_cdr(message, MESSAGE_TYPE)
    stamp = decoded.header.stamp.sec * 10**9 + decoded.header.stamp.nanosec
    position, velocity, effort = (
        np.asarray(numbers, dtype=np.float64)[None, :]
        for numbers in (decoded.position, decoded.velocity, decoded.effort)
    )
    return Block(
        row,
        tuple(decoded.name),
        decoded.header.frame_id,
        np.array([stamp], dtype=np.int64),
        position,
        velocity,
        effort,
    )


@cache
def _typestore():  # type: ignore[no-untyped-def]
    from rosbags.typesys import Stores, get_typestore

    # The definition of JointState is the same in every ROS 2 release.
    return get_typestore(Stores.ROS2_HUMBLE)

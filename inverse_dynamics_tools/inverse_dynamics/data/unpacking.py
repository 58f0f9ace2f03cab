# SPDX-License-Identifier: Apache-2.0
"""Compressed recordings, unpacked within limits: a few kilobytes may unpack to many gigabytes.

A message, a chunk of an MCAP file, or a compressed file may unpack to 256 MB, or to 50 times its size
if that is more. The environment variable IDS_UNPACK_LIMIT_MB stands for other than 256.
"""

from __future__ import annotations

import os
import re
import sys
from io import BytesIO
from typing import TYPE_CHECKING

from inverse_dynamics.base.wording import shown
from inverse_dynamics.errors import BagError

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import Protocol

    class _Readable(Protocol):
        def read(self, size: int, /) -> bytes: ...


VARIABLE = "IDS_UNPACK_LIMIT_MB"

_MEGABYTES = 256
_MOST_DIGITS = 12
_TIMES = 50  # joint states are mostly noise: they shrink to a third, at rest to a tenth
_BLOCK = 2**20
_PACKED = re.compile(rb"\x28\xb5\x2f\xfd|[\x50-\x5f]\x2a\x4d\x18", re.DOTALL)  # zstd frames


class UnpackError(BagError):
    """More than a limit came out."""


def most_unpacked(packed: int) -> int:
    """Bytes that may come out of so many packed ones. Raises BagError: the variable isn't a number."""
    text = os.environ.get(VARIABLE) or str(_MEGABYTES)
    if not (text.isascii() and text.isdigit() and len(text) <= _MOST_DIGITS):
        raise UnpackError(
            f"{VARIABLE}: expected a whole number of megabytes, got {shown(text, _MOST_DIGITS)}"
        )
    return max(int(text) * 10**6, _TIMES * packed)


def unpacked(packed: bytes) -> bytes:
    """Unpacked message or chunk (zstd). Raises BagError above the limit."""
    most = most_unpacked(len(packed))
    size = zstd.get_frame_info(packed).decompressed_size
    if size is not None and size <= most and zstd.get_frame_size(packed) == len(packed):
        return zstd.decompress(packed)
    with zstd.open(BytesIO(packed), "rb") as file:
        return b"".join(_blocks(file, len(packed), "a message or chunk"))


def limit_chunks() -> None:
    """Have rosbags unpack the chunks of MCAP files within the limit."""
    from rosbags.rosbag2.storage_mcap import DECOMPRESSORS

    DECOMPRESSORS["zstd"] = lambda packed, _: unpacked(packed)
    DECOMPRESSORS["lz4"] = lambda packed, _: _unpacked_lz4(packed)


def check_packed_file(file: Path) -> None:
    """Raise BagError if a file is compressed and unpacks to more than the limit."""
    if not file.is_file():
        return
    with file.open("rb") as start:
        if not _PACKED.match(start.read(4)):
            return
    with zstd.open(file, "rb") as content:
        for _ in _blocks(content, file.stat().st_size, file.name):
            pass


def _unpacked_lz4(packed: bytes) -> bytes:
    from lz4.frame import LZ4FrameFile  # type: ignore[import-untyped]

    with LZ4FrameFile(BytesIO(packed)) as file:
        return b"".join(_blocks(file, len(packed), "a chunk"))


def _blocks(file: _Readable, packed: int, what: str) -> Iterator[bytes]:
    """What comes out of a file, up to the limit."""
    most, done = most_unpacked(packed), 0
    while block := file.read(_BLOCK):
        done += len(block)
        if done > most:
            raise UnpackError(
                f"{what} of {packed} bytes unpacks to more than {most / 1e6:.0f} MB: it is damaged, or "
                f"made to fill memory or disk; if you trust it, raise the limit with {VARIABLE}"
            )
        yield block

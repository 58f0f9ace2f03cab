# SPDX-License-Identifier: Apache-2.0
"""Arrays of many rows in a file for numpy.load(), written some rows at a time.

with SeriesFile(Path("series.npz"), 10_000_000) as series:
    while ...:
        series.add({"time": time, "q": q})

The file is a ZIP archive (with 64-bit sizes) of arrays that aren't compressed. As the number of rows
is known, so is the place of each array: nothing is written twice, and no row is kept in memory.
"""

from __future__ import annotations

import io
import struct
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.errors import OutputError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path
    from types import TracebackType

_MAGIC_LOCAL, _MAGIC_CENTRAL = 0x04034B50, 0x02014B50
_MAGIC_END, _MAGIC_END_64, _MAGIC_LOCATOR = 0x06054B50, 0x06064B50, 0x07064B50
_VERSION = 45  # 4.5: 64-bit sizes
_BEYOND_32, _BEYOND_16 = 0xFFFFFFFF, 0xFFFF  # look for the 64-bit number
_MIDNIGHT_1980 = 0x21 << 16  # date and time of each member: the same arrays, the same bytes


@dataclass
class _Member:
    name: bytes
    offset: int  # of its local header
    header: bytes  # of the array
    row_bytes: int
    size: int  # with the array's header
    crc: int

    @property
    def data_offset(self) -> int:
        return self.offset + len(self.local_header()) + len(self.header)

    def local_header(self) -> bytes:
        sizes = struct.pack("<HHQQ", 1, 16, self.size, self.size)
        return (
            struct.pack(
                "<IHHHIIIIHH",
                _MAGIC_LOCAL,
                _VERSION,
                0,
                0,
                _MIDNIGHT_1980,
                self.crc,
                _BEYOND_32,
                _BEYOND_32,
                len(self.name),
                len(sizes),
            )
            + self.name
            + sizes
        )

    def central_header(self) -> bytes:
        sizes = struct.pack("<HHQQQ", 1, 24, self.size, self.size, self.offset)
        return (
            struct.pack(
                "<IHHHHIIIIHHHHHII",
                _MAGIC_CENTRAL,
                _VERSION,
                _VERSION,
                0,
                0,
                _MIDNIGHT_1980,
                self.crc,
                _BEYOND_32,
                _BEYOND_32,
                len(self.name),
                len(sizes),
                0,
                0,
                0,
                0,
                _BEYOND_32,
            )
            + self.name
            + sizes
        )


class SeriesFile:
    """A file of arrays that have `rows` rows each."""

    def __init__(self, path: Path, rows: int) -> None:
        self._path = path
        self._rows = rows
        self._file = path.open("wb")
        self._members: dict[str, _Member] = {}
        self._done = 0

    def __enter__(self) -> SeriesFile:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if error is None:
            self.finish()
        else:
            self.close()

    def add(self, arrays: Mapping[str, np.ndarray[Any, Any]]) -> None:
        """The next rows of each array; each time of the same names, types and columns."""
        if not self._members:
            self._place(arrays)
        count = len(next(iter(arrays.values())))
        for name, array in arrays.items():
            member = self._members[name]
            if len(array) != count or array.nbytes != count * member.row_bytes:
                raise OutputError(
                    f"{self._path}: {name}: expected {count} rows of {member.row_bytes} bytes, got an "
                    f"array of {array.dtype} of shape {array.shape}"
                )
            data = np.ascontiguousarray(array).reshape(-1).view(np.uint8).data
            self._file.seek(member.data_offset + self._done * member.row_bytes)
            self._file.write(data)
            member.crc = zlib.crc32(data, member.crc)
        self._done += count

    def finish(self) -> None:
        """Write what tells where the arrays are. Raises OutputError unless all rows were added."""
        if self._done != self._rows:
            self.close()
            raise OutputError(
                f"{self._path}: expected {self._rows} rows, got {self._done}; is the recording being "
                "written? Evaluate it when it is complete"
            )
        for member in self._members.values():
            self._file.seek(member.offset)
            self._file.write(member.local_header() + member.header)
        start = max(
            (m.data_offset - len(m.header) + m.size for m in self._members.values()), default=0
        )
        directory = b"".join(member.central_header() for member in self._members.values())
        count, end = len(self._members), start + len(directory)
        self._file.seek(start)
        self._file.write(directory)
        self._file.write(
            struct.pack(
                "<IQHHIIQQQQ",
                _MAGIC_END_64,
                44,
                _VERSION,
                _VERSION,
                0,
                0,
                count,
                count,
                len(directory),
                start,
            )
            + struct.pack("<IIQI", _MAGIC_LOCATOR, 0, end, 1)
            + struct.pack(
                "<IHHHHIIH",
                _MAGIC_END,
                0,
                0,
                _BEYOND_16,
                _BEYOND_16,
                _BEYOND_32,
                _BEYOND_32,
                0,
            )
        )
        self.close()

    def close(self) -> None:
        """Leave the file as it is."""
        self._file.close()

    def mapped(self) -> dict[str, np.ndarray[Any, Any]]:
        """The arrays of a finished file, in memory only where they are looked at.

        They stay valid when the file is moved or removed.
        """
        arrays = {}
        for name, member in self._members.items():
            dtype, shape = _read_header(member.header)
            arrays[name] = np.memmap(
                self._path, dtype, "c", offset=member.data_offset, shape=shape
            ).view(np.ndarray)
        return arrays

    def _place(self, arrays: Mapping[str, np.ndarray[Any, Any]]) -> None:
        offset = 0
        for name, array in arrays.items():
            header = _header(array.dtype, (self._rows, *array.shape[1:]))
            row_bytes = array.dtype.itemsize * int(np.prod(array.shape[1:], dtype=np.int64))
            size = len(header) + self._rows * row_bytes
            member = _Member(
                f"{name}.npy".encode(), offset, header, row_bytes, size, zlib.crc32(header)
            )
            self._members[name] = member
            offset = member.data_offset - len(header) + size


def _header(dtype: np.dtype[Any], shape: tuple[int, ...]) -> bytes:
    """Of an array in a file."""
    text = io.BytesIO()
    description = {
        "descr": np.lib.format.dtype_to_descr(dtype),
        "fortran_order": False,
        "shape": shape,
    }
    np.lib.format.write_array_header_1_0(text, description)
    return text.getvalue()


def _read_header(header: bytes) -> tuple[np.dtype[Any], tuple[int, ...]]:
    text = io.BytesIO(header)
    np.lib.format.read_magic(text)
    shape, _, dtype = np.lib.format.read_array_header_1_0(text)
    return dtype, shape

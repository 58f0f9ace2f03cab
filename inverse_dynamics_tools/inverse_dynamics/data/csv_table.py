# SPDX-License-Identifier: Apache-2.0
"""Tables of numbers in text files: a header line, then one row per line.

Between columns: comma, semicolon, tab or spaces, whichever the header has. Decimals have a point, or a
comma where no comma lies between columns. Columns that aren't asked for may hold anything; rows with an
empty field in a column that is are left out and counted.

Without a header, or with one that names fewer columns than there are, columns are called by their number, from
1 on.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from operator import itemgetter
from typing import TYPE_CHECKING, TextIO

import numpy as np

from inverse_dynamics.base.decimals import ASCII_SPACE, NOT_FINITE, decimal
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.wording import counted, harmless, shown
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.base.arrays import Floats, Mask
    from inverse_dynamics.base.progress import Progress

_SUFFIXES = (".csv", ".tsv", ".txt")
_BLOCK = 2**20  # characters read together
_LONGEST_HEADER = 2**22  # characters


def is_csv(path: Path) -> bool:
    """Whether the name is that of a text file."""
    return path.suffix.lower() in _SUFFIXES and not os.path.isdir(path)  # paths may be too long


class CsvTable:
    """The table of a file; reading the header is enough to make one. Raises BagError."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            with self._open() as file:
                self._lines_before, header = _first_line(file)
                first_row = _first_line(file)[1]
        except (OSError, UnicodeDecodeError) as error:
            raise self._unreadable(error) from error
        if len(header) >= _LONGEST_HEADER:
            raise BagError(
                f"{path}:{self._lines_before}: expected a header line of at most {_LONGEST_HEADER} "
                "characters, got a longer one; is it a table of numbers?"
            )
        if not header:
            raise BagError(f"{path}: is empty; expected a header line and rows of numbers")
        self._delimiter = _delimiter(header)
        self.names = tuple(
            name.strip().strip('"').strip() for name in header.lstrip("# ").split(self._delimiter)
        )
        self.unnamed = ""  # why the file doesn't name its columns
        self.incomplete = 0  # rows left out so far
        self._set_unnamed(first_row)

    def _set_unnamed(self, first_row: str) -> None:
        if all(_is_number(name.replace(",", ".")) for name in self.names):
            self.unnamed = "expected a header line that names the columns, got numbers"
            self._lines_before -= 1
        columns = len(first_row.split(self._delimiter))
        if len(self.names) < columns and first_row and not self.unnamed:
            self.unnamed = (
                f"expected a header with {counted(columns, 'name')}, as the first row has columns, got "
                f"{len(self.names)}"
            )
        if self.unnamed:
            self.names = tuple(str(k) for k in range(1, max(columns, len(self.names)) + 1))

    def read(
        self,
        columns: Sequence[str],
        largest: Sequence[float] | None = None,
        progress: Progress = no_progress,
    ) -> Floats:
        """(N, columns) numbers, all of them finite and none larger than those. Raises BagError."""
        self.incomplete = 0
        limits = np.full(len(columns), np.inf) if largest is None else np.array(largest)
        where = [self.names.index(name) for name in columns]
        size = self.path.stat().st_size
        blocks = []
        try:
            with self._open() as file:
                for _ in range(self._lines_before):
                    file.readline()
                line, done = self._lines_before + 1, 0
                while lines := file.readlines(_BLOCK):
                    blocks.append(self._numbers(lines, line, where, limits))
                    line += len(lines)
                    done += sum(map(len, lines))
                    progress("reading", min(done, size), size)
        except (OSError, UnicodeDecodeError) as error:
            raise self._unreadable(error) from error
        progress("reading", size, size)
        return np.concatenate(blocks) if blocks else np.empty((0, len(columns)))

    def rows(self) -> Iterator[list[str]]:
        """Fields of each row, as they are."""
        with self._open() as file:
            for _ in range(self._lines_before):
                file.readline()
            for line in file:
                if not line.isspace():
                    yield line.rstrip("\n").split(self._delimiter)

    def line(self, fields: Iterable[str]) -> str:
        """A line of such a table."""
        return (self._delimiter or " ").join(fields) + "\n"

    def _open(self) -> TextIO:
        return self.path.open(encoding="utf-8-sig")

    def _numbers(self, lines: list[str], first: int, where: list[int], limits: Floats) -> Floats:
        """Numbers of some lines; first: the number of the first line in the file."""
        rows = [line.split(self._delimiter) for line in lines if not line.isspace()]
        if set(map(len, rows)) - {len(self.names)}:
            raise self._wrong_length(lines, first)
        values = np.empty((len(rows), len(where)))
        complete = np.ones(len(rows), dtype=bool)
        try:
            for j, column in enumerate(where):
                texts = list(map(itemgetter(column), rows))
                _refuse_other_notations("".join(texts))
                values[:, j] = self._column(texts, complete)
        except ValueError:
            raise self._no_number(lines, first, where, limits) from None
        values = values[complete]
        self.incomplete += len(rows) - len(values)
        if not (np.abs(values) <= np.minimum(limits, np.finfo(float).max)).all():
            raise self._no_number(lines, first, where, limits)
        return values

    def _column(self, texts: list[str], complete: Mask) -> Floats:
        """Its numbers; where a text is blank, NaN, and the row isn't complete. Raises ValueError."""
        try:
            return np.fromiter(map(float, texts), float, len(texts))
        except ValueError:
            numbers = [self._plain(text) or "nan" for text in texts]
        complete &= np.array([bool(self._plain(text)) for text in texts])
        return np.fromiter(map(float, numbers), float, len(texts))

    def _plain(self, text: str) -> str:
        """A field without blanks around it, and with a point."""
        text = text.strip(ASCII_SPACE)
        return text if self._delimiter == "," else text.replace(",", ".")

    def _wrong_length(self, lines: list[str], first: int) -> BagError:
        line, got = next(
            (line, count)
            for line, text in enumerate(lines, first)
            if (count := len(text.split(self._delimiter))) != len(self.names) and text.strip()
        )
        return BagError(
            f"{self.path}:{line}: expected {counted(len(self.names), 'column')}, as the header has, got "
            f"{got}; is the file cut off?"
        )

    def _no_number(
        self, lines: list[str], first: int, where: list[int], limits: Floats
    ) -> BagError:
        for line, text in enumerate(lines, first):
            if text.isspace():
                continue
            fields = text.split(self._delimiter)
            for column, largest in sorted(zip(where, limits, strict=True)):
                got = self._plain(fields[column])
                if not got:
                    continue
                if not _is_number(got):
                    return self._bad_field(line, column, f"a number, got {shown(got)}")
                if not np.isfinite(float(got)):
                    return self._bad_field(line, column, f"a finite number, got {shown(got)}")
                if abs(float(got)) > largest:
                    expected = f"a number of a motion, in SI units, of at most {largest:g}"
                    return self._bad_field(line, column, f"{expected}, got {shown(got)}")
        raise AssertionError("no field is bad")

    def _bad_field(self, line: int, column: int, text: str) -> BagError:
        return BagError(
            f"{self.path}:{line}: column {column + 1} ({harmless(self.names[column])}): expected {text}"
        )

    def _unreadable(self, error: Exception) -> BagError:
        if isinstance(error, FileNotFoundError):
            return BagError(
                f"{self.path}: no such file; expected a table of numbers in text, or name a "
                "rosbag2 recording"
            )
        why = "it isn't text in UTF-8"
        if isinstance(error, OSError):
            why = error.strerror or str(error)
        return BagError(f"{self.path}: can't be read ({why}); expected a table of numbers in text")


def _first_line(file: TextIO) -> tuple[int, str]:
    """Number and text of the first line that isn't blank; "" if there is none."""
    number = 0
    while text := file.readline(_LONGEST_HEADER):
        number += 1
        if not text.isspace():
            return number, text.strip()
    return number, ""


def _delimiter(header: str) -> str | None:
    """None: any spaces."""
    best = max((",", ";", "\t"), key=header.count)
    return best if best in header else None


def _is_number(text: str) -> bool:
    try:
        decimal(text)
    except ValueError:
        return NOT_FINITE.fullmatch(text) is not None
    return True


def _refuse_other_notations(texts: str) -> None:
    """Raise ValueError for what float() takes beyond ASCII decimals: `1_0`, digits of other scripts."""
    if "_" in texts or not texts.isascii():
        raise ValueError("not all of them are decimal numbers")

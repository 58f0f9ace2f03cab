# SPDX-License-Identifier: Apache-2.0
"""Tables of numbers in text files: a header line, then one row per line.

Between columns: comma, semicolon, tab or spaces. Decimals have a point, or a comma where no comma lies
between columns. Lines that begin with `#` or `sep=` before the header are passed over; a line of units
below it is added to the names. Columns that aren't asked for may hold anything; rows with an empty field,
or nan, in a column that is are left out and counted.

Without a header, or with one that names fewer columns than there are, columns are called by their number,
from 1 on.
"""

from __future__ import annotations

import csv
import os
from contextlib import suppress
from typing import TYPE_CHECKING, TextIO

import numpy as np

from inverse_dynamics.base.decimals import ASCII_SPACE, NOT_FINITE, decimal
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.wording import counted, harmless, shown
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from inverse_dynamics.base.arrays import Floats
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
        self.incomplete = 0  # rows left out so far
        try:
            with self._open() as file:
                comments, lines = self._beginning(file)
            self._name_columns(comments, lines)
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise self._unreadable(error) from error

    def _beginning(self, file: TextIO) -> tuple[list[str], dict[int, str]]:
        """Comments, and the first three other lines by number."""
        comments: list[str] = []
        lines: dict[int, str] = {}
        number = 0
        while len(lines) < 3 and (text := file.readline(_LONGEST_HEADER)):
            number += 1
            if len(text) >= _LONGEST_HEADER:
                raise BagError(
                    f"{self.path}:{number}: expected a header line of at most {_LONGEST_HEADER} "
                    "characters, got a longer one; is it a table of numbers?"
                )
            if not lines and text.lower().startswith(("#", "sep=")):
                comments.append(text.lstrip("# ").strip())
            elif not text.isspace():
                lines[number] = text.strip("\r\n")
        return comments, lines

    def _name_columns(self, comments: list[str], lines: dict[int, str]) -> None:
        """Find the names, and the line of the first row."""
        found = list(lines.values()) or comments[-1:]
        if not found:
            raise BagError(f"{self.path}: is empty; expected a header line and rows of numbers")
        self._delimiter = _delimiter(found[0])
        header, *rows = map(self._fields, found)
        self.unnamed = ""  # why the file doesn't name its columns
        if _numbers_in(header) == len(header):
            rows.insert(0, header)
            header = self._fields(comments[-1]) if comments else []  # np.savetxt() has it there
            self.unnamed = (
                "expected a header line that names the columns, got numbers, "
                f"{counted(len(rows[0]), 'column')}, {harmless(', '.join(rows[0][:4]))}, ..."
            )
        names = [name.strip() for name in header]
        if len(rows) == 2 and not _numbers_in(rows[0]) and _numbers_in(rows[1]):
            units = rows.pop(0)
            names = [f"{n} {unit}".strip() for n, unit in zip(names, units, strict=False)]
        columns = len(rows[0]) - (not rows[0][-1].strip()) if rows else len(names)
        if len(names) >= columns > 0:
            self.unnamed = ""
            names = names if any(names[columns:]) else names[:columns]
        elif names:
            self.unnamed = (
                f"expected a header with {counted(columns, 'name')}, as the first row has columns, got "
                f"{len(names)}"
            )
        self.names = tuple(names if not self.unnamed else map(str, range(1, columns + 1)))
        self._lines_before = [0, *lines][-len(rows)] - 1 if rows else max(lines, default=0)

    def read(self, columns: Sequence[str], progress: Progress = no_progress) -> Floats:
        """(N, columns) numbers, all of them finite. Raises BagError."""
        self.incomplete = 0
        where = [self.names.index(name) for name in columns]
        size = self.path.stat().st_size
        blocks = [np.empty((0, len(columns)))]
        try:
            with self._open() as file:
                for _ in range(self._lines_before):
                    file.readline()
                line, done = self._lines_before + 1, 0
                while lines := file.readlines(_BLOCK):
                    blocks.append(self._numbers(lines, line, where))
                    line += len(lines)
                    done += sum(map(len, lines))
                    progress("reading", min(done, size), size)
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise self._unreadable(error) from error
        progress("reading", size, size)
        return np.concatenate(blocks)

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

    def _fields(self, line: str) -> list[str]:
        if '"' not in line:
            return line.split(self._delimiter)
        return next(csv.reader([line], delimiter=self._delimiter or " ", skipinitialspace=True))

    def _numbers(self, lines: list[str], first: int, where: list[int]) -> Floats:
        """Numbers of complete rows; first: the number of the first line in the file."""
        rows = [line for line in lines if not line.isspace()]
        widths = {len(line.split(self._delimiter)) for line in rows}
        if widths == {len(self.names)} and all(map(str.isascii, rows)):
            if self._delimiter != ",":
                rows = [line.replace(",", ".") for line in rows]
            with suppress(ValueError):  # an empty field, or none of a number
                mark = self._delimiter
                numbers = np.loadtxt(rows, delimiter=mark, usecols=where, comments=None, ndmin=2)
                if np.isfinite(numbers).all():
                    return numbers
        found = [self._row(text, n, where) for n, text in enumerate(lines, first) if text.strip()]
        complete = [row for row in found if None not in row]
        self.incomplete += len(found) - len(complete)
        return np.array(complete, dtype=float).reshape(-1, len(where))

    def _row(self, text: str, line: int, where: list[int]) -> list[float | None]:
        """Numbers of a line; None: its field is empty."""
        fields, expected = self._fields(text), len(self.names)
        if len(fields) < expected or "".join(fields[expected:]).strip():
            raise BagError(
                f"{self.path}:{line}: expected {counted(expected, 'column')}, as the header has, got "
                f"{len(fields)}; is the file cut off?"
            )
        return [self._number(fields[column], line, column) for column in where]

    def _number(self, text: str, line: int, column: int) -> float | None:
        text = text.strip(ASCII_SPACE)
        if text.lower() in ("", "nan"):
            return None
        finite = " finite" if NOT_FINITE.fullmatch(text) else ""
        with suppress(ValueError):
            number = decimal(text.replace(",", "."))
            if np.isfinite(number):
                return number
            finite = " finite"
        raise BagError(
            f"{self.path}:{line}: column {column + 1} ({harmless(self.names[column])}): expected a{finite} "
            f"number, got {shown(text)}"
        )

    def _unreadable(self, error: Exception) -> BagError:
        if isinstance(error, FileNotFoundError):
            return BagError(
                f"{self.path}: no such file; expected a table of numbers in text, or name a "
                "rosbag2 recording"
            )
        why = "it isn't text in UTF-8"
        if not isinstance(error, UnicodeDecodeError):
            why = getattr(error, "strerror", None) or str(error)
        return BagError(f"{self.path}: can't be read ({why}); expected a table of numbers in text")


def _delimiter(line: str) -> str | None:
    """None: any spaces."""
    spaced = line.replace(",", ".").split()
    if len(spaced) > 1 and _numbers_in(spaced) == len(spaced):  # `0,01 1,5`
        return None
    return next((mark for mark in (";", "\t", ",") if mark in line), None)


def _numbers_in(fields: Sequence[str]) -> int:
    return sum(map(_is_number, fields))


def _is_number(text: str) -> bool:
    try:
        decimal(text.strip().replace(",", "."))
    except ValueError:
        return NOT_FINITE.fullmatch(text.strip()) is not None
    return True

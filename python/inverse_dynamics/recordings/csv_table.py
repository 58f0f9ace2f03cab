# SPDX-License-Identifier: Apache-2.0
"""Tables of numbers in text files: a header line, then one row per line.

Between columns: comma, semicolon, tab or spaces. Decimals have a point, or a comma where no comma lies
between columns. Comments and titles before the header are passed over; a line of units below it is added to
the names. Dates and times of day are seconds. Columns that aren't asked for may hold anything; rows with an
empty field, nan, or null in a column that is are left out and counted, and so is a last line that is cut off.

Without a header, or with one that names fewer columns than there are, columns are called by their number,
from 1 on.
"""

from __future__ import annotations

import csv
import os
import shlex
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TextIO

import numpy as np

from inverse_dynamics.decimals import ASCII_SPACE, NOT_FINITE, decimal
from inverse_dynamics.errors import BagError
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.times import seconds_of, time_columns
from inverse_dynamics.recordings.vocabulary import JOINTS_CHANGE
from inverse_dynamics.wording import counted, harmless, listed, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress

_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".log", ".asc")
_COMMENT = ("#", "% ")
_MOST_ABOVE = 50  # lines before the first row that aren't comments
_EMPTY = frozenset(("", "nan", "-nan", "na", "n/a", "none", "null"))
_UNPACKED_BY = {b"\x1f\x8b": "gunzip", b"PK\x03\x04": "unzip"}  # by the first bytes
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
        with self._opened(0) as file:
            self._name_columns(*self._beginning(file))

    def _beginning(self, file: TextIO) -> tuple[list[str], str]:
        """Lines above the first row, and that row: the first line of more numbers than words, else the second line."""
        lines: list[tuple[int, str]] = []
        number = plain = 0
        while plain < _MOST_ABOVE and (text := file.readline(_LONGEST_HEADER)):
            number += 1
            if len(text) >= _LONGEST_HEADER:
                raise BagError(
                    f"{self.path}:{number}: expected a header line of at most {_LONGEST_HEADER} "
                    "characters, got a longer one; is it a table of numbers?"
                )
            if _is_row(text) and (plain or not _counts(_filled_fields(text))):
                self._lines_before = number - 1
                return [line for _, line in lines], text.strip("\r\n")
            if not text.isspace():
                lines.append((number, text.strip("\r\n")))
                plain += not text.startswith(_COMMENT)
        if not any(text.strip("#% ") for _, text in lines):
            raise BagError(f"{self.path}: is empty; expected a header line and rows of numbers")
        self._lines_before = lines[:2][-1][0] - (len(lines) > 1)
        return [lines[0][1]], lines[1][1] if len(lines) > 1 else ""

    def _name_columns(self, above: list[str], row: str) -> None:
        """Find the names: in the last line that has as many fields as the row, but for one of units below it."""
        comments = [text.lstrip("#% ").strip() for text in above if text.startswith(_COMMENT)]
        plain = [t for t in above if not (t.startswith(_COMMENT) or _counts(_filled_fields(t)))]
        fitting = [text for text in plain if _fits(text, row)][-2:]
        fitting = fitting or [text for text in comments if _fits(text, row)][-1:]
        found = fitting or plain[-1:] or comments[-1:]
        self._delimiter = _delimiter(found[0] if found else row)
        header, *units = [_split(line, self._delimiter) for line in found or [""]]
        names = [name.strip() for name in header]
        for line in units:
            names = [f"{n} {unit}".strip() for n, unit in zip(names, line, strict=False)]
        fields = _split(row, self._delimiter)
        if len(fields) == len(names):
            names = [
                each
                for name, text in zip(names, fields, strict=True)
                for each in _cells(name, text)
            ]
        fields = self.first = self._fields(row)
        self.same: Sequence[int] = ()  # columns of joints' names: what they hold must not change
        columns = len(fields) - (not fields[-1].strip()) if row else len(names)
        self.unnamed = ""  # why the file doesn't name its columns
        if not found:
            self.unnamed = (
                "expected a header line that names the columns, got numbers, "
                f"{counted(columns, 'column')}, {harmless(', '.join(fields[:4]))}, ..."
            )
        elif len(names) < columns:
            self.unnamed = (
                f"expected a header with {counted(columns, 'name')}, as the first row has columns, got "
                f"{len(names)}"
            )
        names = names if any(names[columns:]) else names[:columns]
        self.names = tuple(names if not self.unnamed else map(str, range(1, columns + 1)))

    def read(self, columns: Sequence[str], progress: Progress = no_progress) -> Floats:
        """(N, columns) numbers, all of them finite. Raises BagError."""
        self.incomplete = 0
        where = [self.names.index(name) for name in columns]
        size = self.path.stat().st_size
        blocks = [np.empty((0, len(columns)))]
        line, done = self._lines_before + 1, 0
        with self._opened(self._lines_before) as file:
            while lines := file.readlines(_BLOCK):
                blocks.append(self._numbers(lines, line, where))
                line += len(lines)
                done += sum(map(len, lines))
                progress("reading", min(done, size), size)
        progress("reading", size, size)
        return np.concatenate(blocks)

    def rows(self) -> Iterator[list[str]]:
        """Fields of each row, as they are. Raises BagError."""
        with self._opened(self._lines_before) as file:
            for line in file:
                if not line.isspace():
                    text = line.rstrip("\n")
                    fields = text.split(self._delimiter)
                    plain = len(fields) == len(self.names) and not _has_lists(text)
                    yield fields if plain else self._fields(text)

    def line(self, fields: Iterable[str]) -> str:
        """A line of such a table; what holds the delimiter is quoted."""
        mark = self._delimiter or " "
        quoted = ('"{}"'.format(f.replace('"', '""')) if mark in f else f for f in fields)
        return mark.join(quoted) + "\n"

    @contextmanager
    def _opened(self, above: int) -> Iterator[TextIO]:
        """The file behind so many lines. Raises BagError for what goes wrong with it."""
        try:
            with self.path.open(encoding="utf-8-sig") as file:
                for _ in range(above):
                    file.readline()
                yield file
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise self._unreadable(error) from error

    def _fields(self, line: str) -> list[str]:
        fields = _split(line, self._delimiter)
        if not _has_lists(line):
            return fields
        return [number for field in fields for number in _numbers_of(field)]

    def _numbers(self, lines: list[str], first: int, where: list[int]) -> Floats:
        """Numbers of complete rows; first: the number of the first line in the file."""
        rows = [line for line in lines if not line.isspace()]
        split = [line.split(self._delimiter) for line in rows]
        plain = {*map(len, split)} == {len(self.names)} and all(map(str.isascii, rows))
        if plain and all(fields[k] == self.first[k] for k in self.same for fields in split):
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
        if len(fields) < expected and not text.endswith("\n"):  # the recorder was stopped
            return [None] * len(where)
        if len(fields) < expected or "".join(fields[expected:]).strip():
            raise BagError(
                f"{self.path}:{line}: expected {counted(expected, 'column')}, as the header has, got "
                f"{len(fields)}; is the file cut off?"
            )
        joints, found = ([row[k].strip(" '") for k in self.same] for row in (self.first, fields))
        if joints != found:
            raise BagError(
                f"{self.path}:{line}: {JOINTS_CHANGE.format(listed(joints), listed(found))}"
            )
        return [self._number(fields[column], line, column) for column in where]

    def _number(self, text: str, line: int, column: int) -> float | None:
        text = text.strip(ASCII_SPACE)
        if text.lower() in _EMPTY:
            return None
        finite = " finite" if NOT_FINITE.fullmatch(text) else ""
        with suppress(ValueError):
            number = decimal(text.replace(",", "."))
            if np.isfinite(number):
                return number
            finite = " finite"
        with suppress(ValueError):
            return seconds_of(text)
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
        if not isinstance(error, UnicodeDecodeError):
            why = getattr(error, "strerror", None) or str(error)
            return BagError(
                f"{self.path}: can't be read ({why}); expected a table of numbers in text"
            )
        with self.path.open("rb") as file:
            start = file.read(4)
        code = "UTF-16" if start[:2] in (b"\xff\xfe", b"\xfe\xff") else "LATIN1"
        path = shlex.quote(f"{self.path}")
        convert = f"if it is text, convert it: iconv -f {code} -t UTF-8 {path} > NEW.csv"
        if program := next((p for magic, p in _UNPACKED_BY.items() if start.startswith(magic)), ""):
            convert = f"it is compressed: unpack it with {program}"
        return BagError(
            f"{self.path}: can't be read (it isn't text in UTF-8); expected a table of numbers in text; {convert}"
        )


def _is_row(text: str) -> bool:
    """Whether more fields hold numbers, or say that there is none, than words, and none is a name of time."""
    fields = _filled_fields(text)
    numbers = _numbers_in(fields) + sum(field.lower() in _EMPTY for field in fields)
    named = time_columns([*fields[:1], *(field for field in fields if len(field) > 1)])
    return 2 * numbers > len(fields) and not named


def _filled_fields(text: str) -> list[str]:
    fields = [field.strip(' "\r\n') for field in text.split(_delimiter(text))]
    return [field for field in fields if field]


def _counts(fields: Sequence[str]) -> bool:
    """Whether these are the names that pandas gives to columns without any: 0, 1, 2, ..."""
    return len(fields) > 3 and [*fields] == [*map(str, range(len(fields)))]


def _fits(header: str, row: str) -> bool:
    """Whether the line has as many fields as the row, not most of them empty."""
    mark = _delimiter(header)
    fields = [_split(line, mark) for line in (header, row)]
    widths = [len(each) - (not each[-1].strip()) for each in fields if each]
    return widths[:1] == widths[1:] and 2 * sum(map(bool, map(str.strip, fields[0]))) > widths[0]


def _has_lists(line: str) -> bool:
    return "[" in line or "(" in line


def _numbers_of(field: str) -> list[str]:
    """Those of a list, `[1, 2]`, `(1, 2)` or `[1 2]`, which programs write into one field; else the field."""
    inside = field.strip()
    if inside[:1] not in ("[", "(") or inside[-1:] not in ("]", ")"):
        return [field]
    return inside[1:-1].replace(",", " ").split()


def _cells(name: str, field: str) -> list[str]:
    """Names of the columns of a field: `q[0]`, `q[1]`, ... of a list of numbers."""
    numbers = _numbers_of(field)
    return [name] if numbers == [field] else [f"{name}[{k}]" for k in range(len(numbers))]


def _split(line: str, mark: str | None) -> list[str]:
    if '"' not in line:
        return line.split(mark)
    return next(csv.reader([line], delimiter=mark or " ", skipinitialspace=True))


def _delimiter(line: str) -> str | None:
    """None: any spaces."""
    spaced = line.replace(",", ".").split()
    if len(spaced) > 1 and _numbers_in(spaced) == len(spaced):  # `0,01 1,5`
        return None
    return next((mark for mark in (";", "\t", ",") if mark in line), None)


def _numbers_in(fields: Sequence[str]) -> int:
    return sum(map(is_number, fields))


def is_number(text: str) -> bool:
    """Whether a field holds one, finite or not."""
    try:
        decimal(text.strip().replace(",", "."))
    except ValueError:
        return NOT_FINITE.fullmatch(text.strip()) is not None
    return True

# SPDX-License-Identifier: Apache-2.0
"""Help that fits the terminal: paragraphs, rows of two columns, and commands that stay as they are."""

from __future__ import annotations

import argparse
import re
import shutil
import textwrap

_WIDEST = 98  # characters
_ROW = re.compile(r" *\S.*? {2,}(?=\S)")  # the first column of a row, and the space after it
_COMMAND = re.compile(r"  (ids|source) ")


class HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Wraps descriptions and epilogs, whose lines have a meaning, to the width of the terminal."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        width = min(width, _WIDEST) - len(indent)
        return "".join(f"{indent}{line}\n" for line in wrapped(text, width))


def terminal_width() -> int:
    """Characters that a line of help may have."""
    return min(shutil.get_terminal_size().columns - 2, _WIDEST)


def wrapped(text: str, width: int) -> list[str]:
    """Lines of a text: of commands, of rows (two columns, two spaces apart), of paragraphs.

    A line belongs to the paragraph above it if it is indented as much, to the row above it if it
    begins below the second column.
    """
    lines: list[str] = []
    block = prefix = ""  # what is to be wrapped, and what stands before its first line
    goes_on = False  # a command, on the next line

    def flush() -> None:
        nonlocal block, prefix
        if prefix or block:
            hang = " " * len(prefix)
            lines.extend(filled(block, width, prefix, hang))
        block = prefix = ""

    for line in text.splitlines():
        row = _ROW.match(line)
        indent = len(line) - len(line.lstrip())
        if goes_on or not line or (_COMMAND.match(line) and not row):
            flush()
            lines.append(line)
            goes_on = line.endswith("\\")
        elif row:
            flush()
            prefix, block = row[0], line[row.end() :]
        elif block and indent == len(prefix):
            block += f" {line.strip()}"
        else:
            flush()
            prefix, block = line[:indent], line.strip()
    flush()
    return lines


def filled(text: str, width: int, prefix: str, hang: str) -> list[str]:
    """Lines of whole words; what stands before the first one, and before the others."""
    return textwrap.wrap(
        text,
        width,
        initial_indent=prefix,
        subsequent_indent=hang,
        break_long_words=False,
        break_on_hyphens=False,
    )

# SPDX-License-Identifier: Apache-2.0
"""Verbs print results on standard output, as text or JSON, and progress on standard error."""

from __future__ import annotations

import json
import math
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from inverse_dynamics.outputs.plain import plain
from inverse_dynamics.show.result import texts_of
from inverse_dynamics.show.tables import ReportTable
from inverse_dynamics.terminal.help_text import filled
from inverse_dynamics.wording import message, printable

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from pathlib import Path

    from rich.console import ConsoleOptions, RenderableType
    from rich.segment import Segment

    from inverse_dynamics.progress import Progress
    from inverse_dynamics.show import result

    Line = RenderableType | result.Line

SCHEMA = 3  # of the object of --json; docs/command_line.md
_FIRST_LINE = 10.0  # s


class Screen(Console):
    """Standard output, or standard error: lines stay whole, control characters become escapes."""

    def __init__(
        self, *, stderr: bool = False, soft_wrap: bool = True, width: int | None = None
    ) -> None:
        super().__init__(
            stderr=stderr, soft_wrap=soft_wrap, width=width, highlight=False, markup=False
        )

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Every text passes here."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))

    def on_broken_pipe(self) -> None:
        """The reader has gone: cli.py ends the program."""
        raise BrokenPipeError


def show(
    arguments: argparse.Namespace,
    result: Mapping[str, Any],
    written: Iterable[Path],
    lines: Iterable[Line],
) -> None:
    """Print a verb's result: with --json as one object, else line by line.

    written: files and directories that the verb has written. lines: those of a result, or what rich
    prints. In JSON, undefined values are null; non-ASCII characters become escapes, so that a terminal
    acts on none.
    """
    if arguments.json:
        verb, paths = arguments.verb, [path for path in written if path is not None]
        document = {"schema": SCHEMA, "verb": verb, "written": paths, "result": result}
        print(json.dumps(plain(document), indent=2, allow_nan=False))
        return
    console = Screen()
    for line in texts_of(lines):
        if isinstance(line, tuple):
            key, text = line
            prefix = f"{key:<14} "
            if console.is_terminal and key:  # whole words
                text, prefix = "\n".join(filled(text, console.width, prefix, " " * 15)), ""
            console.print(f"{prefix}{text}" if key else Text(text, "bold"))
        else:
            shown = on_screen(line) if isinstance(line, ReportTable) else line
            if isinstance(shown, Table) and shown.caption and console.is_terminal:
                shown.caption = "\n".join(filled(f"{shown.caption}", console.width, "", ""))
            console.print(shown)


def on_screen(table: ReportTable) -> Table:
    """A table whose names stay whole; numbers are aligned to the right."""
    shown = Table(
        box=box.SIMPLE_HEAD,
        title=table.title or None,
        title_justify="left",
        caption=table.note or None,
        caption_justify="left",
        collapse_padding=True,
    )
    for heading, column in zip(table.headings, zip(*table.rows, strict=True), strict=True):
        texts = isinstance(column[0], str)
        shown.add_column(heading, justify="left" if texts else "right", overflow="fold")
    for row in table.rows:
        if table.total and row is table.rows[-1]:
            shown.add_section()
        cells = (rounded(value) if isinstance(value, float) else f"{value}" for value in row)
        shown.add_row(*cells)
    return shown


def rounded(value: float) -> str:
    """Three decimals, or three significant digits of small numbers."""
    if not math.isfinite(value):
        return "-"
    return f"{value:.3f}" if abs(value) >= 0.1 or value == 0 else f"{value:.3g}"


def announce(text: str) -> None:
    """Announce long work on stderr."""
    print(message(f"ids: {text} ..."), file=sys.stderr, flush=True)


class _ProgressLines:
    """Progress where stderr isn't a terminal: a line after 10 s, 20 s, 40 s and so on of work."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._start = now()
        self._next = _FIRST_LINE

    def __call__(self, what: str, done: int, total: int) -> None:
        passed = self._now() - self._start
        if passed >= self._next and 0 < done < total:
            self._next = 2.0 * passed
            announce(f"{what}: {100 * done // total} % done after {passed:.0f} s")


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """A bar per kind of work on stderr, removed at the end; lines where stderr isn't a terminal.

    It shows the work done, the time it took, and the time left.
    """
    console = Screen(stderr=True)
    if not console.is_terminal:
        yield _ProgressLines()
        return

    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description:<16}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
    )
    with Progress(*columns, console=console, transient=True) as bars:
        tasks: dict[str, Any] = {}

        def show(what: str, done: int, total: int) -> None:
            if what not in tasks:
                tasks[what] = bars.add_task(what, total=total)
            bars.update(tasks[what], completed=done, total=total)

        yield show

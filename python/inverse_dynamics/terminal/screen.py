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
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from rich.console import ConsoleOptions, RenderableType
    from rich.segment import Segment

    from inverse_dynamics.progress import Progress
    from inverse_dynamics.show import result

    Line = RenderableType | result.Line

SCHEMA = 3  # of the object of --json; docs/command_line.md
_FIRST_LINE = 10.0  # s
_WIDEST, _NUMBER = 10_000, 6  # characters of a line, and of most numbers


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
    console, texts = Screen(), list(texts_of(lines))
    widest = max((len(line[0]) for line in texts if isinstance(line, tuple)), default=0)
    for line in texts:
        if isinstance(line, tuple):
            key, text = line
            prefix = f"{key:<{max(14, widest)}} " if key else ""
            if console.is_terminal:  # whole words
                hang = " " * len(prefix)
                text, prefix = "\n".join(filled(text, console.width, prefix, hang)), ""
            console.print(f"{prefix}{text}" if key else Text(text, "bold"))
        elif isinstance(line, ReportTable):
            table = on_screen(line, console)
            Screen(width=max(console.width, _narrowest(table, console))).print(table)
        else:
            console.print(line)


def on_screen(table: ReportTable, console: Console) -> Table:
    """A table whose names stay whole, numbers aligned to the right; a line per row and no more in a pipe.

    Where headings make it wider than a terminal, those that are longer than what is below them become
    numbers, which the note explains.
    """
    if not console.is_terminal:
        return _drawn(table, table.headings, table.note, None)
    headings, notes = table.headings, [table.note]
    shown = _drawn(table, headings, table.note, box.SIMPLE_HEAD)
    if _narrowest(shown, console) > console.width:
        below = [max(_NUMBER, *map(len, map(_cell, c))) for c in zip(*table.rows, strict=True)]
        long = [h for h, most in zip(headings, below, strict=True) if _longest_word(h) > most]
        numbers = {heading: f"({k})" for k, heading in enumerate(long, 1)}
        notes = [*(f"{number} {heading}" for heading, number in numbers.items()), *notes]
        headings = [numbers.get(heading, heading) for heading in headings]
    lines = (row for note in notes if note for row in filled(note, console.width, "", ""))
    return _drawn(table, headings, "\n".join(lines), box.SIMPLE_HEAD)


def _drawn(table: ReportTable, headings: Sequence[str], note: str, lines: box.Box | None) -> Table:
    shown = Table(
        box=lines,
        title=table.title or None,
        title_justify="left",
        caption=note or None,
        caption_justify="left",
        collapse_padding=True,
        pad_edge=lines is not None,
        padding=(0, 1) if lines else (0, 2, 0, 0),
    )
    for heading, column in zip(headings, zip(*table.rows, strict=True), strict=True):
        texts = isinstance(column[0], str)
        shown.add_column(heading, justify="left" if texts else "right")
    for row in table.rows:
        if table.total and row is table.rows[-1]:
            shown.add_section()
        shown.add_row(*map(_cell, row))
    return shown


def _narrowest(table: Table, console: Console) -> int:
    """Its width with whole words, in a pipe with whole lines."""
    size = console.measure(table, options=console.options.update(width=_WIDEST))
    return size.minimum if console.is_terminal else size.maximum


def _longest_word(text: str) -> int:
    return max(map(len, text.split()))


def _cell(value: str | float) -> str:
    return rounded(value) if isinstance(value, float) else f"{value}"


def rounded(value: float) -> str:
    """Three decimals, or three significant digits of small numbers."""
    if not math.isfinite(value):
        return "-"
    return f"{value:.3f}" if abs(value) >= 0.1 or value == 0 else f"{value:.3g}"


def announce(text: str) -> None:
    """Announce long work on stderr."""
    say(f"{text} ...")


def say(text: str) -> None:
    """A sentence on stderr; bars of progress stay below it."""
    print(message(f"ids: {text}"), file=sys.stderr, flush=True)


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

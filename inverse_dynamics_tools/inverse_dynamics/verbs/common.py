# SPDX-License-Identifier: Apache-2.0
"""What verbs share: types of options, progress on the screen."""

from __future__ import annotations

import argparse
import math
import re
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.base.decimals import decimal
from inverse_dynamics.base.wording import shown
from inverse_dynamics.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from inverse_dynamics.base.arrays import Parameter
    from inverse_dynamics.base.progress import Progress

_FIRST_LINE = 10.0  # s

_OPTIONS = {  # by the parameter that they set
    "root": "--root",
    "tip": "--tip",
    "gravity": "--gravity",
    "friction": "--no-friction",
    "robot_description": "--urdf",
}


def three_numbers(text: str) -> tuple[float, float, float]:
    """`x,y,z` of an option."""
    try:
        x, y, z = (decimal(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected three numbers, x,y,z, got '{text}'") from None
    if not all(math.isfinite(number) for number in (x, y, z)):
        raise argparse.ArgumentTypeError(f"expected finite numbers, got '{text}'")
    return (x, y, z)


def file_name(text: str) -> Path:
    """The path of an argument; not that of an unset variable, which Path takes for `.`."""
    if not text:
        raise argparse.ArgumentTypeError("expected the name of a file or directory, got ''")
    return Path(text)


def names(text: str) -> tuple[str, ...]:
    """`a,b,c` of an option."""
    parts = tuple(part.strip() for part in text.split(","))
    if not all(parts):
        raise argparse.ArgumentTypeError(f"expected names, a,b,c, got '{text}'")
    return parts


def figure_formats(text: str) -> tuple[str, ...]:
    """`png,svg` of an option; `none`: no figure."""
    from inverse_dynamics.figures.plots import FORMATS

    formats = () if text == "none" else tuple(part.strip() for part in text.split(","))
    if any(part not in FORMATS for part in formats) or len(set(formats)) < len(formats):
        raise argparse.ArgumentTypeError(
            f"expected some of {', '.join(FORMATS)}, such as png,pdf, or none, got {shown(text)}"
        )
    return formats


def positive_number(text: str) -> float:
    """A number above zero of an option."""
    try:
        number = decimal(text)
    except ValueError:
        number = math.nan
    if not (number > 0 and math.isfinite(number)):
        raise argparse.ArgumentTypeError(f"expected a number above zero, got '{text}'")
    return number


def share(text: str) -> float:
    """A part of something, above 0 and up to 1."""
    part = positive_number(text)
    if part > 1.0:
        raise argparse.ArgumentTypeError(f"expected a part, above 0 and up to 1, got '{text}'")
    return part


def number(text: str) -> float:
    """A finite number of an option."""
    try:
        value = decimal(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a number, got '{text}'")
    return value


def whole_number(text: str) -> int:
    """A number of things of an option: 0, 1, 2, ..."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 18):
        raise argparse.ArgumentTypeError(f"expected an integer that isn't negative, got '{text}'")
    return int(text)


def process_count(text: str) -> int:
    """A number of processes of an option: 1, 2, ..."""
    count = whole_number(text)
    if count == 0:
        raise argparse.ArgumentTypeError("expected a number of processes above zero, got '0'")
    return count


def parameter(text: str) -> tuple[str, Parameter]:
    """`NAME=VALUE` of an option; the value as it would stand in a run configuration."""
    from inverse_dynamics import _core
    from inverse_dynamics.base.located_yaml import parse_mapping

    name, _, value = text.partition("=")
    if name == "model":
        raise argparse.ArgumentTypeError(
            "model: is not an option: put it at the top of the run configuration"
        )
    if name in _OPTIONS:
        raise argparse.ArgumentTypeError(
            f"{name}: has an option of its own: give {_OPTIONS[name]} instead"
        )
    found, why = {}, ""
    try:
        found = _core.solver_parameters(parse_mapping(f"{name}: {value}", "option", UserError))
    except UserError as error:
        why = f" ({re.sub(r'^option(:[0-9]+)?: ', '', str(error))})"
    if list(found) != [name]:
        raise argparse.ArgumentTypeError(
            "expected NAME=VALUE, VALUE a number, a text, true, false or a list of one of them, "
            f"[1, 2], got {shown(text)}{why}"
        )
    return name, found[name]


def announce(text: str) -> None:
    """One line on stderr, also where it isn't a terminal: what is about to be done takes long."""
    from inverse_dynamics.base.wording import message

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
    """A bar per kind of work, on stderr, gone at the end; lines where stderr isn't a terminal.

    It shows what is done, the time that it took, and the time that is left.
    """
    from inverse_dynamics.verbs.screen import Screen

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

    with Progress(
        TextColumn("{task.description:<16}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
        console=console,
        transient=True,
    ) as bars:
        tasks: dict[str, object] = {}

        def show(what: str, done: int, total: int) -> None:
            if what not in tasks:
                tasks[what] = bars.add_task(what, total=total)
            bars.update(tasks[what], completed=done, total=total)  # type: ignore[arg-type]

        yield show

# SPDX-License-Identifier: Apache-2.0
"""`ids bench`: how fast this machine computes inverse dynamics."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.values import count, positive_number

if TYPE_CHECKING:
    from inverse_dynamics.terminal.options import Options
    from inverse_dynamics_benchmarks import Measurement

PLACE = ("share", 4)
SUMMARY = "measure this machine beside KDL, Pinocchio and MuJoCo"
DESCRIPTION = "Time this library, KDL, Pinocchio and MuJoCo on this machine."
EPILOG = """\
examples:
  ids bench                                      this machine's tables, in about a minute
  ids bench --only ur10/torques                  only what has such a name
  ids bench --latency                            the slowest of a million single calls too
  ids bench --repetitions 200 --json speed.json  with less noise; the times in a file
  ids bench --from speed.json --plot speed.svg   a figure of times measured before

One thread, double precision, the same 1024 random states for all; time of one state, the least of
the repetitions, which come in random order. This library is called through its public interface,
checks included; KDL, Pinocchio and MuJoCo by their own fastest calls. Keep the machine quiet.
Needs the package inverse_dynamics_benchmarks and Google Benchmark (Debian: libbenchmark-dev).
"""

_REPETITIONS = 20
_SECONDS = 0.003
_CALLS = 1_000_000


def declare(options: Options) -> None:
    """Arguments and options."""
    measured = options.group("what is measured")
    measured.add("--from FILE", "nothing: show what --json wrote earlier", Path, dest="source")
    measured.add(
        "--only REGEX",
        "benchmarks whose name, ROBOT/QUANTITY/LIBRARY, matches",
        _regular_expression,
        default="",
    )
    measured.add(
        "--repetitions N",
        f"of each benchmark, two or more (default: {_REPETITIONS})",
        _repetitions,
    )
    measured.add("--seconds S", f"of each repetition (default: {_SECONDS})", positive_number)
    measured.add("--latency", "time single calls too: their worst, not their least")
    measured.add("--calls N", f"how many with --latency (default: {_CALLS})", count)
    results = options.group("where results go, besides the screen")
    results.add("--json FILE", "all times, for --from", Path)
    results.add("--markdown FILE", "the tables as a page", Path)
    results.add("--plot FILE", "a figure: .svg, .png or .pdf", Path)
    results.add("--overwrite", "replace existing files")


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.outputs.files import write_text_whole
    from inverse_dynamics.terminal.screen import Screen
    from inverse_dynamics_benchmarks import measure, page, read_measurement, write_measurement
    from inverse_dynamics_benchmarks.plot import check_figure_name, save_speed_figure

    # Before anything is measured: that may take ten minutes.
    _check_outputs(arguments)
    _check_measuring(arguments)
    if arguments.plot is not None:
        check_figure_name(arguments.plot)

    if arguments.source is not None:
        result = read_measurement(arguments.source)
    else:
        with Screen(stderr=True).status("measuring; keep the machine quiet"):
            result = measure(
                repetitions=arguments.repetitions or _REPETITIONS,
                seconds=arguments.seconds or _SECONDS,
                only=arguments.only,
                latency_calls=(arguments.calls or _CALLS) if arguments.latency else 0,
            )
    if arguments.json is not None:
        write_measurement(result, arguments.json)
    if arguments.markdown is not None:
        write_text_whole(arguments.markdown, page(result))
    if arguments.plot is not None:
        save_speed_figure(result, arguments.plot)
    _print(result)


def _check_outputs(arguments: argparse.Namespace) -> None:
    from inverse_dynamics.errors import OutputError
    from inverse_dynamics.outputs.files import check_output_file

    others: dict[Path, str] = {}
    for option in ("--json", "--markdown", "--plot"):
        file: Path | None = getattr(arguments, option.removeprefix("--"))
        if file is None:
            continue
        # --json writes again what --from has read: the same file may be meant.
        inputs = [arguments.source] if option != "--json" else []
        check_output_file(file, overwrite=arguments.overwrite, option=option, inputs=inputs)
        other = others.setdefault(file.resolve(), option)
        if other != option:
            raise OutputError(
                f"{file}: expected a file of its own for each result, got the same for {other} "
                f"and {option}; name another file with {option}"
            )


def _check_measuring(arguments: argparse.Namespace) -> None:
    from inverse_dynamics.errors import UserError

    for option in ("--only", "--repetitions", "--seconds", "--latency", "--calls"):
        if arguments.source is not None and getattr(arguments, option.removeprefix("--")):
            raise UserError(
                f"{option}: expected no such choice beside --from, which shows everything that was "
                "measured; leave one of them out"
            )
    if arguments.calls is not None and not arguments.latency:
        raise UserError(
            "--calls: expected --latency beside it, got none; add --latency, or leave --calls out"
        )


def _print(result: Measurement) -> None:
    from rich.markdown import Markdown

    from inverse_dynamics.terminal.screen import Screen
    from inverse_dynamics_benchmarks import page

    # Numbers in full on a narrow screen too, if need be by scrolling.
    Screen(soft_wrap=False, width=max(120, Screen().width)).print(Markdown(page(result)))


def _repetitions(text: str) -> int:
    repetitions = count(text)
    if repetitions == 1:  # no statistics of one
        raise argparse.ArgumentTypeError("expected two or more, got '1'")
    return repetitions


def _regular_expression(text: str) -> str:
    try:
        re.compile(text)
    except re.error as error:
        raise argparse.ArgumentTypeError(
            f"expected a regular expression, got '{text}' ({error})"
        ) from None
    return text

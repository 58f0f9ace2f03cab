# SPDX-License-Identifier: Apache-2.0
"""The command `ids`: verbs, errors, exit codes.

A verb is a module of inverse_dynamics.verbs with `add_parser(subparsers)` and `run(arguments)`; it
imports what is heavy inside `run`. Exit code 0: done; 2: a mistake of the user, said on stderr
(without a verb: the help).
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from importlib import import_module
from typing import TYPE_CHECKING

from inverse_dynamics.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import NoReturn

VERBS = (
    "demo",
    "robots",
    "data",
    "simulate",
    "evaluate",
    "compare",
    "torques",
    "report",
    "video",
    "export",
    "bench",
)

_EPILOG = """\
start here:
  ids demo                                       four robots on one page
  ids data                                       fetch the recordings of the two real ones
  ids robots                                     which robots there are
  ids simulate --robot ur10_simulated --out BAG  record a simulated one
  ids evaluate RECORDING --robot ur10_real       computed against measured torques: table and plots
  ids VERB --help                                more on a verb, with examples
"""

# A list of numbers that begins with a minus looks like an option to argparse.
_NUMBERS = re.compile(r"-[\d.]+(e[-+]?\d+)?,[-+\d.,e]+", re.IGNORECASE)


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, and where help is: pages of usage would hide it."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {message}; see `{self.prog} --help`\n")


def make_parser() -> argparse.ArgumentParser:
    """Parser of the whole command line."""
    parser = _Parser(
        prog="ids",
        description="Inverse dynamics of robot arms: which joint torques belong to this motion?",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    subparsers = parser.add_subparsers(title="verbs", metavar="VERB", required=True)
    for verb in VERBS:
        module = import_module(f"inverse_dynamics.verbs.{verb}")
        module.add_parser(subparsers).set_defaults(run=module.run)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line; give its exit code."""
    given = _with_numbers_joined(list(sys.argv[1:] if arguments is None else arguments))
    parser = make_parser()
    if not given:
        parser.print_help(sys.stderr)
        return 2
    options = parser.parse_args(given)
    try:
        options.run(options)
        sys.stdout.flush()
    except UserError as error:
        print(f"ids: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("ids: interrupted; nothing was written", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output, `head` for one, has enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    return 0


def _with_numbers_joined(arguments: list[str]) -> list[str]:
    """`--gravity -9.81,0,0` as `--gravity=-9.81,0,0`."""
    joined: list[str] = []
    for argument in arguments:
        previous = joined[-1] if joined else ""
        if _NUMBERS.fullmatch(argument) and previous.startswith("--") and "=" not in previous:
            joined[-1] = f"{previous}={argument}"
        else:
            joined.append(argument)
    return joined

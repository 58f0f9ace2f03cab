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
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import UserError
from inverse_dynamics.wording import did_you_mean

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

# What argparse says of a wrong verb or value.
_CHOICE = re.compile(r"invalid choice: '(.*)' \(choose from (.*)\)")


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, and where help is: pages of usage would hide it."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """What is given; an unknown option is an error of the verb, whose help knows the right one."""
        options, unknown = self.parse_known_args(args, namespace)
        if unknown:
            parser = getattr(options, "parser", self)
            hint = did_you_mean(unknown[0].partition("=")[0], parser._option_string_actions)
            parser.error(f"unrecognized arguments: {' '.join(unknown)}{hint and f'; {hint}'}")
        return options

    def error(self, message: str) -> NoReturn:
        if wrong := _CHOICE.search(message):
            hint = did_you_mean(wrong[1], re.findall(r"[\w-]+", wrong[2]))
            message += hint and f"; {hint}"
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
        verb_parser = module.add_parser(subparsers)
        verb_parser.set_defaults(run=module.run, parser=verb_parser)
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

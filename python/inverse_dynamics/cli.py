# SPDX-License-Identifier: Apache-2.0
"""The command `ids`: verbs, errors, exit codes.

A verb NAME is a module verb_NAME.py in the folder of its feature, with PLACE and SUMMARY (its group, place in it,
and line in the list of verbs), EPILOG (examples, a paragraph each: `-h` shows those that fit), perhaps DESCRIPTION,
`declare(options)` and `run(arguments)`, which imports what is heavy. Its line stands in docs/command_line.md. A
package that is built on request brings its verb.
Exit code 0: done; 2: something that the user can correct, named on stderr (without a verb: the help);
3: some of several recordings failed, the others are done; 1: an unexpected error, with a report in a
file; 128 + n: ended by signal n (141: the reader of the output has gone).
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import signal
import sys
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import PartialError, UserError
from inverse_dynamics.installation.extras import EXTRAS, missing
from inverse_dynamics.outputs.crash import crash_report
from inverse_dynamics.outputs.files import (
    outcome,
    replaced,
    start_noting_outputs,
    written_before,
)
from inverse_dynamics.terminal.help_text import HelpFormatter, filled, terminal_width, wrapped
from inverse_dynamics.terminal.options import Options
from inverse_dynamics.wording import TERMINAL, did_you_mean, not_built
from inverse_dynamics.wording import message as _message

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from types import FrameType
    from typing import NoReturn

GROUPS = ("look", "identify", "plan", "share")

# Packages that are built on request: their modules `verb` are verbs too, where they are built.
BUILT_ON_REQUEST = {"bench": "inverse_dynamics_benchmarks"}
_SCREEN = 22  # lines of `-h`

_EPILOG = """\
start here:
  ids demo                                       four robots on one page
  ids data                                       fetch recordings of two real robots
  ids robots                                     list the robots
  ids simulate --robot ur10_simulated --out BAG  record a simulated robot
  ids evaluate RECORDING --robot ur10_real       computed against measured torques: table and plots
  ids VERB -h, ids VERB --help                   a verb on one screen, all of it

Outputs are written whole or not at all. Exit status: 0 done, 2 something to
correct, 3 some of several recordings failed, 1 an unexpected error, 128 + N
ended by signal N.
"""

# To argparse, what begins with a minus is an option unless it looks like this: a number, or several.
_NUMBERS = re.compile(r"-[\d.]+(e[-+]?\d+)?(,[-+\d.,e]+)?$", re.IGNORECASE)

# argparse's text for a wrong verb or value.
_CHOICE = re.compile(r"invalid choice: '(.*)' \(choose from (.*)\)")


class _Version(argparse.Action):
    """--version: read when it is asked for, as that takes time."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from inverse_dynamics.installation.version import version

        print(f"ids {version()}")
        parser.exit()


class _ShortHelp(argparse.Action):
    """-h: a verb on one screen, with as many examples as fit, or the verbs."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        examples = re.split(r"\n\n", (parser.epilog or "").partition("examples:\n")[2])[:2]
        lines = _short_help(parser, examples)
        while examples and len(lines) > _SCREEN:
            examples.pop()
            lines = _short_help(parser, examples)
        print("\n".join(lines))
        parser.exit()


def _short_help(parser: argparse.ArgumentParser, examples: list[str]) -> list[str]:
    actions = [a for a in parser._actions if a.help is not argparse.SUPPRESS]
    positional = " ".join(f"{a.metavar or a.dest}" for a in actions if not a.option_strings)
    usage = parser.usage or " ".join(filter(None, (parser.prog, positional, "[options]")))
    lines = [f"usage: {usage}", "", parser.description or ""]
    lines += ["", *examples] if examples else []
    for group in parser._action_groups:
        options = [_usage(a) for a in group._group_actions if a.option_strings and a in actions]
        if options:
            lines.append(f"{group.title}: {', '.join(options)}")
    lines.append(f"all of it: {parser.prog} --help")
    return [row for part in lines for row in wrapped(part, terminal_width()) or [""]]


def _usage(action: argparse.Action) -> str:
    """`--out DIR`, `--json`."""
    value = "" if action.nargs == 0 else f" {action.metavar or action.dest.upper()}"
    return f"{action.option_strings[0]}{value}"


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, and where help is: pages of usage would hide it."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = _NUMBERS

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse; an unknown option is an error of the verb, whose help lists the known ones."""
        first = "" if not args else args[0].partition("=")[0]
        if first.startswith("-") and not any(
            o.startswith(first) for o in self._option_string_actions
        ):
            self._refuse([first])
        options, unknown = self.parse_known_args(args, namespace)
        if unknown:
            getattr(options, "parser", self)._refuse(unknown)
        return options

    def _refuse(self, unknown: list[str]) -> NoReturn:
        known = (option for option in self._option_string_actions if option.startswith("--"))
        hint = did_you_mean(unknown[0].partition("=")[0], known)
        self.error(f"unrecognized arguments: {' '.join(unknown)}{hint and f'; {hint}'}")

    def error(self, message: str) -> NoReturn:
        wrong = _CHOICE.search(message)
        if wrong and (package := BUILT_ON_REQUEST.get(wrong[1])):
            message = f"verb {wrong[1]}: {not_built(package)}"
        elif wrong:
            hint = did_you_mean(wrong[1], re.findall(r"[\w-]+", wrong[2]))
            message += hint and f"; {hint}"
        self.exit(2, f"{_shown(f'{self.prog}: error: {message}; see `{self.prog} --help`')}\n")


def make_parser() -> argparse.ArgumentParser:
    """Parser of the whole command line."""
    parser = _Parser(
        prog="ids",
        usage="ids VERB ...",
        description="Inverse dynamics of robot arms: which joint torques belong to this motion?",
        epilog=_EPILOG,
        formatter_class=HelpFormatter,
        add_help=False,
    )
    _add_help(parser, "show the verbs")
    parser.add_argument(
        "-V", "--version", action=_Version, nargs=0, help="show the version and exit"
    )
    subparsers = parser.add_subparsers(
        prog="ids", metavar="VERB", required=True, help=argparse.SUPPRESS
    )
    modules = {verb: import_module(module) for verb, module in verb_modules().items()}
    rows, last = [], ""
    for verb, module in sorted(modules.items(), key=_place):
        _add_verb(subparsers, verb, module)
        group, _ = module.PLACE
        rows.append(f"{'' if group == last else group:<9} {verb:<10}  {module.SUMMARY}")
        last = group
    parser.description = "\n".join((parser.description or "", "", *rows))
    return parser


def _place(verb: tuple[str, Any]) -> tuple[int, int]:
    group, number = verb[1].PLACE
    return GROUPS.index(group), number


def verb_modules() -> dict[str, str]:
    """Names of modules by verb, in alphabetical order; of packages that are built on request, where they are."""
    files = Path(__file__).parent.glob("*/verb_*.py")
    own = {
        f.stem.removeprefix("verb_"): f"inverse_dynamics.{f.parent.name}.{f.stem}" for f in files
    }
    built = {
        verb: f"{package}.verb" for verb, package in BUILT_ON_REQUEST.items() if find_spec(package)
    }
    return dict(sorted((own | built).items()))


def _add_help(parser: argparse.ArgumentParser, short: str) -> None:
    parser.add_argument("-h", action=_ShortHelp, nargs=0, help=short)
    parser.add_argument("--help", action="help", help="show all of this")


def _add_verb(subparsers: Any, verb: str, module: Any) -> None:
    summary = module.SUMMARY
    parser = subparsers.add_parser(
        verb,
        help=summary,
        description=getattr(module, "DESCRIPTION", f"{summary[0].upper()}{summary[1:]}."),
        epilog=module.EPILOG,
        formatter_class=HelpFormatter,
        add_help=False,
    )
    _add_help(parser, "show this verb on one screen")
    module.declare(Options(parser))
    parser.set_defaults(run=module.run, parser=parser, verb=verb)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line; give its exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    _write_any_character()
    os.environ[TERMINAL] = "1"
    try:
        with _stopped_by_signals(), _signals_out_of_imports():
            return _run(given)
    except _Stopped as stop:
        _say(f"{stop}; {outcome()}")
        return 128 + stop.number
    except KeyboardInterrupt:
        _say(f"interrupted; {outcome()}")
        return 128 + signal.SIGINT
    except BrokenPipeError:  # the reader of our output, `head` for one, has enough
        _drop_output()
        return 128 + signal.SIGPIPE
    except Exception as error:
        _say(f"error: {crash_report(error, given)}; {outcome()}")
        return 2 if isinstance(error, ModuleNotFoundError) else 1
    finally:
        os.environ.pop(TERMINAL, None)


def _run(given: list[str]) -> int:
    start_noting_outputs()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices are small: others would only wait
    parser = make_parser()
    if "_ARGCOMPLETE" in os.environ:  # a shell asks what may stand at the cursor: `ids completion`
        from argcomplete import autocomplete

        autocomplete(parser)
    if given[:1] == ["help"]:  # as many programs have it
        given = [*given[1:2], "--help"]
    if not given:
        parser.print_help(sys.stderr)
        return 2
    try:
        options = parser.parse_args(given)
        options.command_line = given
        options.run(options)
        if sys.stdout is not None:
            sys.stdout.flush()
        if told := replaced():
            _say(told)
    except BrokenPipeError:
        raise
    except UserError as error:
        separator = "\n" if "\n" in str(error) else "; "
        _say(separator.join(filter(None, (f"error: {error}", written_before()))))
        return 3 if isinstance(error, PartialError) else 2
    except ModuleNotFoundError as error:
        if error.name not in EXTRAS:
            raise
        _say(f"error: {missing('this', error.name)}")
        return 2
    except OSError as error:
        place = error.filename or "a file, or the standard output"
        _say(f"error: {place}: {error.strerror or error}; {outcome()}")
        _drop_output()
        return 2
    return 0


class _Stopped(BaseException):
    """A signal that asks the program to end. Not an Exception, so that no handler of faults catches it."""

    def __init__(self, number: int) -> None:
        super().__init__(f"ended by {signal.Signals(number).name}")
        self.number = number


@contextmanager
def _stopped_by_signals() -> Iterator[None]:
    """SIGTERM and SIGHUP end the program as Ctrl-C does: nothing half-written is left."""

    def stop(number: int, _: FrameType | None) -> None:
        raise _Stopped(number)

    before = {}
    try:
        with suppress(ValueError):  # in another thread than the main one
            for number in (signal.SIGTERM, signal.SIGHUP):
                if signal.getsignal(number) == signal.SIG_DFL:  # nohup ignores SIGHUP
                    before[number] = signal.signal(number, stop)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _signals_out_of_imports() -> Iterator[None]:
    """A signal during the import of a module in C++ is the cause of an ImportError: raise the cause."""
    try:
        yield
    except ImportError as error:
        cause: BaseException | None = error
        while isinstance(cause, Exception):
            cause = cause.__cause__ or cause.__context__
        if cause is None:
            raise
        raise cause from error


def _shown(text: str) -> str:
    """A message as stderr has it: a terminal in lines of whole words."""
    text = _message(text)
    with suppress(OSError, ValueError):
        if sys.stderr is not None and sys.stderr.isatty():
            width = shutil.get_terminal_size().columns
            lines = text.splitlines()
            return "\n".join(row for line in lines for row in filled(line, width, "", "  "))
    return text


def _say(text: str) -> None:
    """A message to the user, on stderr, after what stands on stdout."""
    with suppress(OSError, ValueError, AttributeError):
        sys.stdout.flush()
    with suppress(OSError, ValueError):
        print(_shown(f"ids: {text}"), file=sys.stderr, flush=True)


def _write_any_character() -> None:
    """A terminal without a character gets its escape, instead of this program an error."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError):  # closed, or somebody's own
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


def _drop_output() -> None:
    """Discard what is still to be printed: Python would fail again at exit."""
    with suppress(AttributeError, OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())

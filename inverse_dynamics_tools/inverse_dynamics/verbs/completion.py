# SPDX-License-Identifier: Apache-2.0
"""`ids completion`: scripts that complete commands in bash and zsh.

The scripts ask this verb again, with the words before the cursor, for what may stand there. It reads
the parsers of the verbs, so that nothing is stated twice.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.base.extras import installed_by_pip
from inverse_dynamics.verbs.common import file_name
from inverse_dynamics.verbs.options import add_verb
from inverse_dynamics.verbs.payload_option import payload

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_EPILOG = """\
examples:
  ids completion bash             print the script for bash
  source <(ids completion bash)   complete in this shell; in ~/.bashrc: in every one
  source <(ids completion zsh)    the same for zsh, in ~/.zshrc after compinit
"""

FILES = ":files"  # a line that stands for the names of files

_SCRIPTS = {
    "bash": """\
# Completion of ids in bash: source <(ids completion bash)
_ids() {
  local current=${COMP_WORDS[COMP_CWORD]} line
  [[ $current == = ]] && current=
  COMPREPLY=()
  while IFS= read -r line; do
    if [[ $line == :files ]]; then
      compopt -o filenames 2>/dev/null
      while IFS= read -r line; do COMPREPLY+=("$line"); done < <(compgen -f -- "$current")
    else
      COMPREPLY+=("$line")
    fi
  done < <("${COMP_WORDS[0]}" completion bash "${COMP_WORDS[@]:0:COMP_CWORD+1}" 2>/dev/null)
}
complete -F _ids ids
""",
    "zsh": """\
# Completion of ids in zsh: source <(ids completion zsh)
_ids() {
  local -a found
  local line files
  while IFS= read -r line; do
    if [[ $line == :files ]]; then files=1; else found+=("$line"); fi
  done < <("$words[1]" completion zsh "${(@)words[1,CURRENT]}" 2>/dev/null)
  [[ $PREFIX == --*=* ]] && compset -P '*='
  (( $#found )) && compadd -a found
  [[ -n $files ]] && _files
  return 0
}
compdef _ids ids
""",
}


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "completion",
        summary="print the script that completes `ids` commands in bash or zsh",
        epilog=_EPILOG,
    )
    parser.add_argument("shell", choices=tuple(_SCRIPTS), help="the shell that reads the script")
    words = parser.add_argument("words", nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    words.required = False
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    if arguments.words:
        for candidate in candidates(arguments.program, arguments.words[1:]):
            print(candidate)
    else:
        print(_SCRIPTS[arguments.shell], end="")


def candidates(program: argparse.ArgumentParser, words: Sequence[str]) -> list[str]:
    """What may stand at the cursor, by the parser of `ids`; FILES: also names of files.

    words: those after `ids`, the last one as far as it is written.
    """
    *before, current = _split(words) or [""]
    (verbs,) = (a for a in program._actions if isinstance(a, argparse._SubParsersAction))
    parser = program
    for place, word in enumerate(before):
        if word in verbs.choices:
            parser, before = verbs.choices[word], before[place + 1 :]
            break
    if parser is program:
        found = _options(program) if current.startswith("-") else list(verbs.choices)
    else:
        found = _of_verb(parser, before, current)
    return [one for one in found if one == FILES or one.startswith(current)]


def _split(words: Sequence[str]) -> list[str]:
    """`--robot=x`, which bash gives as three words and zsh as one, as two."""
    split: list[str] = []
    for place, word in enumerate(words):
        option, equals, value = word.partition("=")
        if word == "=":  # bash; the value follows, unless the cursor is here
            split += [""] if place == len(words) - 1 else []
        elif word.startswith("--") and equals:
            split += [option, value]
        else:
            split.append(word)
    return split


def _of_verb(parser: argparse.ArgumentParser, before: Sequence[str], current: str) -> list[str]:
    """What may follow the words after a verb."""
    positional = parser._get_positional_actions()
    pending: argparse.Action | None = None  # the option whose value may come next
    filled = 0  # positional arguments
    for word in before:
        if word.startswith("-"):
            option = parser._option_string_actions.get(word)
            pending = None if option is None or option.nargs == 0 else option
        elif pending is None:
            filled += 1
        elif pending.nargs != "+":
            pending = None
    if pending is not None and not current.startswith("-"):
        return _values(pending)
    if current.startswith("-"):
        return _options(parser)
    last = positional[-1:] if positional and positional[-1].nargs == "+" else []
    expected = (positional[filled : filled + 1] or last)[:1]
    return _values(expected[0]) if expected else _options(parser)


def _options(parser: argparse.ArgumentParser) -> list[str]:
    return [name for name in parser._option_string_actions if name.startswith("--")]


def _values(action: argparse.Action) -> list[str]:
    """Values of an option or argument; none where it takes a number or a name of one's own."""
    if action.choices is not None:
        return [str(choice) for choice in action.choices]
    if action.metavar == "NAME|FILE":
        return [*_robot_names(), FILES]
    if action.metavar == "PACKAGE/CLASS":
        from inverse_dynamics import _core

        return _core.available_solvers()
    return [FILES] if action.type in (Path, file_name, payload) else []


def _robot_names() -> Iterable[str]:
    """As robots.robot_names(), where it can be without loading the libraries, which takes 0.1 s."""
    workspaces = "" if installed_by_pip() else os.environ.get("AMENT_PREFIX_PATH", "")
    for prefix in workspaces.split(os.pathsep):
        directory = Path(prefix) / "share" / "inverse_dynamics_robots" / "robots"
        if prefix and directory.is_dir():
            return sorted(file.stem for file in directory.glob("*.yaml"))
    from inverse_dynamics.robot.robots import robot_names

    return robot_names()

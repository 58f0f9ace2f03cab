# SPDX-License-Identifier: Apache-2.0
"""`ids completion`: the script by which a shell completes commands; argcomplete answers it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.verbs.options import add_verb

if TYPE_CHECKING:
    import argparse

_EPILOG = """\
examples:
  source <(ids completion bash)   complete in this shell; in ~/.bashrc: in every one
  source <(ids completion zsh)    the same for zsh, in ~/.zshrc after compinit
  ids completion fish | source    the same for fish
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "completion",
        summary="print the script that completes `ids` commands in bash, zsh or fish",
        epilog=_EPILOG,
    )
    parser.add_argument(
        "shell", choices=("bash", "zsh", "fish"), help="the shell that reads the script"
    )
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from argcomplete.shell_integration import shellcode

    print(shellcode(["ids"], shell=arguments.shell))

# SPDX-License-Identifier: Apache-2.0
"""`ids completion`: the script by which a shell completes commands; argcomplete answers it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse

    from inverse_dynamics.terminal.options import Options

PLACE = ("share", 3)
SUMMARY = "print the script that completes `ids` commands"
DESCRIPTION = "Print the script that completes `ids` commands in bash, zsh or fish."
EPILOG = """\
examples:
  source <(ids completion bash)   complete in this shell; in ~/.bashrc: in every one
  source <(ids completion zsh)    the same for zsh, in ~/.zshrc after compinit
  ids completion fish | source    the same for fish
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    shells = ("bash", "zsh", "fish")
    options.argument("shell", choices=shells, help="the shell that reads the script")


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from argcomplete.shell_integration import shellcode

    print(shellcode(["ids"], shell=arguments.shell))

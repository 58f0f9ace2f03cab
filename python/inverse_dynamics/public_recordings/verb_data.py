# SPDX-License-Identifier: Apache-2.0
"""`ids data`: fetch public recordings of real robots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from inverse_dynamics.terminal.options import Options

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from inverse_dynamics.terminal.screen import Line

PLACE = ("look", 2)
SUMMARY = "fetch public recordings of a real UR10 and a real Panda"
DESCRIPTION = "Fetch the public recordings of a real UR10 and a real Panda."
EPILOG = """\
examples:
  ids data --dry-run          what would be fetched, from where, how large
  ids data                    fetch it; `ids demo` finds it
  ids data --out recordings   to another directory: IDS_DATA_DIR=recordings ids demo
  ids data --from CLONE       from a clone of the public repository, without network

A real UR10 and a real Panda, each on an exciting trajectory: DIR/bags/ur10_exciting_trajectory and
DIR/bags/panda_exciting_trajectory. The SHA-256 of every file is checked. Recordings that are already there
and intact are kept; each recording is written whole or not at all.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.output(
        "DIR",
        "output directory (default: $IDS_DATA_DIR, else $XDG_DATA_HOME/inverse_dynamics, else "
        "~/.local/share/inverse_dynamics)",
    )
    options.shared("--json")
    options.add(
        "--from URL|CLONE",
        "source of the files, instead of GitHub: another server, or the directory of a clone",
        dest="source",
        default="",
    )
    options.add("--dry-run", "only list what would be fetched")


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.public_recordings.public_recordings import (
        data_directory,
        fetch_recordings,
        listed,
    )
    from inverse_dynamics.terminal.screen import progress_bar, say, show

    directory = arguments.out or data_directory()
    written = []
    if not arguments.dry_run:
        with progress_bar() as progress:
            written = fetch_recordings(
                directory,
                source=arguments.source,
                overwrite=arguments.overwrite,
                say=say,
                progress=progress,
            )
    found = listed(directory)
    show(arguments, found, written, _plan(found) if arguments.dry_run else map(str, written))


def _plan(found: dict[str, Any]) -> Iterator[Line]:
    """The recordings, and the size of the missing ones."""
    yield f"{found['repository']}, commit {found['commit']}, license {found['license']}"
    for recording in found["recordings"]:
        state = "already there and intact" if recording["intact"] else "to be fetched"
        yield f"{recording['directory']}: {state}"
        for file in recording["files"]:
            yield f"  {file['size']:>9} bytes  {file['source']}\n             SHA-256 {file['sha256']}"
    missing = sum(r["bytes"] for r in found["recordings"] if not r["intact"])
    yield f"to fetch: {missing / 1e6:.2f} MB; nothing was fetched"

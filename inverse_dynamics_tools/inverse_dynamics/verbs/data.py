# SPDX-License-Identifier: Apache-2.0
"""`ids data`: fetch public recordings of real robots."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from inverse_dynamics.verbs.common import progress_bar
from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import add_verb

_EPILOG = """\
examples:
  ids data --dry-run          what would be fetched, from where, how large
  ids data                    fetch it; `ids demo` finds it
  ids data --out recordings   to another directory: IDS_DATA_DIR=recordings ids demo
  ids data --from CLONE       from a clone of the public repository, without network

A real UR10 and a real Panda, each on an exciting trajectory: DIR/bags/ur10_exciting_trajectory and
DIR/bags/panda_exciting_trajectory. The SHA-256 of every file is checked. Recordings that are already there
and intact are kept; each recording is written whole or not at all.
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "data",
        summary="fetch the public recordings of a real UR10 and a real Panda",
        description="Fetch the public recordings of a real UR10 and a real Panda, and check them.",
        epilog=_EPILOG,
        json=True,
    )
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        help="output directory (default: $IDS_DATA_DIR, else $XDG_DATA_HOME/inverse_dynamics, else "
        "~/.local/share/inverse_dynamics)",
    )
    parser.add_argument(
        "--from",
        dest="source",
        metavar="URL|CLONE",
        default="",
        help="source of the files, instead of GitHub: another server, or the directory of a clone",
    )
    parser.add_argument("--dry-run", action="store_true", help="only list what would be fetched")
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace recordings that differ from the published ones",
    )
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.data.public_recordings import data_directory, fetch_recordings
    from inverse_dynamics.verbs.screen import Screen

    directory = arguments.out or data_directory()
    if arguments.dry_run and not arguments.json:
        _print_plan(directory)
        return
    written = []
    if not arguments.dry_run:
        with progress_bar() as progress:
            written = fetch_recordings(
                directory,
                source=arguments.source,
                overwrite=arguments.overwrite,
                say=Screen(stderr=arguments.json).print,
                progress=progress,
            )
    if arguments.json:
        print_json("data", _summary(directory), written)


def _summary(directory: Path) -> dict[str, Any]:
    """The published recordings, and whether they are there."""
    from inverse_dynamics.data.public_recordings import is_intact, public_recordings

    table = public_recordings()
    places = {recording.name: directory / "bags" / recording.name for recording in table.recordings}
    return {
        "repository": table.repository,
        "commit": table.commit,
        "license": table.license,
        "recordings": [
            {
                "name": recording.name,
                "directory": places[recording.name],
                "intact": is_intact(recording, places[recording.name]),
                "bytes": recording.size,
                "files": recording.files,
            }
            for recording in table.recordings
        ],
    }


def _print_plan(directory: Path) -> None:
    from inverse_dynamics.data.public_recordings import is_intact, public_recordings
    from inverse_dynamics.verbs.screen import Screen

    screen = Screen()
    table = public_recordings()
    screen.print(f"{table.repository}, commit {table.commit}, license {table.license}")
    missing = 0
    for recording in table.recordings:
        place = directory / "bags" / recording.name
        there = is_intact(recording, place)
        missing += 0 if there else recording.size
        screen.print(f"{place}: {'already there and intact' if there else 'to be fetched'}")
        for file in recording.files:
            screen.print(
                f"  {file.size:>9} bytes  {file.source}\n             SHA-256 {file.sha256}"
            )
    screen.print(f"to fetch: {missing / 1e6:.2f} MB; nothing was fetched")

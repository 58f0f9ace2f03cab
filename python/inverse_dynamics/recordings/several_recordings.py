# SPDX-License-Identifier: Apache-2.0
"""Several recordings: found in directories that hold them, and a name for each.

named_recordings(["monday/run", "tuesday/run", "line_2"])
# {"monday_run": monday/run, "tuesday_run": tuesday/run, "line_2_a": line_2/a, ...}
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import BagError
from inverse_dynamics.wording import listed, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

METADATA = "metadata.yaml"
_LOOSE = (".db3", ".mcap", ".bag", ".csv")


def named_recordings(paths: Iterable[Path | str], *, taken: Sequence[str] = ()) -> dict[str, Path]:
    """The recordings that paths name, each with a name of its own; in their order.

    A directory that is no recording stands for all recordings in it, by name. A name is that of the
    recording without its ending; where several would be the same, the directories above are put
    before it. taken: names that are in use already. Raises BagError: a path is empty, a recording is
    named twice, or a directory holds other files that could be recordings too.
    """
    paths = list(paths)
    if "" in paths:  # Path("") is the working directory
        raise BagError("recordings: expected the name of a file or directory, got ''")
    found = [recording for path in paths for recording in recordings_in(Path(path))]
    _check_once(found)
    names = _names(found, taken)
    for name, path in zip(names, found, strict=True):
        if not name or not name.isprintable():
            raise BagError(
                f"{path}: expected a name in UTF-8 without control characters, after which its result "
                "can be called; rename it"
            )
    return dict(zip(names, found, strict=True))


def name_of(path: Path) -> str:
    """The name of a recording without its ending; of `..`, that of the directory it stands for."""
    return Path(os.path.abspath(path)).stem


def recordings_in(path: Path) -> list[Path]:
    """The recordings in a directory that is no recording itself; else the path alone.

    A result of `ids evaluate` holds a recording too, and doesn't stand for it. Raises BagError.
    """
    if not holds_recordings(path):
        return [path]
    if loose := sorted(f.name for f in path.iterdir() if f.suffix in _LOOSE and f.is_file()):
        raise BagError(
            f"{path}: holds recordings in directories of their own, and other files that could be some "
            f"({listed(loose)}); name the recordings one by one, as {path}/*"
        )
    return [inner for inner in sorted(path.iterdir()) if _is_recording(inner)]


def holds_recordings(path: Path) -> bool:
    """Whether a path is a directory that holds recordings, and neither one itself nor a result."""
    try:
        if not path.is_dir() or _is_recording(path) or (path / "evaluation.json").exists():
            return False
        return any(map(_is_recording, path.iterdir()))
    except OSError:  # the reader says what is wrong with it
        return False


def _is_recording(path: Path) -> bool:
    return (path / METADATA).is_file()


def _check_once(paths: Sequence[Path]) -> None:
    """Raise BagError where a recording is named twice, or as a directory and as the file in it."""
    places: dict[str, Path] = {}
    for path in paths:
        place = os.path.realpath(path)
        if place in places:
            raise _twice(places[place], path)
        places[place] = path
    for place, path in places.items():
        directory = os.path.dirname(place)
        if directory in places and directory != place:  # that of / is /
            raise _twice(places[directory], path)


def _twice(one: Path, other: Path) -> BagError:
    pair = f"{one}: expected each recording once, got it twice"
    if str(one) != str(other):
        pair = f"{one}, {other}: expected each recording once, but they are the same one"
    return BagError(f"{pair}; leave one of them out")


def _names(paths: Sequence[Path], taken: Sequence[str]) -> list[str]:
    """Names that differ: stems, or full names, or those of as many directories above as it takes."""
    parts = [Path(os.path.abspath(path)).parts[1:] for path in paths]
    names = [name_of(path) for path in paths]
    depth = 1
    while clashes := {name for name, count in Counter([*names, *taken]).items() if count > 1}:
        if depth > max(map(len, parts)):  # /x_y/run and /x/y/run
            name = min(clashes)
            same = [str(p) for p, other in zip(paths, names, strict=True) if other == name]
            raise BagError(
                f"{listed(same)}: their results would have the same name, {shown(name)}; rename one of "
                "them, or evaluate them one after the other"
            )
        names = [
            "_".join(part[-depth:]) if name in clashes else name
            for name, part in zip(names, parts, strict=True)
        ]
        depth += 1
    return names

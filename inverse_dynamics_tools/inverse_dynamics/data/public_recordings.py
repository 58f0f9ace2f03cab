# SPDX-License-Identifier: Apache-2.0
"""Public recordings of real robots: which there are, fetching and checking them.

fetch_recordings(default_data_directory())

DIR/bags/NAME/   one directory each, as rosbag2 has it, with the license; DIR is what IDS_DATA_DIR names

Which files, of which commit, with which size and SHA-256: recordings/public.yaml of the package
inverse_dynamics_robots.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.base.ament import DATA_PACKAGE, package_share
from inverse_dynamics.base.files import Contents, written_whole
from inverse_dynamics.base.located_yaml import read_mapping
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.errors import OutputError, RecordingsError

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.base.located_yaml import Mapping
    from inverse_dynamics.base.progress import Progress

SCHEMA = 1
METADATA = "metadata.yaml"


@dataclass(frozen=True)
class PublicFile:
    """One file, and how to know it."""

    source: str  # path below PublicRecordings.url
    name: str
    size: int  # bytes
    sha256: str


@dataclass(frozen=True)
class PublicRecording:
    """A recording: files that are fetched, and metadata that come with this project."""

    name: str
    files: tuple[PublicFile, ...]
    metadata: Path

    @property
    def size(self) -> int:
        """Bytes to fetch."""
        return sum(file.size for file in self.files)


@dataclass(frozen=True)
class PublicRecordings:
    """All public recordings of one commit of a public repository."""

    repository: str
    commit: str
    url: str  # what paths of files are appended to
    license: str
    recordings: tuple[PublicRecording, ...]

    @property
    def how_to_fetch_otherwise(self) -> str:
        """What to do without network, in words."""
        return (
            f"without network here: `git clone {self.repository}` elsewhere, `git checkout {self.commit}` "
            "in it, bring it along, and name it with --from"
        )


def default_data_directory() -> Path:
    """Where `ids data` puts recordings and `ids demo` looks for them, if IDS_DATA_DIR isn't set."""
    data = os.environ.get("XDG_DATA_HOME", "")
    # The XDG specification has relative paths ignored.
    base = Path(data) if Path(data).is_absolute() else Path.home() / ".local" / "share"
    return base / "inverse_dynamics"


def data_directory() -> Path:
    """IDS_DATA_DIR, or else default_data_directory()."""
    return Path(os.environ.get("IDS_DATA_DIR") or default_data_directory())


def public_recordings() -> PublicRecordings:
    """The table of public recordings."""
    file = package_share(DATA_PACKAGE) / "recordings" / "public.yaml"
    top = read_mapping(file, RecordingsError)
    schema = top.required("schema")
    if schema.integer() != SCHEMA:
        schema.fail(f"{SCHEMA}", "it was written for another version of this command")
    table = PublicRecordings(
        repository=top.required("repository").text(),
        commit=top.required("commit").text(),
        url=top.required("url").text(),
        license=top.required("license").text(),
        recordings=tuple(
            _recording(entry.mapping(), file.parent)
            for entry in top.required("recordings").entries()
        ),
    )
    top.reject_others()
    return table


def _recording(mapping: Mapping, directory: Path) -> PublicRecording:
    name = mapping.required("name").text()
    files = tuple(_file(entry.mapping()) for entry in mapping.required("files").entries())
    mapping.reject_others()
    return PublicRecording(name, files, directory / name / METADATA)


def _file(mapping: Mapping) -> PublicFile:
    file = PublicFile(
        source=mapping.required("source").text(),
        name=mapping.required("name").text(),
        size=mapping.required("size").integer(),
        sha256=mapping.required("sha256").text(),
    )
    mapping.reject_others()
    return file


def is_intact(recording: PublicRecording, directory: Path) -> bool:
    """Whether a directory holds all files of a recording, as they were published."""
    files = [(directory / f.name, f.sha256) for f in recording.files]
    files.append((directory / METADATA, _sha256(recording.metadata)))
    return all(file.is_file() and _sha256(file) == expected for file, expected in files)


def fetch_recordings(
    directory: Path,
    *,
    source: str = "",
    overwrite: bool = False,
    say: Callable[[str], None] = lambda text: None,
    progress: Progress = no_progress,
) -> list[Path]:
    """Fetch those of public_recordings() that aren't there; gives the directories of all of them.

    source: URL or directory that holds the repository's files instead of the public one. overwrite:
    replace recordings that aren't as published. say: called with a sentence before each step.

    Each recording is written whole or not at all. Raises RecordingsError, OutputError.
    """
    table = public_recordings()
    places = {r.name: directory / "bags" / r.name for r in table.recordings}
    missing = []
    for recording in table.recordings:
        place = places[recording.name]
        if is_intact(recording, place):
            say(f"{place}: already there and intact")
            continue
        if place.exists() and not overwrite:
            raise OutputError(
                f"{place}: is there, but not as published (its SHA-256 are others, or files are missing); "
                "remove it, replace it with --overwrite, or name another directory with --out"
            )
        missing.append(recording)
    base = _base_url(source or table.url)
    if missing:
        size = sum(r.size for r in missing) / 1e6
        say(f"fetching {size:.2f} MB ({table.license}) from {base}")
    for recording in missing:
        place = places[recording.name]
        contents = Contents(METADATA, (METADATA, *(file.name for file in recording.files)))
        inputs = (Path(source) if source and "://" not in source else None,)
        with written_whole(place, overwrite=overwrite, contents=contents, inputs=inputs) as target:
            for file in recording.files:
                _fetch(f"{base}/{file.source}", file, target, table, progress)
            shutil.copyfile(recording.metadata, target / METADATA)
        say(f"{place}: fetched, every SHA-256 as published")
    return list(places.values())


def _base_url(source: str) -> str:
    if "://" in source:
        return source.rstrip("/")
    directory = Path(source)
    if not directory.is_dir():
        raise RecordingsError(f"--from: expected a URL or a directory, got '{source}'")
    return directory.absolute().as_uri()


def _fetch(
    url: str, file: PublicFile, target: Path, table: PublicRecordings, progress: Progress
) -> None:
    """Fetch a file; raise RecordingsError unless it is the published one."""
    from inverse_dynamics.base.downloads import DownloadError, download

    try:
        digest = download(
            url,
            target / file.name,
            expected_size=file.size,
            progress=lambda done: progress(file.name, done, file.size),
        )
    except DownloadError as error:
        raise RecordingsError(f"{url}: {error}; {table.how_to_fetch_otherwise}") from error
    if digest != file.sha256:
        raise RecordingsError(
            f"{url}: expected SHA-256 {file.sha256}, got {digest}: it isn't the published file, and "
            f"nothing of it was kept; {table.how_to_fetch_otherwise}"
        )


def _sha256(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()

# SPDX-License-Identifier: Apache-2.0
"""Public recordings of real robots: which there are, fetching and checking them.

fetch_recordings(data_directory())

DIR/bags/NAME/   one directory each, as rosbag2 has it, with the license; DIR is what IDS_DATA_DIR names

Which files, of which commit, with which size and SHA-256: recordings/public.yaml of the package
inverse_dynamics_robots.
"""

from __future__ import annotations

import hashlib
import http.client
import os
import shutil
import urllib.error
import urllib.request
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from inverse_dynamics.errors import OutputError, RecordingsError
from inverse_dynamics.installation.ament import DATA_PACKAGE, package_share
from inverse_dynamics.outputs.files import Contents, written_whole
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.located_yaml import read_mapping

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.progress import Progress
    from inverse_dynamics.robots.located_yaml import Mapping

SCHEMA = 1
METADATA = "metadata.yaml"

_SECONDS = 30.0  # without an answer


class PublicFile(NamedTuple):
    """One file, and how to know it."""

    source: str  # path below PublicRecordings.url
    name: str
    sha256: str
    size: int  # bytes


class PublicRecording(NamedTuple):
    """A recording: files that are fetched, and metadata that come with this project."""

    name: str
    files: tuple[PublicFile, ...]
    metadata: Path

    @property
    def size(self) -> int:
        """Bytes to fetch."""
        return sum(file.size for file in self.files)

    def is_intact(self, directory: Path) -> bool:
        """Whether a directory holds all its files, as they were published."""
        expected = {directory / f.name: f.sha256 for f in self.files}
        expected[directory / METADATA] = _sha256(self.metadata.read_bytes())
        return all(f.is_file() and _sha256(f.read_bytes()) == s for f, s in expected.items())


class PublicRecordings(NamedTuple):
    """All public recordings of one commit of a public repository."""

    repository: str
    commit: str
    url: str  # what paths of files are appended to
    license: str
    recordings: tuple[PublicRecording, ...]

    def unusable(self, text: str) -> RecordingsError:
        """The error of a file that can't be fetched or isn't the published one."""
        return RecordingsError(
            f"{text}; without network here: `git clone {self.repository}` elsewhere, `git checkout "
            f"{self.commit}` in it, bring it along, and name it with --from"
        )


def data_directory() -> Path:
    """Directory of `ids data` and `ids demo`: IDS_DATA_DIR, else that of XDG."""
    if named := os.environ.get("IDS_DATA_DIR"):
        return Path(named)
    data = Path(os.environ.get("XDG_DATA_HOME", ""))
    # The XDG specification has relative paths ignored.
    return (data if data.is_absolute() else Path.home() / ".local" / "share") / "inverse_dynamics"


def public_recordings() -> PublicRecordings:
    """The table of public recordings."""
    file = package_share(DATA_PACKAGE) / "recordings" / "public.yaml"
    top = read_mapping(file, RecordingsError)
    schema = top.required("schema")
    if schema.integer() != SCHEMA:
        schema.fail(f"{SCHEMA}", "it was written for another version of this command")
    texts = {k: top.required(k).text() for k in ("repository", "commit", "url", "license")}
    entries = [entry.mapping() for entry in top.required("recordings").entries()]
    recordings = tuple(_recording(entry, file.parent) for entry in entries)
    return PublicRecordings(**texts, recordings=recordings)


def _recording(mapping: Mapping, directory: Path) -> PublicRecording:
    name = mapping.required("name").text()
    entries = [entry.mapping() for entry in mapping.required("files").entries()]
    files = []
    for entry in entries:
        texts = {key: entry.required(key).text() for key in ("source", "name", "sha256")}
        files.append(PublicFile(**texts, size=entry.required("size").integer()))
    return PublicRecording(name, tuple(files), directory / name / METADATA)


def listed(directory: Path) -> dict[str, Any]:
    """The public recordings, and whether they are in the directory, for JSON."""
    table = public_recordings()
    recordings = [
        {
            "name": recording.name,
            "directory": directory / "bags" / recording.name,
            "intact": recording.is_intact(directory / "bags" / recording.name),
            "bytes": recording.size,
            "files": [file._asdict() for file in recording.files],
        }
        for recording in table.recordings
    ]
    about = {key: getattr(table, key) for key in ("repository", "commit", "license")}
    return {**about, "recordings": recordings}


def fetch_recordings(
    directory: Path,
    *,
    source: str = "",
    overwrite: bool = False,
    say: Callable[[str], None] = lambda text: None,
    progress: Progress = no_progress,
) -> list[Path]:
    """Fetch the public recordings that the directory lacks, each whole or not at all.

    Parameters
    ----------
    source
        URL or directory that holds the repository's files instead of the public one.
    overwrite
        Replace recordings that aren't as published.
    say
        Called with a sentence before each step.

    Returns
    -------
    list of Path
        Directories of all public recordings.

    Raises
    ------
    UserError
        RecordingsError, OutputError.
    """
    table = public_recordings()
    places = {recording: directory / "bags" / recording.name for recording in table.recordings}
    missing = [recording for recording, place in places.items() if not recording.is_intact(place)]
    for recording, place in places.items():
        if recording not in missing:
            say(f"{place}: already there and intact")
        elif place.exists() and not overwrite:
            raise OutputError(
                f"{place}: checksum mismatch, or files are missing; remove it, replace it with "
                "--overwrite, or name another directory with --out"
            )
    base = _base_url(source or table.url)
    if missing:
        size = sum(r.size for r in missing) / 1e6
        say(f"fetching {size:.2f} MB ({table.license}) from {base}")
    inputs = (Path(source) if source and "://" not in source else None,)
    for recording in missing:
        place = places[recording]
        contents = Contents(METADATA, (METADATA, *(file.name for file in recording.files)))
        with written_whole(place, overwrite=overwrite, contents=contents, inputs=inputs) as target:
            for file in recording.files:
                progress(file.name, 0, file.size)
                (target / file.name).write_bytes(_fetched(f"{base}/{file.source}", file, table))
                progress(file.name, file.size, file.size)
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


def _fetched(url: str, file: PublicFile, table: PublicRecordings) -> bytes:
    """Content of a URL (http, https, file). Raises RecordingsError unless it is the published file."""
    try:
        with urllib.request.urlopen(url, timeout=_SECONDS) as answer:
            content: bytes = answer.read(file.size + 1)
    except urllib.error.HTTPError as error:
        raise table.unusable(f"{url}: the server says {error.code} {error.reason}") from error
    except (http.client.HTTPException, OSError, ValueError) as error:
        reason = getattr(error, "reason", error)
        text = getattr(reason, "strerror", None) or str(reason) or type(error).__name__
        raise table.unusable(f"{url}: can't be reached ({text}); try again") from error
    if len(content) != file.size:
        got, why = f"{len(content)}", "the transfer was cut off; try again"
        if len(content) > file.size:
            got, why = "more", "it is another file"
        raise table.unusable(f"{url}: expected {file.size} bytes, got {got}: {why}")
    if _sha256(content) != file.sha256:
        raise table.unusable(
            f"{url}: expected SHA-256 {file.sha256}, got {_sha256(content)}: checksum mismatch, and "
            "nothing of the file was kept"
        )
    return content


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()

# SPDX-License-Identifier: Apache-2.0
"""Directories of results: written whole or not at all, and never over something else."""

from __future__ import annotations

import os
import shutil
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import OutputError

if TYPE_CHECKING:
    from collections.abc import Iterator


def check_output_directory(target: Path, *, overwrite: bool = False, mark: str = "") -> None:
    """Raise OutputError unless a directory of results may be made at `target`.

    mark: a file that shows an existing directory to be an older result; only such a directory (or
    an empty one) is ever overwritten.
    """
    if not target.exists() and not target.is_symlink():
        return
    if not target.is_dir() or target.is_symlink():
        raise OutputError(f"{target}: exists and isn't a directory; name another one with --out")
    if not any(target.iterdir()):
        return
    if not overwrite:
        raise OutputError(
            f"{target}: exists already; name another directory with --out, or replace it with "
            "--overwrite"
        )
    if not mark or not (target / mark).is_file():
        raise OutputError(
            f"{target}: won't be overwritten: it holds no {mark or 'older result'}, so it is not a "
            "result of this command; remove it by hand or name another directory with --out"
        )


def check_output_file(target: Path, *, overwrite: bool = False, option: str = "--out") -> None:
    """Raise OutputError unless a file may be made at `target`. option: what names it."""
    if target.is_dir():
        raise OutputError(f"{target}: is a directory; expected the name of a file to write")
    if target.exists() and not overwrite:
        raise OutputError(
            f"{target}: exists already; name another file with {option}, or replace it with "
            "--overwrite"
        )
    above = next(parent for parent in target.absolute().parents if parent.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        reason = "may not be written to" if above.is_dir() else "is not a directory"
        raise OutputError(
            f"{target}: can't be written ({above} {reason}); name another file with {option}"
        )


def write_text_whole(target: Path, text: str) -> None:
    """Write a file, or leave what was there. Raises OutputError."""
    with file_written_whole(target) as work:
        work.write_text(text, encoding="utf-8")


@contextmanager
def file_written_whole(target: Path) -> Iterator[Path]:
    """File to write; it becomes `target` at the end, and vanishes on an error. Raises OutputError."""
    work = target.with_name(f".{target.name}.part")
    try:
        target.absolute().parent.mkdir(parents=True, exist_ok=True)
        yield work
        os.replace(work, target)
    except OSError as error:
        raise OutputError(_cannot_write(target, error)) from error
    finally:
        with suppress(OSError):
            work.unlink()


@contextmanager
def written_whole(target: Path, *, overwrite: bool = False, mark: str = "") -> Iterator[Path]:
    """Directory to write into; it becomes `target` at the end, and vanishes on an error.

    with written_whole(Path("result")) as directory:
        (directory / "metrics.json").write_text("{}")
    """
    check_output_directory(target, overwrite=overwrite, mark=mark)
    target = target.absolute()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        # A sibling: on the same file system, so that renaming it is one step.
        work = Path(tempfile.mkdtemp(prefix=f".{target.name}.", suffix=".part", dir=target.parent))
    except OSError as error:
        raise OutputError(_cannot_write(target, error)) from error
    try:
        fresh = work / "new"
        fresh.mkdir()
        yield fresh
        check_output_directory(target, overwrite=overwrite, mark=mark)
        if target.exists():
            os.replace(target, work / "old")
        os.replace(fresh, target)
    except OSError as error:
        old = work / "old"
        if old.exists() and not target.exists():
            os.replace(old, target)
        raise OutputError(_cannot_write(target, error)) from error
    finally:
        shutil.rmtree(work, ignore_errors=True)


def move_up(directory: Path) -> None:
    """Move the files of a directory into the one above, which may share their names, and remove it."""
    for file in list(directory.iterdir()):
        file.rename(directory.parent / f"{file.name}.moved")
    directory.rmdir()
    for file in directory.parent.glob("*.moved"):
        file.rename(file.with_suffix(""))


def _cannot_write(target: Path, error: OSError) -> str:
    return (
        f"{target}: can't be written ({error.strerror or error}); name another directory with --out"
    )

# SPDX-License-Identifier: Apache-2.0
"""Results: written whole or not at all, and never over something else.

    RESULT = Contents("metrics.json", ("metrics.json", "series.npz"))
    with written_whole(Path("result"), contents=RESULT, overwrite=True) as directory:
        (directory / "metrics.json").write_text("{}")

Whatever happens meanwhile, the older result or the new one is there, whole: see replacement.py.
"""

from __future__ import annotations

import errno
import os
import stat
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from fnmatch import fnmatchcase
from glob import escape
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

from inverse_dynamics.base.replacement import (
    WorkFolder,
    put_directory,
    put_file,
    put_files,
    restore_interrupted,
    signals_deferred,
    sync_files,
)
from inverse_dynamics.base.wording import counted, listed
from inverse_dynamics.errors import OutputError, UserError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

_MOST_NAMED = 5  # files, in a text

_outputs: dict[Path, bool] = {}  # of this process, and whether they were written
_at_work: list[WorkFolder] = []


@dataclass(frozen=True)
class Contents:
    """What a command puts into its directory.

    mark: a file that shows the directory to be its result. files: all of them, as paths in it; names
    with * and ?; {name}: that of the directory. added: what other commands put in. A directory that
    holds anything else is never overwritten.
    """

    mark: str
    files: tuple[str, ...]
    added: tuple[str, ...] = ()

    def has(self, path: PurePath, directory: Path) -> bool:
        """Whether the command itself writes that path, relative to the directory."""
        return _matches(path, self.files, directory)

    def foreign(self, directory: Path) -> list[str]:
        """Paths in the directory that the user, or another program, has put there. Raises OSError."""

        def fail(error: OSError) -> None:
            raise error

        found = []
        for place, directories, names in os.walk(directory, onerror=fail):
            links = [name for name in directories if Path(place, name).is_symlink()]
            for name in (*names, *links):
                path = Path(place, name).relative_to(directory)
                if not _matches(path, (self.mark, *self.files, *self.added), directory):
                    found.append(str(path))
        return sorted(found)


NOTHING = Contents("", ())
"""Of a directory that is never overwritten."""


def check_output_directory(
    target: Path,
    *,
    overwrite: bool = False,
    contents: Contents = NOTHING,
    inputs: Iterable[Path | None] = (),
) -> None:
    """Raise OutputError unless a directory of results may be made at `target`.

    contents: an older result is known by them; only it (or an empty directory) is ever overwritten,
    and only if it holds nothing else. inputs: what is read, which must lie elsewhere.
    """
    with _errors_told(target, "directory with --out"):
        _check_name(target)
        _note(target)
        restore_interrupted(target.absolute())
        if os.path.lexists(target):
            _check_existing_directory(target, overwrite=overwrite, contents=contents)
        _check_apart(target, inputs, "directory with --out")
        _check_parent(target, "directory with --out")


def check_output_file(
    target: Path,
    *,
    overwrite: bool = False,
    option: str = "--out",
    inputs: Iterable[Path | None] = (),
    results: Contents | None = None,
) -> None:
    """Raise OutputError unless a file may be made at `target`. option: what names it.

    inputs: what is read, which must lie elsewhere. results: those of the inputs that are directories
    are such results, and the file may be put into them beside their own files.
    """
    other = f"file with {option}"
    with _errors_told(target, other):
        _check_name(target)
        _note(target)
        restore_interrupted(_file_meant(target))
        _check_regular(target, other)
        if target.exists() and not overwrite:
            raise OutputError(
                f"{target}: exists already; name another {other}, or replace it with --overwrite"
            )
        _check_apart(target, inputs, other, results)
        _check_parent(target, other)


def write_text_whole(target: Path, text: str) -> None:
    """Write a file, or leave what was there. Raises OutputError."""
    with file_written_whole(target) as work:
        write_text(work, text)


def write_text(file: Path, text: str) -> None:
    """Write UTF-8. Names of files that aren't UTF-8 become escapes, which JSON reads back."""
    file.write_text(text, encoding="utf-8", errors="backslashreplace")


@contextmanager
def file_written_whole(target: Path) -> Iterator[Path]:
    """File to write; it becomes `target` at the end, and vanishes on an error. Raises OutputError.

    Where `target` is a symbolic link, what it points to is replaced.
    """
    with _work(target, "name another file with --out") as (work, place):
        _check_regular(target, "file with --out")
        fresh = work.new / place.name
        yield fresh
        with signals_deferred():
            sync_files(work.new)
            put_file(fresh, place)
            _done(target)
            work.remove()


@contextmanager
def files_written_whole(targets: Sequence[Path]) -> Iterator[list[Path]]:
    """Files to write; they become `targets` together at the end, or none of them does.

    They are put in place in this order. On an error, what was there stays. A process that is killed
    between two of them leaves some new ones. Raises OutputError.
    """
    for target in targets:
        _note(target)
    with ExitStack() as stack:
        works = [stack.enter_context(_work(target, "name another output")) for target in targets]
        for target in targets:
            _check_regular(target, "output")
        fresh = [work.new / place.name for work, place in works]
        yield fresh
        with signals_deferred():
            for work, _ in works:
                sync_files(work.new)
            put_files(fresh, [place for _, place in works])
            _outputs.update(dict.fromkeys(targets, True))
            for work, _ in works:
                work.remove()


@contextmanager
def written_whole(
    target: Path,
    *,
    overwrite: bool = False,
    contents: Contents = NOTHING,
    inputs: Iterable[Path | None] = (),
) -> Iterator[Path]:
    """Directory to write into; it becomes `target` at the end, and vanishes on an error.

    The arguments are those of check_output_directory(). Raises OutputError.
    """
    check_output_directory(target, overwrite=overwrite, contents=contents, inputs=inputs)
    nested = bool(_at_work)
    with _work(target, "name another directory with --out", link=False) as (work, place):
        yield work.new
        with signals_deferred():
            if not nested:
                sync_files(work.new)
            if os.path.lexists(place):
                _check_existing_directory(target, overwrite=overwrite, contents=contents)
            put_directory(work.new, place, work.old, overwrite=overwrite)
            _done(target)
            work.remove()


def start_noting_outputs() -> None:
    """Forget what earlier calls have written: outcome() is of what follows."""
    _outputs.clear()


def outcome() -> str:
    """What there is now of all that was to be written, in words."""
    written = [str(path) for path, done in _outputs.items() if done]
    kept = [str(path) for path, done in _outputs.items() if not done and os.path.lexists(path)]
    text = f"written, whole: {', '.join(written)}" if written else "nothing was written"
    return text + (f"; as it was before: {', '.join(kept)}" if kept else "")


def written_before() -> str:
    """Outputs that were written before another one failed, in words; "": none."""
    written = [str(path) for path, done in _outputs.items() if done]
    return f"written before, whole: {', '.join(written)}" if written else ""


def is_plain_name(text: str) -> bool:
    """Whether a text can be the name of a file, and nothing but that: no path, no control character."""
    return text not in ("", ".", "..") and "/" not in text and text.isprintable()


def move_up(directory: Path) -> None:
    """Move the files of a directory into the one above, which may share their names, and remove it."""
    for file in list(directory.iterdir()):
        file.rename(directory.parent / f"{file.name}.moved")
    directory.rmdir()
    for file in directory.parent.glob("*.moved"):
        file.rename(file.with_suffix(""))


@contextmanager
def _work(target: Path, remedy: str, *, link: bool = True) -> Iterator[tuple[WorkFolder, Path]]:
    """A work folder, gone at the end, and the place that is meant. Raises OutputError."""
    work: WorkFolder | None = None
    _note(target)
    try:
        place = _file_meant(target) if link else target.absolute()
        with signals_deferred():
            place.parent.mkdir(parents=True, exist_ok=True)
            work = WorkFolder(place)
            _at_work.append(work)
        yield work, place
    except OSError as error:
        raise OutputError(_cannot_write(target, error, remedy)) from error
    except UserError as error:
        text = " ".join(map(str, error.args))  # str() of it may be shortened
        if work is None or str(work.path) not in text:
            raise
        # Texts name what is being made; its reader knows only where it was to be.
        made = str(work.new if not link else work.new / place.name)
        raise type(error)(text.replace(made, str(target))) from error
    finally:
        if work is not None:
            _at_work.remove(work)
            with signals_deferred():
                work.remove()


def _check_existing_directory(target: Path, *, overwrite: bool, contents: Contents) -> None:
    if not target.is_dir() or target.is_symlink():
        raise OutputError(f"{target}: exists and isn't a directory; name another one with --out")
    here = Path.cwd()
    if any(_same(place, target) for place in (here, *here.parents)):
        raise OutputError(
            f"{target}: is the working directory, or holds it, and would be replaced; name a "
            "directory to be made with --out"
        )
    if not any(target.iterdir()):
        return
    if not overwrite:
        raise OutputError(
            f"{target}: exists already; name another directory with --out, or replace it with "
            "--overwrite"
        )
    if not contents.mark or not (target / contents.mark).is_file():
        raise OutputError(
            f"{target}: won't be overwritten: it holds no {contents.mark or 'older result'}, so it is "
            "not a result of this command; remove it by hand or name another directory with --out"
        )
    foreign = contents.foreign(target)
    if foreign:
        raise OutputError(
            f"{target}: won't be overwritten: it holds {counted(len(foreign), 'file')} that this "
            f"command doesn't write ({listed(foreign, _MOST_NAMED)}); move what is yours elsewhere, or "
            "name another directory with --out"
        )


def _check_regular(target: Path, other: str) -> None:
    """A device, FIFO or socket of that name must stay."""
    if target.is_dir():
        raise OutputError(f"{target}: is a directory; expected the name of a file to write")
    with suppress(FileNotFoundError, NotADirectoryError):
        if not stat.S_ISREG(target.stat().st_mode):
            raise OutputError(
                f"{target}: is a device, pipe or socket, not a file; name another {other}"
            )


def _check_apart(
    target: Path, inputs: Iterable[Path | None], other: str, results: Contents | None = None
) -> None:
    """What is written must not replace what is read, nor be put among its files."""
    place = _real(target)
    for source in inputs:
        if source is None or not os.path.exists(source):
            continue
        read = _real(source)
        if any(_same(part, place) for part in (read, *read.parents)):
            relation = "is" if _same(read, place) else "holds"
            raise OutputError(
                f"{target}: {relation} {source}, which is read and would be replaced; name another "
                f"{other}"
            )
        around = next((part for part in place.parents if _same(part, read)), None)
        if around is None or (results and not results.has(place.relative_to(around), around)):
            continue
        raise OutputError(f"{target}: lies in {source}, which is read; name another {other}")


def _check_parent(target: Path, other: str) -> None:
    above = next(parent for parent in target.absolute().parents if parent.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        reason = "may not be written to" if above.is_dir() else "is not a directory"
        raise OutputError(f"{target}: can't be written ({above} {reason}); name another {other}")


def _check_name(target: Path) -> None:
    """Files name each other in texts, which are UTF-8 and have lines."""
    name = target.absolute().name
    if not name or not name.isprintable():
        raise OutputError(
            f"{target}: expected a name in UTF-8 without control characters; name another output"
        )
    with suppress(FileNotFoundError, NotADirectoryError):
        target.lstat()  # else too long, for one


def _file_meant(target: Path) -> Path:
    """What a symbolic link points to, if it is one."""
    return _real(target) if target.is_symlink() else target.absolute()


def _real(path: Path) -> Path:
    return Path(os.path.realpath(path))


def _matches(path: PurePath, patterns: Iterable[str], directory: Path) -> bool:
    own = escape(directory.absolute().name)

    def match(pattern: str) -> bool:
        parts = pattern.split("/")
        return len(parts) == len(path.parts) and all(
            fnmatchcase(name, part.replace("{name}", own))
            for name, part in zip(path.parts, parts, strict=True)
        )

    return any(map(match, patterns))


def _same(one: Path, other: Path) -> bool:
    """Whether two paths lead to one file or directory, by whatever names."""
    try:
        return os.path.samestat(one.stat(), other.stat())
    except OSError:
        return one == other


def _note(target: Path) -> None:
    if not _at_work:  # else it is a part of what is being made
        _outputs.setdefault(target, False)


def _done(target: Path) -> None:
    if target in _outputs and len(_at_work) == 1:
        _outputs[target] = True


@contextmanager
def _errors_told(target: Path, other: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OutputError(_cannot_write(target, error, f"name another {other}")) from error


def _cannot_write(target: Path, error: OSError, remedy: str) -> str:
    kept = ""
    with suppress(OSError):
        kept = "; what was there is kept" if os.path.lexists(target) else ""
    room = "free some space, or " if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
    return f"{target}: can't be written ({error.strerror or error}){kept}; {room}{remedy}"

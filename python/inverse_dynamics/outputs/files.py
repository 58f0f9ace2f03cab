# SPDX-License-Identifier: Apache-2.0
"""Results: written whole or not at all, and never over something else.

    RESULT = Contents("metrics.json", ("metrics.json", "series.npz"))
    with written_whole(Path("result"), contents=RESULT, overwrite=True) as directory:
        (directory / "metrics.json").write_text("{}")

NAME is made in the hidden folder `.NAME.XXXXXXXX.part` beside it, and renamed at the end. Everything
here raises OutputError.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import signal
import stat
import threading
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from glob import escape
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

from inverse_dynamics.errors import OutputError, UserError
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

_MOST_NAMED = 5  # files, in a text
_FILE = "name another file with --out"
_DIRECTORY = "name another directory with --out"

_outputs: dict[Path, str] = {}  # of this process: "", "written", "replaced" an earlier result
_at_work: list[Path] = []  # work folders


@dataclass(frozen=True)
class Contents:
    """Files that a command writes into its directory.

    mark: a file that shows the directory to be its result. files: all of them, as paths in it; names
    with * and ?; {name}: that of the directory. added: what other commands put in. A directory that
    holds anything else is never overwritten.
    """

    mark: str
    files: tuple[str, ...]
    added: tuple[str, ...] = ()

    def foreign(self, directory: Path) -> list[str]:
        """Paths in the directory that the user, or another program, has put there. Raises OSError."""

        def fail(error: OSError) -> None:
            raise error

        found = []
        own = (self.mark, *self.files, *self.added)
        for place, directories, names in os.walk(directory, onerror=fail):
            links = [name for name in directories if Path(place, name).is_symlink()]
            paths = [Path(place, name).relative_to(directory) for name in (*names, *links)]
            found += [str(path) for path in paths if not _matches(path, own, directory)]
        return sorted(found)


NOTHING = Contents("", ())
"""For a directory that is never overwritten."""


def check_output_directory(
    target: Path,
    *,
    overwrite: bool = False,
    contents: Contents = NOTHING,
    inputs: Iterable[Path | None] = (),
) -> None:
    """Check that a directory of results may be made at `target`.

    contents: an older result is known by them; only it (or an empty directory) is ever overwritten,
    and only if it holds nothing else. inputs: what is read, which must lie elsewhere.
    """
    with _output(target, _DIRECTORY):
        _check_existing_directory(target, overwrite=overwrite, contents=contents)
        _check_apart(target, inputs, _DIRECTORY)
        _check_parent(target, _DIRECTORY)


def check_output_file(
    target: Path,
    *,
    overwrite: bool = False,
    option: str = "--out",
    inputs: Iterable[Path | None] = (),
    results: Contents | None = None,
) -> None:
    """Check that a file may be made at `target`. option: what names it.

    inputs: what is read, which must lie elsewhere. results: those of the inputs that are directories
    are such results, and the file may be put into them beside their own files.
    """
    remedy = f"name another file with {option}"
    with _output(target, remedy):
        _check_regular(target, remedy)
        if target.exists() and not overwrite:
            raise OutputError(f"{target}: exists already; {remedy}, or replace it with --overwrite")
        _check_apart(target, inputs, remedy, results)
        _check_parent(target, remedy)


def write_text(file: Path, text: str) -> None:
    """Write UTF-8. Names of files that aren't UTF-8 become escapes, which JSON reads back."""
    file.write_text(text, encoding="utf-8", errors="backslashreplace")


def write_text_whole(target: Path, text: str) -> None:
    """Write a file, or leave what was there."""
    with files_written_whole([target]) as (file,):
        write_text(file, text)


@contextmanager
def files_written_whole(targets: Sequence[Path]) -> Iterator[list[Path]]:
    """Files to write; they become `targets` together at the end, or none of them does.

    They are renamed in this order; a process that is killed meanwhile leaves some new ones. Where a
    target is a symbolic link, what it points to is replaced.
    """
    pairs = [(target, Path(os.path.realpath(target))) for target in targets]
    for target in targets:
        _note(target)
    with ExitStack() as stack:
        fresh = [stack.enter_context(_made(*pair, _FILE)) for pair in pairs]
        for target in targets:
            _check_regular(target, _FILE)
        yield fresh
        with signals_deferred():
            _put(fresh, [place for _, place in pairs])
            for target in targets:
                _note(target, "written")


@contextmanager
def written_whole(
    target: Path,
    *,
    overwrite: bool = False,
    contents: Contents = NOTHING,
    inputs: Iterable[Path | None] = (),
) -> Iterator[Path]:
    """Directory to write into; it becomes `target` at the end, and vanishes on an error.

    The arguments are those of check_output_directory().
    """
    check_output_directory(target, overwrite=overwrite, contents=contents, inputs=inputs)
    place = target.absolute()
    with _made(target, place, _DIRECTORY) as fresh:
        fresh.mkdir()
        yield fresh
        with signals_deferred():
            _check_existing_directory(target, overwrite=overwrite, contents=contents)
            older = place.exists() and any(place.iterdir())
            _put([fresh], [place])
            _note(target, "replaced" if older else "written")


def start_noting_outputs() -> None:
    """Forget what earlier calls have written: outcome() is of what follows."""
    _outputs.clear()


def replaced() -> str:
    """Earlier results that were replaced since, in words; "": none."""
    paths = [str(path) for path, state in _outputs.items() if state == "replaced"]
    return f"replaced the earlier result in {', '.join(paths)}" if paths else ""


def written_before() -> str:
    """Outputs that were written before another one failed, in words; "": none."""
    written = [str(path) for path, state in _outputs.items() if state]
    return f"written before, whole: {', '.join(written)}" if written else ""


def outcome() -> str:
    """State of the outputs, in words: written, or as before."""
    kept = [str(path) for path, state in _outputs.items() if not state and os.path.lexists(path)]
    text = written_before().replace("written before", "written") or "nothing was written"
    return text + (f"; as it was before: {', '.join(kept)}" if kept else "")


def move_up(directory: Path) -> None:
    """Move the files of a directory into the one above, which may share their names, and remove it."""
    directory = directory.rename(directory.with_name(".moved"))
    for file in list(directory.iterdir()):
        file.rename(directory.parent / file.name)
    directory.rmdir()


@contextmanager
def signals_deferred() -> Iterator[None]:
    """SIGINT, SIGTERM and SIGHUP act at the end of the block. In the main thread; else no change."""
    arrived: list[int] = []
    before = {}
    try:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                if signal.getsignal(number) not in (None, signal.SIG_IGN):
                    before[number] = signal.signal(number, lambda number, _: arrived.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for caught in arrived[:1]:
            signal.raise_signal(caught)


def _note(target: Path, state: str = "") -> None:
    """For outcome() and replaced(). A part of what is being made isn't noted."""
    if not any(work in target.absolute().parents for work in _at_work):
        _outputs[target] = state or _outputs.get(target, "")


@contextmanager
def _output(target: Path, remedy: str) -> Iterator[None]:
    """Check the name of an output, note it for outcome(), and turn OSError into OutputError."""
    try:
        if not target.absolute().name or not target.absolute().name.isprintable():
            raise OutputError(
                f"{target}: expected a name in UTF-8 without control characters; name another output"
            )
        _note(target)
        with suppress(FileNotFoundError, NotADirectoryError):
            target.lstat()  # else too long, for one
        yield
    except OSError as error:
        kept = "; what was there is kept" if os.path.lexists(target) else ""
        room = "free some space, or " if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
        raise OutputError(
            f"{target}: can't be written ({error.strerror or error}){kept}; {room}{remedy}"
        ) from error


@contextmanager
def _made(target: Path, place: Path, remedy: str) -> Iterator[Path]:
    """Path to make what is then renamed to `place`, in a work folder that is removed at the end."""
    work = place.parent / f".{place.name[:50]}.{secrets.token_hex(4)}.part"
    fresh = work / "new" / place.name
    with _output(target, remedy):
        try:
            work.mkdir(mode=0o700, parents=True)
            _at_work.append(work)
            fresh.parent.mkdir()
            yield fresh
        except UserError as error:  # its reader knows only the target
            text = " ".join(map(str, error.args))  # str() of it may be shortened
            if str(fresh) not in text:
                raise
            raise type(error)(text.replace(str(fresh), str(target))) from error
        finally:
            with signals_deferred():
                if work in _at_work:
                    _at_work.remove(work)
                if not (fresh.exists() and (work / "old").exists()):  # it can't be put back
                    shutil.rmtree(work, ignore_errors=True)


def _put(fresh: Sequence[Path], places: Sequence[Path]) -> None:
    """Rename what was made; on an error, put back what was there. Raises OSError."""
    done = []
    try:
        for new, place in zip(fresh, places, strict=True):
            if os.path.lexists(place):
                shutil.copymode(place, new)
                if len(fresh) > 1 or new.is_dir():
                    os.rename(place, new.parents[1] / "old")
            os.replace(new, place)
            done.append(new)
    except OSError:
        for new, place in zip(fresh, places, strict=True):
            if new in done:
                os.replace(place, new)
            if (old := new.parents[1] / "old").exists():
                os.replace(old, place)
        raise


def _check_existing_directory(target: Path, *, overwrite: bool, contents: Contents) -> None:
    if not os.path.lexists(target):
        return
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
        raise OutputError(f"{target}: exists already; {_DIRECTORY}, or replace it with --overwrite")
    if not contents.mark or not (target / contents.mark).is_file():
        raise OutputError(
            f"{target}: won't be overwritten: it holds no {contents.mark or 'older result'}, so it is "
            "not a result of this command; remove it by hand or name another directory with --out"
        )
    if foreign := contents.foreign(target):
        raise OutputError(
            f"{target}: won't be overwritten: it holds {counted(len(foreign), 'file')} that this "
            f"command doesn't write ({listed(foreign, _MOST_NAMED)}); move what is yours elsewhere, or "
            f"{_DIRECTORY}"
        )


def _check_regular(target: Path, remedy: str) -> None:
    """Refuse to replace a directory, device, FIFO or socket."""
    if target.is_dir():
        raise OutputError(f"{target}: is a directory; expected the name of a file to write")
    with suppress(FileNotFoundError, NotADirectoryError):
        if not stat.S_ISREG(target.stat().st_mode):
            raise OutputError(f"{target}: is a device, pipe or socket, not a file; {remedy}")


def _check_apart(
    target: Path, inputs: Iterable[Path | None], remedy: str, results: Contents | None = None
) -> None:
    """Refuse an output that replaces an input or lies in it."""
    place = Path(os.path.realpath(target))
    for source in inputs:
        if source is None or not os.path.exists(source):
            continue
        read = Path(os.path.realpath(source))
        if any(_same(part, place) for part in (read, *read.parents)):
            relation = "is" if _same(read, place) else "holds"
            raise OutputError(
                f"{target}: {relation} {source}, which is read and would be replaced; {remedy}"
            )
        around = next((part for part in place.parents if _same(part, read)), None)
        if around and not (
            results and not _matches(place.relative_to(around), results.files, around)
        ):
            raise OutputError(f"{target}: lies in {source}, which is read; {remedy}")


def _check_parent(target: Path, remedy: str) -> None:
    above = next(parent for parent in target.absolute().parents if parent.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        reason = "may not be written to" if above.is_dir() else "is not a directory"
        raise OutputError(f"{target}: can't be written ({above} {reason}); {remedy}")


def _matches(path: PurePath, patterns: Iterable[str], directory: Path) -> bool:
    own = escape(directory.absolute().name)
    return any(
        pattern.count("/") == len(path.parts) - 1 and path.match(pattern.replace("{name}", own))
        for pattern in patterns
        if pattern
    )


def _same(one: Path, other: Path) -> bool:
    """Whether two paths lead to one file or directory, by whatever names."""
    try:
        return os.path.samestat(one.stat(), other.stat())
    except OSError:
        return one == other

# SPDX-License-Identifier: Apache-2.0
"""Putting what was made into the place of an older result, so that either of them is there, whole.

What is made for NAME is made in the hidden folder `.NAME.part` beside it, on the same file system:

    .NAME.part/new/   what is being made
    .NAME.part/old/   the older result, between the two renames of a file system that can't exchange

The folder is locked (flock) as long as its process lives. A folder without a lock was left behind by
a process that was killed: the next run puts `old` back if NAME is missing or if `new` never took its
place, and removes the rest. It removes nothing if another program has made NAME meanwhile.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import hashlib
import os
import shutil
import signal
import threading
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import OutputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Signals that end a program and leave it time to tidy up."""

_LONGEST_NAME = 255  # bytes, of Linux
_AT_FDCWD = -100
_RENAME_EXCHANGE = 2
_CANT_EXCHANGE = {errno.EINVAL, errno.ENOSYS, errno.ENOTSUP}


class WorkFolder:
    """The folder `.NAME.part`, made and locked. Raises OutputError, OSError."""

    def __init__(self, target: Path) -> None:
        self.path = work_path(target)
        self._lock: int | None = None
        while self._lock is None:
            restore_interrupted(target)
            with suppress(FileExistsError):  # another run was faster
                self.path.mkdir(mode=0o700)
                with suppress(FileNotFoundError):  # and took this one for a leftover
                    self._lock = _lock(self.path, target, fresh=True)
        self.new = self.path / "new"
        self.old = self.path / "old"
        try:
            self.new.mkdir()
        except BaseException:
            self.remove()
            raise

    def remove(self) -> None:
        """Remove it with everything in it, unless the older result is there: the next run puts it back."""
        if self._lock is not None:
            if not (self.old.exists() and self.new.exists()):
                shutil.rmtree(self.path, ignore_errors=True)
            os.close(self._lock)
            self._lock = None


def work_path(target: Path) -> Path:
    """The folder in which `target` is made."""
    name = f".{target.name}.part"
    if len(os.fsencode(name)) > _LONGEST_NAME:
        name = f".{hashlib.sha256(os.fsencode(target.name)).hexdigest()}.part"
    return target.with_name(name)


def restore_interrupted(target: Path) -> None:
    """Undo what a killed process left: put the older result back if it is missing, remove the rest.

    Raises OutputError where another process is at work, where the folder isn't ours, or where something
    else has taken the place of the older result; OSError.
    """
    path = work_path(target)
    if not os.path.lexists(path):
        return
    if not path.is_dir() or path.is_symlink() or set(os.listdir(path)) - {"new", "old"}:
        raise OutputError(
            f"{target}: can't be written: {path} is in the way and was not written by this command; remove it "
            "by hand, or name another output"
        )
    with suppress(FileNotFoundError):  # its process has ended just now
        lock = _lock(path, target)
        try:
            with signals_deferred():
                old = path / "old"
                if old.exists() and ((path / "new").exists() or not os.path.lexists(target)):
                    os.rename(old, target)  # replaces an empty directory too
                shutil.rmtree(path)
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR):
                raise
            raise OutputError(
                f"{target}: can't be written: it was made after a run was killed, and the older result "
                f"is still {path / 'old'}; move one of them elsewhere, or name another output"
            ) from error
        finally:
            os.close(lock)


def put_directory(new: Path, target: Path, old: Path, *, overwrite: bool) -> None:
    """Rename a directory; what was at `target` is then at `new` or `old`. Raises OutputError, OSError.

    overwrite: else only an empty directory is replaced.
    """
    with suppress(FileNotFoundError):
        shutil.copymode(target, new)
    try:
        os.rename(new, target)  # replaces an empty directory too
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        if not overwrite:
            raise OutputError(
                f"{target}: exists already, since a moment ago: another program has made it; it was "
                "left alone; name another directory with --out"
            ) from error
        if not _exchange(new, target):
            os.rename(target, old)  # restore_interrupted() puts it back if this process ends here
            try:
                os.rename(new, target)
            except BaseException:
                os.rename(old, target)
                raise
    _sync(target.parent)


def put_files(new: Sequence[Path], targets: Sequence[Path]) -> None:
    """Rename files over others, one after another; on an error, put back what was there. Raises OSError."""
    kept: dict[Path, Path | None] = {}
    try:
        for file, target in zip(new, targets, strict=True):
            older = os.path.lexists(target)
            if older:
                shutil.copymode(target, file)
            if len(new) > 1:
                kept[target] = Path(shutil.copy2(target, f"{file}.before")) if older else None
            os.replace(file, target)
            _sync(target.parent)
    except BaseException:
        for target, before in kept.items():
            if before is not None:
                os.replace(before, target)
            else:
                target.unlink(missing_ok=True)
        raise


def sync_files(directory: Path) -> None:
    """Have everything below a directory on the disk before it is renamed. Raises OSError."""
    for place, _, names in os.walk(directory):
        for name in names:
            _sync(Path(place, name))
        _sync(Path(place))


@contextmanager
def signals_deferred() -> Iterator[None]:
    """SIGINT, SIGTERM and SIGHUP act at the end of the block. In the main thread; else no change."""
    arrived: list[int] = []
    before = {}
    try:
        if threading.current_thread() is threading.main_thread():
            for number in STOPPING:
                handler = signal.getsignal(number)
                if handler not in (None, signal.SIG_IGN):
                    before[number] = handler
                    signal.signal(number, lambda number, _: arrived.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for caught in arrived[:1]:
            signal.raise_signal(caught)


def _exchange(one: Path, other: Path) -> bool:
    """Swap two directories in one step; false where kernel, C library or file system can't."""
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError):
        return False
    paths = (_AT_FDCWD, os.fsencode(one), _AT_FDCWD, os.fsencode(other))
    if renameat2(*paths, ctypes.c_uint(_RENAME_EXCHANGE)) == 0:
        return True
    error = ctypes.get_errno()
    if error in _CANT_EXCHANGE:
        return False
    raise OSError(error, os.strerror(error), str(other))


def _lock(path: Path, target: Path, *, fresh: bool = False) -> int:
    """Lock of a work folder. Raises OutputError if it may belong to another run, FileNotFoundError.

    fresh: this process has just made it; it may then be on a file system without locks.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if not fresh or isinstance(error, BlockingIOError):
                raise OutputError(
                    f"{target}: can't be written: another run is writing it now; wait for its end, or "
                    f"name another output; if no run is left, remove {path} by hand"
                ) from None
        if not os.path.samestat(os.fstat(descriptor), os.stat(path)):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.EROFS):  # a file system without it
            raise
    finally:
        os.close(descriptor)

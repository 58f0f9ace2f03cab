# SPDX-License-Identifier: Apache-2.0
"""Processes that share the calls of one function; a call that fails, or kills its process, fails alone.

    in_processes(work, files, jobs=4, done=lambda index, outcome: print(files[index], outcome))

Workers are new Python processes, so a script that uses them needs no `if __name__ == "__main__"`, and
threads of this process don't matter. Function and arguments are pickled; the function is imported by
its name. Each worker takes the next argument when it has done one.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import tempfile
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING, Any, TypeVar

from inverse_dynamics.errors import UserError
from inverse_dynamics.outputs.crash import crash_report
from inverse_dynamics.outputs.files import signals_deferred

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_Argument = TypeVar("_Argument")
_PR_SET_PDEATHSIG = 1
_START = "import sys; sys.path[:] = {path}; from {module} import serve; serve(*{arguments})"

# Libraries that would start as many threads in each worker as there are cores.
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Failure:
    """A call without a result: why, in one line."""

    text: str


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0))


def outcome_of(function: Callable[[_Argument], Any], argument: _Argument) -> Any:
    """The function's result, or a Failure with the text of its exception."""
    try:
        return function(argument)
    except UserError as error:
        return Failure(" ".join(str(error).split()))
    except Exception as error:
        return Failure(crash_report(error, [str(argument)]))


def in_processes(
    function: Callable[[_Argument], Any],
    arguments: Sequence[_Argument],
    *,
    jobs: int,
    done: Callable[[int, Any], None],
) -> None:
    """Call the function with each argument, at most `jobs` at a time.

    done: called here, with the index of an argument and what the function returned, or a Failure, as
    soon as it is known. An exception here, Ctrl-C too, ends all workers at once.
    """
    waiting = deque(range(len(arguments)))
    workers: list[_Worker] = []
    with tempfile.TemporaryDirectory(prefix="ids-") as scratch:
        try:
            while waiting or workers:
                while waiting and len(workers) < jobs:
                    with signals_deferred():  # no worker may be started and forgotten
                        workers.append(_Worker(function, scratch))
                    index = waiting.popleft()
                    workers[-1].take(index, arguments[index])
                ready: list[Any] = wait(workers)  # type: ignore[arg-type]  # anything with fileno()
                for worker in ready:
                    index, outcome = worker.index, worker.outcome()
                    if waiting and worker.alive:
                        following = waiting.popleft()
                        worker.take(following, arguments[following])
                    else:
                        worker.end()
                        workers.remove(worker)
                    done(index, outcome)
        finally:
            for worker in workers:
                worker.kill()


def serve(descriptor: int, parent: int, scratch: str) -> None:
    """Run in a worker: receive the function, then arguments until there are no more.

    scratch: directory for temporary files, which a worker that is killed can't remove.
    """
    _end_with(parent)
    tempfile.gettempdir()  # that of reports on unexpected errors stays
    os.environ["TMPDIR"] = scratch
    with Connection(descriptor) as connection, suppress(EOFError):
        function = connection.recv()
        while True:
            connection.send(outcome_of(function, connection.recv()))


class _Worker:
    """One process, and the argument that it has."""

    def __init__(self, function: Callable[[Any], Any], scratch: str) -> None:
        self.index = -1
        self.alive = True
        self._connection, theirs = Pipe()
        with theirs:
            arguments = (theirs.fileno(), os.getpid(), scratch)
            command = _START.format(path=sys.path, module=__name__, arguments=arguments)
            self._process = subprocess.Popen(
                [sys.executable, "-c", command],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(),),
                env={**dict.fromkeys(_THREADS, "1"), **os.environ},
                start_new_session=True,  # Ctrl-C is this process's affair
            )
        self._send(function)

    def fileno(self) -> int:
        """For wait()."""
        return self._connection.fileno()

    def take(self, index: int, argument: object) -> None:
        """Begin with an argument."""
        self.index = index
        self._send(argument)

    def outcome(self) -> Any:
        """Wait for the result of the argument."""
        try:
            return self._connection.recv()
        except (EOFError, OSError):
            self.alive = False
            return Failure(_how_it_ended(self._process.wait()))

    def end(self) -> None:
        """End it after its last argument."""
        self._connection.close()
        self._process.wait()

    def kill(self) -> None:
        """End it, whatever it does."""
        self._process.kill()
        self.end()

    def _send(self, what: object) -> None:
        with suppress(OSError):  # it has died already: outcome() reports it
            self._connection.send(what)


def _how_it_ended(code: int) -> str:
    if code == -signal.SIGKILL:
        return (
            "its process was killed (SIGKILL); most likely memory ran out: let fewer run at the same "
            "time with --jobs (jobs=), or add memory"
        )
    if code < 0:
        with suppress(ValueError):
            return f"its process was ended by {signal.Signals(-code).name}"
    return f"its process ended with exit status {code}"


def _end_with(parent: int) -> None:
    """Have this process killed when the one that started it ends, however that ends."""
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)

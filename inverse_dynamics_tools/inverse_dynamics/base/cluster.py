# SPDX-License-Identifier: Apache-2.0
"""The calls of one function on the workers of a Dask cluster: as workers.py, beyond one machine.

    on_cluster(work, files, "tcp://10.0.0.1:8786", paths=files, done=lambda index, outcome: ...)

Dask distributed is optional: the extra `dask`.
"""

from __future__ import annotations

import asyncio
import os
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeVar
from uuid import uuid4

from inverse_dynamics.base.extras import how_to_install
from inverse_dynamics.base.wording import counted, listed
from inverse_dynamics.base.workers import Failure, outcome_of
from inverse_dynamics.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from distributed import Client

_Argument = TypeVar("_Argument")
_SECONDS = 20.0  # without an answer of the scheduler, or without a worker

# Of a worker.
_alone = threading.Lock()
_running = ""  # the run whose call it has
_stopped: set[str] = set()  # runs


class ClusterError(UserError):
    """A cluster that can't be reached, or whose workers lack something."""


def on_cluster(
    function: Callable[[_Argument], Any],
    arguments: Sequence[_Argument],
    address: str,
    *,
    paths: Sequence[Path],
    done: Callable[[int, Any], None],
) -> None:
    """Call the function with each argument on the cluster's workers, one call at a time each.

    paths: what every worker must see. done: as that of in_processes(). An exception here, Ctrl-C too,
    cancels what hasn't begun, and stops a call where it calls check_stopped(). Raises ClusterError.
    """
    with _connected(address) as client:
        from distributed import as_completed

        _check_workers(client, address, paths)
        run = uuid4().hex
        count = len(arguments)
        calls = client.map(
            _outcome_alone, [run] * count, [function] * count, list(arguments), pure=False
        )
        indices = {call: index for index, call in enumerate(calls)}
        try:
            for call in as_completed(calls, loop=client.loop):
                failed = call.status != "finished"
                done(indices[call], Failure(_lost(call)) if failed else call.result())
        except BaseException:
            client.cancel(calls, force=True)
            with suppress(Exception):  # the cluster has gone
                client.run(_stop, run)
            raise


class Stopped(BaseException):
    """The run that a call belongs to has been stopped. Not an Exception: nobody takes it for a fault."""


def check_stopped() -> None:
    """Raise Stopped in a call whose run has been stopped: for long calls, now and then."""
    if _running in _stopped:
        raise Stopped


def _outcome_alone(run: str, function: Callable[[_Argument], Any], argument: _Argument) -> Any:
    """What a worker does: one call at a time, though it may have several threads."""
    global _running
    with _alone:
        if run in _stopped:
            return Failure("stopped")
        _running = run
        try:
            return outcome_of(function, argument)
        except Stopped:
            return Failure("stopped")
        finally:
            _running = ""


async def _stop(run: str) -> None:
    """Have a worker begin no further call of a run, and wait for the end of the one that it has."""
    _stopped.add(run)
    while _running == run:
        await asyncio.sleep(0.02)


def missing(paths: Sequence[str]) -> list[str]:
    """Those paths that this process doesn't see."""
    return [path for path in paths if not os.path.exists(path)]


def _connected(address: str) -> Client:
    try:
        from distributed import Client
        from distributed.comm import get_address_host_port
    except ImportError as error:
        raise ClusterError(
            f"--scheduler {address}: needs Dask distributed, which can't be imported ({error}): "
            f"{how_to_install('distributed')}, or leave --scheduler out: then the cores of this "
            "machine do the work"
        ) from error
    try:
        get_address_host_port(address)  # a Client that is refused later leaves threads
        return Client(address, timeout=_SECONDS, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise ClusterError(
            f"--scheduler {address}: expected the address of a Dask scheduler, as it prints it "
            f"(tcp://HOST:8786), but none answers there ({_first_line(error)}); start one with `dask "
            "scheduler`, and workers with `dask worker ADDRESS --nthreads 1`"
        ) from error


def _check_workers(client: Client, address: str, paths: Sequence[Path]) -> None:
    """Raise ClusterError unless there are workers, which have this software and see the paths."""
    try:
        client.wait_for_workers(1, timeout=_SECONDS)
    except TimeoutError:
        raise ClusterError(
            f"--scheduler {address}: it has no workers; start some with `dask worker {address} "
            "--nthreads 1`, in a shell where this workspace is sourced"
        ) from None
    answers = client.run(missing, list(map(str, paths)), on_error="return")
    for worker, answer in answers.items():
        if isinstance(answer, Exception):
            raise ClusterError(
                f"worker {worker}: can't use this software ({_first_line(answer)}); install the same "
                "version there, and start the worker in a shell where its workspace is sourced"
            )
        if answer:
            raise ClusterError(
                f"worker {worker}: doesn't see {counted(len(answer), 'path')} of {len(paths)} "
                f"({listed(answer, 3)}); have recordings and results on a file system that every "
                "worker mounts at the same place"
            )


def _lost(call: Any) -> str:
    """Why a call has no result: its worker died, again and again, or it was cancelled."""
    if call.status != "error":
        return "it was cancelled on the cluster, or the scheduler has gone"
    error = call.exception()
    if type(error).__name__ == "KilledWorker":
        return (
            f"its worker on the cluster died, at each try (the last was {error.last_worker.address}); "
            "most likely memory ran out: see that worker's log, or give workers more memory"
        )
    return f"on the cluster: {type(error).__name__}: {_first_line(error)}"


def _first_line(error: BaseException) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]

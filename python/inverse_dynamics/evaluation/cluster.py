# SPDX-License-Identifier: Apache-2.0
"""The calls of one function on the workers of a Dask cluster, which is optional: the extra `dask`."""

from __future__ import annotations

import os
import threading
from asyncio import CancelledError
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation.workers import Failure, outcome_of
from inverse_dynamics.installation.extras import require

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_SECONDS = 20.0  # without an answer of the scheduler, or without a worker
_START = "`dask scheduler`, and `dask worker tcp://HOST:8786` where this workspace is sourced"
_alone = threading.Lock()  # of a worker, which may have several threads
_stop: Any = None  # of the call that a worker has: the event that stops its run


def check_stopped() -> None:
    """Raise CancelledError in a call whose run has been stopped: for long calls, now and then."""
    if _stop is not None and _stop.is_set():
        raise CancelledError


def unseen(paths: list[str]) -> str:
    """Paths that don't exist for this process."""
    return ", ".join(f"no {path}" for path in paths if not os.path.exists(path))


def on_cluster(
    function: Callable[[Any], Any],
    arguments: Sequence[Any],
    address: str,
    *,
    paths: Sequence[object],
    done: Callable[[int, Any], None],
) -> None:
    """As in_processes(), on workers that see the paths; an exception here stops calls at check_stopped()."""
    require(f"--scheduler {address}", "distributed")
    from distributed import Client, Event, as_completed

    where = f"--scheduler {address}: expected a Dask scheduler with workers ({_START})"
    try:
        client = Client(address, timeout=_SECONDS, set_as_default=False)
        client.wait_for_workers(1, timeout=_SECONDS)
    except (OSError, ValueError, TypeError) as error:
        raise UserError(f"{where}, got {str(error).strip()}") from error
    with client:
        answers = client.run(unseen, list(map(str, paths)), on_error="return")
        if wrong := {worker: answer for worker, answer in answers.items() if answer}:
            raise UserError(f"{where}, files and software, got {wrong}")
        stop = Event(uuid4().hex, client=client)
        calls = client.map(partial(_outcome, stop.name, function), list(arguments), pure=False)
        try:
            for call in as_completed(calls, loop=client.loop):
                lost = call.exception()  # its worker died
                outcome = Failure(f"on the cluster: {lost}") if lost else call.result()
                done(calls.index(call), outcome)
        except BaseException:
            stop.set()
            client.gather(calls, errors="skip")
            raise


def _outcome(run: str, function: Callable[[Any], Any], argument: Any) -> Any:
    global _stop
    from distributed import Event

    with _alone, suppress(CancelledError):
        _stop = Event(run)
        check_stopped()
        return outcome_of(function, argument)

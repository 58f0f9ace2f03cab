# SPDX-License-Identifier: Apache-2.0
"""Runs one thing in a process of its own, with limits on time and memory."""

from __future__ import annotations

import os
import pickle
import resource
import signal
import tempfile
import time
import traceback
from typing import TYPE_CHECKING

from outcome import Outcome

if TYPE_CHECKING:
    from collections.abc import Callable

SECONDS = 20  # of CPU
LONGEST = 120.0  # s: a process that waits for ever uses no CPU
MEMORY = 3 << 30  # bytes of address space: libraries alone map about 1 GiB


def run_apart(act: Callable[[], Outcome]) -> Outcome:
    """The outcome of `act()` in a child process; `failed` if that dies, hangs or raises.

    A fork: what this process has imported, the child needn't import again. So this process must
    not load a solver itself.
    """
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as answer:
        child = os.fork()
        if child == 0:
            _child(act, said.fileno(), answer.fileno())
        status = _wait(child)
        said.seek(0)
        words = said.read().decode(errors="replace")
        answer.seek(0)
        content = answer.read()
    if status is None:
        return Outcome("failed", f"still running after {LONGEST:.0f} s")
    if os.WIFSIGNALED(status):
        name = signal.Signals(os.WTERMSIG(status)).name
        return Outcome("failed", f"killed by {name}: {words[-300:]!r}")
    if not content:
        code = os.WEXITSTATUS(status)
        return Outcome("failed", f"exit code {code} without an answer: {words[-500:]!r}")
    outcome: Outcome = pickle.loads(content)
    return outcome


def _child(act: Callable[[], Outcome], said: int, answer: int) -> None:
    """Never returns."""
    try:
        os.dup2(said, 1)
        os.dup2(said, 2)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
        try:
            outcome = act()
        except BaseException:
            outcome = Outcome("failed", f"traceback: {traceback.format_exc()[-600:]}")
        with os.fdopen(answer, "wb") as stream:
            stream.write(pickle.dumps(outcome))
    finally:
        os._exit(0)


def _wait(child: int) -> int | None:
    """Exit status of the child; None if it had to be killed."""
    end = time.monotonic() + LONGEST
    pause = 0.001
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return status
        time.sleep(pause)
        pause = min(2 * pause, 0.05)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None

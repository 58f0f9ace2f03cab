# SPDX-License-Identifier: Apache-2.0
"""The progress of long work, for whoever shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    # Called now and then during long work: what is done, how much of it, out of how much.
    Progress = Callable[[str, int, int], None]


def no_progress(_what: str, _done: int, _total: int) -> None:
    """Say nothing: the progress of a call from a script."""

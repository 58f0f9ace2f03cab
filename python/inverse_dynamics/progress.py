# SPDX-License-Identifier: Apache-2.0
"""The progress of long work, for whoever shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    # Called during long work: kind of work, amount done, total.
    Progress = Callable[[str, int, int], None]


def no_progress(_what: str, _done: int, _total: int) -> None:
    """Report nothing: the default of calls from scripts."""

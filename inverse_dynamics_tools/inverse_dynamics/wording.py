# SPDX-License-Identifier: Apache-2.0
"""Words of texts."""

from __future__ import annotations


def counted(count: int, noun: str) -> str:
    """A number of things: `1 joint`, `6 joints`."""
    return f"{count} {noun}{'' if count == 1 else 's'}"

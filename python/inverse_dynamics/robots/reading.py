# SPDX-License-Identifier: Apache-2.0
"""Files of others, read whole up to a limit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics.errors import UserError

_MOST_BYTES = 64 * 2**20


def read_bytes(file: Path, what: str, error: type[UserError]) -> bytes:
    """Content of a file. Raises `error` if it can't be read or has more than 64 MiB. what: it is, as `a URDF`."""
    try:
        with file.open("rb") as stream:
            data = stream.read(_MOST_BYTES + 1)
    except OSError as reason:
        raise error(f"{file}: can't be read ({reason.strerror})") from reason
    if len(data) > _MOST_BYTES:
        raise error(f"{file}: expected {what} of at most {_MOST_BYTES >> 20} MiB, got more")
    return data

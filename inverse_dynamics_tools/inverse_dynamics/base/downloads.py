# SPDX-License-Identifier: Apache-2.0
"""One file from a URL, with what can go wrong in words."""

from __future__ import annotations

import hashlib
import http.client
import urllib.error
import urllib.request
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

_SECONDS = 30.0  # without an answer
_BLOCK = 65536


class DownloadError(Exception):
    """A file that can't be had, or isn't complete."""


def download(
    url: str,
    file: Path,
    *,
    expected_size: int,
    progress: Callable[[int], None] = lambda done: None,
) -> str:
    """Write what a URL (http, https, file) gives into a file; gives its SHA-256.

    progress: called with the number of bytes received. Raises DownloadError, and OSError of the file.
    """
    digest = hashlib.sha256()
    done = 0
    with file.open("wb") as out:
        for block in _blocks(url):
            done += len(block)
            if done > expected_size:
                raise DownloadError(f"expected {expected_size} bytes, got more: it is another file")
            digest.update(block)
            out.write(block)
            progress(done)
    if done < expected_size:
        raise DownloadError(
            f"expected {expected_size} bytes, got {done}: the transfer was cut off; try again"
        )
    return digest.hexdigest()


def _blocks(url: str) -> Iterator[bytes]:
    try:
        with urllib.request.urlopen(url, timeout=_SECONDS) as answer:
            while block := answer.read(_BLOCK):
                yield block
    except urllib.error.HTTPError as error:
        raise DownloadError(f"the server says {error.code} {error.reason}") from error
    except urllib.error.URLError as error:
        raise DownloadError(f"can't be reached ({_text(error.reason)})") from error
    except (http.client.HTTPException, OSError, ValueError) as error:
        raise DownloadError(f"the transfer failed ({_text(error)}); try again") from error


def _text(error: object) -> str:
    reason = getattr(error, "strerror", None)
    return str(reason or error or type(error).__name__)

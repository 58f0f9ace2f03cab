# SPDX-License-Identifier: Apache-2.0
"""The option --json: what a verb found, as one JSON object on standard output."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

SCHEMA = 3  # of the object; docs/command_line.md


def print_json(verb: str, result: Mapping[str, Any], written: Iterable[Path] = ()) -> None:
    """Print the object. written: files and directories that the verb has written.

    Undefined figures are null; other characters than ASCII become escapes, so that a terminal acts on none.
    """
    from inverse_dynamics.base.plain import plain

    document = {"schema": SCHEMA, "verb": verb, "written": list(written), "result": result}
    print(json.dumps(plain(document), indent=2, allow_nan=False))

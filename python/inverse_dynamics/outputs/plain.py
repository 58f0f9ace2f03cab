# SPDX-License-Identifier: Apache-2.0
"""Results as JSON has them, plain objects, lists, texts and finite numbers."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def plain(value: Any) -> Any:
    """The value of dataclasses, mappings, sequences, arrays and paths; an undefined value is None."""
    if is_dataclass(value) and not isinstance(value, type):
        return plain(asdict(value))
    if isinstance(value, dict) or hasattr(value, "items"):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, Path) else value


def objects_of_joints(
    joints: Sequence[str], units: Sequence[str], columns: Mapping[str, Any]
) -> list[Any]:
    """An object for each joint, of columns (n,) by key."""
    rows = zip(joints, units, *columns.values(), strict=True)
    return [dict(zip(("joint", "unit", *columns), row, strict=True)) for row in rows]


def json_text(data: Any) -> str:
    """The text of a JSON file of such a value."""
    return json.dumps(plain(data), indent=2, allow_nan=False, ensure_ascii=False) + "\n"

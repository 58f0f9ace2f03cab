# SPDX-License-Identifier: Apache-2.0
"""Results as JSON has them, plain objects, lists, texts and finite numbers; and read back from it."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict, fields, is_dataclass
from pathlib import Path
from types import NoneType, SimpleNamespace, UnionType
from typing import TYPE_CHECKING, Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from inverse_dynamics.wording import shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

# What modules import for their annotations alone. Not NDArray: NumPy 2.5 made it an alias, with an origin of its own.
_ARRAYS = {
    "Floats": np.ndarray[Any, np.dtype[np.float64]],
    "Integers": np.ndarray[Any, np.dtype[np.int64]],
    "Mask": np.ndarray[Any, np.dtype[np.bool_]],
}


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


def read_back(kind: Any, value: Any, where: str) -> Any:
    """The object of a type whose JSON, or array, a value is; its parts may be such objects already.

    Keys without a field are left out. Raises ValueError or TypeError where something doesn't fit.
    """
    origin, parts = get_origin(kind), get_args(kind)
    # Of X[Y], too, Python 3.10 says that it is a type.
    if origin is None and isinstance(kind, type) and isinstance(value, kind):
        if kind is not int or not isinstance(value, bool):
            return value
    elif isinstance(kind, type) and is_dataclass(kind) and isinstance(value, dict):
        there = SimpleNamespace(
            __annotations__={f.name: f.type for f in fields(kind) if f.name in value}
        )
        hints = get_type_hints(there, vars(sys.modules[kind.__module__]), _ARRAYS)
        return kind(**{k: read_back(hint, value[k], f"{where}.{k}") for k, hint in hints.items()})
    elif origin in (Union, UnionType):  # X | None
        (other,) = (part for part in parts if part is not NoneType)
        return None if value is None else read_back(other, value, where)
    elif origin is tuple and isinstance(value, list):
        kinds = [parts[0]] * len(value) if parts[-1] is Ellipsis else parts
        pairs = zip(kinds, value, strict=True)
        return tuple(read_back(part, v, f"{where}[{k}]") for k, (part, v) in enumerate(pairs))
    elif kind is Path and isinstance(value, str):
        return Path(value)
    elif kind is float and (value is None or type(value) is int):
        return math.nan if value is None else value
    elif origin is Literal and value in parts:
        return value
    elif origin is np.ndarray and isinstance(value, np.ndarray):
        stated = np.dtype(get_args(parts[1])[0])
        if value.dtype.kind == stated.kind:
            return value
    raise ValueError(f"{where}: expected {getattr(kind, '__name__', kind)}, got {shown(value)}")

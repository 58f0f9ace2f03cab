# SPDX-License-Identifier: Apache-2.0
"""Results as arrays of a .npz file: every field, of every object within, with every digit.

np.savez(file, **stored(contacts))
with np.load(file) as arrays:
    again = restored(Contacts, arrays)
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

T = TypeVar("T")

_FIELDS = "fields"  # the entry that holds all but the arrays
_PACKAGE = "inverse_dynamics."


def stored(result: object) -> dict[str, Any]:
    """The arrays of a result, not copied, by their fields; "fields": a text, all that isn't an array.

    Fields that don't take part in comparisons are left out. An array is named after its field, and by its whole
    path where a field nearer to the result has that name.
    """
    arrays: dict[str, NDArray[Any]] = {}
    tree = _tree(result, arrays, ())
    return {**arrays, _FIELDS: np.array(json.dumps(tree))}


def restored(kind: type[T], arrays: Mapping[str, NDArray[Any]]) -> T:
    """The result that stored() took apart. Raises KeyError, TypeError, ValueError where something doesn't fit."""
    tree = json.loads(str(arrays[_FIELDS]))
    if tree["class"].rpartition(".")[2] != kind.__name__:
        raise ValueError(f"expected {kind.__name__}, got {tree['class']}")
    return kind(**_value(tree["state"], arrays))


def _tree(value: Any, arrays: dict[str, NDArray[Any]], path: tuple[str, ...]) -> Any:
    """The value as JSON."""
    if isinstance(value, np.ndarray):
        name = ".".join(path) if path[-1] in arrays else path[-1]
        arrays[name] = value
        return {"array": [name, value.dtype.str, value.shape]}
    if value is None or isinstance(value, str | bool | int | float):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Path):
        return {"path": str(value)}
    if isinstance(value, slice):
        return {"slice": [value.start, value.stop, value.step]}
    if isinstance(value, Mapping):
        # Arrays first: what lies deeper gets the longer names.
        keys = sorted(value, key=lambda key: not isinstance(value[key], np.ndarray))
        of_keys = {key: _tree(value[key], arrays, (*path, str(key))) for key in keys}
        return {"map": {key: of_keys[key] for key in value}}
    if isinstance(value, list | tuple):
        trees = [_tree(part, arrays, (*path, str(k))) for k, part in enumerate(value)]
        return trees if isinstance(value, list) else {"tuple": trees}
    kind = type(value)
    return {
        "class": f"{kind.__module__}.{kind.__qualname__}",
        "state": _tree(_state(value), arrays, path),
    }


def _state(value: Any) -> Any:
    if hasattr(value, "__setstate__"):  # of C++
        return value.__getstate__()
    state = value.__reduce_ex__(2)[2]
    return {field.name: state[field.name] for field in fields(value) if field.compare}


def _value(tree: Any, arrays: Mapping[str, NDArray[Any]]) -> Any:
    """The value of JSON."""
    if isinstance(tree, list):
        return [_value(part, arrays) for part in tree]
    if not isinstance(tree, dict):
        return tree
    if "array" in tree:
        name, dtype, shape = tree["array"]
        array = arrays[name]
        if (array.dtype.str, list(array.shape)) != (dtype, shape):
            raise ValueError(f"{name}: expected {dtype} {shape}, got {array.dtype} {array.shape}")
        return array
    if "path" in tree:
        return Path(tree["path"])
    if "slice" in tree:
        return slice(*tree["slice"])
    if "map" in tree:
        return {key: _value(part, arrays) for key, part in tree["map"].items()}
    if "tuple" in tree:
        return tuple(_value(part, arrays) for part in tree["tuple"])
    return _object(tree["class"], _value(tree["state"], arrays))


def _object(name: str, state: Any) -> Any:
    """An object of one of this package's classes of data."""
    module, _, of = name.rpartition(".")
    kind: Any = getattr(import_module(module), of) if name.startswith(_PACKAGE) else None
    if not (is_dataclass(kind) or hasattr(kind, "__setstate__")):
        raise ValueError(f"expected a class of results, got {name}")
    if hasattr(kind, "__setstate__"):
        if is_dataclass(kind) and {field.name for field in fields(kind)} != {*state}:
            raise ValueError(f"{name}: expected other fields")
        made: Any = kind.__new__(kind)
        made.__setstate__(state)
        return made
    return kind(**state)

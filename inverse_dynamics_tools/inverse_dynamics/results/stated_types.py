# SPDX-License-Identifier: Apache-2.0
"""Whether objects that were made from a file hold what their classes state."""

from __future__ import annotations

import types
from dataclasses import is_dataclass
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from inverse_dynamics.base.wording import shown
from inverse_dynamics.data import joint_log


class _Array:
    """An array of a kind of numbers, as numpy calls it."""

    def __init__(self, kind: str) -> None:
        self.kind = kind


# What modules import for their annotations alone.
_NAMES: dict[str, Any] = {
    "Floats": Literal[_Array("f")],
    "Integers": Literal[_Array("i")],
    "Mask": Literal[_Array("b")],
    "Parameter": object,
    "Clock": joint_log.Clock,
    "Storage": joint_log.Storage,
    "JointLog": joint_log.JointLog,
}


def check_types(instance: object, where: str) -> None:
    """Raise ValueError unless all fields of a dataclass, and of those in it, hold what they state."""
    for name, stated in get_type_hints(type(instance), localns=_NAMES).items():
        _check(getattr(instance, name), stated, f"{where}.{name}")


def _check(value: object, stated: Any, where: str) -> None:
    if isinstance(stated, type) and is_dataclass(stated) and isinstance(value, stated):
        check_types(value, where)
    elif not _fits(value, stated, where):
        raise ValueError(f"{where}: expected {_named(stated)}, got {_shown(value)}")


def _fits(value: object, stated: Any, where: str) -> bool:
    origin, parts = get_origin(stated), get_args(stated)
    if origin is Literal and isinstance(parts[0], _Array):
        return isinstance(value, np.ndarray) and value.dtype.kind == parts[0].kind
    if origin is Literal:
        return value in parts
    if origin in (Union, types.UnionType):
        if value is None:
            return type(None) in parts
        others = [part for part in parts if part is not type(None)]
        if len(others) == 1:
            _check(value, others[0], where)
            return True
        return any(_fits(value, part, where) for part in others)
    if origin is tuple and isinstance(value, tuple):
        kinds = [parts[0]] * len(value) if parts[-1] is Ellipsis else parts
        if len(kinds) != len(value):
            return False
        for k, (entry, kind) in enumerate(zip(value, kinds, strict=True)):
            _check(entry, kind, f"{where}[{k}]")
        return True
    if origin is list and isinstance(value, list):
        return all(_fits(entry, parts[0], where) for entry in value)
    if origin is dict and isinstance(value, dict):
        for key, entry in value.items():
            _check(entry, parts[1], f"{where}.{key}")
        return True
    if stated is float:
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    if stated is int:
        return isinstance(value, int) and not isinstance(value, bool)
    return origin is None and isinstance(value, stated)


def _named(stated: Any) -> str:
    parts = get_args(stated)
    if parts and isinstance(parts[0], _Array):
        return f"an array of the kind '{parts[0].kind}'"
    return stated.__name__ if isinstance(stated, type) else str(stated)


def _shown(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"one of the kind '{value.dtype.kind}'"
    return shown(value)

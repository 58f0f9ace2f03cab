# SPDX-License-Identifier: Apache-2.0
"""Arrays and tables in memory: types for annotations, and what several modules do with them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from typing import Any

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Mask = NDArray[np.bool_]
    Parameter = (
        bool | int | float | str | Sequence[bool] | Sequence[int] | Sequence[float] | Sequence[str]
    )
    DataFrame = Any  # of pandas or polars, which needn't be installed


def stretches(flags: Mask) -> tuple[Integers, Integers]:
    """Where flags (N,) are set in succession: the first samples, and those after the last ones."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    return edges[::2], edges[1::2]


def whole_turns(way: Floats) -> Floats:
    """The whole turns [rad] that are nearest to ways [rad]."""
    return np.asarray(2 * np.pi * np.round(way / (2 * np.pi)))


def names_of(table: Any) -> list[Any] | None:
    """Names of the columns of a DataFrame or a structured array; None: it is neither."""
    if isinstance(table, np.ndarray):
        return list(table.dtype.names) if table.dtype.names else None
    return list(table.columns) if hasattr(table, "columns") else None


def columns_of(table: Mapping[str, Any] | DataFrame) -> Iterator[tuple[str, Any]]:
    """Arrays by name: entries of a mapping, columns of a DataFrame or a structured array.

    A table or a mapping among the entries of a mapping gives `NAME.COLUMN`. The index of a DataFrame of pandas that has
    a name is its first column. Masked and absent numbers are NaN, and times integers, `NAME_ns`.
    Raises ValueError: two columns have the same name.
    """
    names = names_of(table)
    if names and (twice := [name for name in names if names.count(name) > 1]):
        raise ValueError(f"two columns are called {twice[0]}")
    index: Any = getattr(table, "index", None)
    if names is not None and getattr(index, "name", None) is not None:
        yield from _named(f"{index.name}", index)
    for name in list(table) if names is None else names:
        key = ".".join(filter(None, map(str, name))) if isinstance(name, tuple) else f"{name}"
        yield from _named(key, table[name])


def _named(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    inner = list(value) if isinstance(value, Mapping) else names_of(value)
    if inner and all(isinstance(column, (str, tuple)) for column in inner):
        columns = list(columns_of(value))
        # the 1 of `q1` or `joint_1`
        numbers = [re.sub(r"^[A-Za-z_]*?(?=\d+$)", "", key) for key, _ in columns]
        distinct = len({*numbers}) == len(numbers)  # not of two arms
        for (column, array), number in zip(columns, numbers, strict=True):
            key = f"[{number}]" if distinct and number.isdecimal() else f".{column}"
            yield f"{name}{key}", array
        return
    if isinstance(value, np.ma.MaskedArray) and value.dtype.kind in "biuf":
        value = np.ma.filled(value.astype(np.float64), np.nan)
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    array = np.asarray(value, "M8[ns]" if kind == "M" else None)  # of pandas also with a time zone
    if array.dtype == object and hasattr(value, "isna"):  # pandas, with absent numbers
        with suppress(TypeError, ValueError):  # no numbers
            array = np.where(value.isna(), np.nan, array).astype(np.float64, casting="unsafe")
    if array.dtype.kind in "mM":
        name, absent = f"{name}_ns", np.isnat(array)
        array = array.astype(f"{array.dtype.kind}8[ns]").astype(np.int64)
        array = np.where(absent, np.nan, array) if absent.any() else array
    yield name, array


def by_joint(table: Any, joints: Sequence[str], where: str) -> Any:
    """Columns of a DataFrame in the order of the joints that name them; as it is, where none names one.

    Of a Series of pandas the entries. Raises ArgumentError: some joints are missing.
    """
    names = names_of(table)
    if names is None:  # of a list, `index` is a method
        names = list(table.index) if hasattr(table, "reindex") else []
    if not set(names) & set(joints):
        return table
    if missing := [joint for joint in joints if joint not in names]:
        raise ArgumentError(
            f"{where}: expected a column for each of the joints {', '.join(joints)}, got none for "
            f"{', '.join(missing)}"
        )
    return table[list(joints)]

# SPDX-License-Identifier: Apache-2.0
"""Logs as arrays: in files of Parquet, NumPy (.npz, .npy) and MATLAB (.mat), or in memory.

    table = open_arrays(Path("episode.parquet"))
    table.names    # ("timestamp", "observation.state[0]", "observation.state[1]", ...)

An array of N samples is a column; an array of N x n or n x N numbers is n columns `NAME[0]` ..
`NAME[n-1]`; an array in a structure of MATLAB is `STRUCTURE.NAME`. N is the length of the time, or else the longest
dimension. Other arrays are passed over; one whose name alone says a quantity, `qd`, is an error. A Parquet file, or
the directory, of a LeRobot data set has the names that meta/info.json states: `observation.state.shoulder_pan.pos`.
"""

from __future__ import annotations

import json
import shlex
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from inverse_dynamics.arrays import columns_of, names_of
from inverse_dynamics.errors import BagError
from inverse_dynamics.installation.extras import is_installed, require
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.times import time_columns
from inverse_dynamics.recordings.vocabulary import (
    EFFORT,
    JOINTS_CHANGE,
    KEYS,
    POSITION,
    VELOCITY,
)
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from inverse_dynamics.arrays import DataFrame, Floats
    from inverse_dynamics.progress import Progress

_INFO = "meta/info.json"  # of a LeRobot data set
# The command that makes an .npz file of one in HDF5. With `/` before them, no name is that of an argument of savez().
HDF5 = (
    'python3 -c "import h5py, numpy, sys; d = {{}}; h5py.File(sys.argv[1]).visititems(lambda k, v: d.update('
    "{{'/' + k: v[()]}}) if hasattr(v, 'dtype') and v.dtype.kind in 'fiub' else None); numpy.savez(sys.argv[2], **d)\" "
    "{path} {stem}.npz"
)


def command_for(command: str, path: Path, *modules: str) -> str:
    """The command with names for a shell, after the one that installs the modules that it lacks."""
    filled = command.format(path=shlex.quote(f"{path}"), stem=shlex.quote(path.stem))
    absent = [module for module in modules if not is_installed(module)]
    return f"{'pip install ' + ' '.join(absent) + ' && ' if absent else ''}{filled}"


class ArrayTable:
    """Arrays by name, a structured array, or a DataFrame, as a table. path: for errors. Raises BagError."""

    def __init__(self, path: Path, source: Mapping[str, Any] | DataFrame) -> None:
        self.path = path
        self.incomplete = 0
        if not hasattr(source, "keys") and names_of(source) is None:
            raise BagError(
                f"{path}: expected arrays by name, a structured array or a DataFrame, got "
                f"{type(source).__name__}; give {{'time': t, 'q': q, 'effort': tau}}"
            )
        try:
            arrays = dict(columns_of(source))
        except (TypeError, ValueError) as error:
            raise BagError(f"{path}: expected arrays of numbers ({error})") from error
        numeric = {name: array for name, array in arrays.items() if _is_numeric(array)}
        samples = _samples(numeric)
        self._columns = dict(_columns(numeric, samples))
        self.names = tuple(self._columns)
        if not self.names:
            raise BagError(f"{path}: expected arrays of numbers, got none")
        _check_lengths(path, numeric, samples)

    def read(self, columns: Sequence[str], progress: Progress = no_progress) -> Floats:
        """(N, columns) numbers, all of them finite; rows with NaN are left out. Raises BagError."""
        progress("reading", 1, 1)
        rows = np.column_stack([np.asarray(self._columns[name], float) for name in columns])
        missing = np.isnan(rows).any(axis=1)
        self.incomplete = int(missing.sum())
        if np.isinf(rows).any():
            k, j = (int(i) for i in np.argwhere(np.isinf(rows))[0])
            raise BagError(
                f"{self.path}: {columns[j]}: expected finite numbers, got {rows[k, j]} in row {k + 1}; leave "
                "such rows out"
            )
        complete: Floats = rows[~missing]
        return complete


def open_arrays(path: Path) -> ArrayTable:
    """The columns of a file. Raises BagError, MissingPackageError."""
    suffix = path.suffix.lower() if path.is_file() else ".parquet"
    try:
        return ArrayTable(path, dict(_READERS[suffix](path)))
    except FileNotFoundError as error:
        raise BagError(f"{path}: no such file") from error
    except (OSError, ValueError, NotImplementedError, BadZipFile) as error:
        raise BagError(
            f"{path}: can't be read as {suffix} ({error}); is it damaged or of another kind?"
        ) from error


def is_array_file(path: Path) -> bool:
    """Whether it is the name of such a file, or of the directory of a LeRobot data set."""
    with suppress(OSError):  # a path may be too long
        if path.is_dir():
            return (path / _INFO).is_file()
    return path.suffix.lower() in _READERS


def _is_numeric(array: Any) -> bool:
    return array.dtype.kind in "fiub" and array.ndim in (1, 2)


def _samples(arrays: dict[str, Any]) -> int:
    """The length of the time, where another array has it too; else the longest dimension."""
    times = [len(arrays[name]) for name in time_columns(tuple(arrays)) if arrays[name].ndim == 1]
    shared = [size for size in times if sum(size in a.shape for a in arrays.values()) > 1]
    return max(shared or (size for array in arrays.values() for size in array.shape), default=0)


def _check_lengths(path: Path, arrays: dict[str, Any], samples: int) -> None:
    """Raise BagError where an array whose name alone says a quantity would be passed over."""
    if wrong := [k for k, a in arrays.items() if samples not in a.shape and k.lower() in KEYS]:
        shapes = (f"{name} {arrays[name].shape}" for name in arrays)
        raise BagError(
            f"{path}: {wrong[0]}: expected {counted(samples, 'sample')}, as the others have, got the shape "
            f"{arrays[wrong[0]].shape}; all: {', '.join(shapes)}"
        )


def _columns(arrays: dict[str, Any], samples: int) -> Iterator[tuple[str, Any]]:
    for name, array in arrays.items():
        if array.shape == (samples,):
            yield name, array
        elif array.ndim == 2 and samples in array.shape:
            rows = array if array.shape[0] == samples else array.T
            for k in range(rows.shape[1]):
                yield (f"{name}[{k}]" if rows.shape[1] > 1 else name), rows[:, k]


def _of_parquet(path: Path) -> Iterator[tuple[str, Any]]:
    require("a log in Parquet", "pyarrow")
    import pyarrow as pa
    from pyarrow import parquet

    root = path if path.is_dir() else path.absolute().parent.parent.parent
    files = sorted(path.glob("data/*/*.parquet")) if path.is_dir() else [path]
    table = pa.concat_tables([parquet.read_table(file, partitioning=None) for file in files])
    labels = _labels(root / _INFO) | _joints_beside(table, path)
    for name, column in zip(table.column_names, table.columns, strict=True):
        if pa.types.is_timestamp(column.type):
            yield f"{name}_ns", column.cast(pa.timestamp("ns")).cast(pa.int64()).to_numpy()
        elif pa.types.is_list(column.type) or pa.types.is_fixed_size_list(column.type):
            with suppress(ValueError):  # rows differ in their lengths
                rows = np.stack(column.to_numpy())
                named = labels.get(name, ())
                if rows.ndim == 2 and len(named) == rows.shape[1]:
                    yield from ((f"{name}.{each}", rows[:, k]) for k, each in enumerate(named))
                else:
                    yield name, rows
        else:
            yield name, column.to_numpy()


def _joints_beside(table: Any, path: Path) -> dict[str, list[str]]:
    """The joints whose names a list beside those of joint states holds. Raises BagError: they change."""
    labels: dict[str, list[str]] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        if (
            name.endswith("name")
            and f"{column.type}".startswith("list<")
            and column.type.value_type == "string"
        ):
            first, *others = {tuple(joints): None for joints in column.to_pylist()}
            if others:
                change = JOINTS_CHANGE.format(listed(first), listed(others[0]))
                raise BagError(f"{path}: {name}: {change}")
            before = name.removesuffix("name")
            labels |= {f"{before}{kind}": [*first] for kind in (POSITION, VELOCITY, EFFORT)}
    return labels


def _labels(info: Path) -> dict[str, list[str]]:
    """What the numbers of each feature of a LeRobot data set are called: a list, or one in a mapping."""
    if not info.is_file():
        return {}
    features = json.loads(info.read_bytes()).get("features", {})
    names = {key: feature.get("names") for key, feature in features.items()}
    names |= {key: next(iter(n.values())) for key, n in names.items() if isinstance(n, dict) and n}
    return {key: n for key, n in names.items() if isinstance(n, list)}


def _of_npz(path: Path) -> Iterator[tuple[str, Any]]:
    with np.load(path) as file:  # without pickled objects
        yield from ((name, file[name]) for name in file.files)


def _of_npy(path: Path) -> Iterator[tuple[str, Any]]:
    yield path.stem, np.load(path)


def _of_mat(path: Path) -> Iterator[tuple[str, Any]]:
    require("a log of MATLAB", "scipy")
    from scipy.io import loadmat

    try:
        found = loadmat(path, squeeze_me=True, struct_as_record=False)
    except NotImplementedError as error:
        command = command_for(HDF5, path, "h5py")
        raise ValueError(f"it is of version 7.3; save it with '-v7', or: {command}") from error
    for name, value in found.items():
        if not name.startswith("__"):
            yield from _of_structure(name, value)


def _of_structure(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    fields = getattr(value, "_fieldnames", None)
    if fields is None:
        yield name, value
    for key in fields or ():
        yield from _of_structure(f"{name}.{key}", getattr(value, key))


_READERS = {".parquet": _of_parquet, ".npz": _of_npz, ".npy": _of_npy, ".mat": _of_mat}

# SPDX-License-Identifier: Apache-2.0
"""Logs as arrays: in files of Parquet, NumPy (.npz) and MATLAB (.mat), or in memory.

    table = open_arrays(Path("episode.parquet"))
    table.names    # ("timestamp", "observation.state[0]", "observation.state[1]", ...)

An array of N samples is a column; an array of N x n or n x N numbers is n columns `NAME[0]` ..
`NAME[n-1]`; an array in a structure of MATLAB is `STRUCTURE.NAME`. N is the longest dimension in the
file. Other arrays are passed over.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from inverse_dynamics.base.extras import require
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.progress import Progress


class Arrays(type(Path())):  # type: ignore[misc]
    """Columns in memory, where a path may stand: `Arrays.of({"time": t, "q": q, "tau": tau})`."""

    arrays: dict[str, Any]

    @classmethod
    def of(cls, source: Any) -> Arrays:
        """Of a mapping from names to arrays, N or N x n, or of a table of pandas or polars."""
        made = cls("arrays")
        made.arrays = {str(name): np.asarray(source[name]) for name in list(source)}
        return made


class ArrayTable:
    """Arrays as a table. path: for errors. Raises BagError."""

    def __init__(self, path: Path, arrays: dict[str, Any]) -> None:
        self.path = path
        numeric = {name: array for name, array in arrays.items() if _is_numeric(array)}
        samples = max((size for array in numeric.values() for size in array.shape), default=0)
        self._columns = dict(_columns(numeric, samples))
        self.names = tuple(self._columns)
        if not self.names:
            raise BagError(f"{path}: expected arrays of numbers, got none")

    def read(
        self,
        columns: Sequence[str],
        largest: Sequence[float] | None = None,
        progress: Progress = no_progress,
    ) -> Floats:
        """(N, columns) numbers, all of them finite. Raises BagError."""
        progress("reading", 1, 1)
        rows = np.column_stack([np.asarray(self._columns[name], float) for name in columns])
        if not np.isfinite(rows).all():
            k, j = (int(i) for i in np.argwhere(~np.isfinite(rows))[0])
            raise BagError(
                f"{self.path}: {columns[j]}: expected finite numbers, got {rows[k, j]} in row {k + 1}; leave "
                "such rows out"
            )
        return rows


def open_arrays(path: Path) -> ArrayTable:
    """The columns of a file, or of Arrays. Raises BagError, MissingPackageError."""
    if isinstance(path, Arrays):
        return ArrayTable(path, path.arrays)
    try:
        return ArrayTable(path, dict(_READERS[path.suffix.lower()](path)))
    except FileNotFoundError as error:
        raise BagError(f"{path}: no such file") from error
    except (OSError, ValueError, NotImplementedError, BadZipFile) as error:
        raise BagError(
            f"{path}: can't be read as {path.suffix} ({error}); is it damaged or of another kind?"
        ) from error


def is_array_file(path: Path) -> bool:
    """Whether it is Arrays, or the name of such a file."""
    return isinstance(path, Arrays) or (path.suffix.lower() in _READERS and not path.is_dir())


def _is_numeric(array: Any) -> bool:
    return isinstance(array, np.ndarray) and array.dtype.kind in "fiub" and array.ndim in (1, 2)


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

    table = parquet.read_table(path)
    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = column.type
        if pa.types.is_timestamp(kind):
            yield f"{name}_ns", column.cast(pa.timestamp("ns")).cast(pa.int64()).to_numpy()
        elif pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind):
            rows = column.to_pylist()
            if rows and all(row is not None and len(row) == len(rows[0]) for row in rows):
                yield name, np.array(rows)
        else:
            yield name, column.to_numpy()


def _of_npz(path: Path) -> Iterator[tuple[str, Any]]:
    with np.load(path) as file:  # without pickled objects
        yield from ((name, file[name]) for name in file.files)


def _of_mat(path: Path) -> Iterator[tuple[str, Any]]:
    require("a log of MATLAB", "scipy")
    from scipy.io import loadmat

    found = loadmat(path, squeeze_me=True, struct_as_record=False)
    for name, value in found.items():
        if not name.startswith("__"):
            yield from _of_structure(name, value)


def _of_structure(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    fields = getattr(value, "_fieldnames", None)
    if fields is None:
        yield name, value
    for key in fields or ():
        yield from _of_structure(f"{name}.{key}", getattr(value, key))


_READERS = {".parquet": _of_parquet, ".npz": _of_npz, ".mat": _of_mat}

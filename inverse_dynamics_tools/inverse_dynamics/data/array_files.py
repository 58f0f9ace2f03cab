# SPDX-License-Identifier: Apache-2.0
"""Logs in files of arrays: Parquet, NumPy's .npz, MATLAB's .mat.

    table = ArrayFile(Path("episode.parquet"))
    table.names    # ("timestamp", "observation.state[0]", "observation.state[1]", ...)

An array of N samples is a column; an array of N x n or n x N numbers is n columns `NAME[0]` ..
`NAME[n-1]`; an array in a structure of MATLAB is `STRUCTURE.NAME`. N is the longest dimension in the
file. Other arrays are passed over.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from inverse_dynamics.base.extras import require
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.progress import Progress


class ArrayFile:
    """The columns of a file. Raises BagError, MissingPackageError."""

    def __init__(self, path: Path) -> None:
        self.path = path
        read = _READERS[path.suffix.lower()]
        try:
            arrays = {name: array for name, array in read(path) if _is_numeric(array)}
        except FileNotFoundError as error:
            raise BagError(f"{path}: no such file") from error
        except (OSError, ValueError, NotImplementedError, BadZipFile) as error:
            raise BagError(
                f"{path}: can't be read as {path.suffix} ({error}); is it damaged or of another kind?"
            ) from error
        samples = max((size for array in arrays.values() for size in array.shape), default=0)
        self._columns = dict(_columns(arrays, samples))
        self.names = tuple(self._columns)
        if not self.names:
            raise BagError(f"{path}: expected arrays of numbers, got none")

    def read(
        self,
        columns: Sequence[str],
        largest: Sequence[float] | None = None,
        progress: Progress = no_progress,
    ) -> Floats:
        """(N, columns) numbers."""
        progress("reading", 1, 1)
        return np.column_stack([np.asarray(self._columns[name], float) for name in columns])


def is_array_file(path: Path) -> bool:
    """Whether the name is that of such a file."""
    return path.suffix.lower() in _READERS and not path.is_dir()


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

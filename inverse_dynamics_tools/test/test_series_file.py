# SPDX-License-Identifier: Apache-2.0
import zipfile

import numpy as np
import pytest

from inverse_dynamics.errors import OutputError
from inverse_dynamics.results.series_file import SeriesFile


@pytest.fixture
def arrays():
    random = np.random.default_rng(1)
    return {
        "time": random.normal(size=1000),
        "q": random.normal(size=(1000, 3)),
        "stamps": random.integers(0, 1 << 60, 1000),
        "kept": random.random(1000) < 0.5,
    }


@pytest.mark.parametrize("block", [1, 7, 1000, 5000])
def test_numpy_reads_what_was_added(tmp_path, arrays, block):
    path = tmp_path / "series.npz"
    with SeriesFile(path, 1000) as series:
        for begin in range(0, 1000, block):
            series.add({name: array[begin : begin + block] for name, array in arrays.items()})
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
    mapped = series.mapped()
    with np.load(path, allow_pickle=False) as read:
        assert read.files == list(arrays)
        for name, array in arrays.items():
            assert read[name].dtype == array.dtype
            np.testing.assert_array_equal(read[name], array)
            np.testing.assert_array_equal(mapped[name], array)
            assert type(mapped[name]) is np.ndarray


def test_sizes_may_be_beyond_32_bits(tmp_path):
    rows = (1 << 32) // 8 + 10
    path = tmp_path / "series.npz"
    with SeriesFile(path, rows) as series:  # a sparse file
        series.add({"a": np.arange(3.0), "b": np.arange(3.0)})
        series._done = rows - 1
        series.add({"a": np.arange(1.0), "b": np.arange(1.0)})
    with np.load(path, mmap_mode="r") as read:
        assert read.files == ["a", "b"]
        with read.zip.open("b.npy") as member:
            header = member.read(1000)
    assert str(rows).encode() in header
    np.testing.assert_array_equal(series.mapped()["b"][:3], np.arange(3.0))
    assert len(series.mapped()["b"]) == rows


def test_the_same_arrays_give_the_same_bytes(tmp_path, arrays):
    for name in ("one", "two"):
        with SeriesFile(tmp_path / name, 1000) as series:
            series.add(arrays)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


@pytest.mark.parametrize("count", [999, 1001])
def test_another_number_of_rows_than_announced_is_an_error(tmp_path, count):
    series = SeriesFile(tmp_path / "series.npz", 1000)
    series.add({"time": np.zeros(count)})
    with pytest.raises(OutputError, match=rf"series.npz: expected 1000 rows, got {count}"):
        series.finish()


def test_arrays_of_other_lengths_are_an_error(tmp_path):
    series = SeriesFile(tmp_path / "series.npz", 1000)
    with pytest.raises(OutputError, match=r"q: expected 3 rows .*, got .* of shape \(0, 0\)"):
        series.add({"time": np.zeros(3), "q": np.zeros((0, 0))})
    series.add({"time": np.zeros(3), "q": np.zeros((3, 0))})
    with pytest.raises(OutputError, match=r"q: expected 3 rows of 0 bytes, got .* \(3, 2\)"):
        series.add({"time": np.zeros(3), "q": np.zeros((3, 2))})
    series.close()

# SPDX-License-Identifier: Apache-2.0
import tracemalloc

import numpy as np
import pytest

from inverse_dynamics.figures.thinning import PeaksOfRows, peaks
from inverse_dynamics.figures.torque_lines import TorqueLines


@pytest.mark.parametrize("count", [3, 10, 11, 12, 99, 1000])
def test_peaks_are_no_more_than_asked_for(count):
    values = np.random.default_rng(count).normal(size=count)
    kept = peaks(values, 10)
    assert len(kept) <= 10
    assert (np.diff(kept) > 0).all()
    assert {0, count - 1, int(values.argmin()), int(values.argmax())} <= set(kept.tolist())


def test_each_stretch_keeps_its_lowest_and_highest():
    # 20 values, at most 10: stretches of 5
    values = np.array([0, 9, 0, -9, 0, 1, 2, 3, 4, 5, 0, 0, 0, 0, 0, 7, 6, 5, 4, 8.0])
    assert peaks(values, 10).tolist() == [0, 1, 3, 5, 9, 10, 18, 19]


def test_a_short_last_stretch_names_no_index_beyond_the_end():
    values = np.arange(23.0)
    assert peaks(values, 10).max() == 22


@pytest.mark.parametrize("count", [1, 9, 10, 11, 999, 5000])
@pytest.mark.parametrize("block", [1, 7, 1000, 5000])
def test_peaks_of_rows_that_come_in_blocks_are_those_of_all(count, block):
    values = np.random.default_rng(count).normal(size=(count, 2)).round(1)
    time = np.arange(count) * 0.5
    rows = PeaksOfRows(count, 10)
    for begin in range(0, count, block):
        rows.add(time[begin : begin + block], values[begin : begin + block])
    for i in range(2):
        kept = peaks(values[:, i], 10)
        np.testing.assert_array_equal(rows.line(i)[0], time[kept])
        np.testing.assert_array_equal(rows.line(i)[1], values[kept, i])


def test_lines_of_many_samples_need_little_memory():
    torques = np.random.default_rng(1).normal(size=(4096, 7))
    lines = TorqueLines(10_000_000, 7)
    tracemalloc.start()
    for block in range(200):
        lines.add(np.arange(4096.0) + 4096 * block, torques, 0.9 * torques)
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert held < 3e6

# SPDX-License-Identifier: Apache-2.0
import tracemalloc

import numpy as np
import pytest

from inverse_dynamics.show.thinning import error_limit, line, peaks


@pytest.mark.parametrize("count", [3, 10, 11, 12, 23, 99, 1000])
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


def test_a_line_of_many_samples_needs_little_memory():
    torques = np.random.default_rng(1).normal(size=(400_000, 7))
    time = np.arange(400_000.0)
    tracemalloc.start()
    shown, values = line(time, torques[:, 3])
    limit = error_limit(torques[:, 3])
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(shown) == len(values) <= 6000
    assert values.max() == torques[:, 3].max()
    assert 1.5 * 2.5 < limit < 1.5 * 3.1  # of 400,000 normal numbers, the greatest is 4.9
    assert peak < 1.5 * time.nbytes  # one column is copied, not all

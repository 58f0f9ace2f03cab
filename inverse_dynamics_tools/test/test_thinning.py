# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from inverse_dynamics.figures.thinning import peaks


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

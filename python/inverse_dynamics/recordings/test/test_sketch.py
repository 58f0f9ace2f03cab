# SPDX-License-Identifier: Apache-2.0
"""Recordings are recognised by their samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from example_recordings import joint_log

from inverse_dynamics.recordings.sketch import has_samples_of, sketch_of


@pytest.fixture
def log():
    """A joint turns on and on; the arm rests for the first fifth."""
    log = joint_log(2000, 3)
    time = np.maximum(np.arange(2000) - 400, 0)[:, None] / 100
    q = np.array([3.0, 1.0, 0.5]) * time
    random = np.random.default_rng(0).standard_normal(q.shape)
    return replace(log, q=q, effort=np.where(time > 0, np.sin(q) + 0.1 * random, 1.0))


def rows(log, some):
    names = ("header_stamps", "receive_stamps", "q", "qd", "effort")
    return replace(log, **{name: getattr(log, name)[some] for name in names})


def test_a_part_is_recognised_by_the_whole_and_the_whole_by_a_part(log):
    part = rows(log, slice(1000, 1400))
    assert has_samples_of(log, sketch_of(log))
    assert has_samples_of(part, sketch_of(log))
    assert has_samples_of(log, sketch_of(part))


def test_the_rest_of_a_recording_and_rest_at_the_same_place_are_others(log):
    first, rest = rows(log, slice(0, 1000)), rows(log, slice(1000, None))
    assert not has_samples_of(rest, sketch_of(first))
    assert not has_samples_of(first, sketch_of(rest))
    still = rows(log, slice(0, 400))
    assert not has_samples_of(still, sketch_of(log))


def test_neither_digits_that_a_table_leaves_out_count_nor_turns(log):
    table = replace(log, q=log.q - 2 * np.pi, effort=np.round(log.effort, 9))
    assert has_samples_of(table, sketch_of(log))
    assert not has_samples_of(replace(log, effort=log.effort + 1e-3), sketch_of(log))

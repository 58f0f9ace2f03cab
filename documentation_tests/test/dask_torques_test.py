# SPDX-License-Identifier: Apache-2.0
"""The example of ten million states, with a few thousand, in blocks that don't come out even."""

from __future__ import annotations

import re
import subprocess
import sys

import dask
import numpy as np
import pytest
from pages import REPOSITORY

from inverse_dynamics import Solver

EXAMPLE = REPOSITORY / "examples/dask_torques.py"
sys.path.insert(0, str(EXAMPLE.parent))

import dask_torques  # noqa: E402

STATES, BLOCK = 5000, 700


def ran(*options: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, EXAMPLE, *options], capture_output=True, text=True)


@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_blocks_have_the_torques_of_one_call(scheduler: str) -> None:
    solver = Solver(dask_torques.UR10)
    states = dask_torques.random_states(6, STATES, BLOCK)
    tau = dask_torques.torques(solver, *states)
    assert tau.numblocks == (8, 1)
    expected = solver.torques(*dask.compute(*states))
    np.testing.assert_array_equal(tau.compute(scheduler=scheduler), expected)


@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_the_table_is_that_of_all_torques(scheduler: str) -> None:
    done = ran("--states", str(STATES), "--block", str(BLOCK), "--scheduler", scheduler)
    assert done.returncode == 0, done.stderr
    solver = Solver(dask_torques.UR10)
    tau = solver.torques(*dask.compute(*dask_torques.random_states(6, STATES, BLOCK)))
    rows = [line.split() for line in done.stdout.splitlines()[1:]]
    assert [row[0] for row in rows] == list(solver.joint_names)
    shown = np.array([row[1:] for row in rows], dtype=float)
    expected = np.stack([np.abs(tau).max(axis=0), np.sqrt((tau**2).mean(axis=0))], axis=1)
    np.testing.assert_allclose(shown, expected, rtol=0, atol=0.0501)


def test_no_array_of_all_states_is_made() -> None:
    states = dask_torques.random_states(6, 10_000_000, 100_000)
    tau = dask_torques.torques(Solver(dask_torques.UR10), *states)
    assert tau.shape == (10_000_000, 6)
    assert tau.chunksize == (100_000, 6)
    # One block of the last ones can be had without the others.
    assert np.isfinite(tau[-1].compute()).all()


@pytest.mark.parametrize("option", ["--states", "--block"])
@pytest.mark.parametrize("value", ["0", "1e7", "many"])
def test_a_number_that_is_none_is_an_error(option: str, value: str) -> None:
    done = ran(option, value)
    assert done.returncode == 2
    message = f"argument {option}: expected a whole number above 0, got '{value}'"
    assert re.search(re.escape(message), done.stderr)

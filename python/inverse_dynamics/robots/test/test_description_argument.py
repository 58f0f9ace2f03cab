# SPDX-License-Identifier: Apache-2.0
"""The argument `urdf` of Solver and FastModel: a text, or the path of a file."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from example_robots import RIGID_BODY
from simulation_arms import pendulum

from inverse_dynamics import FastModel, Solver
from inverse_dynamics.errors import ArgumentError, RobotError


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(pendulum())
    return path


def test_a_path_is_as_good_as_the_text(file):
    of_text = Solver(RIGID_BODY, urdf=pendulum()).torques([0.3], [0.2], [0.1])
    for urdf in (file, str(file)):
        solver = Solver(RIGID_BODY, urdf=urdf)
        np.testing.assert_array_equal(solver.torques([0.3], [0.2], [0.1]), of_text)
        assert FastModel.from_urdf(urdf).joint_names == ("swing",)
    file.unlink()
    again = pickle.loads(pickle.dumps(solver))  # holds the text
    np.testing.assert_array_equal(again.torques([0.3], [0.2], [0.1]), of_text)


def test_a_file_that_is_missing_is_named(tmp_path):
    missing = tmp_path / "no.urdf"
    for urdf in (missing, str(missing)):
        with pytest.raises(RobotError, match=r"no\.urdf: no such file; expected a robot descr"):
            Solver(RIGID_BODY, urdf=urdf)
    missing.mkdir()
    with pytest.raises(RobotError, match=r"no\.urdf: is a directory; expected a robot descr"):
        Solver(RIGID_BODY, urdf=missing)


def test_anything_else_is_refused():
    with pytest.raises(ArgumentError, match=r"Solver: argument urdf: expected str \| Path, got 5"):
        Solver(RIGID_BODY, urdf=5)

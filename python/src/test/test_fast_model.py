# SPDX-License-Identifier: Apache-2.0
"""The engine without a plugin, from Python."""

from __future__ import annotations

import numpy as np
import pytest
from example_robots import RIGID_BODY

from inverse_dynamics import FastModel, Solver, UserError, load_robot

N = 40


@pytest.fixture(scope="module")
def urdf() -> str:
    urdf = load_robot("ur10_simulated").urdf
    assert urdf is not None
    return urdf.read_text()


@pytest.fixture(scope="module")
def motion() -> tuple[np.ndarray, ...]:
    return tuple(np.random.default_rng(1).uniform(-2, 2, size=(3, N, 6)))


@pytest.mark.parametrize(
    ("method", "inputs"),
    [
        ("torques", 3),
        ("inertia_matrix", 1),
        ("coriolis_vector", 2),
        ("gravity_vector", 1),
        ("accelerations", 3),
        ("torque_derivatives", 3),
        ("coriolis_matrix", 2),
        ("tip_pose", 1),
        ("jacobian", 1),
        ("tip_jacobian_derivative", 2),
    ],
)
def test_results_are_those_of_the_solver(urdf, motion, method, inputs):
    """Of many states and of one; test_solver_capabilities.py judges the solver."""
    model, solver = FastModel.from_urdf(urdf), Solver(RIGID_BODY, urdf=urdf)
    assert model.joint_names == solver.joint_names
    for states in (motion[:inputs], [values[3] for values in motion[:inputs]]):
        ours, theirs = (getattr(each, method)(*states) for each in (model, solver))
        for our, their in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(our, their, rtol=0, atol=1e-9)


def test_regressor_times_parameters_are_the_torques(
    urdf: str, motion: tuple[np.ndarray, ...]
) -> None:
    model, solver = FastModel.from_urdf(urdf), Solver(RIGID_BODY, urdf=urdf)
    Y = model.regressor(*motion)
    assert Y.shape == (N, 6, 60)
    np.testing.assert_allclose(Y @ model.parameters, solver.torques(*motion), atol=1e-10)
    np.testing.assert_allclose(model.regressor(*(x[7] for x in motion)), Y[7], atol=1e-10)


def test_threads_give_the_same_bits(urdf: str) -> None:
    motion = np.random.default_rng(3).uniform(-2, 2, size=(3, 10_000, 6))
    one, three = FastModel.from_urdf(urdf), FastModel.from_urdf(urdf, threads=3)
    assert (one.regressor(*motion) == three.regressor(*motion)).all()
    assert (one.accelerations(*motion) == three.accelerations(*motion)).all()


def test_errors_name_what_was_expected(urdf: str) -> None:
    model = FastModel.from_urdf(urdf)
    q = np.zeros((5, 6))
    with pytest.raises(UserError, match=r"regressor: argument qd: wrong shape: expected \(5, 6\)"):
        model.regressor(q, q[:4], q)
    with pytest.raises(UserError, match="argument threads: expected 1 or more, got 0"):
        FastModel.from_urdf(urdf, threads=0)
    with pytest.raises(UserError, match="tip"):
        FastModel.from_urdf(urdf, tip="nowhere")
    with pytest.raises(UserError, match=r"from_joints: wrong shape"):
        FastModel.from_joints(
            ["a"], [False], np.eye(3), np.zeros(2), np.zeros(10), gravity=(0, 0, 1)
        )

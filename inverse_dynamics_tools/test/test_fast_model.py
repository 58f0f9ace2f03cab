# SPDX-License-Identifier: Apache-2.0
"""The engine without a plugin, from Python."""

from __future__ import annotations

import numpy as np
import pytest

from inverse_dynamics import FastModel, Solver, UserError, load_robot

RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"
N = 40


@pytest.fixture(scope="module")
def urdf() -> str:
    urdf = load_robot("ur10_simulated").urdf
    assert urdf is not None
    return urdf.read_text()


@pytest.fixture(scope="module")
def motion() -> tuple[np.ndarray, ...]:
    return tuple(np.random.default_rng(1).uniform(-2, 2, size=(3, N, 6)))


def test_forward_dynamics_inverts_torques(urdf: str, motion: tuple[np.ndarray, ...]) -> None:
    q, qd, qdd = motion
    model, solver = FastModel.from_urdf(urdf), Solver(RIGID_BODY, urdf=urdf)
    assert model.joint_names == solver.joint_names
    tau = solver.torques(q, qd, qdd)
    np.testing.assert_allclose(model.forward_dynamics(q, qd, tau), qdd, rtol=0, atol=1e-9)
    out = np.zeros((N, 12))[:, ::2]
    assert model.forward_dynamics(q, qd, tau, out=out) is out
    np.testing.assert_allclose(out[3], model.forward_dynamics(q[3], qd[3], tau[3]), atol=1e-9)


def test_derivatives_are_difference_quotients(urdf: str, motion: tuple[np.ndarray, ...]) -> None:
    q, qd, qdd = motion
    model, solver = FastModel.from_urdf(urdf), Solver(RIGID_BODY, urdf=urdf)
    by_q, by_qd, H = model.torque_derivatives(q, qd, qdd)
    np.testing.assert_allclose(H, solver.inertia_matrix(q), atol=1e-12)
    h = 1e-6
    for j in range(6):
        step = h * np.eye(6)[j]
        quotient = (solver.torques(q + step, qd, qdd) - solver.torques(q - step, qd, qdd)) / (2 * h)
        np.testing.assert_allclose(by_q[:, :, j], quotient, atol=1e-6)
        quotient = (solver.torques(q, qd + step, qdd) - solver.torques(q, qd - step, qdd)) / (2 * h)
        np.testing.assert_allclose(by_qd[:, :, j], quotient, atol=1e-6)


def test_coriolis_matrix_gives_vector_and_rate_of_inertia(
    urdf: str, motion: tuple[np.ndarray, ...]
) -> None:
    q, qd, _ = motion
    model, solver = FastModel.from_urdf(urdf), Solver(RIGID_BODY, urdf=urdf)
    C = model.coriolis_matrix(q, qd)
    assert C.shape == (N, 6, 6)
    c = solver.coriolis_vector(q, qd)
    np.testing.assert_allclose(np.einsum("kij,kj->ki", C, qd), c, atol=1e-11)
    h = 1e-6
    rate = (solver.inertia_matrix(q + h * qd) - solver.inertia_matrix(q - h * qd)) / (2 * h)
    np.testing.assert_allclose(C + C.transpose(0, 2, 1), rate, atol=1e-6)
    out = np.zeros((N, 6, 12))[:, :, ::2]
    assert model.coriolis_matrix(q, qd, out=out) is out
    np.testing.assert_allclose(out[3], model.coriolis_matrix(q[3], qd[3]), atol=1e-11)


def test_jacobian_and_its_derivative_are_difference_quotients(
    urdf: str, motion: tuple[np.ndarray, ...]
) -> None:
    q, qd, _ = motion
    model = FastModel.from_urdf(urdf)
    R, p = model.tip_pose(q)
    J = model.tip_jacobian(q)
    assert (R.shape, p.shape, J.shape) == ((N, 3, 3), (N, 3), (N, 6, 6))
    h = 1e-6
    for j in range(6):
        step = h * np.eye(6)[j]
        (R2, p2), (R1, p1) = model.tip_pose(q + step), model.tip_pose(q - step)
        np.testing.assert_allclose(J[:, :3, j], (p2 - p1) / (2 * h), atol=1e-8)
        w = (R2 - R1) @ R.transpose(0, 2, 1) / (2 * h)
        angular = np.stack([w[:, 2, 1], w[:, 0, 2], w[:, 1, 0]], axis=1)
        np.testing.assert_allclose(J[:, 3:, j], angular, atol=1e-8)
    dJ = model.tip_jacobian_derivative(q, qd)
    quotient = (model.tip_jacobian(q + h * qd) - model.tip_jacobian(q - h * qd)) / (2 * h)
    np.testing.assert_allclose(dJ, quotient, atol=1e-8)
    out = np.zeros((6, 12))[:, ::2]
    assert model.tip_jacobian(q[3], out=out) is out
    np.testing.assert_allclose(out, J[3], atol=1e-14)
    np.testing.assert_allclose(model.tip_pose(q[3])[0], R[3], atol=1e-14)
    np.testing.assert_allclose(model.tip_jacobian_derivative(q[3], qd[3]), dJ[3], atol=1e-13)
    with pytest.raises(UserError, match=r"tip_jacobian: argument out: wrong shape: .*\(6, 6\)"):
        model.tip_jacobian(q[3], out=np.zeros((6, 5)))


def test_regressor_times_parameters_are_the_torques(
    urdf: str, motion: tuple[np.ndarray, ...]
) -> None:
    model, solver = FastModel.from_urdf(urdf), Solver(RIGID_BODY, urdf=urdf)
    Y = model.regressor(*motion)
    assert Y.shape == (N, 6, 60)
    np.testing.assert_allclose(Y @ model.parameters, solver.torques(*motion), atol=1e-10)
    np.testing.assert_allclose(model.regressor(*(x[7] for x in motion)), Y[7], atol=1e-10)


@pytest.mark.parametrize("threads", [1, 3])
def test_gram_matrices_are_sums_of_products_of_rows(urdf: str, threads: int) -> None:
    model = FastModel.from_urdf(urdf, gravity=(1.0, 2.0, -9.0), threads=threads)
    q, qd, qdd, tau, weights = np.random.default_rng(2).uniform(0.1, 2, size=(5, 7000, 6))
    own = [qd, np.sign(qd), np.ones_like(qd)]
    gram = model.regressor_gram(q, qd, qdd, tau, own_columns=own, weights=weights)
    assert gram.shape == (6, 64, 64)
    Y = model.regressor(q, qd, qdd)
    for j in range(6):
        rows = np.column_stack([Y[:, j], *(column[:, j] for column in own), tau[:, j]])
        expected = rows.T @ (weights[:, j, None] * rows)
        np.testing.assert_allclose(gram[j], expected, rtol=0, atol=1e-12 * expected.max())


def test_threads_give_the_same_bits(urdf: str) -> None:
    motion = np.random.default_rng(3).uniform(-2, 2, size=(3, 10_000, 6))
    one, three = FastModel.from_urdf(urdf), FastModel.from_urdf(urdf, threads=3)
    assert (one.regressor(*motion) == three.regressor(*motion)).all()
    assert (one.forward_dynamics(*motion) == three.forward_dynamics(*motion)).all()


def test_errors_name_what_was_expected(urdf: str) -> None:
    model = FastModel.from_urdf(urdf)
    q = np.zeros((5, 6))
    with pytest.raises(UserError, match=r"regressor: argument qd: wrong shape: expected \(5, 6\)"):
        model.regressor(q, q[:4], q)
    with pytest.raises(UserError, match=r"regressor_gram: argument own_columns\[1\]: wrong shape"):
        model.regressor_gram(q, q, q, q, own_columns=[q, q[:, :5]])
    with pytest.raises(UserError, match="argument threads: expected 1 or more, got 0"):
        FastModel.from_urdf(urdf, threads=0)
    with pytest.raises(UserError, match="tip"):
        FastModel.from_urdf(urdf, tip="nowhere")
    with pytest.raises(UserError, match=r"from_joints: wrong shape"):
        FastModel.from_joints(["a"], [False], np.eye(3), np.zeros(2), np.zeros(10), (0, 0, -9.81))

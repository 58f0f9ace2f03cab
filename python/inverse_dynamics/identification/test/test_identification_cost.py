# SPDX-License-Identifier: Apache-2.0
"""The least cost of a fit is that of an interior-point solver for cones, which shares nothing with it."""

from __future__ import annotations

import numpy as np
import pytest

import inverse_dynamics as ids
from inverse_dynamics import _core
from inverse_dynamics.robots.descriptions import read_description

clarabel = pytest.importorskip("clarabel", reason="the judge, clarabel, isn't installed")
sparse = pytest.importorskip("scipy.sparse")

NOISE = 0.5  # N m
RELATIVE = 1e-4  # of the cost: the judge's own tolerance is 1e-8
OWN = 4  # columns: qdd, qd, 1, step
POSITIVE = (0, 1, 3)
WIDE = 1e4  # N m; standard deviation of the offset beforehand


@pytest.fixture(scope="module", params=["ur10_simulated", "panda_simulated"])
def arm(request):
    """A fitter whose description is wrong by a half, and a block of samples."""
    robot = ids.load_robot(request.param)
    text, ends = read_description(robot.urdf), {"root": robot.root, "tip": robot.tip}
    model = _core.FastModel.from_urdf(text, **ends)
    n = len(model.joint_names)
    random = np.random.default_rng(1)
    q, qd, qdd = (random.uniform(-most, most, (400, n)) for most in (3.0, 1.5, 4.0))
    scale = np.repeat(random.uniform(0.6, 1.6, n), 10)
    tau = model.regressor(q, qd, qdd) @ (scale * model.parameters)
    tau += 0.4 * qdd + 2.0 * qd + 1.5 * np.tanh((qd + 0.02) / 0.08) + 0.3
    tau += random.normal(0.0, NOISE, tau.shape)
    return _core.ArmFitter.from_urdf(text, **ends), model, (q, qd, qdd, tau)


def quadratic(model, fit, block):
    """A, b, c of the weighted squares x' A x - 2 b' x + c at the steps of a fit."""
    q, qd, qdd, tau = block
    width = np.array([law["width"] for law in fit.friction])
    shift = np.array([law["shift"] for law in fit.friction])
    own = [qdd, qd, np.ones_like(qd), np.tanh((qd + shift) / width)]
    Y, n = model.regressor(q, qd, qdd), q.shape[1]
    A, b, c = np.zeros((14 * n, 14 * n)), np.zeros(14 * n), 0.0
    for j in range(n):
        rows = np.column_stack([Y[:, j], *(column[:, j] for column in own), tau[:, j]])
        gram = rows.T @ rows
        at = np.r_[0 : 10 * n, 10 * n + OWN * j : 10 * n + OWN * (j + 1)]
        weight = fit.noise[j] ** -2
        A[np.ix_(at, at)] += weight * gram[:-1, :-1]
        b[at] += weight * gram[:-1, -1]
        c += weight * gram[-1, -1]
    offsets = 10 * n + 2 + OWN * np.arange(n)
    A[offsets, offsets] += WIDE**-2
    return A, b, c


def pseudo_inertia(p):
    """4 x 4."""
    inertia = np.array([[p[4], p[5], p[6]], [p[5], p[7], p[8]], [p[6], p[8], p[9]]])
    P = np.zeros((4, 4))
    P[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    P[:3, 3] = P[3, :3] = p[1:4]
    P[3, 3] = p[0]
    return P


def unknowns(fit):
    """In the order of the quadratic."""
    figures = [[law[key] for key in ("fv", "fo", "fc")] for law in fit.friction]
    own = np.column_stack([fit.rotor_inertia, figures])
    return np.concatenate([fit.parameters.ravel(), own.ravel()])


def cost(x, parts, prior, strength):
    """What is minimised."""
    A, b, c = parts
    n = len(prior)
    total = x @ A @ x - 2 * b @ x + c
    for p, p0 in zip(x[: 10 * n].reshape(n, 10), prior, strict=True):
        P, P0 = pseudo_inertia(p), pseudo_inertia(p0)
        total += strength * (np.trace(np.linalg.solve(P0, P)) - np.linalg.slogdet(P)[1])
    return total - np.log(x[10 * n :].reshape(n, OWN)[:, POSITIVE]).sum()


class Cones:
    """Rows `s = offset + row . variables` in cones, for the judge."""

    def __init__(self):
        self.entries, self.offsets, self.kinds = [], [], []

    def row(self, entries, offset=0.0):
        self.entries += [(len(self.offsets), column, -value) for column, value in entries]
        self.offsets.append(offset)

    def logarithm(self, u, z):
        """u <= log z."""
        self.row([(u, 1.0)])
        self.row([], 1.0)
        self.row([(z, 1.0)])
        self.kinds.append(clarabel.ExponentialConeT())


SYMMETRIC = [(i, j) for j in range(4) for i in range(j + 1)]  # of Q: upper triangle by columns


def determinant(cones, Q, Z, u):
    """sum u <= log det Q: [[Q, Z], [Z', diag Z]] >= 0, Z lower triangular [Boyd, Vandenberghe]."""
    of_Q = {pair: Q + k for k, pair in enumerate(SYMMETRIC)}
    of_Z = {(j, i): Z + k for k, (i, j) in enumerate(SYMMETRIC)}
    for j in range(8):
        for i in range(j + 1):
            factor = 1.0 if i == j else np.sqrt(2.0)
            if j < 4:
                column = of_Q[i, j]
            elif i < 4:
                column = of_Z.get((i, j - 4))
            else:
                column = of_Z[i - 4, i - 4] if i == j else None
            cones.row([] if column is None else [(column, factor)])
    cones.kinds.append(clarabel.PSDTriangleConeT(8))
    for k in range(4):
        cones.logarithm(u + k, of_Z[k, k])


def least_cost(parts, prior, strength):
    """By the judge, in coordinates where the prior is the identity."""
    A, b, c = parts
    n = len(prior)
    to_x, trace = np.eye(14 * n), np.zeros(14 * n)
    constant = c
    units = np.array([pseudo_inertia(e) for e in np.eye(10)]).reshape(10, 16).T
    for i, p0 in enumerate(prior):
        L = np.linalg.cholesky(pseudo_inertia(p0))
        constant -= strength * 2 * np.log(np.diag(L)).sum()
        for k, (r, s) in enumerate(SYMMETRIC):
            Q = np.zeros((4, 4))
            Q[r, s] = Q[s, r] = 1
            to_x[10 * i : 10 * i + 10, 10 * i + k] = np.linalg.lstsq(units, (L @ Q @ L.T).ravel())[
                0
            ]
            trace[10 * i + k] = strength * np.trace(Q)
    cones, size = Cones(), 14 * n
    linear = [trace - 2 * to_x.T @ b]
    for i in range(n):
        determinant(cones, 10 * i, size, size + 10)
        linear.append(np.r_[np.zeros(10), np.full(4, -strength)])
        size += 14
    for j in range(n):
        for k in POSITIVE:
            cones.logarithm(size, 10 * n + OWN * j + k)
            linear.append([-1.0])
            size += 1
    P = np.zeros((size, size))
    P[: 14 * n, : 14 * n] = 2 * to_x.T @ A @ to_x
    rows, columns, values = zip(*cones.entries, strict=True)
    matrix = sparse.csc_matrix((values, (rows, columns)), shape=(len(cones.offsets), size))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix(np.triu(P)),
        np.concatenate(linear),
        matrix,
        np.array(cones.offsets),
        cones.kinds,
        settings,
    )
    found = solver.solve()
    assert "Solved" in str(found.status)
    return found.obj_val + constant


@pytest.mark.parametrize("strength", [1.0, 100.0, 1000.0])
def test_the_cost_is_the_least(arm, strength):
    fitter, model, block = arm
    fit = fitter.fit(fitter.data([block]), _core.ArmFitOptions("step", prior_strength=strength))
    parts = quadratic(model, fit, block)
    ours = cost(unknowns(fit), parts, fitter.prior, strength)
    assert ours == pytest.approx(least_cost(parts, fitter.prior, strength), rel=RELATIVE)


def test_a_worse_fit_is_told_apart(arm):
    """The tolerance is no wider than what the wrong prior strength costs."""
    fitter, model, block = arm
    data = fitter.data([block])
    fit = fitter.fit(data, _core.ArmFitOptions("step", prior_strength=100.0))
    other = fitter.fit(data, _core.ArmFitOptions("step", prior_strength=1000.0), fit)
    parts = quadratic(model, fit, block)
    least = cost(unknowns(fit), parts, fitter.prior, 100.0)
    assert cost(unknowns(other), parts, fitter.prior, 100.0) > least * (1 + 2 * RELATIVE)

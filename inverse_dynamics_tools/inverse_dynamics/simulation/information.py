# SPDX-License-Identifier: Apache-2.0
"""What a motion tells about the torques of an arm: how far predicted torques are uncertain after it.

    unknowns = Unknowns.of_arm(robot, limits, noise)
    gram = unknowns.gram(q, qd, qdd, period)          # of a motion, or of a recording
    random = unknowns.random_states(1000)
    unknowns.deviations(gram, random)                 # (n,) N m, mean over the random states

A torque is linear in what is unknown: `tau_j = z_j(q, qd, qdd) b`. b holds the ten parameters of each link and, for
each joint, rotor inertia, viscous friction, step, offset, friction that grows with the load of gravity, and width and
shift of the step (linearised). After N independent samples with noise of standard deviation s_j the covariance of b is

    V = (sum_k sum_j z_jk' z_jk / s_j^2 + H)^-1

and the variance of a predicted torque `z_j V z_j'` [Fedorov, Theory of Optimal Experiments, 1972]. H is the information
of the prior: for the links half the Hessian of `gamma [tr(P0^-1 P) - log det P]`, P the pseudo-inertia [Lee, Wensing,
Park, IEEE T-RO 2020], for the others that of a normal distribution. Residuals of a recording are correlated, so an
interval CORRELATION counts as one sample.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.simulation.regressor import PARAMETERS_PER_LINK, ArmGeometry

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from inverse_dynamics._core import FastModel
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.simulation.limits import MotionLimits
    from inverse_dynamics.simulation.model import SimulatedRobot

OWN = 7  # unknowns that belong to one joint: rotor, viscous, step, offset, load, width, shift
CORRELATION = 0.25  # s, distance of samples with independent errors
NOISE = 0.01  # part of the effort limit that is the noise's standard deviation, where none is known
STEP_WIDTH = 0.02  # part of the velocity limit: of the friction step

# Standard deviations of the prior, in parts of the effort limit at the velocity or acceleration limit.
_PRIOR_FRICTION = 0.1
_PRIOR_OFFSET = 0.05
_PRIOR_LOAD = 0.2  # N m per N m of gravity
_PRIOR_STEP_SHAPE = 1.0  # of width and shift, in widths
_TYPICAL_STEP = 0.05  # what the effect of width and shift is computed with
_STRENGTH = 2.0  # gamma: all numbers of a link are known to one half
_PAYLOAD_RADIUS = 0.1  # m, of the prior's ball
_PAYLOAD_SHARE = 0.05  # of the arm's mass, the prior's ball
_LEAST_EXTENT = 0.02  # m, square root of the least second moment over mass of a link
_LEAST_MASS = 1e-3  # of the arm's mass
_BLOCK = 2000  # states at a time


@dataclass(frozen=True)
class States:
    """Joint states, (N, n) each."""

    q: Floats
    qd: Floats
    qdd: Floats

    def __iter__(self):  # type: ignore[no-untyped-def]
        return iter((self.q, self.qd, self.qdd))

    def __len__(self) -> int:
        return len(self.q)


@dataclass(frozen=True)
class Unknowns:
    """The unknown numbers of an arm, m of them, and what is believed of them beforehand."""

    model: FastModel
    limits: MotionLimits
    noise: Floats  # (n,) N m, standard deviation of an independent sample
    columns: slice  # of the regressor, which are unknown
    scale: Floats  # (m, m): the covariance of the prior is scale scale'
    predicted: (
        Floats  # (m,) 1 for unknowns whose effect on torques is to be known, 0 for the others
    )

    @classmethod
    def of_arm(
        cls, robot: SimulatedRobot, limits: MotionLimits, noise: Floats | None = None
    ) -> Unknowns:
        """All parameters of an arm. noise: None: NOISE of each effort limit."""
        model = ArmGeometry.of(robot).model
        links = model.parameters.reshape(-1, PARAMETERS_PER_LINK)
        total = max(float(links[:, 0].sum()), 1e-3)
        scales = [_prior_scale(_pseudo_inertia(link, total)) for link in links]
        return cls._made(model, limits, noise, slice(0, 10 * len(links)), scales, predict_own=True)

    @classmethod
    def of_payload(
        cls, robot: SimulatedRobot, limits: MotionLimits, noise: Floats | None = None
    ) -> Unknowns:
        """The ten parameters of a body at the tip; what friction may have changed is a nuisance."""
        model = ArmGeometry.of(robot).model
        count = len(model.joint_names)
        mass = _PAYLOAD_SHARE * max(float(model.parameters[::PARAMETERS_PER_LINK].sum()), 1e-3)
        ball = mass * np.diag([*3 * [_PAYLOAD_RADIUS**2 / 5], 1.0])
        columns = slice(10 * count - 10, 10 * count)
        return cls._made(model, limits, noise, columns, [_prior_scale(ball)], predict_own=False)

    @classmethod
    def _made(
        cls,
        model: FastModel,
        limits: MotionLimits,
        noise: Floats | None,
        columns: slice,
        link_scales: list[Floats],
        *,
        predict_own: bool,
    ) -> Unknowns:
        joints, inertial = len(model.joint_names), PARAMETERS_PER_LINK * len(link_scales)
        scale = np.zeros(2 * (inertial + OWN * joints,))
        for i, block in enumerate(link_scales):
            at = slice(PARAMETERS_PER_LINK * i, PARAMETERS_PER_LINK * (i + 1))
            scale[at, at] = block
        effort, velocity = limits.effort, limits.velocity
        own = np.column_stack(
            [
                _PRIOR_FRICTION * effort / limits.acceleration,
                _PRIOR_FRICTION * effort / velocity,
                _PRIOR_FRICTION * effort,
                _PRIOR_OFFSET * effort,
                np.full(joints, _PRIOR_LOAD),
                *2 * [np.full(joints, _PRIOR_STEP_SHAPE)],
            ]
        )
        np.fill_diagonal(scale[inertial:, inertial:], own.ravel())
        predicted = np.ones(len(scale))
        predicted[inertial:] = predict_own
        return cls(
            model,
            limits,
            NOISE * effort if noise is None else noise,
            columns,
            scale,
            predicted,
        )

    def rows(self, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """z, (N, n, m), of states (N, n)."""
        return self.rows_and_torques(q, qd, qdd)[0]

    def rows_and_torques(self, q: Floats, qd: Floats, qdd: Floats) -> tuple[Floats, Floats]:
        """z, (N, n, m), and the description's torques without friction, (N, n) N m."""
        count, joints = q.shape
        Y = self.model.regressor(q, qd, qdd)
        Z = np.zeros((count, joints, len(self.scale)))
        Z[:, :, : self._inertial] = Y[:, :, self.columns]
        Z[:, np.arange(joints)[:, None], self._places] = self._own(self.gravity(q), qd, qdd)
        return Z, np.asarray(Y @ self.model.parameters)

    def weighted_sum(self, U: Floats, U_tau: Floats) -> Callable[..., Floats]:
        """What computes `sum_jm U z + sum_j U_tau tau`, (N,), of other states, without their z (N, n, m).

        U: (N, n, m), U_tau: (N, n). Its arguments: q, qd, qdd, (N, n), and gravity(q) or None.
        """
        of_regressor = U_tau[:, :, None] * self.model.parameters
        of_regressor[:, :, self.columns] += U[:, :, : self._inertial]
        of_own = U[:, np.arange(U.shape[1])[:, None], self._places]

        def weighted(q: Floats, qd: Floats, qdd: Floats, gravity: Floats | None) -> Floats:
            gravity = self.gravity(q) if gravity is None else gravity
            Y, own = self.model.regressor(q, qd, qdd), self._own(gravity, qd, qdd)
            return np.asarray(
                np.einsum("kjm,kjm->k", of_regressor, Y) + np.einsum("kjm,kjm->k", of_own, own)
            )

        return weighted

    @property
    def _inertial(self) -> int:
        """How many unknowns belong to links."""
        return len(self.scale) - OWN * len(self.model.joint_names)

    @property
    def _places(self) -> NDArray[np.intp]:
        """(n, OWN): where each joint's own unknowns are."""
        joints = len(self.model.joint_names)
        return self._inertial + np.arange(OWN * joints).reshape(joints, OWN)

    def gravity(self, q: Floats) -> Floats:
        """Gravity torques (N, n) N m, of the description."""
        still = np.zeros_like(q)
        return np.asarray(self.model.regressor(q, still, still) @ self.model.parameters)

    def _own(self, gravity: Floats, qd: Floats, qdd: Floats) -> Floats:
        """(N, n, OWN): derivatives of a joint's torque by its own unknowns."""
        s = qd / (STEP_WIDTH * self.limits.velocity)
        step = np.tanh(s)
        bell = _TYPICAL_STEP * self.limits.effort * (1.0 - step**2)
        load = np.abs(gravity) * step
        return np.stack([qdd, qd, step, np.ones_like(qd), load, -s * bell, bell], axis=-1)

    def gram(self, q: Floats, qd: Floats, qdd: Floats, period: float) -> Floats:
        """Information (m, m) of a motion, sampled at distances of `period` s; motions add up."""
        total = np.zeros_like(self.scale)
        for k in range(0, len(q), _BLOCK):
            Z = self.rows(*(values[k : k + _BLOCK] for values in (q, qd, qdd)))
            total += self.weighted_gram(Z, period)
        return total

    def weighted_gram(self, Z: Floats, period: float) -> Floats:
        """The same of rows (N, n, m)."""
        weighted = (Z / self.noise[:, None]).reshape(-1, Z.shape[2])
        return np.asarray(weighted.T @ weighted) * sample_weight(period)

    def covariance(self, gram: Floats | None = None) -> Floats:
        """V (m, m) after that information; None: of the prior alone."""
        if gram is None:
            return self.scale @ self.scale.T
        # in units of the prior: well-conditioned, whatever the units are
        whitened = np.eye(len(gram)) + self.scale.T @ gram @ self.scale
        half = np.linalg.solve(np.linalg.cholesky(whitened), self.scale.T)
        return half.T @ half

    def random_states(self, count: int, seed: int = 0) -> States:
        """States drawn evenly from the limits."""
        random = np.random.default_rng(seed)
        lower, upper = self.limits.window()
        unit = random.uniform(-1.0, 1.0, (2, count, len(lower)))
        return States(
            random.uniform(lower, upper, (count, len(lower))),
            self.limits.velocity * unit[0],
            self.limits.acceleration * unit[1],
        )

    def deviations(self, gram: Floats | None, states: States) -> Floats:
        """(n,) N m: standard deviation of predicted torques, mean over the states."""
        V = self.covariance(gram)
        Z = self.rows(*states) * self.predicted
        variances = np.einsum("kjm,kjm->kj", Z @ V, Z)
        return np.asarray(np.sqrt(np.maximum(variances, 0.0)).mean(axis=0))


def sample_weight(period: float) -> float:
    """How many independent samples one is worth, where samples are `period` s apart."""
    return min(1.0, period / CORRELATION)


def _pseudo_inertia(link: Floats, total_mass: float) -> Floats:
    """P (4, 4) of ten parameters; where the description's isn't usable, made so at the center of mass."""
    m, mc = link[0], link[1:4]
    xx, xy, xz, yy, yz, zz = link[4:]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    second = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    mass = max(m, _LEAST_MASS * total_mass)
    center = mc / m if m > 0.0 else np.zeros(3)
    # about the center of mass, in principal axes: the same in whatever frame
    moments, axes = np.linalg.eigh(second - m * np.outer(center, center))
    central = (axes * np.maximum(moments, mass * _LEAST_EXTENT**2)) @ axes.T
    P = np.empty((4, 4))
    P[:3, :3] = central + mass * np.outer(center, center)
    P[:3, 3] = P[3, :3] = mass * center
    P[3, 3] = mass
    return P


def _prior_scale(P0: Floats) -> Floats:
    """S (10, 10), S S' the covariance of the ten parameters under the prior at P0."""
    inverse = np.linalg.inv(P0)
    basis = np.array([_pseudo_inertia_of_unit(i) for i in range(PARAMETERS_PER_LINK)])
    products = inverse @ basis
    H = 0.5 * _STRENGTH * np.einsum("iab,jba->ij", products, products)
    return np.linalg.inv(np.linalg.cholesky(H)).T


def _pseudo_inertia_of_unit(i: int) -> Floats:
    """Derivative of P by p_i, (4, 4), constant: P is linear in the ten parameters."""
    unit = np.zeros(PARAMETERS_PER_LINK)
    unit[i] = 1.0
    xx, xy, xz, yy, yz, zz = unit[4:]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    P = np.zeros((4, 4))
    P[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    P[:3, 3] = P[3, :3] = unit[1:4]
    P[3, 3] = unit[0]
    return P

# SPDX-License-Identifier: Apache-2.0
"""How uncertain the predicted torques of an arm are after a motion has been recorded.

    unknowns = Unknowns.of(robot, limits, noise)
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
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from inverse_dynamics._core import FastModel
from inverse_dynamics.robots.link_parameters import inertia_matrix, pseudo_inertia

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.simulation.limits import MotionLimits
    from inverse_dynamics.simulation.model import SimulatedRobot

PARAMETERS_PER_LINK = 10
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


def engine_of(robot: SimulatedRobot) -> FastModel:
    """The chain as the description has it, with the payload."""
    chain = robot.chain
    return FastModel.from_urdf(
        chain.urdf, root=chain.root, tip=list(chain.tips), gravity=robot.gravity
    )


def base_count(engine: FastModel) -> int:
    """Number of base parameters: the rank of Y over all motions."""
    joints = len(engine.joint_names)
    random = np.random.default_rng(0)
    q, qd, qdd = random.uniform(-np.pi, np.pi, (3, 20 * joints, joints))
    Y = engine.regressor(q, qd, qdd)
    values = np.linalg.svd(Y.reshape(-1, Y.shape[2]), compute_uv=False)
    # rounding leaves about 1e-15 of the greatest one where there is none
    return int((values > 1e-8 * values[0]).sum())


def condition_number(Y: Floats, count: int) -> float:
    """Ratio of the greatest to the least of the `count` nonzero singular values of the stacked Y.

    It is the condition number of `Y V`, V an orthonormal basis of the base parameters: every such basis gives the same
    one. A choice of independent columns of Y would not: columns of equal norm leave that choice to rounding.
    """
    # the square of the condition, from a small matrix: enough digits up to about 1e6
    # (summed sample by sample: one large product would start threads, which costs more than it saves)
    squares = np.linalg.eigvalsh((Y.transpose(0, 2, 1) @ Y).sum(axis=0))
    return float(np.sqrt(squares[-1] / max(squares[-count], 1e-16 * squares[-1])))


class States(NamedTuple):
    """Joint states, (N, n) each."""

    q: Floats
    qd: Floats
    qdd: Floats


@dataclass(frozen=True)
class Unknowns:
    """The m unknowns of an arm, and their prior."""

    model: FastModel
    limits: MotionLimits
    noise: Floats  # (n,) N m, standard deviation of an independent sample
    columns: slice  # of the regressor, which are unknown
    scale: Floats  # (m, m): the covariance of the prior is scale scale'
    predicted: Floats  # (m,) 1 for unknowns whose effect on torques is to be known, 0 for others

    @classmethod
    def of(
        cls,
        robot: SimulatedRobot,
        limits: MotionLimits,
        noise: Floats | None = None,
        *,
        payload: bool = False,
    ) -> Unknowns:
        """All parameters of an arm. noise: None: NOISE of each effort limit.

        payload: the ten parameters of a body at the first tip instead; what friction may have changed is a nuisance.
        """
        model = engine_of(robot)
        links = model.parameters.reshape(-1, PARAMETERS_PER_LINK)
        total = max(float(links[:, 0].sum()), 1e-3)
        first = 0
        if payload:
            bodies = [_PAYLOAD_SHARE * total * np.diag([*3 * [_PAYLOAD_RADIUS**2 / 5], 1.0])]
            last_joint = robot.chain.joints_to(robot.chain.tips[0])[-1]
            first = PARAMETERS_PER_LINK * model.link_joints.index(last_joint)
        else:
            bodies = [_pseudo_inertia(link, total) for link in links]
        own, inertial = _own_scales(limits), PARAMETERS_PER_LINK * len(bodies)
        scale = np.diag(np.append(np.zeros(inertial), own))
        for begin, body in zip(range(0, inertial, PARAMETERS_PER_LINK), bodies, strict=True):
            part = slice(begin, begin + PARAMETERS_PER_LINK)
            scale[part, part] = _prior_scale(body)
        predicted = np.repeat([1.0, 0.0 if payload else 1.0], [inertial, len(own)])
        noise = NOISE * limits.effort if noise is None else noise
        columns = slice(first, first + inertial)
        return cls(model, limits, noise, columns, scale, predicted)

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


def _own_scales(limits: MotionLimits) -> Floats:
    """(OWN n,) standard deviations of the prior, of the unknowns that belong to single joints."""
    effort, velocity = limits.effort, limits.velocity
    shape = _PRIOR_STEP_SHAPE * np.ones_like(effort)
    columns = [
        _PRIOR_FRICTION * effort / limits.acceleration,
        _PRIOR_FRICTION * effort / velocity,
        _PRIOR_FRICTION * effort,
        _PRIOR_OFFSET * effort,
        _PRIOR_LOAD * np.ones_like(effort),
        shape,
        shape,
    ]
    return np.column_stack(columns).ravel()


def sample_weight(period: float) -> float:
    """Effective independent samples per sample, where samples are `period` s apart."""
    return min(1.0, period / CORRELATION)


def _pseudo_inertia(link: Floats, total_mass: float) -> Floats:
    """P (4, 4) of ten parameters; where the description's isn't usable, made so at the center of mass."""
    m, mc, inertia = link[0], link[1:4], inertia_matrix(link[4:])
    second = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    mass = max(m, _LEAST_MASS * total_mass)
    center = mc / m if m > 0.0 else np.zeros(3)
    # about the center of mass, in principal axes: the same in whatever frame
    moments, axes = np.linalg.eigh(second - m * np.outer(center, center))
    central = (axes * np.maximum(moments, mass * _LEAST_EXTENT**2)) @ axes.T
    place = np.append(center, 1.0)
    return np.asarray(np.pad(central, (0, 1)) + mass * np.outer(place, place))


def _prior_scale(P0: Floats) -> Floats:
    """S (10, 10), S S' the covariance of the ten parameters under the prior at P0."""
    basis = np.array([pseudo_inertia(unit) for unit in np.eye(PARAMETERS_PER_LINK)])
    products = np.linalg.inv(P0) @ basis
    H = 0.5 * _STRENGTH * np.einsum("iab,jba->ij", products, products)
    return np.linalg.inv(np.linalg.cholesky(H)).T

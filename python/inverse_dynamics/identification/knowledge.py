# SPDX-License-Identifier: Apache-2.0
"""Which of a model's numbers the data determine, how well, and what the prior decided.

Errors of neighbouring samples are alike, so textbook intervals are far too narrow. Here the scores of
contiguous blocks vary as they do (cluster-robust covariance with Student's t) [Cameron, Miller 2015,
doi 10.3368/jhr.50.2.317].
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.identification.blocks import data_of
from inverse_dynamics.identification.result import Interval, PriorDecided

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics._core import ArmFit, ArmFitOptions, ArmFitter, FastModel
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.blocks import Block

PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")
UNITS = ("kg", *["kg m"] * 3, *["kg m^2"] * 6)

# Own columns of a joint [friction_step.hpp]: key and whether the step is one of the logarithm.
_OWN = (
    ("rotor_inertia", False),
    ("fv", False),
    ("fo", False),
    ("fc", False),
    ("shift", False),
    ("width", True),
    ("fl", False),
    ("fs", False),
    ("vs", True),
    ("fm", False),
    ("distance", True),
)
_COLUMNS = {"step": 6, "load": 7, "stribeck": 9, "memory": 11}  # of _OWN, that a law has
_OWN_UNITS = {  # of a revolute joint, and of a prismatic one
    "rotor_inertia": ("kg m^2", "kg"),
    "fv": ("N m s/rad", "N s/m"),
    "fo": ("N m", "N"),
    "fc": ("N m", "N"),
    "shift": ("rad/s", "m/s"),
    "width": ("rad/s", "m/s"),
    "fl": ("", ""),
    "fs": ("N m", "N"),
    "vs": ("rad/s", "m/s"),
    "fm": ("N m", "N"),
    "distance": ("rad", "m"),
    "stiffness": ("N m/rad", "N/m"),
    "lever_sin": ("N m", "N"),
    "lever_cos": ("N m", "N"),
}
_SPRINGS: tuple[tuple[str, ...], ...] = ((), ("stiffness",), ("lever_sin", "lever_cos"))

_CLUSTERS = 10
# Student's t, 97.5 %, by degrees of freedom, from one.
_T = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160)
DOUBT = 0.1
"""Relative error of a described mass that nothing shows: where efforts lack gravity."""

_KNOWN = 0.5  # share of the information that must be the data's


@dataclass(frozen=True)
class _Own:
    """An unknown of friction, rotor or spring."""

    place: str  # the joint, or another place with friction
    key: str  # of _OWN_UNITS
    logarithm: bool  # whether its step is one of the logarithm
    value: float


@dataclass(frozen=True)
class Knowledge:
    """Second derivatives of the cost at a fit, and how they vary from block to block. m unknowns."""

    joints: tuple[str, ...]
    own: tuple[_Own, ...]  # behind the parameters of links
    values: Floats  # (m,)
    described: Floats  # (l, 10): the parameters of the prior, of all links
    data: Floats  # (m, m), of samples as if they were independent
    prior: Floats  # (m, m)
    scores: Floats  # (clusters, m)
    # (m, K) errors of the unknowns if an assumption is wrong by one standard deviation
    assumed: Floats

    @property
    def deviations(self) -> Floats:
        """(m, K), of the covariance `deviations deviations'`: cluster-robust, and what the prior may be wrong by.

        A fit is drawn to the prior by as much as the prior is wrong. How wrong that is, in units of
        its strength, the links tell that the data have moved.
        """
        bread = _inverse(self.data + self.prior)
        centered = self.scores - self.scores.mean(0)
        clusters = len(centered)
        of_blocks = centered.T * np.sqrt(clusters / (clusters - 1))
        of_prior = _root(self.prior) * np.sqrt(self._prior_error())
        return np.hstack([bread @ of_blocks, bread @ of_prior, self.assumed])

    def _prior_error(self) -> float:
        """Mean square of the prior's errors in the directions that the data determine, at least one."""
        rigid = slice(0, self.described.size)
        moved = self.values[rigid] - self.described.ravel()
        told = np.trace(_inverse(self.data + self.prior)[rigid] @ self.data[:, rigid])
        error = moved @ self.prior[rigid, rigid] @ moved / max(float(told), 1.0)
        return max(float(error), 1.0)

    def shares(self, worth: float) -> Floats:
        """(m,) of the information on each unknown, what comes from the data: 0 to 1.

        worth: effective independent samples per sample, mean over the joints.
        """
        prior = self.prior / self._prior_error()
        posterior = np.diag(_inverse(worth * self.data + prior)) + (self.assumed**2).sum(1)
        shares: Floats = 1 - posterior / np.diag(_inverse(prior))
        return shares


def student_t(clusters: int) -> float:
    """Half width of a 95 % interval, in standard deviations that so many clusters tell."""
    return float(_T[min(clusters - 2, len(_T) - 1)])


def _inverse(matrix: Floats) -> Floats:
    """Of a positive definite matrix whose unknowns have different units."""
    scale = 1 / np.sqrt(np.diag(matrix))
    return np.linalg.inv(matrix * np.outer(scale, scale)) * np.outer(scale, scale)


def _root(matrix: Floats) -> Floats:
    """R of a positive semidefinite matrix R R' whose unknowns have different units."""
    scale = np.sqrt(np.diag(matrix))
    scale[scale == 0] = 1
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    root: Floats = scale[:, None] * vectors * np.sqrt(np.maximum(values, 0))
    return root


def knowledge(
    fitter: ArmFitter, fit: ArmFit, blocks: Sequence[Block], options: ArmFitOptions
) -> Knowledge:
    """That of a fit to blocks, which are cut further, to about ten clusters."""
    each = max(1, round(_CLUSTERS / len(blocks)))
    clusters = [part for block in blocks for part in block.rows(block.counts).parts(each)]
    data, prior, scores = fitter.information(fit, data_of(fitter, clusters), options)
    own = _own(fitter, fit, options.law)
    values = _values(fit, own)
    none = np.zeros((len(values), 0))
    return Knowledge(fitter.joint_names, own, values, fitter.prior, data, prior, scores, none)


def own_columns(law: str) -> int:
    """Unknowns of a joint's rotor and friction."""
    return _COLUMNS[law]


def _own(fitter: ArmFitter, fit: ArmFit, law: str) -> tuple[_Own, ...]:
    """The unknowns of a fit beside those of links, in the order of ArmInformation [arm_fit.hpp]."""
    joints = fitter.joint_names
    found = []
    for k, (place, friction) in enumerate(
        zip((*joints, *fitter.friction_places), fit.friction, strict=True)
    ):
        for key, logarithm in _OWN[: _COLUMNS[law]]:
            if k < len(joints) and key == "rotor_inertia":
                found.append(_Own(place, key, logarithm, float(fit.rotor_inertia[k])))
            elif k < len(joints) or key not in ("rotor_inertia", "fo"):
                found.append(_Own(place, key, logarithm, friction.get(key, 0.0)))
    if fit.springs is not None:
        for joint, kind, values in zip(joints, fitter.springs, fit.springs, strict=True):
            keys = _SPRINGS[kind]
            found += [
                _Own(joint, key, False, float(x)) for key, x in zip(keys, values, strict=False)
            ]
    return tuple(found)


def _values(fit: ArmFit, own: Sequence[_Own]) -> Floats:
    """(m,) the unknowns of a fit."""
    values: Floats = np.append(fit.parameters.ravel(), [one.value for one in own])
    return values


def weights_of_links(
    model: FastModel, links: Floats, blocks: Sequence[Block]
) -> list[list[Floats]]:
    """Gravity torques of DOUBT of each link's mass, (N, n) of each block. links: (l, 10)."""

    def of(block: Block) -> Floats:
        still = np.zeros_like(block.q)
        columns = model.regressor(block.q, still, still).reshape(*block.q.shape, -1, 10)
        weights: Floats = DOUBT * np.einsum("njkc,kc->knj", columns, links)
        return weights

    return [list(link) for link in zip(*map(of, blocks), strict=True)]


def assumed(
    fitter: ArmFitter,
    fit: ArmFit,
    blocks: Sequence[Block],
    options: ArmFitOptions,
    changes: Sequence[Sequence[Floats]],
) -> Floats:
    """(m, K): by how much the unknowns change with the torques (N, n) of the blocks."""
    steps = []
    own = _own(fitter, fit, options.law)
    values = _values(fit, own)
    unit = np.append(
        np.ones(fit.parameters.size), [one.value if one.logarithm else 1.0 for one in own]
    )
    for change in changes:
        moved = [replace(b, tau=b.tau + torques) for b, torques in zip(blocks, change, strict=True)]
        again = fitter.fit(data_of(fitter, moved), options, fit)
        steps.append((_values(again, _own(fitter, again, options.law)) - values) / unit)
    return np.array(steps).T


def independent_samples(errors: Sequence[Floats]) -> Floats:
    """(n,) effective number of independent samples of errors (M, n) of blocks.

    Samples over the sum of their autocorrelations, up to the first one that is negative.
    """
    total = np.zeros(errors[0].shape[1])
    for block in errors:
        centered = block - block.mean(0)
        size = len(centered)
        spectrum = np.abs(np.fft.rfft(centered, 2 * size, axis=0)) ** 2
        correlation = np.fft.irfft(spectrum, axis=0)[:size]
        correlation = correlation / np.maximum(correlation[0], 1e-300)
        positive = np.logical_and.accumulate(correlation > 0, axis=0)
        total += size / np.maximum(2 * (correlation * positive).sum(0) - 1, 1)
    return total


def intervals(known: Knowledge, model: FastModel, units: Sequence[str]) -> tuple[Interval, ...]:
    """95 % intervals of values of friction, rotor inertias, and identifiable inertial combinations.

    units: of each joint's torque, N m or N.
    """
    rigid = known.described.size
    deviations = known.deviations
    factor = student_t(len(known.scores))
    found = []
    for combination, k, name in _combinations(model):
        direction = np.zeros(len(known.values))
        direction[:rigid] = combination
        half = factor * float(np.linalg.norm(direction @ deviations))
        found.append(Interval(name, UNITS[k % 10], float(direction @ known.values), half, ""))
    half_widths: list[float] = (factor * np.linalg.norm(deviations, axis=1)).tolist()
    for at, one in enumerate(known.own, rigid):
        width = half_widths[at] * (one.value if one.logarithm else 1.0)
        is_joint = one.place in known.joints
        slides = is_joint and units[known.joints.index(one.place)] == "N"
        found.append(
            Interval(
                f"{one.place} {one.key}",
                _OWN_UNITS[one.key][slides],
                one.value,
                width,
                one.place if is_joint else "",
            )
        )
    return tuple(found)


def _combinations(model: FastModel) -> list[tuple[Floats, int, str]]:
    """Inertial combinations that torques depend on: coefficients, ten of each link, and their names.

    Parameter k of each, the last that is independent, has coefficient one; the others are those
    that move with it [Gautier 1991, doi 10.1002/rob.4620080405].
    """
    n, rigid = len(model.joint_names), 10 * len(model.link_joints)
    random = np.random.default_rng(0)
    q, qd, qdd = (random.uniform(-3, 3, (50 * n, n)) for _ in range(3))
    Y = model.regressor(q, qd, qdd).reshape(-1, rigid)
    independent: list[int] = []
    kept = np.zeros((len(Y), 0))
    for k in reversed(range(rigid)):  # the distal links keep their parameters
        column = Y[:, k] - kept @ (kept.T @ Y[:, k])
        if np.linalg.norm(column) > 1e-8 * (float(np.linalg.norm(Y[:, k])) + 1.0):
            kept = np.column_stack([kept, column / np.linalg.norm(column)])
            independent.append(k)
    independent.sort()
    dependent = [k for k in range(rigid) if k not in independent]
    factors = np.linalg.lstsq(Y[:, independent], Y[:, dependent])[0]
    found = []
    for row, k in zip(factors, independent, strict=True):
        coefficients = np.zeros(rigid)
        coefficients[dependent] = np.where(np.abs(row) > 1e-9, row, 0.0)
        coefficients[k] = 1
        found.append((coefficients, k, _name(coefficients, k, model.link_joints)))
    return found


def _name(coefficients: Floats, k: int, joints: Sequence[str]) -> str:
    """The parameter, and those that move with it."""

    def one(index: int) -> str:
        return f"{PARAMETERS[index % 10]} of {joints[index // 10]}'s link"

    others = [int(i) for i in np.flatnonzero(coefficients) if i != k]
    if not others:
        return one(k)
    terms = [f"{coefficients[i]:+.3g} {one(i)}" for i in others[:2]]
    more = f" and {len(others) - 2} more" if len(others) > 2 else ""
    return f"{one(k)} {' '.join(terms)}{more}"


def prior_decided(known: Knowledge, worth: float, links: Sequence[str]) -> tuple[PriorDecided, ...]:
    """Numbers of links of whose information less than half comes from the data. worth: as shares() takes it."""
    shares, described = known.shares(worth), known.described.ravel()
    return tuple(
        PriorDecided(
            link=links[i // 10],
            parameter=PARAMETERS[i % 10],
            prior=float(described[i]),
            value=float(known.values[i]),
            share=float(np.clip(shares[i], 0, 1)),
        )
        for i in range(described.size)
        if shares[i] < _KNOWN
    )

# SPDX-License-Identifier: Apache-2.0
"""Uncertainty of an identified model: the content of the file beside it, see model_errors.py.

The covariance is that of the posterior: samples whose errors are correlated in time, and the prior.
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics.evaluation.bands import LEVEL, SHARE, TorqueBand
from inverse_dynamics.identification.blocks import data_of
from inverse_dynamics.identification.cross_validation import errors_of
from inverse_dynamics.identification.result import Level, valid_samples
from inverse_dynamics.outputs.plain import plain
from inverse_dynamics.robots.model_errors import LEAST_GAIN, SCHEMA, MoreFriction, sha256

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from inverse_dynamics._core import ArmFit, ArmFitter, Solver
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.blocks import Block
    from inverse_dynamics.identification.cross_validation import Chosen
    from inverse_dynamics.identification.knowledge import Knowledge
    from inverse_dynamics.identification.result import HeldOutBlock, Identification

_DIGITS = 7
_LEAST = 1e-6  # variance of the torques by the noise's, of deviations that are written
_RIDGE = 1e-12  # by the information: rounding, of directions that change no torque
_MOST_ROWS = 10_000  # of held-out errors: half a megabyte; they are thinned
_APART = 10.0  # s between blocks: many correlation times
_GREATEST = 0.995  # quantile that is taken for the greatest torque
_USUAL_RANGE, _MOST_RANGE = 3.0, 7.0  # greatest torques
_MOVES = 0.05  # of the greatest velocity
USUAL_COUNTS = 2  # recordings


def factor_of(
    fitter: ArmFitter, fit: ArmFit, blocks: Sequence[Block], known: Knowledge, *, law: str
) -> Floats:
    """(m, K): independent deviations of the m unknowns of a fit to blocks.

    Those come first that change torques most; those that change none are left out. Last are those of known.assumed.
    """
    errors = np.concatenate([errors_of(fitter, fit, block) for block in blocks])
    times = [block.time[block.counts] for block in blocks]
    rows, end = [], 0.0
    for time in times:  # one after another, those of several recordings too
        rows.append(time - time[0] + end)
        end = float(rows[-1][-1]) + _APART
    noise = _core.residual_noise(np.concatenate(rows), errors - errors.mean(axis=0))
    samples = data_of(fitter, blocks, times)
    data = fitter.whitened_information(fit, samples, law, noise)
    information = data + known.prior
    scale = 1 / np.sqrt(np.diag(information))
    scaled = information * np.outer(scale, scale) + _RIDGE * np.eye(len(scale))
    root = np.linalg.cholesky(scaled)
    any_factor = scale[:, None] * np.linalg.inv(root).T
    variances, turn = np.linalg.eigh(any_factor.T @ known.data @ any_factor)
    kept = np.flatnonzero(variances > _LEAST * len(errors))[::-1]
    return np.hstack([any_factor @ turn[:, kept], known.assumed])


def more_of(fitter: ArmFitter, others: Sequence[dict[str, float]]) -> MoreFriction:
    """What a fit has beside a law of each joint."""
    coupling = None if fitter.coupling is None else fitter.coupling.tolist()
    return MoreFriction(tuple(others), coupling, tuple(fitter.springs))


def band_of(
    fitter: ArmFitter,
    chosen: Chosen,
    factor: Floats,
    blocks: Sequence[Block],
    limits: Floats | None,
) -> TorqueBand:
    """The band of a fit to blocks, of whose level on other days nothing is known but what is usual.

    limits: (n,) of efforts, infinite where they aren't known; None: a band for the same day.
    """
    samples = [block.fitted for block in blocks]
    _, qd, _, tau = (np.abs(np.concatenate(v)) for v in zip(*samples, strict=True))
    n = qd.shape[1]
    none, greatest = np.zeros(n), np.quantile(tau, _GREATEST, axis=0)
    return TorqueBand(
        factor=factor,
        friction=chosen.fit.friction[:n],
        more=more_of(fitter, chosen.fit.friction[n:]),
        noise=chosen.noise,
        level=none if limits is None else usual_level(greatest, limits),
        share=none if limits is None else none + SHARE,
        seen=qd.max(axis=0),
    )


def usual_level(greatest: Floats, limits: Floats) -> Floats:
    """(n,) of offsets. Some descriptions state limits that no motor has, or that are passed."""
    stated = np.isfinite(limits) & (limits >= greatest)
    usual = np.where(stated, limits, _USUAL_RANGE * greatest)
    return np.asarray(LEVEL * np.minimum(usual, _MOST_RANGE * greatest))


def level_of(recording: str, blocks: Sequence[HeldOutBlock], solver: Solver) -> Level:
    """By which offset and share of friction torques differ from those that other recordings predict.

    blocks: of recordings that were held out as a whole. solver: of the final model.
    """
    of_recording = [block for block in blocks if block.recording == recording]
    q, qd, measured, identified = valid_samples(of_recording, "q", "qd", "measured", "identified")
    friction = solver.friction_vector(qd, q=q) - solver.friction_vector(np.zeros_like(qd), q=q)
    values = []
    for f, v, e in zip(friction.T, np.abs(qd).T, (measured - identified).T, strict=True):
        moves = v > _MOVES * v.max()
        values.append(np.linalg.lstsq(np.column_stack([np.ones_like(f), f])[moves], e[moves])[0])
    offset, share = np.transpose(values)
    return Level(recording, offset, share)


def with_levels(band: TorqueBand, levels: Sequence[Level]) -> TorqueBand:
    """The band, of whose levels R recordings tell: what is usual counts as two of them.

    A recording differs from the mean of R - 1 others; a new one will differ from that of all, by a little less.
    """
    count = len(levels)

    def level(usual: Floats, found: Sequence[Floats]) -> Floats:
        squares = (1 - 1 / max(count, 1) ** 2) * np.square(found).sum(axis=0)
        return np.asarray(np.sqrt((USUAL_COUNTS * usual**2 + squares) / (USUAL_COUNTS + count)))

    return replace(
        band,
        level=level(band.level, [recording.offset for recording in levels]),
        share=level(band.share, [recording.share for recording in levels]),
    )


def uncertainty_text(found: Identification, model_text: str) -> str:
    """The text of that file, for the text of the model."""
    content = {
        "schema": SCHEMA,
        "model_sha256": sha256(model_text.encode()),
        "friction": plain(found.model.friction),
        **found.band.more.written(),
        "deviations": _rows(found.factor.T, _DIGITS),
        "held_out": _held_out(found),
        "band": {
            key: _rows([getattr(found.band, key)], _DIGITS)[0]
            for key in ("noise", "level", "share")
        },
        "fitted_to": list(found.sketch),
    }
    return json.dumps(content, allow_nan=False) + "\n"


def _held_out(found: Identification) -> dict[str, Any]:
    """Errors of the held-out blocks, low-passed as an estimator of external torques does it.

    A mean over its time constant has the noise of the low-pass, or up to twice that. The gain is the least
    one: errors of friction where joints turn round, not noise, are what contacts are told from.
    """
    period = float(np.median(np.concatenate([np.diff(b.time[b.counts]) for b in found.blocks])))
    each = max(1, round(1 / (LEAST_GAIN * period)))
    means = []
    for block in found.blocks:
        errors = block.errors["identified"]
        count = len(errors) // each
        means.append(errors[: count * each].reshape(count, each, errors.shape[1]).mean(axis=1))
    rows = np.concatenate(means)
    step = 1 + len(rows) // _MOST_ROWS
    return {"gain": LEAST_GAIN, "period": step * each * period, "torques": _rows(rows[::step], 4)}


def _rows(values: Iterable[Floats], digits: int) -> list[list[float]]:
    return [[float(f"{x:.{digits}g}") for x in row] for row in values]

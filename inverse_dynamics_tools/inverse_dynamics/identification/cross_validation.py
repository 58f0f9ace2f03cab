# SPDX-License-Identifier: Apache-2.0
"""Which friction law, prior strength and delay: by predicting each block from the others.

The simplest alternative within one standard error of the best is taken: laws in the order of LAWS,
then stronger priors.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.identification.blocks import together
from inverse_dynamics.identification.result import LAWS, Choice

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics._core import ArmFit, ArmFitter
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.identification.blocks import Block

STRENGTHS = (1000.0, 100.0, 10.0)
"""Prior strengths to choose from, the simplest first."""

_PASSES = 3  # over the samples, from a fit to nearly the same ones
_BAND = 0.95


@dataclass(frozen=True)
class Chosen:
    """A fit to blocks, with everything that was chosen on them."""

    law: str
    prior_strength: float
    delay: float
    fit: ArmFit
    band: Floats  # (n,) half the width of the 95 % band
    choices: tuple[Choice, ...]


@dataclass(frozen=True)
class _Alternative:
    law: str
    prior_strength: float
    errors: list[Floats]  # of each block left out, (M, n)

    def scores(self, noise: Floats) -> Floats:
        """Of each block: mean over the joints of the RMSE in units of the noise."""
        return np.array([(np.sqrt((e**2).mean(0)) / noise).mean() for e in self.errors])


def errors_of(fitter: ArmFitter, fit: ArmFit, block: Block) -> Floats:
    """Measured minus computed torques of the samples that count, (M, n)."""
    q, qd, qdd, tau = block.fitted
    return tau - fitter.torques(fit, q, qd, qdd)


def choose(fitter: ArmFitter, blocks: Sequence[Block]) -> Chosen:
    """The fit to all blocks, chosen by leaving out each in turn."""
    whole: dict[str, ArmFit] = {}
    alternatives: list[_Alternative] = []
    start = None
    for law in LAWS:
        start = whole[law] = fitter.fit(
            together(blocks), law=law, prior_strength=STRENGTHS[1], start=start
        )
        alternatives += _alternatives(fitter, blocks, law, start)
    noise = whole["step"].noise
    best, choices = _simplest(alternatives, noise)
    fit = fitter.fit(
        together(blocks),
        law=best.law,
        prior_strength=best.prior_strength,
        start=whole[best.law],
    )
    band = np.quantile(np.abs(np.concatenate(best.errors)), _BAND, axis=0)
    return Chosen(best.law, best.prior_strength, 0.0, fit, band, choices)


def _alternatives(
    fitter: ArmFitter, blocks: Sequence[Block], law: str, start: ArmFit
) -> list[_Alternative]:
    found = [_Alternative(law, strength, []) for strength in STRENGTHS]
    for k, block in enumerate(blocks):
        others = together([*blocks[:k], *blocks[k + 1 :]])
        fit = start
        for alternative in found:
            fit = fitter.fit(
                others,
                law=law,
                prior_strength=alternative.prior_strength,
                most_passes=_PASSES,
                start=fit,
            )
            alternative.errors.append(errors_of(fitter, fit, block))
    return found


def _simplest(
    alternatives: Sequence[_Alternative], noise: Floats
) -> tuple[_Alternative, tuple[Choice, ...]]:
    scores = np.array([a.scores(noise) for a in alternatives])  # (alternatives, blocks)
    best = scores[scores.mean(1).argmin()]
    worse = (scores - best).mean(1)
    deviation = (scores - best).std(1, ddof=1) / np.sqrt(scores.shape[1])
    chosen = int(np.flatnonzero(worse <= deviation)[0])
    choices = tuple(
        Choice(
            law=a.law,
            prior_strength=a.prior_strength,
            delay=0.0,
            error=float(scores[i].mean()),
            standard_error=float(deviation[i]),
            chosen=i == chosen,
        )
        for i, a in enumerate(alternatives)
    )
    return alternatives[chosen], choices

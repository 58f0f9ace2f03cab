# SPDX-License-Identifier: Apache-2.0
"""Which friction law, prior strength and delay: by predicting each block from the others.

The strength of the prior is chosen with the simplest law, then the law, then the strength with that law. The simplest
alternative within two standard errors of the best is taken: laws in the order of LAWS, then stronger priors. The
standard error is that of the difference, so a richer model needs evidence at the level of 95 %: one that predicts only
a little better by chance is a worse model of what the motion excites less, as a load at the tip.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import ArmFitOptions
from inverse_dynamics.evaluation.bands import NORMAL, rest_share
from inverse_dynamics.identification.blocks import data_of, moving
from inverse_dynamics.identification.result import LAWS, Choice

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics._core import ArmFit, ArmFitter
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.blocks import Block

STRENGTHS = (1000.0, 100.0, 10.0)
"""Usual prior strengths to choose from, the simplest first."""

# Where the weakest usual prior is chosen, weaker ones are tried, each a tenth, if they predict clearly better: parts of
# one recording are alike, and what fits them with a weak prior predicts other motions worse (KR300: 549 N m for 459).
_WEAKEST = 1e-4
_CLEARLY = 0.9  # of the error with the usual prior
_SETTLED = 0.99  # of the error with the prior before: weaker ones aren't tried

# Of the error of the best law without memory, below which the law with memory must be: one that gains less on parts of
# one recording gains nothing on others, and weighs loads worse (Panda: errors of 2.1 % of the mass instead of 1.0 %).
_CLEARLY_REMEMBERS = 0.925

_STANDARD_ERRORS = 2.0  # by which a simpler alternative may be worse than the best
_PASSES = 2  # over the samples, from a fit to nearly the same ones
_BAND = 0.95
_LITTLE = 0.05  # of the uncertainty at rest, where a joint counts as moving
_FOLDS = 8  # parts of blocks that are left out in turn, about
_MOST_SAMPLES = 15_000  # that choices are made with; neighbours' errors are alike
_DELAY_STEP = 0.008  # s, at least
_MOST_DELAY_STEPS = 8
_VERTICES = 2
_LEAST_DELAY = 1e-4  # s; a shorter one counts as none
_DELAY_LAW = "load"  # the law that delays are looked for with
_MEMORY = "memory"  # the law whose friction lags behind


@dataclass(frozen=True)
class Chosen:
    """A fit to blocks, with everything that was chosen on them."""

    law: str
    prior_strength: float
    delay: float  # s; what the blocks alone find
    blocks: Sequence[Block]  # what the fit is to: samples in motion, its delay made up for
    fit: ArmFit
    band: Floats  # (n,) half the width of the 95 % band
    noise: Floats  # (n,) standard deviation of held-out torques of a joint while it moves
    choices: tuple[Choice, ...]
    delays: Mapping[str, float]  # of each law [s], made up for

    @property
    def options(self) -> ArmFitOptions:
        """Those of the fit."""
        return ArmFitOptions(self.law, prior_strength=self.prior_strength)


def errors_of(fitter: ArmFitter, fit: ArmFit, block: Block) -> Floats:
    """Measured minus computed torques of the valid samples, (M, n)."""
    q, qd, qdd, tau = block.fitted
    return tau - fitter.torques(fit, q, qd, qdd, before=block.before)


def choose(
    fitter: ArmFitter, blocks: Sequence[Block], delays: Mapping[str, float] | None = None
) -> Chosen:
    """The fit to all blocks, chosen by leaving out each part in turn.

    Choices use equidistant samples of long recordings; the fit uses all. delays: of each law [s], found on more blocks:
    they are made up for, and what these blocks alone find near is stated.
    """
    blocks = moving(blocks)
    step = 1 + sum(map(len, blocks)) // _MOST_SAMPLES
    recorded = _Parts(fitter, blocks, 0.0, step)
    of_laws = delays or _delays(fitter, blocks, recorded, step)
    parts = _parts_of(fitter, blocks, recorded, step, of_laws)
    simplest, *others = LAWS
    fit = parts[simplest].fit(simplest, STRENGTHS[1], None)
    fits, noise = {simplest: fit}, fit.noise
    usual = _strengths(parts[simplest], simplest, fit, noise)
    laws = [usual[_simplest(usual, noise)[0]]]
    strength = laws[0].prior_strength
    for law in others:
        fit = fits[law] = parts[law].fit(law, strength, fit)
        laws.append(parts[law].left_out(law, strength, fit))
    one = laws[_simplest(laws, noise)[0]]
    at = laws.index(one)
    if at > 0:
        usual = _strengths(parts[one.law], one.law, fits[one.law], noise, one)
    alternatives = [*laws[:at], *usual, *laws[at + 1 :]]
    chosen, choices = _simplest(alternatives, noise)
    best = alternatives[chosen]
    delay = best.delay
    if delays and delay != 0:
        delay, _ = _delay(fitter, blocks, step, best.law, fits[best.law], delay)
    blocks = [block.later(best.delay) for block in blocks]
    data = parts[best.law].data if step == 1 else data_of(fitter, blocks)
    options = ArmFitOptions(best.law, prior_strength=best.prior_strength)
    fit = fitter.fit(data, options, fits[best.law])
    errors = np.abs(np.concatenate(best.errors))
    qd = np.concatenate([part.fitted[1] for part in recorded.blocks])
    return Chosen(
        law=best.law,
        prior_strength=best.prior_strength,
        delay=delay,
        blocks=blocks,
        fit=fit,
        band=np.quantile(errors, _BAND, axis=0),
        noise=noise_in_motion(errors, qd, fit.friction[: qd.shape[1]]),
        choices=choices,
        delays=of_laws,
    )


def noise_in_motion(errors: Floats, qd: Floats, friction: Sequence[Mapping[str, float]]) -> Floats:
    """(n,) standard deviation, from the quantile of absolute errors (M, n) of samples at which the joint moves.

    Of all samples where none counts as moving: the joint stands still, or the step of its friction is as wide as
    its velocities.
    """
    moves = rest_share(qd, friction, np.abs(qd).max(axis=0)) < _LITTLE
    counted = np.where(moves | ~moves.any(axis=0), errors, np.nan)
    return np.asarray(np.nanquantile(counted, _BAND, axis=0) / NORMAL)


@dataclass(frozen=True)
class _Alternative:
    law: str
    prior_strength: float
    delay: float
    errors: list[Floats]  # of each part, by a fit to the others, (M, n)

    def scores(self, noise: Floats) -> Floats:
        """Of each part: mean over the joints of the RMSE in units of the noise."""
        return np.array([(np.sqrt((e**2).mean(0)) / noise).mean() for e in self.errors])


class _Parts:
    """Parts of blocks, to be left out in turn: more and shorter ones than the blocks, for a steadier choice.

    delay: made up for. step: from one sample to the next. tested: what errors are of.
    """

    def __init__(self, fitter: ArmFitter, blocks: Sequence[Block], delay: float, step: int) -> None:
        each = max(1, round(_FOLDS / len(blocks)))
        self.delay = delay
        self.blocks = [part for block in blocks for part in block.later(delay, step).parts(each)]
        self.tested = self.blocks
        self.data = data_of(fitter, self.blocks)
        self._fitter = fitter

    def fit(self, law: str, strength: float, start: ArmFit | None) -> ArmFit:
        """The fit to all parts."""
        return self._fitter.fit(self.data, ArmFitOptions(law, prior_strength=strength), start)

    def left_out(self, law: str, strength: float, fit: ArmFit) -> _Alternative:
        """The errors of each part, of fits to the others that begin with a fit to all."""
        options = ArmFitOptions(law, prior_strength=strength)
        pairs = zip(self._fitter.left_out(fit, self.data, options), self.tested, strict=True)
        errors = [errors_of(self._fitter, others, part) for others, part in pairs]
        return _Alternative(law, strength, self.delay, errors)


def _parts_of(
    fitter: ArmFitter,
    blocks: Sequence[Block],
    recorded: _Parts,
    step: int,
    delays: Mapping[str, float],
) -> dict[str, _Parts]:
    """Parts for each law, with its delay made up for."""
    of = {0.0: recorded}
    for delay in {*delays.values()} - {0.0}:
        later = of[delay] = _Parts(fitter, blocks, delay, step)
        later.tested = recorded.blocks  # as solvers compute torques: the delay isn't made up for
    return {law: of[delay] for law, delay in delays.items()}


def _delays(
    fitter: ArmFitter, blocks: Sequence[Block], recorded: _Parts, step: int
) -> dict[str, float]:
    """The delay that is made up for with each law [s].

    Friction that lags behind a reversal looks like a delay to a law without memory; a law with memory may take some of
    its own lag back. So the lesser one of both delays is that of the law with memory.
    """
    delay, start = _delay(fitter, blocks, step, _DELAY_LAW, None)
    plain = _helpful(fitter, blocks, recorded, step, _DELAY_LAW, delay, start)
    delays = dict.fromkeys(LAWS, plain)
    if plain != 0:
        delay, start = _delay(fitter, blocks, step, _MEMORY, start)
        lesser = min(delay, plain, key=abs) if delay * plain > 0 else 0.0
        delays[_MEMORY] = _helpful(fitter, blocks, recorded, step, _MEMORY, lesser, start)
    return delays


def _helpful(
    fitter: ArmFitter,
    blocks: Sequence[Block],
    recorded: _Parts,
    step: int,
    law: str,
    delay: float,
    start: ArmFit,
) -> float:
    """The delay, if the law predicts parts that are left out better where it is made up for; else zero."""
    if delay == 0:
        return delay
    before, after = (
        parts.left_out(law, STRENGTHS[1], start).scores(start.noise).mean()
        for parts in (recorded, _Parts(fitter, blocks, delay, step))
    )
    return delay if after < before else 0.0


def _delay(
    fitter: ArmFitter,
    blocks: Sequence[Block],
    thinned: int,
    law: str,
    start: ArmFit | None,
    about: float | None = None,
) -> tuple[float, ArmFit]:
    """By how much the torques are later than the states [s], and a fit with nearly that delay; zero: there is none.

    The vertex of the parabola through the noise at three delays, gone to twice, or once from a delay `about` that is
    nearly right. Far from the least noise, where there is none, the way leads downhill.
    """
    periods = np.concatenate([np.diff(block.instants[block.used]) for block in blocks])
    step = max(float(np.median(periods[periods > 0])), _DELAY_STEP)
    settled = ArmFitOptions(law, prior_strength=STRENGTHS[1])
    near = ArmFitOptions(law, prior_strength=STRENGTHS[1], most_passes=_PASSES)
    center, vertices = 0.0, 0
    if about is not None:
        center, vertices, step = about, _VERTICES - 1, 0.5 * step

    def at(delay: float, options: ArmFitOptions, start: ArmFit | None) -> ArmFit:
        samples = [block.later(delay, thinned) for block in blocks]
        return fitter.fit(data_of(fitter, samples), options, start)

    for _ in range(_MOST_DELAY_STEPS):
        start = at(center, near if vertices else settled, start)
        fits = [at(center - step, near, start), start, at(center + step, near, start)]
        # samples at the ends of blocks are fewer where the delay is greater
        costs = [2 * float(np.log(fit.noise).sum()) for fit in fits]
        slope, curvature = costs[0] - costs[2], costs[0] - 2 * costs[1] + costs[2]
        if curvature <= 0:
            center += 2 * step * float(np.sign(slope))
            continue
        center += step * float(np.clip(0.5 * slope / curvature, -3, 3))
        step *= 0.5
        vertices += 1
        if vertices == _VERTICES:
            break
    assert start is not None
    found = vertices == _VERTICES and abs(center) >= _LEAST_DELAY
    return (center if found else 0.0), start


def _strengths(
    parts: _Parts, law: str, start: ArmFit, noise: Floats, *known: _Alternative
) -> list[_Alternative]:
    """Usual prior strengths, and ever weaker ones as far as they predict clearly better. known: some of them."""
    of = {one.prior_strength: one for one in known}
    found = [of.get(strength) or parts.left_out(law, strength, start) for strength in STRENGTHS]
    usual = len(found)
    errors = [alternative.scores(noise).mean() for alternative in found]
    if errors[-1] > min(errors):
        return found
    while found[-1].prior_strength > _WEAKEST:
        found.append(parts.left_out(law, found[-1].prior_strength / 10, start))
        errors.append(found[-1].scores(noise).mean())
        if errors[-1] > _SETTLED * errors[-2]:
            break
    return found if min(errors) < _CLEARLY * errors[usual - 1] else found[:usual]


def _simplest(
    alternatives: Sequence[_Alternative], noise: Floats
) -> tuple[int, tuple[Choice, ...]]:
    """The number of the chosen one, and all of them compared."""
    scores = np.array([a.scores(noise) for a in alternatives])  # (alternatives, blocks)
    remembers = np.array([a.law == _MEMORY for a in alternatives])
    means = scores.mean(1)
    least = means[~remembers].min(initial=np.inf)
    allowed = ~remembers | (means < _CLEARLY_REMEMBERS * least)
    best = scores[np.where(allowed, means, np.inf).argmin()]
    worse = (scores - best).mean(1)
    deviation = (scores - best).std(1, ddof=1) / np.sqrt(scores.shape[1])
    chosen = int(np.flatnonzero(allowed & (worse <= _STANDARD_ERRORS * deviation))[0])
    choices = tuple(
        Choice(
            law=a.law,
            prior_strength=a.prior_strength,
            delay=a.delay,
            error=float(scores[i].mean()),
            standard_error=float(deviation[i]),
            chosen=i == chosen,
        )
        for i, a in enumerate(alternatives)
    )
    return chosen, choices

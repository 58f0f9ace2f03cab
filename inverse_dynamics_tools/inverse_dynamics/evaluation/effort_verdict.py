# SPDX-License-Identifier: Apache-2.0
"""Which meaning of the recorded efforts fits the data, and how sure that is.

Each meaning predicts the recorded efforts from computed torques `tau`, gravity `g`, drive gains `k`:

    torque                    tau
    current                   tau / k
    torque_without_gravity    tau - g

Predictions are compared with what was recorded, in its own unit, so no meaning gains by being small.
Samples follow each other too closely to count one by one: the recording is cut into 20 stretches. In
each, the error of a meaning is the geometric mean over the joints of its root mean square errors: a
ratio of two such errors doesn't depend on units, and joints that can't tell leave it as it is.

The best meaning is sure if, against every rival, it is better in 17 stretches of 20 (by chance: 1 in
750), its error is smaller by a tenth, and it fits: on the joints that tell, the error is less than
prediction and recording differ by if they have nothing to do with each other.

Currents are only looked at where drive gains are known. Gains fitted to the data would give that
meaning a free number per joint, and it would always win.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.base.arrays import Floats, Mask

STRETCHES = 20
LEAST_WON = 17  # of them; by a coin 1 in 750
LEAST_MARGIN = 1.1
_LEAST_SAMPLES = 5 * STRETCHES
_NOTHING = 1e-3  # of a joint's efforts: smaller errors are as good as that
_MOST_MISFIT = 0.5  # 0: prediction is recording; 1: they have nothing in common
_NO_GRAVITY = 0.01  # of the computed torques


@dataclass(frozen=True)
class Candidate:
    """A meaning, and how far it is from the recorded efforts."""

    meaning: str
    error: float  # RMSE as a share of the recorded range, mean over the joints
    margin: float  # its error over that of the best meaning: 1 for the best
    worse_in: int  # stretches in which the best meaning has a smaller error


@dataclass(frozen=True)
class Verdict:
    """Candidates, the best first, and whether it is sure."""

    candidates: tuple[Candidate, ...]
    sure: bool
    stretches: int
    reason: str = ""  # why it isn't sure, in words

    @property
    def best(self) -> str:
        """The meaning with the smallest error."""
        return self.candidates[0].meaning

    @property
    def rivals(self) -> tuple[str, ...]:
        """Meanings that aren't clearly worse than the best."""
        return tuple(c.meaning for c in self.candidates[1:] if not self._clearly_worse(c))

    @property
    def summary(self) -> str:
        """In words: errors, and in how many stretches the best is better."""
        first, *others = self.candidates
        text = f"{first.meaning} is {_percent(first.error)} of the range off"
        for other in others:
            text += (
                f", {other.meaning} {_percent(other.error)} (worse in {other.worse_in} of "
                f"{self.stretches} stretches, {other.margin:.3g} times)"
            )
        if not any(c.meaning == "current" for c in self.candidates):
            text += "; current wasn't looked at, no drive gains are known"
        return text

    def _clearly_worse(self, candidate: Candidate) -> bool:
        share = candidate.worse_in / self.stretches
        return share >= LEAST_WON / STRETCHES and candidate.margin >= LEAST_MARGIN


def compare_meanings(
    computed: Floats,
    gravity: Floats,
    effort: Floats,
    gains: Sequence[float] | None = None,
    kept: Mask | None = None,
) -> Verdict:
    """Compare what each meaning predicts with the recorded efforts.

    computed, gravity: (N, n) N m. effort: (N, n) as recorded. gains: (n,) N m/A, if they are known.
    kept: (N,) samples that count.
    """
    finite = np.isfinite(computed).all(axis=1) & np.isfinite(effort).all(axis=1)
    rows = finite if kept is None else finite & kept
    if not rows.all():
        computed, gravity, effort = computed[rows], gravity[rows], effort[rows]
    predictions = {"torque": computed, "torque_without_gravity": computed - gravity}
    if gains is not None:
        predictions["current"] = computed / np.asarray(gains)
    stretches = min(STRETCHES, max(1, len(effort)))
    errors = _errors(predictions, effort, stretches)
    candidates = _ranked(errors, effort)
    verdict = Verdict(candidates, sure=False, stretches=stretches)
    reason = _doubt(verdict, predictions, errors, effort, gravity)
    return Verdict(candidates, sure=not reason, stretches=stretches, reason=reason)


def _errors(predictions: dict[str, Floats], effort: Floats, stretches: int) -> dict[str, Floats]:
    """Root mean square errors of each meaning, (stretches, n)."""
    if len(effort) == 0:
        return {meaning: np.ones((stretches, effort.shape[1])) for meaning in predictions}
    starts = np.linspace(0, len(effort), stretches, endpoint=False).astype(int)
    counts = np.diff([*starts, len(effort)])[:, None]
    scale = np.max([_rms(values) for values in (effort, *predictions.values())], axis=0)
    least = np.maximum(_NOTHING * scale, np.finfo(float).tiny)
    return {
        meaning: np.maximum(
            np.sqrt(np.add.reduceat((effort - values) ** 2, starts) / counts), least
        )
        for meaning, values in predictions.items()
    }


def _ranked(errors: dict[str, Floats], effort: Floats) -> tuple[Candidate, ...]:
    scores = {meaning: np.log(error).mean(axis=1) for meaning, error in errors.items()}
    ranked = sorted(scores, key=lambda meaning: float(scores[meaning].mean()))
    best = scores[ranked[0]]
    span = np.ptp(effort, axis=0) if len(effort) else np.zeros(effort.shape[1])
    moved = span > 0
    return tuple(
        Candidate(
            meaning,
            error=float((_rms(errors[meaning])[moved] / span[moved]).mean())
            if moved.any()
            else 0.0,
            margin=float(np.exp((scores[meaning] - best).mean())),
            worse_in=int((scores[meaning] > best).sum()),
        )
        for meaning in ranked
    )


def _doubt(
    verdict: Verdict,
    predictions: dict[str, Floats],
    errors: dict[str, Floats],
    effort: Floats,
    gravity: Floats,
) -> str:
    """Why the best meaning isn't sure; empty if it is."""
    if len(effort) < _LEAST_SAMPLES:
        return f"{len(effort)} samples that count are too few, {_LEAST_SAMPLES} are needed"
    if verdict.rivals:
        told = f"{verdict.best} and {', '.join(verdict.rivals)} can't be told apart"
        loaded = _rms(gravity).max() >= _NO_GRAVITY * _rms(predictions["torque"]).max()
        if {verdict.best, *verdict.rivals} >= {"torque", "torque_without_gravity"} and not loaded:
            told += ", as gravity hardly loads the joints in this motion"
        return told
    best = verdict.best
    telling = np.any(
        [_rms(errors[m]) > LEAST_MARGIN * _rms(errors[best]) for m in errors if m != best], axis=0
    )
    size = _rms(effort) ** 2 + _rms(predictions[best]) ** 2
    misfit = _rms(effort - predictions[best]) ** 2 / np.maximum(size, np.finfo(float).tiny)
    if np.median(misfit[telling]) > _MOST_MISFIT:
        return f"no meaning fits{_gains_that_would_fit(predictions, effort)}"
    return ""


def _gains_that_would_fit(predictions: dict[str, Floats], effort: Floats) -> str:
    """A hint where efforts are proportional to torques, but not equal."""
    for meaning in ("torque", "torque_without_gravity"):
        torque = predictions[meaning]
        product = (torque * effort).sum(axis=0)
        likeness = product / np.maximum(len(effort) * _rms(torque) * _rms(effort), 1e-300)
        alike = likeness > 0.9
        if 2 * alike.sum() < len(alike):
            continue
        gains = (torque**2).sum(axis=0)[alike] / product[alike]
        if not 0.5 < np.median(gains) < 2:
            figures = ", ".join(f"{gain:.3g}" for gain in gains)
            return (
                f", but efforts are proportional to {meaning}, by {figures}: if they are currents, "
                "state drive_gains in the run configuration, from the robot's data sheet"
            )
    return "; gravity, payload, joint order and units are worth a look"


def _rms(values: Floats) -> Floats:
    """(n,) of (N, n)."""
    return np.asarray(np.sqrt((values**2).mean(axis=0)))


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 1 else f"{100 * share:.0f} %"

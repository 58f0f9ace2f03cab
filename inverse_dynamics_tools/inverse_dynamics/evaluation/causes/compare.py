# SPDX-License-Identifier: Apache-2.0
"""Why computed torques don't match the measured ones: mistakes as rivals, judged on data that were held out.

    found = compare(samples, arm)
    for cause in found.causes:
        print(cause.text)

1. Positions, velocities and time are compared with each other. What contradicts is put right.
2. All rivals are fitted to every second piece of the recording and judged on the others (fit.py).
3. A cause is named if its remedy, with the numbers that it states, leaves a small error, and if in 95 % of the
   recordings that resampled pieces make it is better than each rival by a margin. Rivals that can't be told apart
   are named together. Special cases take precedence over what includes them.
4. Else pairs of mistakes are tried in the same way. Both are named, or none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.base.wording import listed
from inverse_dynamics.evaluation.causes import (
    columns,
    efforts,
    frictions,
    gravity,
    loads,
    masses,
    motions,
    pairs,
    residuals,
)
from inverse_dynamics.evaluation.causes.arm import ArmModel, View
from inverse_dynamics.evaluation.causes.fit import Fitting
from inverse_dynamics.evaluation.causes.rival import PAGE, Rival
from inverse_dynamics.evaluation.effort import Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.causes.rival import Told
    from inverse_dynamics.evaluation.causes.samples import Samples
    from inverse_dynamics.evaluation.effort import Effort

_MISMATCH = 0.02  # error of the joints, as a share of their ranges, up to which a model fits
_RUBS = 0.08  # the same, from which a model is told that it lacks friction
_FITS = 0.1  # the same, that a remedy may leave
_FAR, _MOST_LEFT = (
    6.0,
    0.2,
)  # or this part of the error, where models are far from their arms; up to this share
_PAIR_FITS = 0.06  # the same, of two remedies
_EXPLAINED = 0.02  # the same, of which no second mistake is looked for
_GAIN = 2.0  # least ratio of the errors before and after
_MARGIN, _FLAT = 1.15, 0.004  # a rival is worse by this ratio, and by this share of the range
_ROUGH_MARGIN = 1.6  # masses that are inexact: centers of mass and inertias are so, too
_SURE = 0.95  # of the resampled recordings
_RESAMPLED = 400
_MOST_NAMED = 3
_AT_REST = ("gravity", "no_gravity", "payload", "tool", "mass")
_OF_EFFORTS = (
    "currents",
    "effort_scale",
    "effort_sign",
    "effort_direction",
    "no_gravity",
    "gravity",
)
_SCALES = ("currents", "effort_scale")
_LIKE_COUPLING = (*_SCALES, "mass")  # of one joint, where the other's torque is like its own

KINDS = (efforts, gravity, loads, masses, columns, motions, frictions, residuals)


@dataclass(frozen=True)
class Cause:
    """A mistake, and what to do about it. Errors: mean over the joints, as shares of measured ranges.

    kind: currents, effort_scale, effort_sign, effort_direction, effort_order, no_gravity, gravity, payload, tool,
    mass, friction, guided, order, direction, degrees, velocity, clock, motor_side, saturation, coupling,
    drift. mistake: the nearest heading of PAGE; "": none is near. value: what was found, of kind's unit.
    error_after: None where the remedy's numbers aren't known. rival: one of several of which one is right.
    """

    kind: str
    joints: tuple[str, ...]
    value: Any
    error_before: float
    error_after: float | None
    reason: str
    remedy: str
    mistake: str = ""
    rival: bool = False

    @property
    def text(self) -> str:
        """Reason, remedy and the place in the documentation."""
        return f"{self.reason}; {self.remedy}" + (f" ({self.reference})" if self.mistake else "")

    @property
    def reference(self) -> str:
        """The page and the place on it."""
        kept = "".join(c for c in self.mistake.lower() if c.isalnum() or c in " -")
        return f"{PAGE}#{kept.replace(' ', '-')}"


def residual_causes(samples: Samples, computed: Floats) -> tuple[Cause, ...]:
    """What no model of an arm can have: saturation, coupled joints, drift. computed: (K M, n) N m."""
    view = View(samples, ArmModel(lambda *_: computed, np.zeros_like))
    contest = _Contest(view)
    contest.add(frictions.nothing(view))
    for rival in (*residuals.rivals(view, contest.fit), *residuals.couplings(view)):
        contest.add(rival)
    before = float(contest.fit.mean(contest.squares[0]))
    if before > _MISMATCH and (named := contest.best(before)):
        return _causes(named, contest.as_is)
    told = residuals.of_joints(view, contest.fit, contest.squares[0])
    return () if told is None else (_cause(told, before, None),)


@dataclass(frozen=True)
class Comparison:
    """Causes: all of them, but one of those that are rivals."""

    causes: tuple[Cause, ...] = ()
    excluded: tuple[str, ...] = ()  # kinds, where nothing explains an error

    @property
    def text(self) -> str:
        """What a reader should know of it; "": nothing."""
        told = [cause.text for cause in self.causes if not cause.rival]
        if rivals := "; or ".join(cause.text for cause in self.causes if cause.rival):
            told.append(f"{rivals}. This recording doesn't tell them apart: {self._experiment}")
        if self.excluded:
            left = " that is left" if told else ""
            told.append(
                f"no single cause explains the error{left}; these were excluded: {listed(self.excluded)}"
            )
        return "; and ".join(told)

    def doubting(self, effort: Effort) -> Effort:
        """What efforts mean; not sure where a cause, or nothing that was compared, contradicts it."""
        contradicts = {c.kind for c in self.causes} & set(_OF_EFFORTS) or set(self.excluded)
        if effort.verdict is None or not effort.verdict.sure or not contradicts:
            return effort
        reason = (
            self.text
            if self.excluded
            else f"{listed(sorted(contradicts))} may explain them as well"
        )
        return replace(effort, verdict=replace(effort.verdict, sure=False, reason=reason))

    @property
    def _experiment(self) -> str:
        """The motion that tells rivals apart."""
        kinds = {cause.kind for cause in self.causes if cause.rival}
        if kinds & set(_AT_REST) and kinds - set(_AT_REST):
            return (
                "record the same motion twice as fast: torques of loads and gravity stay the same"
            )
        if kinds <= set(_AT_REST):
            return "record a motion in which all joints of the wrist turn round"
        return "record a motion in which the joints move one after the other"


def meaning_of_efforts(
    samples: Samples | None, arm: ArmModel, drive_gains: Sequence[float]
) -> Verdict:
    """Which meaning explains recorded efforts. samples.measured: as recorded. drive_gains: (n,) N m/A, or none.

    Currents need known gains: gains that are fitted would be a free number for each joint, and always win.
    """
    if samples is None or not samples.comparable:
        return Verdict("torque", sure=False, reason="there are too few valid samples of a motion")
    view = View(samples, arm)
    predicted = {"torque": view.computed, "torque_without_gravity": view.computed - view.gravity}
    if len(drive_gains):
        predicted["current"] = view.computed / drive_gains
    contest = _Contest(view)
    for meaning, base in predicted.items():
        contest.add(Rival(meaning, base, view.qd))
    best, *others = sorted(range(len(contest.rivals)), key=contest.score)
    names = [contest.rivals[i].kind for i in (best, *others)]
    errors = [f"{100 * contest.score(i):.2g} %" for i in (best, *others)]
    summary = ", ".join(f"{n} is {e} of the range off" for n, e in zip(names, errors, strict=True))
    if "current" not in names:
        summary += "; current wasn't considered, as no drive gains are known"
    alike = [contest.rivals[i].kind for i in others if contest.alike(i, best, _MARGIN)]
    reason = f"{names[0]} and {listed(alike)} can't be told apart" if alike else ""
    if not reason and names[0] != "torque":
        causes = compare(samples, arm) if names[0] == "torque_without_gravity" else Comparison()
        alone = all(cause.kind == "no_gravity" for cause in causes.causes) and not causes.excluded
        if contest.score(best) > _FITS or not alone:
            reason = causes.text or "no meaning fits"
    return Verdict(names[0], not reason, summary, reason)


def compare(samples: Samples | None, arm: ArmModel) -> Comparison:
    """The causes of a mismatch; none where torques match, or samples tell nothing."""
    if samples is None or not samples.comparable:
        return Comparison()
    found = motions.contradiction(samples, arm)
    if found is None:
        return _Contest(View(samples, arm)).decide()
    told, right = found
    contest = _Contest(View(right, arm))
    rest = contest.decide()
    known = [cause.error_after for cause in rest.causes if cause.error_after is not None]
    after = min(known, default=contest.score(0))  # of friction alone
    first = _cause(told, _Contest(View(samples, arm)).as_is, after)
    others = [c for c in rest.causes if c.kind != "friction"]
    return replace(
        rest, causes=(first, *(replace(c, rival=len(others) > 1 and c.rival) for c in others))
    )


class _Contest:
    """Rivals of one recording."""

    def __init__(self, view: View) -> None:
        self.view = view
        self.fit = Fitting(view.samples, view.friction)
        pieces = view.samples.q.shape[0]
        random = np.random.default_rng(0)
        self.weights = random.multinomial(pieces, np.full(pieces, 1 / pieces), _RESAMPLED) / pieces
        self.rivals: list[Rival] = []
        self.squares: list[Floats] = []

    def decide(self) -> Comparison:
        """The outcome."""
        view, fit = self.view, self.fit
        nothing = frictions.nothing(view)
        self.add(nothing)
        before = self.score(0)
        if before > _MISMATCH:
            self.add(masses.rough(view))
            for kind in KINDS:
                for rival in kind.rivals(view, fit):
                    self.add(rival)
            named = self.best(before)
            if not named or named[0][0].kind in _LIKE_COUPLING:
                for rival in residuals.couplings(view):
                    self.add(rival)
                named = self.best(before)
            if both := self._pair(named, before):
                return Comparison(both)
            if named:
                return Comparison(_causes(named, self.as_is))
        return self._unnamed(before)

    def _pair(self, named: list[tuple[Told, float]], before: float) -> tuple[Cause, ...]:
        """Two mistakes, if they leave half of what the best single one leaves, and no other pair does."""
        least = min(after for _, after in named) if named else before
        each = bool(named) and named[0][0].own is not None
        if not each and least < (_EXPLAINED if named else _FITS):
            return ()
        contest = _Contest(self.view)
        for rival in pairs.rivals(self.view, self.fit):
            contest.add(rival)
        # scales of all joints have more numbers than a pair: it needn't be better than they
        found = contest.best(_GAIN * (_MARGIN * least + _FLAT) if each else min(before, least))
        if len(found) != 1 or found[0][1] > _PAIR_FITS:
            return ()
        first, after = found[0]
        return tuple(_cause(told, self.as_is, after) for told in (first, first.also) if told)

    def _unnamed(self, before: float) -> Comparison:
        """What is said where no rival wins."""
        told: tuple[Told, ...] = ()
        if own := residuals.of_joints(self.view, self.fit, self.squares[0]):
            told = (own,)
        elif before > _FITS:
            told = motions.beyond_reach(self.view) or efforts.too_small(self.view)
        if told:
            causes = _causes([(one, None) for one in told], self.as_is)
            return Comparison(causes)
        lacks = self.fit.friction is None and self.as_is >= max(_GAIN * before, _RUBS)
        if before <= _FITS:
            causes = (_cause(frictions.FRICTION, self.as_is, before),) if lacks else ()
            return Comparison(causes)
        excluded = tuple(sorted({r.kind for r in self.rivals} - {"rough"}))
        return Comparison(excluded=excluded)

    @property
    def as_is(self) -> float:
        """Error of the model, nothing fitted."""
        measured = self.view.samples.flat(self.view.samples.measured)
        squares = (((measured - self.view.computed) / self.fit.size) ** 2).reshape(self.fit.shape)
        return float(self.fit.mean(squares.mean(axis=1)))

    def score(self, i: int) -> float:
        """Error that a rival leaves on pieces that were held out."""
        return float(self.fit.mean(self.squares[i]))

    def add(self, rival: Rival, squares: Floats | None = None) -> None:
        """One more, unless it can't be."""
        squares = self.fit.errors(rival) if squares is None else squares
        if np.isfinite(squares).all():
            self.rivals.append(rival)
            self.squares.append(squares)

    def best(self, before: float) -> list[tuple[Told, float]]:
        """What is named: one, or those that can't be told apart; with the errors that remedies leave.

        before: the error without any.
        """
        still = Rival("", 0.0 * self.view.computed, self.view.qd)
        least = {True: min(before, float(self.fit.mean(self.fit.errors(still)))), False: before}
        scores = [self.score(i) for i in range(len(self.rivals))]
        tied: list[int] = []
        result = []
        for i in map(int, np.argsort(scores, kind="stable")):
            rival = self.rivals[i]
            if tied and not self.alike(i, tied[0], _MARGIN):
                break
            told = rival.tell(*self.fit.numbers(rival))
            if told is None:
                continue
            of = least[told.kind in _SCALES]  # a scale of zero is no explanation
            after = float(self.fit.mean(self.fit.errors(self.fit.applied(rival, told))))
            if _small(after, of, told):
                tied.append(i)
                result.append((told, after))
        rough = [i for i, rival in enumerate(self.rivals) if rival.kind == "rough"]
        static = bool(tied) and self.rivals[tied[0]].kind in _AT_REST
        margin = _ROUGH_MARGIN if static else _MARGIN
        if any(self.alike(i, tied[0], margin) for i in rough if tied):
            return []
        return self._special(tied, result)

    def alike(self, i: int, best: int, margin: float) -> bool:
        """Whether a rival can't be told from the best one."""
        error, least = (self.fit.mean(self.squares[k], self.weights) for k in (i, best))
        worse = error > margin * least + _FLAT
        return bool(worse.mean() < _SURE)

    def _special(
        self, tied: list[int], result: list[tuple[Told, float]]
    ) -> list[tuple[Told, float]]:
        """Without those that include another one; nothing if too many are left."""
        kinds = {self.rivals[i].kind for i in tied}
        kept: list[tuple[Told, float]] = []
        for i, found in zip(tied, result, strict=True):
            same = any(k[0].kind == found[0].kind and k[0].joints == found[0].joints for k in kept)
            if not same and not kinds & set(self.rivals[i].includes):
                kept.append(found)
        return kept if len(kept) <= _MOST_NAMED else []


def _small(after: float, before: float, told: Told) -> bool:
    """Whether a remedy leaves little enough of an error; of weights, wrong masses leave more."""
    most = max(_FITS, min(before / _FAR, _MOST_LEFT)) if told.kind in _AT_REST else _FITS
    return told.gain * after <= before and after <= most


def _causes(named: Sequence[tuple[Told, float | None]], before: float) -> tuple[Cause, ...]:
    """One, or rivals."""
    causes = (_cause(told, before, after) for told, after in named)
    return tuple(replace(cause, rival=len(named) > 1) for cause in causes)


def _cause(told: Told, before: float, after: float | None) -> Cause:
    return Cause(
        told.kind,
        told.joints,
        told.value,
        before,
        after,
        told.reason,
        told.remedy,
        told.mistake,
    )

# SPDX-License-Identifier: Apache-2.0
"""Why computed torques don't match the measured ones: mistakes as rivals, judged on data that were held out.

    found = compare(samples, arm)
    for cause in found.causes:
        print(cause.text)

1. Positions, velocities and time are compared with each other. Contradictions are corrected.
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

from inverse_dynamics._core import Verdict
from inverse_dynamics.diagnosis import bodies, efforts, motions, pairs, residuals, sensors
from inverse_dynamics.diagnosis.arm import ArmModel
from inverse_dynamics.diagnosis.fit import Fitting
from inverse_dynamics.diagnosis.pieces import View
from inverse_dynamics.diagnosis.rival import PAGE, Rival, printed
from inverse_dynamics.wording import listed, told

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics._core import Effort
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.diagnosis.pieces import Pieces
    from inverse_dynamics.diagnosis.rival import Mistake

# Errors: mean over the joints, as shares of their measured ranges.
_MISMATCH = 0.02  # up to which a model fits
_FITS = 0.1  # that a remedy may leave
_FAR, _MOST_LEFT = 6.0, 0.2  # or this part of a greater error, up to this one
_PAIR_FITS = 0.06  # that two remedies may leave, or one of a sensor
_EXPLAINED = 0.02  # up to which no second mistake is looked for
_GAIN = 2.0  # least ratio of the errors before and after
_MARGIN, _FLAT = 1.15, 0.004  # a rival is worse by this ratio, and by this error
_ROUGH_MARGIN = 1.6  # masses that are inexact: centers of mass and inertias are so, too
_SURE = 0.95  # of the resampled recordings
_RESAMPLED = 400
_MOST_NAMED = 3
_AT_REST = {"gravity", "no_gravity", "payload", "tool", "mass"}
_SCALES = {"currents", "effort_scale"}
_OF_EFFORTS = {*_SCALES, "effort_sign", "effort_direction", "no_gravity", "gravity"}
_LIKE_COUPLING = {*_SCALES, "mass"}  # of one joint, where the other's torque is like its own

KINDS = (efforts.rivals, bodies.rivals, efforts.columns, motions.rivals, residuals.rivals)


@dataclass(frozen=True)
class Cause:
    """A mistake, and what to do about it. Errors: mean over the joints, as shares of measured ranges.

    kind: currents, effort_scale, effort_sign, effort_direction, effort_order, effort_zero, effort_delay, no_gravity,
    gravity, payload, tool, mass, friction, guided, order, direction, zero, degrees, velocity, clock, motor_side,
    saturation, coupling, drift, unrelated. mistake: the nearest heading of PAGE; "": none is near. value: what was
    found, of kind's unit.
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

    def __post_init__(self) -> None:
        object.__setattr__(self, "remedy", told(self.remedy))

    @property
    def text(self) -> str:
        """Reason, remedy and the place in the documentation."""
        return f"{self.reason}; {self.remedy}" + (f" ({self.reference})" if self.mistake else "")

    @property
    def reference(self) -> str:
        """The page and the place on it."""
        kept = "".join(c for c in self.mistake.lower() if c.isalnum() or c in " -")
        return f"{PAGE}#{kept.replace(' ', '-')}"


@dataclass(frozen=True)
class Diagnosis:
    """The causes of a mismatch."""

    causes: tuple[Cause, ...] = ()  # all are right, but of rivals only one
    excluded: tuple[str, ...] = ()  # kinds, where nothing explains an error

    @property
    def text(self) -> str:
        """The causes in words; "": there are none."""
        texts = [cause.text for cause in self.causes if not cause.rival]
        if rivals := "; or ".join(cause.text for cause in self.causes if cause.rival):
            texts.append(f"{rivals}. This recording doesn't tell them apart: {self._experiment}")
        if self.excluded:
            left = " that is left" if texts else ""
            texts.append(
                f"no single cause explains the error{left}; these were excluded: {listed(self.excluded)}"
            )
        return "; and ".join(texts)

    def doubting(self, effort: Effort) -> Effort:
        """The meaning of efforts; not sure where a cause contradicts it, or where no cause was found."""
        contradicts = {c.kind for c in self.causes} & _OF_EFFORTS or set(self.excluded)
        if effort.verdict is None or not effort.verdict.sure or not contradicts:
            return effort
        reason = f"{listed(sorted(contradicts))} may explain them as well"
        reason = self.text if self.excluded else reason
        return replace(effort, verdict=replace(effort.verdict, sure=False, reason=reason))

    @property
    def _experiment(self) -> str:
        """The motion that tells rivals apart."""
        kinds = {cause.kind for cause in self.causes if cause.rival}
        if kinds <= _AT_REST:
            return "record a motion in which all joints of the wrist turn round"
        if kinds & _AT_REST:
            return (
                "record the same motion twice as fast: torques of loads and gravity stay the same"
            )
        return "record a motion in which the joints move one after the other"


def residual_causes(samples: Pieces, computed: Floats) -> tuple[Cause, ...]:
    """Causes outside any model of an arm: saturation, coupled joints, drift. computed: (K M, n) N m."""
    view = View(samples, ArmModel(lambda *_: computed, np.zeros_like))
    contest = _Contest(view)
    contest.add(view.rival("friction", residuals.FRICTION))
    contest.add(*residuals.limits(view, contest.fit), *residuals.couplings(view))
    before = float(contest.fit.mean(contest.squares[0]))
    if before > _MISMATCH and (named := contest.best(before)):
        return _causes(named, contest.as_is)
    finding = residuals.of_joints(view, contest.fit, contest.squares[0])
    return () if finding is None else _causes([(finding, None)], before)


def meaning_of_efforts(
    samples: Pieces | None, arm: ArmModel, drive_gains: Sequence[float]
) -> Verdict:
    """Which meaning explains recorded efforts. samples.measured: as recorded. drive_gains: (n,) N m/A, or none.

    Currents need known gains: gains that are fitted would be a free number for each joint, and always win.
    """
    if samples is None or not samples.comparable:
        return Verdict("torque", sure=False, reason="there are too few valid samples of a motion")
    if arm.guessed:
        return Verdict("torque", sure=False, reason="masses of the description are guesses")
    view = View(samples, arm)
    predicted = {"torque": view.computed, "torque_without_gravity": view.computed - view.gravity}
    if len(drive_gains):
        predicted["current"] = view.computed / drive_gains
    contest = _Contest(view)
    contest.add(*(view.rival(meaning, base=base) for meaning, base in predicted.items()))
    best, *others = sorted(range(len(contest.rivals)), key=contest.score)
    name = contest.rivals[best].kind
    summary = ", ".join(
        f"{contest.rivals[i].kind} is {printed(100 * contest.score(i), 2):g} % of the range off"
        for i in (best, *others)
    )
    if "current" not in predicted:
        summary += "; current wasn't considered, as no drive gains are known"
    alike = [contest.rivals[i].kind for i in others if contest.alike(i, best, _MARGIN)]
    reason = f"{name} and {listed(alike)} can't be told apart" if alike else ""
    if not reason and name != "torque":
        causes = compare(samples, arm) if name == "torque_without_gravity" else Diagnosis()
        alone = all(cause.kind == "no_gravity" for cause in causes.causes) and not causes.excluded
        if contest.score(best) > _FITS or not alone:
            reason = causes.text or "no meaning fits"
    return Verdict(name, not reason, summary, reason)


def compare(samples: Pieces | None, arm: ArmModel) -> Diagnosis:
    """The causes of a mismatch; none where torques match, or samples are uninformative."""
    if samples is None or not samples.comparable:
        return Diagnosis()
    found = motions.contradictions(samples, arm)
    if arm.guessed:
        alone = [(finding, None) for finding, _ in found]
        beyond = [(finding, None) for finding in motions.beyond_reach(View(samples, arm))]
        return Diagnosis(_causes(alone or beyond, _Contest(View(samples, arm)).as_is))
    if not found:
        return _Contest(View(samples, arm)).decide()
    # torques tell which correction is right, where more than one removes the contradiction
    contests = [_Contest(View(right, arm)) for _, right in found]
    best = min(range(len(found)), key=lambda i: contests[i].with_friction)
    finding, contest = found[best][0], contests[best]
    rest = contest.decide()
    known = [cause.error_after for cause in rest.causes if cause.error_after is not None]
    after = min(known, default=contest.score(0))  # of friction alone
    first = _causes([(finding, after)], _Contest(View(samples, arm)).as_is)
    others = [c for c in rest.causes if c.kind != "friction"]
    rivals = (replace(c, rival=len(others) > 1 and c.rival) for c in others)
    return replace(rest, causes=(*first, *rivals))


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
        self.remedies: dict[int, tuple[Mistake | None, float]] = {}  # by the number of the rival

    @property
    def with_friction(self) -> float:
        """Error of the model, friction and offset fitted."""
        return float(self.fit.mean(self.fit.errors(self.view.rival("friction"))))

    def decide(self) -> Diagnosis:
        """The outcome."""
        view, fit = self.view, self.fit
        self.add(view.rival("friction", residuals.FRICTION))
        before = self.score(0)
        if before > _MISMATCH:
            self.add(bodies.rough(view))
            for kind in KINDS:
                self.add(*kind(view, fit))
            named = self.best(before)
            if not named or named[0][0].kind in _LIKE_COUPLING:
                self.add(*residuals.couplings(view))
                named = self.best(before)
            causes = self._pair(named, before) or _causes(named, self.as_is)
            if causes := self._of_sensors(before, causes) or causes:
                return Diagnosis(causes)
        return self._unnamed(before)

    def _pair(self, named: list[tuple[Mistake, float]], before: float) -> tuple[Cause, ...]:
        """Two mistakes, if they leave half of what the best single one leaves, and no other pair does."""
        least = min((after for _, after in named), default=before)
        each = bool(named) and named[0][0].own is not None
        if not each and least < (_EXPLAINED if named else _FITS):
            return ()
        contest = _Contest(self.view)
        contest.add(*pairs.rivals(self.view, self.fit))
        # scales of all joints have more numbers than a pair: it needn't be better than they
        found = contest.best(_GAIN * (_MARGIN * least + _FLAT) if each else min(before, least))
        if len(found) != 1 or found[0][1] > _PAIR_FITS:
            return ()
        finding, after = found[0]
        both = [(one, after) for one in (finding, finding.also) if one]
        return tuple(replace(cause, rival=False) for cause in _causes(both, self.as_is))

    def _unnamed(self, before: float) -> Diagnosis:
        """The outcome where no rival wins."""
        own = residuals.of_joints(self.view, self.fit, self.squares[0])
        findings: tuple[Mistake, ...] = () if own is None else (own,)
        if not findings and before > _FITS:
            findings = motions.beyond_reach(self.view) or efforts.unlike(self.view)
        if findings:
            return Diagnosis(_causes([(one, None) for one in findings], self.as_is))
        if before > _FITS:
            rough = [self.score(i) for i, r in enumerate(self.rivals) if r.kind == "rough"]
            if min(rough, default=before) <= _MISMATCH:  # inexact masses explain it
                return Diagnosis()
            return Diagnosis(excluded=tuple(sorted({r.kind for r in self.rivals} - {"rough"})))
        friction = residuals.friction(self.view, self.fit, before)
        return Diagnosis(_causes([(friction, before)] if friction else [], self.as_is))

    def _of_sensors(self, before: float, causes: tuple[Cause, ...]) -> tuple[Cause, ...]:
        """A sensor that is off, if that leaves less than the causes named; beside a cause that leaves as much."""
        contest = _Contest(self.view)
        contest.add(bodies.rough(self.view), *sensors.rivals(self.view, self.fit))
        found = contest.best(before)
        least = min((cause.error_after or 0.0 for cause in causes), default=before)
        if not found or found[0][1] > min(least, _PAIR_FITS):
            return ()
        own = _causes(found, self.as_is)
        if len(causes) == 1 and _MARGIN * found[0][1] + _FLAT > least:
            return tuple(replace(cause, rival=True) for cause in (*causes, *own))
        return own

    @property
    def as_is(self) -> float:
        """Error of the model, nothing fitted."""
        measured = self.view.samples.flat(self.view.samples.measured)
        squares = (((measured - self.view.computed) / self.fit.size) ** 2).reshape(self.fit.shape)
        return float(self.fit.mean(squares.mean(axis=1)))

    def score(self, i: int) -> float:
        """Error that a rival leaves on pieces that were held out."""
        return float(self.fit.mean(self.squares[i]))

    def add(self, *rivals: Rival) -> None:
        """Add rivals, skipping fits that aren't finite."""
        for rival in rivals:
            squares = self.fit.errors(rival)
            if np.isfinite(squares).all():
                self.rivals.append(rival)
                self.squares.append(squares)

    def best(self, before: float) -> list[tuple[Mistake, float]]:
        """The best finding, or those that can't be told apart, with the errors that their remedies leave.

        before: the error without any.
        """
        still = self.view.rival("", base=np.zeros_like(self.view.computed))
        least = {True: min(before, float(self.fit.mean(self.fit.errors(still)))), False: before}
        scores = [self.score(i) for i in range(len(self.rivals))]
        tied: list[int] = []
        result = []
        for i in map(int, np.argsort(scores, kind="stable")):
            if tied and not self.alike(i, tied[0], _MARGIN):
                break
            if _MARGIN * scores[i] > before:  # a remedy leaves hardly less than its rival's own fit
                break
            finding, after = self.remedy(i)
            # a scale of zero is no explanation
            if finding and _small(after, least[finding.kind in _SCALES], finding):
                tied.append(i)
                result.append((finding, after))
        # a clock that explains no more than a free scale for each joint, which is no mistake, isn't the cause
        scales = [
            i for i, r in enumerate(self.rivals) if r.kind == "scales" and not self.remedy(i)[0]
        ]
        by_clock = bool(tied) and self.rivals[tied[0]].kind == "clock"
        if by_clock and any(self.alike(i, tied[0], _MARGIN) for i in scales):
            return []
        rough = [i for i, rival in enumerate(self.rivals) if rival.kind == "rough"]
        static = bool(tied) and self.rivals[tied[0]].kind in _AT_REST
        margin = _ROUGH_MARGIN if static else _MARGIN
        if any(self.alike(i, tied[0], margin) for i in rough if tied):
            return []
        return self._special(tied, result)

    def remedy(self, i: int) -> tuple[Mistake | None, float]:
        """The finding of a rival, and the error that is left with the numbers that it states."""
        if i not in self.remedies:
            rival, after = self.rivals[i], np.inf
            finding = rival.finding(*self.fit.numbers(rival))
            if finding is not None:
                after = float(self.fit.mean(self.fit.errors(self.fit.applied(rival, finding))))
            self.remedies[i] = finding, after
        return self.remedies[i]

    def alike(self, i: int, best: int, margin: float) -> bool:
        """Whether a rival can't be told from the best one."""
        error, least = (self.fit.mean(self.squares[k], self.weights) for k in (i, best))
        worse = error > margin * least + _FLAT
        return bool(worse.mean() < _SURE)

    def _special(
        self, tied: list[int], result: list[tuple[Mistake, float]]
    ) -> list[tuple[Mistake, float]]:
        """Without those that include another one; nothing if too many are left."""
        kinds = {self.rivals[i].kind for i in tied}
        kept: dict[tuple[str, tuple[str, ...]], tuple[Mistake, float]] = {}
        for i, (finding, after) in zip(tied, result, strict=True):
            if not kinds & set(self.rivals[i].includes):
                kept.setdefault((finding.kind, finding.joints), (finding, after))
        return list(kept.values()) if len(kept) <= _MOST_NAMED else []


def _small(after: float, before: float, finding: Mistake) -> bool:
    """Whether a remedy leaves little enough of an error; of weights, wrong masses leave more."""
    most = max(_FITS, min(before / _FAR, _MOST_LEFT)) if finding.kind in _AT_REST else _FITS
    return finding.gain * after <= before and after <= most


def _causes(named: Sequence[tuple[Mistake, float | None]], before: float) -> tuple[Cause, ...]:
    """One, or rivals. named: with the errors that remedies leave."""
    words = ("kind", "joints", "value", "reason", "remedy", "mistake")
    return tuple(
        Cause(
            **{name: getattr(finding, name) for name in words},
            error_before=before,
            error_after=after,
            rival=len(named) > 1,
        )
        for finding, after in named
    )

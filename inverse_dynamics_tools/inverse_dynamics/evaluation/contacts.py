# SPDX-License-Identifier: Apache-2.0
"""What touched the robot in a recording: external torques, contacts, the wrench at the tip.

    found = find_contacts("recording", "panda_real", quiet=(0.0, 20.0))
    for contact in found.contacts:
        print(contact.begin, contact.end, contact.joint, contact.torque)

Estimators and statistics are those of the C++ package inverse_dynamics_control: see docs/contact.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.wording import counted, listed
from inverse_dynamics.contact import (
    AccelerationResidual,
    Compensated,
    ContactDetector,
    ContactThresholds,
    EstimatorOptions,
    MomentumObserver,
    TipWrench,
    VelocitySource,
    contact_thresholds,
)
from inverse_dynamics.errors import EvaluationError, InvalidParameterError
from inverse_dynamics.evaluation.band_thresholds import BandThresholds, band_thresholds
from inverse_dynamics.evaluation.evaluation import Evaluation, evaluate
from inverse_dynamics.robot.descriptions import effort_limits, read_description
from inverse_dynamics.robot.solvers import open_solver

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats, Integers, Mask
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.robot.robots import Robot

GAIN = 60.0
"""Default of the estimators, 1/s: a time constant of 17 ms."""

TRACKING = 200.0
"""Default of the tracked velocities, rad/s."""

FALSE_ALARMS = 1.0
"""Default, per hour."""

_GAP = 2.5  # periods; one lost message isn't a gap
_LONGEST_PERIOD = 0.02  # s, unless samples are further apart
_LATEST = 1e9  # s
_LARGE = 0.2  # of an effort limit: a threshold above it is noted
_UNCERTAIN = 3.0  # upper by lower end of the range of a threshold: noted above it


@dataclass(frozen=True)
class Contact:
    """One contact. Times: s since the first sample."""

    begin: float
    end: float  # of the last sample with a torque above its threshold
    joint: str  # whose torque is the greatest multiple of its threshold
    unit: str
    torque: float  # its greatest, N m (prismatic N), with its sign
    torque_time: float
    unknown: float = 0.0  # s of it without an estimate: see Contacts.interruptions
    force: float | None = None  # N, at the tip, mean over it; None: the solver has no Kinematics
    force_direction: tuple[float, float, float] | None = (
        None  # of that mean, in the axes of the root
    )
    greatest_force: float | None = None  # N; near singularities it is mostly noise
    unseen: int | None = None  # directions of a wrench that can't be observed, the most during it


@dataclass(frozen=True)
class Contacts:
    """External torques of a recording and its contacts. N samples, n joints; order of the chain.

    All is what the robot exerts on its surroundings.
    """

    evaluation: Evaluation
    estimator: str  # name of its class
    gain: float  # 1/s
    tracking: float  # rad/s
    friction_band: tuple[float, ...]  # (n,) N m; empty: none
    measured_velocities: bool
    quiet: str  # where the thresholds are from, in words
    time: Floats  # (N,) s
    torques: Floats  # (N, n) N m, beyond the friction band; zero where not valid
    valid: Mask  # (N,) whether they are an estimate
    contact: Mask  # (N,) from begin to end of each contact
    wrenches: Floats | None  # (N, 6) N, N m about the tip, in the axes of the root
    unseen: Integers | None  # (N,) how many directions of a wrench can't be observed
    thresholds: ContactThresholds | BandThresholds
    contacts: tuple[Contact, ...]
    interruptions: tuple[tuple[float, float], ...] = ()  # from, to [s]: no estimate in between
    quiet_part: tuple[float, float] | None = None  # from, to [s], if the thresholds are from there
    notes: tuple[str, ...] = ()


def find_contacts(
    bag: Path | str,
    robot: Robot | Path | str,
    *,
    quiet: tuple[float, float] | None = None,
    quiet_recording: Path | str | None = None,
    false_alarms: float = FALSE_ALARMS,
    gain: float = GAIN,
    tracking: float = TRACKING,
    friction_band: Sequence[float] = (),
    measured_velocities: bool = False,
    progress: Progress = no_progress,
    **options: Any,
) -> Contacts:
    """Find the contacts of a recording.

    quiet: from, to [s] of a part without contact; quiet_recording: a recording without contact; both:
    that part of that recording; none: thresholds are made of the model's torque bands. false_alarms:
    per hour. gain: 1/s;
    tracking: rad/s; friction_band: N m, one number per joint, or one for all: what the friction
    model may be wrong by beyond what the quiet part shows, whose thresholds are made without it;
    measured_velocities: recorded velocities instead of tracked positions. options: others of
    evaluate().

    Raises UserError: those of evaluate(), InvalidParameterError.
    """
    if quiet is not None:
        _check_quiet(*quiet)  # before anything is read
    evaluation = evaluate(bag, robot, progress=progress, **options)
    solver = _solver_of(evaluation)
    band = tuple(friction_band)
    band = band * len(evaluation.joint_names) if len(band) == 1 else band
    chosen = _Chosen(solver, gain, tracking, band, measured_velocities)
    estimates = _estimate(evaluation, chosen)
    without_contact = evaluation
    if quiet_recording is not None:
        without_contact = evaluate(quiet_recording, robot, progress=progress, **options)
    thresholds: ContactThresholds | BandThresholds
    if quiet is None and quiet_recording is None:
        where, thresholds = _thresholds_of_bands(evaluation, solver, false_alarms)
    else:
        # What the quiet part shows of the friction's error is in the thresholds: no band there.
        of_quiet = _estimate(without_contact, replace(chosen, friction_band=()))
        where, thresholds = _thresholds(of_quiet, quiet, solver, false_alarms)
    wrenches, unseen, wrench_notes = _wrenches(solver, estimates, thresholds)
    found = Contacts(
        evaluation=evaluation,
        estimator=chosen.kind.__name__,
        gain=gain,
        tracking=tracking,
        friction_band=chosen.friction_band,
        measured_velocities=measured_velocities,
        quiet=where,
        time=estimates.time,
        torques=estimates.torques,
        valid=estimates.valid,
        contact=np.zeros(len(estimates.time), dtype=bool),
        wrenches=wrenches,
        unseen=unseen,
        thresholds=thresholds,
        contacts=(),
        interruptions=_interruptions(estimates),
        quiet_part=quiet if quiet_recording is None else None,
    )
    spans = _spans(found)
    for first, last in spans:
        found.contact[first : last + 1] = True
    found = replace(found, contacts=tuple(_contact(found, *span) for span in spans))
    notes = (
        *evaluation.notes,
        *_interruption_notes(found.interruptions, estimates.longest_period),
        *_threshold_notes(evaluation, thresholds),
        *wrench_notes,
    )
    return replace(found, notes=notes)


def _check_quiet(start: float, end: float) -> None:
    if not (abs(start) < _LATEST and abs(end) < _LATEST and start < end):
        raise EvaluationError(
            "--quiet (quiet=): expected two times in s since the first sample, the later one second, "
            f"got {start:g},{end:g}"
        )


@dataclass(frozen=True)
class _Chosen:
    """How external torques are estimated."""

    solver: Solver
    gain: float
    tracking: float
    friction_band: tuple[float, ...]
    measured_velocities: bool

    @property
    def kind(self) -> type[MomentumObserver | AccelerationResidual]:
        return MomentumObserver if self.solver.inertia_is_physical else AccelerationResidual


@dataclass(frozen=True)
class _Estimates:
    """External torques of the samples of an evaluation that can be used."""

    evaluation: Evaluation
    time: Floats  # (M,)
    q: Floats  # (M, n)
    torques: Floats  # (M, n)
    valid: Mask  # (M,)
    longest_period: float  # s; samples further apart interrupt the estimate


def _solver_of(evaluation: Evaluation) -> Solver:
    urdf = evaluation.robot.urdf
    return open_solver(evaluation.robot, "" if urdf is None else read_description(urdf))


def _estimate(evaluation: Evaluation, chosen: _Chosen) -> _Estimates:
    """Of samples that are later than those before them and don't repeat them."""
    used = ~(evaluation.samples.repeated | evaluation.samples.non_increasing)
    time, log = evaluation.time[used], evaluation.log
    measured = chosen.measured_velocities
    longest_period = max(_LONGEST_PERIOD, _GAP * _period(time))
    options = EstimatorOptions(
        np.full(len(evaluation.joint_names), chosen.gain),
        velocity=VelocitySource.MEASURED if measured else VelocitySource.POSITIONS,
        tracking=chosen.tracking,
        compensated=Compensated(gravity=evaluation.effort.meaning == "torque_without_gravity"),
        friction_band=chosen.friction_band,
        longest_period=longest_period,
    )
    qd = log.qd[used] if measured else None
    estimator = chosen.kind(chosen.solver, options)
    torques, valid = estimator.run(time, log.q[used], evaluation.measured[used], qd)
    if not valid.any():
        raise EvaluationError(
            f"{evaluation.bag}: expected a stretch of {10 / chosen.tracking:.3g} s without a gap of "
            f"{longest_period:.3g} s, after which velocities are known, got {len(time)} samples in "
            f"{time[-1] - time[0]:.3g} s; take a longer recording, or more --tracking"
        )
    return _Estimates(evaluation, time, log.q[used], torques, valid, longest_period)


def _period(time: Floats) -> float:
    return float(np.median(np.diff(time))) if len(time) > 1 else _LONGEST_PERIOD


def _thresholds(
    estimates: _Estimates, quiet: tuple[float, float] | None, solver: Solver, false_alarms: float
) -> tuple[str, ContactThresholds]:
    """What they are made of, in words, and the thresholds."""
    where, chosen, time = f"{estimates.evaluation.bag}", estimates.valid, estimates.time
    if quiet is not None:
        where += f", from {quiet[0]:.9g} s to {quiet[1]:.9g} s"
        chosen = chosen & (time >= quiet[0]) & (time <= quiet[1])
        if not chosen.any():
            raise EvaluationError(
                f"{where}: expected a part of the recording, which ends at {time[-1]:.4g} s, got no "
                "sample; give another --quiet FROM,TO"
            )
    try:
        thresholds = contact_thresholds(
            estimates.torques[chosen], _period(time), false_alarms, solver.joint_names
        )
    except InvalidParameterError as error:
        raise InvalidParameterError(f"{where}: {error}") from None
    return f"{where}: {chosen.sum()} samples, {chosen.sum() * _period(time):.3g} s", thresholds


def _thresholds_of_bands(
    evaluation: Evaluation, solver: Solver, false_alarms: float
) -> tuple[str, BandThresholds]:
    """What they are made of, in words, and the thresholds."""
    bands = solver.torque_deviation
    if bands is None:
        raise EvaluationError(
            "contacts: which part of the recording is without contact? give --quiet FROM,TO [s], or "
            f"--quiet-recording; the model of {evaluation.robot.name} states no torque bands to take instead, as "
            "those of `ids identify` do"
        )
    return (
        "the model's 95 % torque bands, taken for Gaussian noise (a part without contact, --quiet, is better)",
        band_thresholds(bands, false_alarms),
    )


def _wrenches(
    solver: Solver, estimates: _Estimates, thresholds: ContactThresholds | BandThresholds
) -> tuple[Floats | None, Integers | None, tuple[str, ...]]:
    try:
        tip = TipWrench(solver, thresholds.noise)
    except InvalidParameterError as error:
        return None, None, (f"no wrench at the tip: {error}",)
    return *tip.run(estimates.q, estimates.torques), ()


def _interruptions(estimates: _Estimates) -> tuple[tuple[float, float], ...]:
    """From the last sample with an estimate to the next one, or to the end; not those of the start."""
    time = estimates.time
    index = np.flatnonzero(estimates.valid)
    pairs = [(index[k], index[k + 1]) for k in np.flatnonzero(np.diff(index) > 1)]
    if index[-1] < len(time) - 1:
        pairs.append((index[-1], len(time) - 1))
    return tuple((float(time[first]), float(time[after])) for first, after in pairs)


def _spans(found: Contacts) -> list[tuple[int, int]]:
    """First and last sample of each contact: those with a torque above its threshold."""
    thresholds = found.thresholds.torques
    detector = ContactDetector(thresholds, found.evaluation.joint_names)
    marked = detector.run(found.time, found.torques, found.valid)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], marked.astype(int), [0]])))
    above = np.flatnonzero((np.abs(found.torques) > thresholds).any(axis=1))
    last = above[np.searchsorted(above, edges[1::2]) - 1]
    return list(zip(edges[::2].tolist(), last.tolist(), strict=True))


def _contact(found: Contacts, first: int, last: int) -> Contact:
    part = found.torques[first : last + 1]
    row, j = np.unravel_index(np.abs(part / found.thresholds.torques).argmax(), part.shape)
    begin, end = float(found.time[first]), float(found.time[last])
    contact = Contact(
        begin=begin,
        end=end,
        joint=found.evaluation.joint_names[j],
        unit=found.evaluation.units[j],
        torque=float(part[row, j]),
        torque_time=float(found.time[first + row]),
        unknown=sum(max(0.0, min(end, b) - max(begin, a)) for a, b in found.interruptions),
    )
    if found.wrenches is None or found.unseen is None:
        return contact
    known = found.valid[first : last + 1]
    forces = found.wrenches[first : last + 1, :3][known]
    mean = forces.mean(axis=0)
    force = float(np.linalg.norm(mean))
    x, y, z = (float(component) for component in mean / max(force, 1e-300))
    return replace(
        contact,
        force=force,
        force_direction=(x, y, z),
        greatest_force=float(np.linalg.norm(forces, axis=1).max()),
        unseen=int(found.unseen[first : last + 1][known].max()),
    )


def _interruption_notes(
    interruptions: tuple[tuple[float, float], ...], longest_period: float
) -> tuple[str, ...]:
    if not interruptions:
        return ()
    lengths = [end - begin for begin, end in interruptions]
    begin, end = interruptions[int(np.argmax(lengths))]
    return (
        f"the estimate is interrupted {counted(len(lengths), 'time')}, {sum(lengths):.3g} s in all, "
        f"the longest from {begin:.6g} s to {end:.6g} s: samples more than {longest_period:.3g} s "
        "apart; it restarts from zero, and contacts aren't looked for in between",
    )


def _threshold_notes(
    evaluation: Evaluation, thresholds: ContactThresholds | BandThresholds
) -> tuple[str, ...]:
    """Thresholds that a contact hardly reaches, and those that may well be others."""
    names, units = evaluation.joint_names, evaluation.units
    urdf = evaluation.robot.urdf
    limits = effort_limits(urdf, "" if urdf is None else read_description(urdf), names)
    seen = np.abs(evaluation.measured).max(axis=0)
    large, uncertain = [], []
    for j, joint in enumerate(names):
        threshold, low, high = thresholds.torques[j], thresholds.low[j], thresholds.high[j]
        if threshold > _LARGE * limits[j]:
            share = f"{100 * threshold / limits[j]:.0f} % of its effort limit"
            large.append(f"{joint} ({threshold:.3g} {units[j]}, {share})")
        elif threshold > seen[j]:
            large.append(f"{joint} ({threshold:.3g} {units[j]}, more than any torque recorded)")
        if high > _UNCERTAIN * low:
            uncertain.append(f"{joint} ({low:.3g} to {high:.3g} {units[j]})")
    notes = []
    if large:
        notes.append(
            f"high thresholds: {listed(large)}: weaker contacts aren't found; take a longer part "
            "without contact, or more --false-alarms"
        )
    if uncertain:
        notes.append(
            f"uncertain thresholds: {listed(uncertain)} with a confidence of 90 %; take a longer "
            "part without contact, and make sure that nothing touches the robot in it"
        )
    return tuple(notes)

# SPDX-License-Identifier: Apache-2.0
"""Contacts in a recording: external torques, when they exceed thresholds, the wrench at the tip.

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

from inverse_dynamics import _core
from inverse_dynamics.arguments import checked
from inverse_dynamics.arrays import stretches
from inverse_dynamics.contact import (
    AccelerationResidual,
    ContactDetector,
    ContactThresholds,
    EstimatorOptions,
    MomentumObserver,
    TipWrench,
    VelocitySource,
    contact_thresholds,
)
from inverse_dynamics.contacts.figure import contact_figure
from inverse_dynamics.contacts.page import contact_page
from inverse_dynamics.contacts.tables import contact_lines, contact_numbers
from inverse_dynamics.errors import EvaluationError, InvalidParameterError
from inverse_dynamics.evaluation.evaluation import (
    Evaluation,
    evaluate,
    evaluate_run,
    open_run,
    torques_with_gravity,
)
from inverse_dynamics.evaluation.run import RunOptions, of_run
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.model_errors import LEAST_GAIN, read_model_errors
from inverse_dynamics.show.result import PAGE, ResultDirectory, files_of
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Unpack

    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import Floats, Integers, Mask
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Recorded
    from inverse_dynamics.robots.robots import Robot

FALSE_ALARMS = 1.0
"""Default, per hour."""

_GAIN_BY_TRACKING = 0.3  # the most with which the time constant is 1 / gain: motion_tracker.hpp
_MOST_GAIN = 60.0  # 1/s: contacts are noticed within 17 ms
_RELEASE = 0.1  # s; torques that are greater again after a shorter time belong to a contact
_GAP = 2.5  # periods; one lost message isn't a gap
_LONGEST_PERIOD = 0.02  # s, unless samples are further apart
_LATEST = 1e9  # s
_LARGE = 0.2  # of an effort limit: a threshold above it is noted
_FEW = 10.0  # peaks: fewer make a threshold more than twice that of many
_MOVING = 0.05  # rad/s (prismatic m/s): slower, friction may hold a joint
_LEAST = 10.0  # independent samples: medians of fewer aren't compared
_RAISED = 1.5  # times: noted above it


@dataclass(frozen=True)
class Contact:
    """One contact. Times: s since the first sample."""

    begin: float
    end: float  # then torques have fallen to half of their greatest
    joint: str  # whose torque is the greatest multiple of its threshold
    unit: str
    torque: float  # its greatest, N m (prismatic N), with its sign
    torque_time: float
    unknown: float = 0.0  # s of it without an estimate: see Contacts.interruptions
    force: float | None = None  # N, at the tip, mean over it; None: the solver has no Kinematics
    force_direction: tuple[float, float, float] | None = None  # of that mean, in the root's axes
    greatest_force: float | None = None  # N; near singularities it is mostly noise
    unseen: int | None = None  # directions of a wrench that can't be observed, the most during it


@dataclass(frozen=True, repr=False)
class Contacts(ResultDirectory):
    """External torques of a recording and its contacts. N samples, n joints; order of the chain.

    All is what the robot exerts on its surroundings.
    """

    contents = files_of("contacts.json", "contacts", PAGE)
    numbers, lines, plot, page = contact_numbers, contact_lines, contact_figure, contact_page

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
    thresholds: ContactThresholds
    contacts: tuple[Contact, ...]
    interruptions: tuple[tuple[float, float], ...] = ()  # from, to [s]: no estimate in between
    blind: tuple[str, ...] = ()  # joints whose thresholds exceed their effort limits
    quiet_part: tuple[float, float] | None = None  # from, to [s], if the thresholds are from there
    notes: tuple[str, ...] = ()

    def inputs(self) -> tuple[Path | None, ...]:
        """The recording and the robot's files."""
        return self.evaluation.bag, *self.evaluation.robot.files


class ContactOptions(RunOptions, total=False):
    """What is said about the estimator beside a recording.

    gain: 1/s; none: by the cut-off of the recording that thresholds are made of. tracking: rad/s, of velocities from
    positions; none: recorded velocities. friction_band: N m, one number per joint, or one for all: what the friction
    model may be wrong by beyond what the quiet part shows, whose thresholds are made without it.
    """

    gain: float | None
    tracking: float | None
    friction_band: Sequence[float]


@checked
def find_contacts(
    bag: Recorded,
    robot: Robot | Solver | Path | str | None = None,
    *,
    quiet: tuple[float, float] | None = None,
    quiet_recording: Recorded | None = None,
    false_alarms: float = FALSE_ALARMS,
    progress: Progress = no_progress,
    **options: Unpack[ContactOptions],
) -> Contacts:
    """Find the contacts of a recording.

    Parameters
    ----------
    bag, robot, **options
        As evaluate() takes them, and ContactOptions.
    quiet, quiet_recording
        From, to [s] of a part without contact; a recording without contact; both: that part of that recording;
        none: the errors that `ids identify` found on held-out data.
    false_alarms
        Per hour.

    Raises
    ------
    UserError
        Those of evaluate(), InvalidParameterError.

    Examples
    --------
    >>> import numpy as np
    >>> from inverse_dynamics import Solver, find_contacts
    >>> t = np.linspace(0, 10, 2001)
    >>> phase = t[:, None] + np.arange(6)
    >>> q, qd = np.sin(phase), np.cos(phase)
    >>> tau = Solver("ur10_simulated").torques(q, qd, -q) + np.random.default_rng(1).normal(0, 0.1, q.shape)
    >>> tau[1400:1500] += Solver("ur10_simulated").external_torques(q[1400:1500], [0, 0, -30, 0, 0, 0])  # N
    >>> table = {"time": t, "q": q, "qd": qd, "effort": tau}
    >>> [round(contact.begin) for contact in find_contacts(table, "ur10_simulated", quiet=(0, 5)).contacts]
    [7]
    """
    if quiet is not None and not -_LATEST < quiet[0] < quiet[1] < _LATEST:
        raise EvaluationError(
            "--quiet (quiet=): expected two times in s since the first sample, the later one second, "
            f"got {quiet[0]:g},{quiet[1]:g}"
        )
    evaluation = evaluate(bag, robot, progress=progress, **of_run(options))
    solver, alone, held_out = evaluation.arm.solver, evaluation, None
    if quiet_recording is not None:
        alone = evaluate_run(open_run(quiet_recording, robot, progress=progress, **of_run(options)))
    elif quiet is None:
        held_out = _held_out(evaluation.robot)
    gain, tracking = _gain(options.get("gain"), held_out, alone), options.get("tracking")
    plain = _estimate(evaluation, solver, gain, tracking)
    of_quiet = plain if alone is evaluation else _estimate(alone, solver, gain, tracking)
    without_contact = held_out or _quiet_part(of_quiet, quiet)
    thresholds, raised_notes = _raised(without_contact, plain, solver, false_alarms)
    # Thresholds contain the friction's error of the quiet part: no band there.
    band = tuple(options.get("friction_band", ()))
    band *= len(solver.joint_names) if len(band) == 1 else 1
    estimates = _estimate(evaluation, solver, gain, tracking, band) if band else plain
    wrenches, unseen, wrench_notes = _wrenches(solver, estimates, thresholds)
    limits = evaluation.arm.limit("effort", np.inf)
    interruptions = _interruptions(estimates)
    found = Contacts(
        evaluation=evaluation,
        estimator=estimates.estimator,
        gain=gain,
        tracking=tracking or _bandwidth(gain),
        friction_band=band,
        measured_velocities=tracking is None,
        quiet=without_contact.where,
        time=estimates.time,
        torques=estimates.torques,
        valid=estimates.valid,
        contact=np.zeros(len(estimates.time), dtype=bool),
        wrenches=wrenches,
        unseen=unseen,
        thresholds=thresholds,
        contacts=(),
        interruptions=interruptions,
        blind=_blind(evaluation, thresholds, limits, without_contact.where),
        quiet_part=quiet if quiet_recording is None else None,
        notes=(
            *evaluation.notes,
            *_interruption_notes(interruptions, estimates.longest_period),
            *raised_notes,
            *_threshold_notes(evaluation, thresholds, limits),
            *wrench_notes,
        ),
    )
    spans = _spans(found)
    for first, last in spans:
        found.contact[first : last + 1] = True
    return replace(found, contacts=tuple(_contact(found, *span) for span in spans))


@dataclass(frozen=True)
class _Estimates:
    """External torques of the samples of an evaluation that can be used."""

    evaluation: Evaluation
    time: Floats  # (M,) by the time base of the evaluation
    q: Floats  # (M, n)
    qd: Floats  # (M, n) as recorded
    torques: Floats  # (M, n)
    valid: Mask  # (M,)
    longest_period: float  # s; samples further apart interrupt the estimate
    estimator: str  # name of its class


@dataclass(frozen=True)
class _Quiet:
    """External torques without contact."""

    where: str  # in words
    period: float  # s
    torques: Floats  # (M, n)
    most_gain: float = np.inf  # 1/s, of an estimator whose torques are compared with them


def _gain(stated: float | None, held_out: _Quiet | None, alone: Evaluation) -> float:
    """Gain of the estimators [1/s]. alone: the recording that gives thresholds where held-out errors don't.

    By default the cut-off [Hz] of its accelerations decides: what noise, jitter and quantisation allow.
    """
    if held_out is None:
        cutoff = alone.accelerations.cutoff or np.inf
        usual = np.clip(_GAIN_BY_TRACKING * 2 * np.pi * cutoff, LEAST_GAIN, _MOST_GAIN)
        return float(usual) if stated is None else stated
    if stated and stated > held_out.most_gain:
        raise InvalidParameterError(
            f"--gain (gain=): expected at most {held_out.most_gain:.3g} 1/s, at which `ids identify` has found the "
            f"errors that thresholds are made of, got {stated:.3g}; give --quiet FROM,TO too"
        )
    return held_out.most_gain if stated is None else stated


def _bandwidth(gain: float) -> float:
    """Of tracked velocities [rad/s], the least that a gain goes with."""
    return gain / _GAIN_BY_TRACKING


def _period(time: Floats) -> float:
    return float(np.median(np.diff(time))) if len(time) > 1 else _LONGEST_PERIOD


def _estimate(
    evaluation: Evaluation,
    solver: Solver,
    gain: float,
    tracking: float | None,
    friction_band: Sequence[float] = (),
) -> _Estimates:
    """Of samples that are later than those before them and don't repeat them."""
    log, samples, time = evaluation.log, evaluation.samples, evaluation.log.time
    used = ~(samples.repeated | samples.start_transient)
    if evaluation.accelerations.time_base == "stamps":
        used &= ~samples.non_increasing
    else:
        time = _core.sample_instants(time, log.q, log.qd, log.effort)
    time, q, qd = time[used], log.q[used], log.qd[used]
    longest_period = max(_LONGEST_PERIOD, _GAP * _period(time))
    options = EstimatorOptions(
        np.full(len(evaluation.joint_names), gain),
        velocity=VelocitySource.POSITIONS if tracking else VelocitySource.MEASURED,
        tracking=tracking or _bandwidth(gain),
        friction_band=friction_band,
        longest_period=longest_period,
    )
    kind = MomentumObserver if solver.inertia_is_physical else AccelerationResidual
    effort = torques_with_gravity(evaluation)[used]
    effort[1:] = (effort[1:] + effort[:-1]) / 2  # estimators take the mean since the sample before
    torques, valid = kind(solver, options).run(time, q, effort, None if tracking else qd)
    if not valid.any():
        raise EvaluationError(
            f"{evaluation.bag}: expected a stretch of {10 / tracking if tracking else 0:.3g} s without a "
            f"gap of {longest_period:.3g} s, after which velocities are known, got {len(time)} samples "
            f"in {time[-1] - time[0]:.3g} s; take a longer recording, or more --tracking"
        )
    return _Estimates(evaluation, time, q, qd, torques, valid, longest_period, kind.__name__)


def _quiet_part(estimates: _Estimates, quiet: tuple[float, float] | None) -> _Quiet:
    where, chosen, time = f"{estimates.evaluation.bag}", estimates.valid, estimates.time
    if quiet is not None:
        where += f", from {quiet[0]:.9g} s to {quiet[1]:.9g} s"
        chosen = chosen & (time >= quiet[0]) & (time <= quiet[1])
        if not chosen.any():
            raise EvaluationError(
                f"{where}: expected a part of the recording, which ends at {time[-1]:.4g} s, got no "
                "sample; give another --quiet FROM,TO"
            )
    period = _period(time)
    where += f": {chosen.sum()} samples, {chosen.sum() * period:.3g} s"
    return _Quiet(where, period, estimates.torques[chosen])


def _held_out(robot: Robot) -> _Quiet:
    """Held-out errors of a model of `ids identify`."""
    content, why = read_model_errors(robot.model) if robot.model else (None, "it has none")
    if content is None:
        raise EvaluationError(
            "contacts: which part of the recording is without contact? give --quiet FROM,TO [s], or "
            f"--quiet-recording; the held-out errors of the model of {robot.name}, which `ids identify` "
            f"writes, aren't there to be taken instead ({why})"
        )
    held_out = content["held_out"]
    torques = np.array(held_out["torques"], dtype=float)
    where = f"errors of the model on held-out data: {len(torques) * held_out['period']:.3g} s"
    return _Quiet(where, held_out["period"], torques, held_out["gain"])


def _raised(
    quiet: _Quiet, estimates: _Estimates, solver: Solver, false_alarms: float
) -> tuple[ContactThresholds, tuple[str, ...]]:
    """Thresholds, raised where external torques of the recording at hand are greater than quiet ones.

    Contacts are shorter than half of the time that a joint moves. So the median of its torques is one
    without contact: where it is greater than that of the quiet part, false alarms would be more than
    stated. At rest friction holds a joint, and this isn't known.
    """
    thresholds = _thresholds(quiet, solver, false_alarms)
    evaluation, factors, raised = estimates.evaluation, np.ones(quiet.torques.shape[1]), []
    for j, joint in enumerate(evaluation.joint_names):
        moving = estimates.valid & (np.abs(estimates.qd[:, j]) > _MOVING)
        usual = float(np.median(np.abs(quiet.torques[:, j])))
        independent = moving.sum() * _period(estimates.time) / thresholds.correlation_time[j] / 2
        if independent < _LEAST or usual == 0:
            continue
        here = float(np.median(np.abs(estimates.torques[moving, j])))
        factors[j] = max(1.0, here / usual)
        if factors[j] > _RAISED:
            raised.append(f"{joint} ({factors[j]:.2g} times, to {here:.3g} {evaluation.units[j]})")
    if factors.max() > 1:
        thresholds = _thresholds(
            replace(quiet, torques=quiet.torques * factors), solver, false_alarms
        )
    note = (
        f"thresholds are raised, as external torques usually are greater where joints move than in what "
        f"thresholds are made of: {listed(raised)}; take a part without contact that has the same motions "
        "and loads, or a better model"
    )
    return thresholds, (note,) if raised else ()


def _thresholds(quiet: _Quiet, solver: Solver, false_alarms: float) -> ContactThresholds:
    try:
        return contact_thresholds(quiet.torques, quiet.period, false_alarms, solver.joint_names)
    except InvalidParameterError as error:
        raise InvalidParameterError(f"{quiet.where}: {error}") from None


def _wrenches(
    solver: Solver, estimates: _Estimates, thresholds: ContactThresholds
) -> tuple[Floats | None, Integers | None, tuple[str, ...]]:
    try:
        tip = TipWrench(solver, thresholds.noise)
    except InvalidParameterError as error:
        return None, None, (f"no wrench at the tip: {error}",)
    note = f"the wrench is that at {solver.tip}, the first tip, as if nothing else were touched"
    several = len(solver.tip_names) > 1
    return *tip.run(estimates.q, estimates.torques), (note,) if several else ()


def _interruptions(estimates: _Estimates) -> tuple[tuple[float, float], ...]:
    """From the last sample with an estimate to the next one, or to the end; not those of the start."""
    time = estimates.time
    index = np.flatnonzero(estimates.valid)
    pairs = [(index[k], index[k + 1]) for k in np.flatnonzero(np.diff(index) > 1)]
    if index[-1] < len(time) - 1:
        pairs.append((index[-1], len(time) - 1))
    return tuple((float(time[first]), float(time[after])) for first, after in pairs)


def _spans(found: Contacts) -> list[tuple[int, int]]:
    """First and last sample of each contact, without the time after which the detector ends it."""
    detector = ContactDetector(
        found.thresholds.torques, found.evaluation.joint_names, release_time=_RELEASE
    )
    marked = detector.run(found.time, found.torques, found.valid)
    first, after = stretches(marked)
    ends = found.time[np.minimum(after, len(marked) - 1)] - _RELEASE
    last = np.where(after < len(marked), np.searchsorted(found.time, ends), len(marked) - 1)
    return list(zip(first.tolist(), np.maximum(first, last).tolist(), strict=True))


def _contact(found: Contacts, first: int, last: int) -> Contact:
    during = slice(first, last + 1)
    part = found.torques[during]
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
    known = found.valid[during]
    forces = found.wrenches[during, :3][known]
    mean = forces.mean(axis=0)
    force = float(np.linalg.norm(mean))
    x, y, z = (mean / max(force, 1e-300)).tolist()
    return replace(
        contact,
        force=force,
        force_direction=(x, y, z),
        greatest_force=float(np.linalg.norm(forces, axis=1).max()),
        unseen=int(found.unseen[during][known].max()),
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


def _blind(
    evaluation: Evaluation, thresholds: ContactThresholds, limits: Floats, quiet: str
) -> tuple[str, ...]:
    """Joints that show no contact that they could bear; refused where no other is left."""
    blind = np.array(thresholds.torques) > limits
    if not blind.all():
        return tuple(np.array(evaluation.joint_names)[blind].tolist())
    shares = ", ".join(f"{100 * x:.3g} %" for x in thresholds.torques / limits)
    raise EvaluationError(
        f"{quiet}: no contact could be found, as thresholds exceed the effort limits of all joints: {shares} of them; "
        f"{_remedy(evaluation)}"
    )


def _remedy(evaluation: Evaluation) -> str:
    """Against high thresholds. A longer quiet part can't fix errors of the model."""
    if evaluation.diagnosis:
        causes = (f"{cause.reason}; {cause.remedy}" for cause in evaluation.diagnosis)
        return f"first remove the likely cause of the error: {', or '.join(causes)}"
    return "take a longer part without contact, or more --false-alarms"


def _threshold_notes(
    evaluation: Evaluation, thresholds: ContactThresholds, limits: Floats
) -> list[str]:
    """Thresholds that a contact hardly reaches, and those that may well be others."""
    names, units = evaluation.joint_names, evaluation.units
    seen = np.abs(evaluation.measured).max(axis=0)
    large, uncertain = [], []
    for j, joint in enumerate(names):
        threshold, peaks = thresholds.torques[j], thresholds.peaks[j]
        if threshold > _LARGE * limits[j]:
            share = f"{100 * threshold / limits[j]:.0f} % of its effort limit"
            large.append(f"{joint} ({threshold:.3g} {units[j]}, {share})")
        elif threshold > seen[j]:
            large.append(f"{joint} ({threshold:.3g} {units[j]}, more than any torque recorded)")
        if peaks < _FEW:
            uncertain.append(f"{joint} ({peaks:.0f})")
    notes = []
    if large:
        notes.append(
            f"high thresholds: {listed(large)}: weaker contacts aren't found; {_remedy(evaluation)}"
        )
    if uncertain:
        notes.append(
            f"thresholds rest on few peaks, and are high for that: {listed(uncertain)}; take a longer "
            "part without contact"
        )
    return notes

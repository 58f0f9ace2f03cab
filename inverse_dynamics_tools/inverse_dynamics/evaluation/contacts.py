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
from inverse_dynamics.data.time_window import TimeWindow
from inverse_dynamics.errors import EvaluationError, InvalidParameterError
from inverse_dynamics.evaluation.evaluation import Evaluation, evaluate
from inverse_dynamics.robot.descriptions import read_description
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

_GAP = 2.5  # periods; a lost message is none
_LONGEST_PERIOD = 0.02  # s, unless samples are further apart


@dataclass(frozen=True)
class Contact:
    """One contact. Times: s since the first sample."""

    begin: float
    end: float
    joint: str  # whose torque is the greatest of its threshold
    unit: str
    torque: float  # its greatest, N m (prismatic N), with its sign
    torque_time: float
    force: float | None = None  # N, the greatest at the tip; None: the solver knows no tip
    force_direction: tuple[float, float, float] | None = None  # then, in the axes of the root
    unseen: int | None = None  # how many directions of a wrench couldn't be told then


@dataclass(frozen=True)
class Contacts:
    """External torques of a recording and its contacts. N samples, n joints; order of the chain.

    All is what the robot exerts on its surroundings.
    """

    evaluation: Evaluation
    estimator: str  # name of its class
    gain: float  # 1/s
    quiet: str  # where the thresholds are from, in words
    time: Floats  # (N,) s
    torques: Floats  # (N, n) N m
    valid: Mask  # (N,) whether they are an estimate
    contact: Mask  # (N,)
    wrenches: Floats | None  # (N, 6) N, N m about the tip, in the axes of the root
    unseen: Integers | None  # (N,) how many directions of a wrench can't be told
    thresholds: ContactThresholds
    contacts: tuple[Contact, ...]
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

    quiet: from, to [s] of a part without contact; quiet_recording: one that has none. One of them
    must be given; both: that part of that recording. false_alarms: per hour. gain: 1/s; tracking:
    rad/s; friction_band: N m, one for each joint, or one for all; measured_velocities: recorded
    velocities instead of tracked positions. options: others of evaluate().

    Raises UserError: those of evaluate(), InvalidParameterError.
    """
    if quiet is None and quiet_recording is None:
        raise EvaluationError(
            "contacts: which part of the recording is without contact? give --quiet FROM,TO [s], or "
            "--quiet-recording"
        )
    if quiet is not None:
        TimeWindow(*quiet)  # refused before anything is read
    evaluation = evaluate(bag, robot, progress=progress, **options)
    solver = _solver_of(evaluation)
    chosen = _Chosen(solver, gain, tracking, tuple(friction_band), measured_velocities)
    estimates = _estimate(evaluation, chosen)
    if quiet_recording is not None:
        without = _estimate(evaluate(quiet_recording, robot, progress=progress, **options), chosen)
    else:
        without = estimates
    where, thresholds = _thresholds(without, quiet, solver, false_alarms)
    time, torques = estimates.time, estimates.torques
    wrenches, unseen, notes = _wrenches(solver, estimates, thresholds)
    found = Contacts(
        evaluation=evaluation,
        estimator=chosen.kind.__name__,
        gain=gain,
        quiet=where,
        time=time,
        torques=torques,
        valid=estimates.valid,
        contact=ContactDetector(thresholds.torques, solver.joint_names).run(time, torques),
        wrenches=wrenches,
        unseen=unseen,
        thresholds=thresholds,
        contacts=(),
        notes=(*evaluation.notes, *notes),
    )
    return replace(found, contacts=_contacts(found))


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


def _solver_of(evaluation: Evaluation) -> Solver:
    urdf = evaluation.robot.urdf
    return open_solver(evaluation.robot, "" if urdf is None else read_description(urdf))


def _estimate(evaluation: Evaluation, chosen: _Chosen) -> _Estimates:
    """Of samples that are later than those before them and don't repeat them."""
    used = ~(evaluation.samples.repeated | evaluation.samples.non_increasing)
    time, log = evaluation.time[used], evaluation.log
    n, band = len(evaluation.joint_names), chosen.friction_band
    measured = chosen.measured_velocities
    options = EstimatorOptions(
        np.full(n, chosen.gain),
        velocity=VelocitySource.MEASURED if measured else VelocitySource.POSITIONS,
        tracking=chosen.tracking,
        compensated=Compensated(gravity=evaluation.effort.meaning == "torque_without_gravity"),
        friction_band=band * n if len(band) == 1 else band,
        longest_period=max(_LONGEST_PERIOD, _GAP * _period(time)),
    )
    qd = log.qd[used] if measured else None
    estimator = chosen.kind(chosen.solver, options)
    torques, valid = estimator.run(time, log.q[used], evaluation.measured[used], qd)
    if not valid.any():
        raise EvaluationError(
            f"{evaluation.bag}: expected samples close enough to estimate external torques, got "
            f"{len(time)}, {_period(time):.3g} s apart; take a longer recording"
        )
    return _Estimates(evaluation, time, log.q[used], torques, valid)


def _period(time: Floats) -> float:
    return float(np.median(np.diff(time))) if len(time) > 1 else _LONGEST_PERIOD


def _thresholds(
    estimates: _Estimates, quiet: tuple[float, float] | None, solver: Solver, false_alarms: float
) -> tuple[str, ContactThresholds]:
    """Where from, in words, and the thresholds."""
    where, chosen, time = f"{estimates.evaluation.bag}", estimates.valid, estimates.time
    if quiet is not None:
        where += f", {TimeWindow(*quiet)}"
        chosen = chosen & (time >= quiet[0]) & (time <= quiet[1])
        if not chosen.any():
            raise EvaluationError(
                f"{where}: expected a part of the recording, which ends at {time[-1]:.4g} s, got no "
                "sample; give another --quiet FROM,TO"
            )
    try:
        torques = estimates.torques[chosen]
        return where, contact_thresholds(torques, _period(time), false_alarms, solver.joint_names)
    except InvalidParameterError as error:
        raise InvalidParameterError(f"{where}: {error}") from None


def _wrenches(
    solver: Solver, estimates: _Estimates, thresholds: ContactThresholds
) -> tuple[Floats | None, Integers | None, tuple[str, ...]]:
    try:
        tip = TipWrench(solver, thresholds.noise)
    except InvalidParameterError as error:
        return None, None, (f"no wrench at the tip: {error}",)
    return *tip.run(estimates.q, estimates.torques), ()


def _contacts(found: Contacts) -> tuple[Contact, ...]:
    marked = np.concatenate([[False], found.contact, [False]]).astype(int)
    edges = np.flatnonzero(np.diff(marked)).reshape(-1, 2)
    return tuple(_contact(found, int(first), int(after)) for first, after in edges)


def _contact(found: Contacts, first: int, after: int) -> Contact:
    """That of the samples first to after - 1."""
    part = found.torques[first:after]
    row, j = np.unravel_index(np.abs(part / found.thresholds.torques).argmax(), part.shape)
    contact = Contact(
        begin=float(found.time[first]),
        end=float(found.time[after - 1]),
        joint=found.evaluation.joint_names[j],
        unit=found.evaluation.units[j],
        torque=float(part[row, j]),
        torque_time=float(found.time[first + row]),
    )
    if found.wrenches is None or found.unseen is None:
        return contact
    forces = found.wrenches[first:after, :3]
    sizes = np.linalg.norm(forces, axis=1)
    most = int(sizes.argmax())
    x, y, z = (float(c) for c in forces[most] / max(sizes[most], 1e-300))
    return replace(
        contact,
        force=float(sizes[most]),
        force_direction=(x, y, z),
        unseen=int(found.unseen[first + most]),
    )

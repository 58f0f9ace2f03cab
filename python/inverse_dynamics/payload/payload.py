# SPDX-License-Identifier: Apache-2.0
"""What a robot carries: mass, center of mass and inertia from a few seconds of motion.

    found = estimate_payload("recording", "ur10_real", empty="recording_without_load")
    print(found.estimate.mass, found.estimate.mass_half_width)

The estimator is that of the C++ package inverse_dynamics_identification: see docs/payload.md. The load is
stated in the tip frame, in addition to the payload of the run configuration.
"""

from __future__ import annotations

import math
import warnings
from copy import copy
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import PayloadEstimator, PayloadOptions, PayloadStatus, residual_noise
from inverse_dynamics.arguments import checked
from inverse_dynamics.errors import EvaluationError
from inverse_dynamics.evaluation.evaluation import (
    CAUSE,
    Evaluation,
    evaluate,
    torques_with_gravity,
)
from inverse_dynamics.evaluation.run import RunOptions
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.payload.figure import payload_figure
from inverse_dynamics.payload.files import yaml_text
from inverse_dynamics.payload.page import payload_page
from inverse_dynamics.payload.tables import payload_lines, payload_numbers
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.model_errors import read_uncertainty
from inverse_dynamics.robots.robots import RIGID_BODY
from inverse_dynamics.robots.solvers import brings_own_model
from inverse_dynamics.show.result import ResultFiles
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from typing import Any

    from typing_extensions import Unpack

    from inverse_dynamics._core import ArmUncertainty, PayloadEstimate, ResidualNoise, Solver
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Recorded
    from inverse_dynamics.robots.robots import Robot

_ALLOWED = ("payload", "tool", "mass", "friction", "drift")  # causes of errors beside a load

NAME = "estimated load"  # of the body among the solver's payloads

_BLOCK = 0.8  # s, of the mean torques of an empty run
_LEAST_MOTION = 2.0  # s
_MOVING = 0.02  # rad/s (m/s)
_MOST_ROUNDS = 8
_SETTLED = 1e-3  # of the half widths
_WORST_CENTER = 0.1  # m: half width of a center of mass that isn't known
_ROUNDING = 1e-9  # of a variance that a projection has removed
_PICOMETRES = 12  # digits: less is rounding
_NO_LOAD = 1e-3  # of the weight at 1 m: the direction is known to a mm in some m
_LEAST_SHARE = 0.02  # of a joint's noise: offsets are no more certain
_MOST_UNEXPLAINED = 0.5  # of what the torques of a joint vary by
_LEAST_VARIATION = 0.1  # of the largest torques: of joints that this is asked of


class PayloadError(EvaluationError):
    """A recording that doesn't determine a payload: the text states why, and the remedy."""


@dataclass(frozen=True)
class Fit:
    """An estimate, with intervals of 95 %, and the residuals before and after it, (N, n) N m.

    Measured minus computed torques, without the load, and with it and the offsets.
    """

    estimate: PayloadEstimate
    noise: ResidualNoise
    rounds: int  # until a friction that grows with load was settled
    before: Floats
    after: Floats


@dataclass(frozen=True, repr=False)
class Payload(ResultFiles, Fit):
    """What was found. N samples, n joints; order of the chain."""

    names = ("{stem}.json", "{stem}.html", "{stem}.{figure}")
    reader = ""
    numbers, lines, plot, page = payload_numbers, payload_lines, payload_figure, payload_page

    evaluation: Evaluation
    empty: Path | None
    time: Floats  # (N,) s
    notes: tuple[str, ...]
    # (k, 3) orthonormal: directions of the tip frame in which a load may lie anywhere, as no joint bears it
    idle: Floats = field(default_factory=lambda: np.empty((0, 3)))

    def inputs(self) -> tuple[Path | None, ...]:
        """The recordings and the robot's files."""
        return self.evaluation.bag, self.empty, *self.evaluation.robot.files

    def texts(self, files: Sequence[Path]) -> tuple[str, ...]:
        """For --payload; all numbers; the page."""
        return yaml_text(self), json_text(self.numbers()), self.page()

    @property
    def frame(self) -> str:
        """Which one the tip frame is, in words."""
        robot = self.evaluation.robot
        if brings_own_model(robot) or robot.model is not None:
            return f"`tip` of the model {robot.plugin if robot.model is None else robot.model.name}"
        return f"link {self.evaluation.arm.solver.tip}"

    @property
    def center_of_mass(self) -> Floats:
        """(3,) m in the tip frame; zero along `idle`."""
        center = self.estimate.center_of_mass
        if len(self.idle):
            center = np.round(center - self.idle.T @ (self.idle @ center), _PICOMETRES) + 0.0
        return np.asarray(center)

    @property
    def center_of_mass_half_width(self) -> Floats:
        """(3,) m, without what is unknown along `idle`; NaN where nothing is known."""
        return _center_half_width(self.estimate, self.idle)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The n joints."""
        return self.evaluation.joint_names

    @property
    def rmse_before(self) -> Floats:
        """(n,) N m (prismatic N)."""
        return _rms(self.before)

    @property
    def rmse_after(self) -> Floats:
        """(n,) N m (prismatic N)."""
        return _rms(self.after)


@dataclass(frozen=True)
class Samples:
    """Motion and torques of a loaded arm. (N,) s; (N, n) rad, rad/s, rad/s^2, N m."""

    time: Floats
    q: Floats
    qd: Floats
    qdd: Floats
    measured: Floats

    @property
    def motion(self) -> tuple[Floats, Floats, Floats]:
        """q, qd, qdd."""
        return self.q, self.qd, self.qdd

    def residual(self, solver: Solver) -> Floats:
        """(N, n) measured minus computed torques, with what friction remembers of these samples."""
        remembered = solver.friction_state().along(self.q, self.qd)
        return self.measured - solver.torques(*self.motion) - remembered


@checked
def estimate_payload(
    bag: Recorded,
    robot: Robot | Solver | Path | str | None = None,
    *,
    empty: Recorded | None = None,
    progress: Progress = no_progress,
    **options: Unpack[RunOptions],
) -> Payload:
    """Estimate what the robot carries in a recording.

    Parameters
    ----------
    bag, robot, **options
        As evaluate() takes them.
    empty
        A recording of the same robot without the load: its torques tell offsets and noise.

    Raises
    ------
    UserError
        Those of evaluate(), PayloadError.

    Examples
    --------
    >>> import numpy as np
    >>> from inverse_dynamics import Solver, estimate_payload
    >>> t = np.linspace(0, 10, 1001)
    >>> phase = t[:, None] + np.arange(6)
    >>> q, qd = np.sin(phase), np.cos(phase)
    >>> arm = Solver("ur10_simulated")
    >>> arm.set_payload("load", 3.0)  # kg
    >>> table = {"time": t, "q": q, "qd": qd, "effort": arm.torques(q, qd, -q)}
    >>> round(estimate_payload(table, "ur10_simulated").estimate.mass, 1)
    3.0
    """
    evaluation = evaluate(bag, robot, progress=progress, **options)
    if evaluation.arm.guess:
        raise PayloadError(
            f"{evaluation.bag}: no load can be told from masses that are guesses: {evaluation.arm.guess}"
        )
    _require_own_tip(evaluation.robot, evaluation.robot.tip if options.get("tip") else None)
    _require_plausible(evaluation)
    solver = copy(evaluation.arm.solver)  # one that may carry a load
    arm, told = _arm_of(evaluation.robot)
    alone, phantom = None, []
    if empty is not None:
        without = evaluate(empty, robot, progress=progress, **options)
        _require_plausible(without)
        if evaluation.accelerations.by_efforts:  # which the model without the load doesn't explain
            options["cutoff"] = without.accelerations.cutoff
            evaluation = evaluate(bag, robot, progress=progress, **options)
        unloaded = samples_of(without)
        alone = empty_run(unloaded, solver)
        _require_motion(unloaded, str(without.bag), "without the load")
        phantom = _phantom(fit_payload(unloaded, solver, arm=arm, where=str(without.bag)))
    samples = samples_of(evaluation)
    where = str(evaluation.bag)
    _require_motion(samples, where)
    found = fit_payload(samples, solver, alone, arm, where)
    idle = _idle_directions(found.estimate, solver)
    _check(found, samples, evaluation, idle, solver)
    return Payload(
        **vars(found),
        evaluation=evaluation,
        empty=None if empty is None else without.bag,
        time=samples.time,
        notes=(
            *(note for note in evaluation.notes if not note.startswith(CAUSE)),
            *told,
            *phantom,
            *_notes(found, evaluation, idle, solver),
        ),
        idle=idle,
    )


def samples_of(evaluation: Evaluation) -> Samples:
    """Those without a fault, in ascending time."""
    kept, log = evaluation.samples.kept, evaluation.log
    measured = torques_with_gravity(evaluation)[kept]
    return Samples(evaluation.time[kept], log.q[kept], log.qd[kept], evaluation.qdd[kept], measured)


def empty_run(samples: Samples, solver: Solver) -> PayloadOptions:
    """Offsets and noise of an arm that carries nothing: mean of measured minus computed, its deviation."""
    residual = samples.residual(solver)
    offset = residual.mean(axis=0)
    noise = residual_noise(samples.time, residual - offset)
    blocks = np.floor((samples.time - samples.time[0]) / _BLOCK).astype(int)
    means = [residual[blocks == block].mean(axis=0) for block in np.unique(blocks)]
    deviation = _rms(residual - offset)
    if len(means) > 1:
        deviation = np.std(means, axis=0, ddof=1) / math.sqrt(len(means))
    least = _LEAST_SHARE * np.hypot(noise.white, noise.correlated)
    return PayloadOptions(noise, offset=offset, offset_deviation=np.maximum(deviation, least))


def fit_payload(
    samples: Samples,
    solver: Solver,
    empty: PayloadOptions | None = None,
    arm: ArmUncertainty | None = None,
    where: str = "payload",
) -> Fit:
    """Estimate the body at the tip of the solver's robot, which is as before when this returns.

    Torques and estimate are computed in turns: friction may grow with the load. empty: as empty_run() gives it.
    arm: what the solver's model may be wrong by. where: of errors. Raises PayloadError.
    """
    before = samples.residual(solver)
    if empty is None:
        options = PayloadOptions(residual_noise(samples.time, before - before.mean(axis=0)))
    else:
        options = PayloadOptions(
            empty.noise, offset=empty.offset, offset_deviation=empty.offset_deviation
        )
    if arm is not None:
        options.arm = arm
    found, rounds, settled = _round(samples, solver, options, where), 1, False
    try:
        after = _carry(samples, solver, found) - found.offset
        while not settled and rounds < _MOST_ROUNDS:
            if empty is None:
                of_arm = 0.0 if arm is None else arm.torques(solver, found.arm, samples.motion)
                options.noise = residual_noise(samples.time, after - of_arm)
            last = found
            options.carried = solver.payloads[NAME]
            found = _round(samples, solver, options, where)
            after = _carry(samples, solver, found) - found.offset
            settled, rounds = _settled(last, found), rounds + 1
    finally:
        solver.remove_payload(NAME)
    return Fit(found, options.noise, rounds, before, after)


def _round(
    samples: Samples, solver: Solver, options: PayloadOptions, where: str
) -> PayloadEstimate:
    estimator = PayloadEstimator(solver, options)
    estimator.run(samples.time, samples.motion, samples.measured)
    found, status = estimator.estimate()
    if status == PayloadStatus.TOO_SHORT:
        duration = samples.time[-1] - samples.time[0] if len(samples.time) else 0.0
        raise PayloadError(
            f"{where}: expected at least {_LEAST_MOTION:g} s of motion with the load, got "
            f"{duration:.2g} s; record a few seconds, better ten"
        )
    if status != PayloadStatus.OK:
        raise PayloadError(f"{where}: {status.text}; look at the recording with `ids evaluate`")
    return found


def _carry(samples: Samples, solver: Solver, found: PayloadEstimate) -> Floats:
    """Measured minus computed torques of an arm with the body."""
    inertia = found.inertia if found.inertia_is_known else np.zeros((3, 3))
    with warnings.catch_warnings():  # what is carried is checked at the end
        warnings.simplefilter("ignore", UserWarning)
        solver.set_payload(NAME, found.mass, center_of_mass=found.center_of_mass, inertia=inertia)
    return samples.residual(solver)


def _idle_directions(found: PayloadEstimate, solver: Solver) -> Floats:
    """(k, 3) uncertain directions along which a load could be moved without a change of any torque.

    Of a SCARA, whose joint axes are parallel to gravity: along them.
    """
    variances, directions = np.linalg.eigh(_center_covariance(found))
    wide = directions.T[1.96 * np.sqrt(np.maximum(variances, 0.0)) > _WORST_CENTER]
    return np.array([v for v in wide if not _bears(solver, v)]).reshape(-1, 3)


def _bears(solver: Solver, direction: Floats, inertia: float = 0.0, speed: float = 1.0) -> bool:
    """Whether torques show it where 1 kg at the tip is moved by 1 m, and given an inertia [kg m^2]."""
    states = np.random.default_rng(0).standard_normal((3, 50, len(solver.joint_names)))
    states[1:] *= speed
    torques = []
    try:
        for share in (0.0, 1.0):
            moment = share * inertia * np.eye(3)
            solver.set_payload(NAME, 1.0, center_of_mass=share * direction, inertia=moment)
            torques.append(solver.torques(*states))
    finally:
        solver.remove_payload(NAME)
    return bool(np.abs(torques[1] - torques[0]).max() > _NO_LOAD * 9.81)


def _center_covariance(found: PayloadEstimate) -> Floats:
    return np.asarray(found.covariance[1:4, 1:4] / found.mass**2)


def _center_half_width(found: PayloadEstimate, idle: Floats) -> Floats:
    covariance = _center_covariance(found)
    seen = np.eye(3) - idle.T @ idle
    share = np.diag(seen @ covariance @ seen) / np.maximum(np.diag(covariance), 1e-300)
    width: Floats = found.center_of_mass_half_width * np.sqrt(np.maximum(share, 0.0))
    width[share < _ROUNDING] = np.nan
    return width


def _settled(last: PayloadEstimate, found: PayloadEstimate) -> bool:
    change = np.append(found.center_of_mass - last.center_of_mass, found.mass - last.mass)
    width = np.append(found.center_of_mass_half_width, found.mass_half_width)
    return bool(np.all(np.abs(change) <= _SETTLED * width))


def _arm_of(robot: Robot) -> tuple[ArmUncertainty | None, list[str]]:
    """The uncertainty of the model, and a note where it is unknown."""
    if robot.model is None or robot.plugin != RIGID_BODY or not robot.friction:
        return None, []
    arm, why = read_uncertainty(robot.model)
    if arm is not None:
        return arm, []
    return None, [
        f"what the model of the arm is wrong by isn't estimated with the load ({why}); `ids identify` "
        "writes it beside its models"
    ]


def _rms(values: Floats) -> Floats:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))


def _require_own_tip(robot: Robot, tip: str | None) -> None:
    if tip is None or (robot.model is None and not brings_own_model(robot)):
        return
    raise PayloadError(
        f"--tip {tip}: the model of {robot.name} states its tip itself, and the load is found in that frame; "
        "leave --tip out, or compute from a description: --urdf"
    )


def _require_plausible(evaluation: Evaluation) -> None:
    others = [cause for cause in evaluation.diagnosis if cause.kind not in _ALLOWED]
    rivals = [cause for cause in evaluation.diagnosis if cause.rival]
    certain = any(not cause.rival for cause in others)
    if certain or (rivals and all(cause in others for cause in rivals)):
        why = "; ".join(cause.text for cause in others)
        raise PayloadError(f"{evaluation.bag}: no load can be estimated: {why}")


def _require_motion(samples: Samples, where: str, load: str = "with the load") -> None:
    if len(samples.time) < 2:
        raise PayloadError(f"{where}: expected samples, got {len(samples.time)}; record a motion")
    moving = np.any(np.abs(samples.qd) > _MOVING, axis=1)
    steps = np.diff(samples.time)
    motion = float(np.sum(np.minimum(steps, 10 * np.median(steps))[moving[1:]]))
    if motion < _LEAST_MOTION:
        raise PayloadError(
            f"{where}: expected at least {_LEAST_MOTION:g} s of motion {load}, got {motion:.2g} s "
            f"with a joint faster than {_MOVING:g} rad/s; move all joints for a few seconds, the wrist "
            "above all"
        )


def _check(
    found: Fit, samples: Samples, evaluation: Evaluation, idle: Floats, solver: Solver
) -> None:
    """Refuse what isn't an estimate of a load."""
    where, estimate = evaluation.bag, found.estimate
    varies, left = samples.measured.std(axis=0), found.after.std(axis=0)
    loaded = varies > _LEAST_VARIATION * _rms(samples.measured).max()
    bad = loaded & (left > _MOST_UNEXPLAINED * varies)
    if bad.any():
        names = listed(np.array(evaluation.joint_names)[bad].tolist())
        raise PayloadError(
            f"{where}: no body at the tip explains the torques of {names}: more than half of what "
            "they vary by is left; the model lacks friction, isn't this robot's, or efforts mean something else: look "
            "at `ids evaluate` of a recording without load, and at docs/why_dont_my_torques_match.md"
        )
    mass, half = estimate.mass, estimate.mass_half_width
    if half >= mass:
        raise PayloadError(
            f"{where}: no load is found: {mass:.3g} kg with a 95 % interval of +- {half:.2g} kg, which "
            "holds zero; the robot carries nothing, or too little for this motion: move the joints that bear "
            "most of it further and longer, and give --empty"
        )
    widths = _center_half_width(estimate, idle)
    wide = np.flatnonzero(widths > _WORST_CENTER)
    if len(wide):
        axes = listed([f"{'xyz'[i]} (+- {1e3 * widths[i]:.0f} mm)" for i in wide])
        why = (
            "gravity hardly loads the wrist in these poses; turn the wrist so that each of its axes is horizontal "
            "for some time"
        )
        if not any(_bears(solver, np.eye(3)[i], speed=0.0) for i in wide):
            why = "gravity never shows it, accelerations do: turn the joints next to the tip faster and longer"
        raise PayloadError(
            f"{where}: mass {mass:.3g} +- {half:.2g} kg, but its position is uncertain along {axes} of the tip "
            f"frame: {why}"
        )


def _phantom(found: Fit) -> list[str]:
    """The load found in a recording without one: an error of the model, in words."""
    mass, half = found.estimate.mass, found.estimate.mass_half_width
    if mass <= half:
        return []
    return [
        f"without the load {mass:.2g} +- {half:.2g} kg are found: the model of the arm is wrong by about "
        "as much, which the intervals don't include; a tool that it doesn't have, or friction"
    ]


def _notes(found: Fit, evaluation: Evaluation, idle: Floats, solver: Solver) -> list[str]:
    notes = []
    if len(idle):
        along = "" if len(idle) == 3 else f" along {listed([_vector(v) for v in idle])}"
        notes.append(
            f"the torques don't depend on the load's position{along} in the tip frame, where it is written as 0"
        )
    if evaluation.effort.meaning == "torque_without_gravity":
        notes.append(
            "efforts lack gravity: the load must not be set in the robot (or as before this recording), else "
            "its weight isn't in them, and the estimate is wrong"
        )
    if "payload.mass" in evaluation.robot.parameters:
        notes.append(
            "the load comes on top of the `payload` of the run configuration, which another one without a name "
            "would replace: give that one a name, as `payload: {tool: {mass: ...}}`"
        )
    if not found.estimate.inertia_is_known:
        notes.append(
            "the inertia isn't determined by the data, so the load is written as a point mass; faster motion of "
            "the wrist, or a heavier load, would determine it"
            if _bears(solver, np.zeros(3), inertia=1.0)
            else "the torques don't depend on the load's inertia, as no joint turns it: it is written as a point mass"
        )
    if not evaluation.robot.friction:
        notes.append(
            "friction is left out: where the robot has friction, mass and center are wrong by more than "
            "their intervals"
        )
    return notes


def _vector(direction: Floats) -> str:
    return f"({', '.join(f'{x:.3g}' for x in np.round(direction, 3) + 0.0)})"


def with_load(samples: Samples, solver: Solver, load: dict[str, Any]) -> Samples:
    """The same motion with a simulated load: a body as set_payload() takes it.

    The torques that the load adds by the solver's model, friction that grows with load included, are
    put on top of the measured ones: what is wrong with the model stays as it was.
    """
    alone = solver.torques(*samples.motion)
    solver.set_payload(NAME, **load)
    try:
        loaded = solver.torques(*samples.motion)
    finally:
        solver.remove_payload(NAME)
    return replace(samples, measured=samples.measured + loaded - alone)

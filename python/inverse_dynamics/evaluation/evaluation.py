# SPDX-License-Identifier: Apache-2.0
"""From a recording to computed torques and their errors.

result = evaluate("recording", "ur10_real")
for error in result.errors:
    print(error.joint, error.rmse, error.unit)
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import Accelerations, Effort, JointError, joint_errors
from inverse_dynamics.arguments import checked
from inverse_dynamics.diagnosis.arm import arm_model
from inverse_dynamics.diagnosis.compare import Cause, compare, meaning_of_efforts
from inverse_dynamics.diagnosis.samples import pieces_of
from inverse_dynamics.evaluation.accelerations import MASKS, Samples
from inverse_dynamics.evaluation.bands import read_band
from inverse_dynamics.evaluation.posture import posture_of
from inverse_dynamics.evaluation.seen_range import outside_of_seen
from inverse_dynamics.evaluation.views import Views
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.bags import topics_of
from inverse_dynamics.recordings.joint_log import JointLog, check_clock
from inverse_dynamics.recordings.log_format import LogFormat
from inverse_dynamics.recordings.recordings import open_motion
from inverse_dynamics.recordings.time_window import TimeWindow
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.dh_tables import guess_notes
from inverse_dynamics.robots.robots import Robot, load_robot, with_changes
from inverse_dynamics.robots.solvers import description_notes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics._core import Evaluated, Verdict
    from inverse_dynamics.arrays import DataFrame, Floats, Parameter
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.bags import JointStateTopic
    from inverse_dynamics.recordings.joint_log import Clock

__all__ = ["Evaluation", "JointError", "check_options", "evaluate", "joint_errors"]

CAUSE = "likely cause of the error: "
"""Prefix of the note that states a diagnosis."""


@dataclass(frozen=True, repr=False)
class Evaluation(Views):
    """Measured and computed torques of a recorded motion. N samples, n joints; order of the chain.

    robot: the run configuration with everything that was overridden; joints and effort filled in.

    Examples
    --------
    >>> import numpy as np
    >>> from inverse_dynamics import evaluate
    >>> still = {"time": np.arange(100) / 100, "q": np.zeros((100, 6)), "effort": np.zeros((100, 6))}
    >>> result = evaluate(still, "ur10_simulated", accelerations="backward-difference")
    >>> [error.joint for error in result.errors if error.rmse > 50]  # N m: the arm is stretched out
    ['shoulder_lift_joint']
    """

    robot: Robot
    bag: Path
    log: JointLog  # its efforts are as recorded
    joint_names: tuple[str, ...]  # those of the solver; the recording's are log.joint_names
    units: tuple[str, ...]
    accelerations: Accelerations
    samples: Samples
    time: Floats  # (N,) s since the first sample
    qdd: Floats  # (N, n) rad/s^2 or m/s^2
    measured: Floats  # (N, n) N m or N: the torques that recorded efforts mean
    computed: Floats  # (N, n) N m or N; without gravity if the efforts are
    errors: tuple[JointError, ...]  # over all samples
    errors_of_kept: tuple[JointError, ...]  # over samples.kept, the valid samples
    effort: Effort = field(default_factory=Effort)  # what recorded efforts mean
    notes: tuple[str, ...] = ()  # what was left out or assumed, in words
    diagnosis: tuple[
        Cause, ...
    ] = ()  # likely causes of the errors, the last one of the notes; not in files
    joint_types: tuple[str, ...] = ()  # as Solver.joint_types; not in files
    band: Floats | None = None  # (N, n) half the width of the model's 95 % band; None: not known

    @property
    def coverage(self) -> Floats | None:
        """(n,) share of the valid samples within the 95 % band; None: the model has none."""
        if self.band is None:
            return None
        kept = self.samples.kept
        within = [
            np.count_nonzero(np.abs(computed - measured)[kept] <= band[kept])
            for computed, measured, band in zip(
                self.computed.T, self.measured.T, self.band.T, strict=True
            )
        ]
        return np.array(within) / np.count_nonzero(kept)

    @property
    def notes_without_causes(self) -> tuple[str, ...]:
        """Those that say nothing of the causes of errors."""
        return tuple(note for note in self.notes if not note.startswith(CAUSE))

    @property
    def mean_rmse(self) -> float:
        """Mean over the joints of the root mean square errors."""
        return sum(e.rmse for e in self.errors) / len(self.errors)


@checked
def evaluate(
    bag: Path | str | Mapping[str, Any] | DataFrame,
    robot: Robot | Path | str,
    *,
    plugin: str | None = None,
    friction: bool | None = None,
    urdf: Path | str | None = None,
    root: str | None = None,
    tip: str | None = None,
    gravity: tuple[float, float, float] | None = None,
    topic: str | None = None,
    joints: Sequence[str] | None = None,
    parameters: Mapping[str, Parameter] | None = None,
    effort_is: str | None = None,
    accelerations: str | None = None,
    cutoff: float | None = None,
    drive_gains: Sequence[float] | None = None,
    columns: str | None = None,
    scale: Sequence[str] | None = None,
    sign: Sequence[float] | None = None,
    rate: float | None = None,
    gears: Sequence[float] | None = None,
    clock: Clock = "auto",
    start: float | None = None,
    end: float | None = None,
    without_rules: Sequence[str] = (),
    progress: Progress = no_progress,
    scratch: Path | str | None = None,
) -> Evaluation:
    """Compute the torques of a recorded motion and compare them with the measured ones.

    Parameters
    ----------
    bag
        A recording or a table, see recordings.py; or arrays by name, (N,) or (N, n), or a table of pandas
        or polars, with columns as docs/tables.md has them.
    robot
        A name of robot_names(), the file of a run configuration, or one that is loaded. What else is
        given replaces what the configuration says, see Robot; parameters, of the solver, one by one.
    effort_is
        What recorded efforts mean, one of EFFORT_CHOICES.
    drive_gains
        N m/A (prismatic N/A) of efforts that are currents.
    columns, scale, sign, rate, gears
        What the names of a table's columns don't say, see log_format.LogFormat.
    accelerations, cutoff
        One of accelerations.METHODS; Hz, of a low-pass.
    clock
        Which stamps are the time.
    start, end
        s since the first sample; the others aren't evaluated.
    without_rules
        Those of accelerations.RULES not to be acted upon.
    scratch
        Directory for unnamed files that hold the arrays of a recording that needn't fit into memory.

    Raises
    ------
    UserError
        BagError, RobotError, SolverError, EvaluationError.

    Examples
    --------
    >>> import numpy as np
    >>> from inverse_dynamics import Solver, evaluate
    >>> t = np.linspace(0, 10, 1001)
    >>> phase = t[:, None] + np.arange(6)
    >>> q, qd = np.sin(phase), np.cos(phase)
    >>> tau = Solver("ur10_simulated").torques(q, qd, -q)
    >>> result = evaluate({"time": t, "q": q, "qd": qd, "effort": tau}, "ur10_simulated")
    >>> result.mean_rmse < 0.5  # N m
    True
    """
    if not isinstance(robot, Robot):
        robot = load_robot(robot)
    robot = with_changes(
        robot,
        plugin=plugin,
        friction=friction,
        urdf=None if urdf is None else Path(urdf),
        root=root,
        tip=tip,
        gravity=gravity,
        topic=topic,
        joints=None if joints is None else tuple(joints),
        parameters=parameters,
        accelerations=accelerations,
        cutoff=cutoff,
        drive_gains=drive_gains,
        columns=columns,
        scale=scale,
        sign=sign,
        rate=rate,
        gears=gears,
    )
    source = Path(bag) if isinstance(bag, str) else bag
    bag = source if isinstance(source, Path) else Path("arrays")
    window = TimeWindow(start, end)

    arm = Arm(robot)
    posture = posture_of(source, robot, arm.description, arm.joint_names, topic=topic)
    if posture.parameters:
        robot = replace(robot, parameters={**robot.parameters, **posture.parameters})
        arm = Arm(robot)
    motion = open_motion(
        source,
        arm.recorded_names,
        topic=topic or "",
        usual_topic=robot.topic,
        clock=clock,
        form=LogFormat.of(robot),
        progress=progress,
    )
    if isinstance(motion, JointLog):
        motion = window.of(motion, f"{bag}")
    result = _compare(
        bag,
        arm,
        motion,
        clock=clock,
        window=window,
        effort_is=effort_is,
        without_rules=without_rules,
        progress=progress,
        scratch="" if scratch is None else scratch,
    )
    notes = (
        *window.notes,
        *_topic_notes(bag, motion, topic or robot.topic),
        *posture.notes,
        *(guess_notes(robot.urdf) if robot.urdf is not None else ()),
        *(description_notes(robot, "drawing") if urdf is not None else ()),
    )
    result = _with_band(replace(result, notes=(*notes, *result.notes)), arm)
    return result if posture.moves else _with_causes(result, arm)


def _with_band(result: Evaluation, arm: Arm) -> Evaluation:
    """The same with the band of the robot's model, and a note where the motion leaves the model's range."""
    states = (result.log.q, result.log.qd, result.qdd)
    outside = outside_of_seen(
        arm.solver.seen,
        states,
        result.samples.kept,
        arm.joint_names,
        arm.units,
        types=result.joint_types,
    )
    band, other = read_band(arm.robot.model, arm.solver)
    return replace(
        result,
        notes=(*result.notes, *filter(None, [outside, other])),
        band=None if band is None else band.of_recording(arm.solver, *states),
    )


def _with_causes(result: Evaluation, arm: Arm) -> Evaluation:
    """The same with the likely causes of its errors."""
    without_gravity = result.effort.meaning == "torque_without_gravity"
    states = (result.log.q, result.log.qd, result.qdd)
    found = compare(
        pieces_of(arm.joint_names, result.time, states, result.measured, result.samples.kept),
        arm_model(arm, without_gravity=without_gravity),
    )
    result = replace(result, effort=found.doubting(result.effort), diagnosis=found.causes)
    if not found.text:
        return result
    note = f"{CAUSE}{found.text}" if found.causes else found.text
    others = tuple(other for other in result.notes if found.text not in other)
    return replace(result, notes=(*others, note))


def _topic_notes(bag: Path, motion: JointLog | JointStateTopic, expected: str) -> list[str]:
    """That a recording has its joint states on another topic, where it has just one."""
    if isinstance(motion, JointLog) or motion.topic == expected or "+" in motion.topic:
        return []
    if expected in (topic.name for topic in topics_of(motion.recording)):
        return [f"{expected} lacks joints, efforts or velocities: {motion.topic} is taken"]
    return [f"{bag} has no topic {expected}: its only one of joint states is {motion.topic}"]


def check_options(
    robot: Robot,
    *,
    accelerations: str | None = None,
    cutoff: float | None = None,
    effort_is: str | None = None,
    clock: Clock = "auto",
    start: float | None = None,
    end: float | None = None,
    without_rules: Sequence[str] = (),
    **_others: object,
) -> None:
    """Raise UserError for options of evaluate() that are wrong whatever the recording is."""
    from inverse_dynamics import _core

    changed = with_changes(robot, accelerations=accelerations, cutoff=cutoff)
    _core.check_options(changed.accelerations, changed.cutoff, list(without_rules), effort_is)
    check_clock(clock)
    TimeWindow(start, end)


def torques_with_gravity(evaluation: Evaluation, robot: Robot | None = None) -> Floats:
    """(N, n) measured torques; to efforts without gravity, that of Arm(robot).subtracted is added."""
    if evaluation.effort.meaning != "torque_without_gravity":
        return evaluation.measured
    lacking = Arm(robot or evaluation.robot).subtracted.gravity_vector(evaluation.log.q)
    return evaluation.measured + lacking


def _compare(
    bag: Path,
    arm: Arm,
    motion: JointLog | JointStateTopic,
    *,
    clock: Clock,
    window: TimeWindow,
    effort_is: str | None,
    without_rules: Sequence[str],
    progress: Progress,
    scratch: Path | str,
) -> Evaluation:
    """Computed torques of a motion against its measured ones. Raises EvaluationError, RobotError."""
    from inverse_dynamics import _core

    robot = arm.robot
    if isinstance(motion, JointLog):
        expected, notes = len(motion), motion.notes
    else:
        expected, notes = motion.recording.expected_messages(motion.topic), ()
    effort = _core.effort_options(robot, arm.solver, effort_is, motion.effort_is)

    def ask(found: Evaluated) -> Verdict:
        time, q, qd, qdd, recorded, kept = (
            found.table.series[name] for name in ("time", "q", "qd", "qdd", "effort", "kept")
        )
        samples = pieces_of(arm.joint_names, time, (q, qd, qdd), recorded, kept)
        return meaning_of_efforts(samples, arm_model(arm), effort.drive_gains)

    options = _core.EvaluationOptions(
        joints=list(arm.recorded_names),
        clock=clock,
        window=window.span,
        method=robot.accelerations,
        cutoff=robot.cutoff or 0.0,
        without_rules=list(without_rules),
        effort=effort,
        recording=", ".join(filter(None, (f"{bag}", f"{window}"))),
        topic=motion.topic,
        units=list(arm.units),
        notes=list(notes),
        scratch=scratch,
    )
    found = _core.evaluate(
        arm.solver,
        motion if isinstance(motion, JointLog) else motion.recording,
        options,
        ask,
        lambda share: progress("evaluating", round(share * expected), expected),
        arm.subtracted,
    )
    arrays = found.table.series
    if isinstance(motion, JointLog):
        log = replace(motion, q=arrays["q"])  # continuous joints go on beyond a driver's seam
    else:
        log = motion.log(found.table)
    return Evaluation(
        robot=replace(
            robot, joints=arm.recorded_names, topic=log.topic, effort=found.effort.meaning
        ),
        bag=bag,
        log=log,
        joint_names=arm.joint_names,
        units=arm.units,
        accelerations=found.accelerations,
        samples=Samples(
            **{name: arrays[name] for name in MASKS}, period=found.period, jitter=found.jitter
        ),
        time=arrays["time"],
        qdd=arrays["qdd"],
        measured=arrays["measured"],
        computed=arrays["computed"],
        errors=found.errors(arm.units),
        errors_of_kept=found.errors_of_kept(arm.units),
        effort=found.effort,
        joint_types=arm.solver.joint_types,
        notes=tuple(found.notes),
    )

# SPDX-License-Identifier: Apache-2.0
"""A run: a recorded motion of a robot, opened once. What is done with a recording is a function of it.

run = open_run("recording", "ur10_real", cutoff=5.0)
run.arm.solver.torques(run.log.q, run.log.qd, run.qdd)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, cast

from inverse_dynamics import _core
from inverse_dynamics._core import Solver
from inverse_dynamics.errors import RobotError
from inverse_dynamics.evaluation.posture import Posture, posture_of
from inverse_dynamics.evaluation.samples import MASKS, SampleReport
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.bags import topics_of
from inverse_dynamics.recordings.joint_log import JointLog, check_clock
from inverse_dynamics.recordings.log_format import LogFormat
from inverse_dynamics.recordings.recordings import open_motion
from inverse_dynamics.recordings.time_window import TimeWindow
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import Robot, robot_of, with_changes
from inverse_dynamics.robots.solvers import description_notes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from typing_extensions import Unpack

    from inverse_dynamics._core import Accelerations, Evaluated
    from inverse_dynamics.arrays import Floats, Parameter
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.bags import JointStateTopic
    from inverse_dynamics.recordings.joint_log import Clock, Recorded


ARRAYS = Path("arrays")
"""What a recording without a file is called."""

_OF_SOLVERS = ("plugin", "friction", "urdf", "root", "tip", "gravity", "parameters")


class Overrides(TypedDict, total=False):
    """What replaces entries of a run configuration, see Robot; None: as there.

    parameters: of the solver, one by one. drive_gains: N m/A (prismatic N/A) of efforts that are currents. columns,
    scale, sign, rate, gears: what the names of a table's columns don't say, see log_format.LogFormat.
    accelerations, cutoff: one of METHODS; Hz, of a low-pass.
    """

    plugin: str | None
    friction: bool | None
    urdf: Path | str | None
    root: str | None
    tip: str | Sequence[str] | None
    gravity: tuple[float, float, float] | None
    topic: str | None
    joints: Sequence[str] | None
    parameters: Mapping[str, Parameter] | None
    accelerations: str | None
    cutoff: float | None
    drive_gains: Sequence[float] | None
    columns: str | None
    scale: Sequence[str] | None
    sign: Sequence[float] | None
    rate: float | None
    gears: Sequence[float] | None


class RunOptions(Overrides, total=False):
    """What is said about a recording.

    effort_is: what recorded efforts mean, one of EFFORT_CHOICES. clock: which stamps are the time (auto).
    start, end: s since the first sample; the others aren't read. without_rules: those of RULES not to
    be acted upon.
    """

    effort_is: str | None
    clock: Clock
    start: float | None
    end: float | None
    without_rules: Sequence[str]


@dataclass(frozen=True, repr=False)
class Run:
    """A recorded motion of a robot. N samples, n joints; order of the chain."""

    bag: Path
    arm: Arm  # the robot, with everything that was overridden, and its solver
    log: JointLog  # its efforts are as recorded
    accelerations: Accelerations
    samples: SampleReport
    time: Floats  # (N,) s since the first sample
    qdd: Floats  # (N, n) rad/s^2 or m/s^2
    notes: tuple[str, ...]  # what was left out or assumed in opening, in words
    posture_changes: bool  # joints beside the chain move
    motion: Evaluated  # the same, and what evaluate() needs
    options: _core.EvaluationOptions
    progress: Callable[[float], None]  # told the share that is done


def overridden(robot: Robot | Solver | Path | str | None, options: RunOptions) -> Robot:
    """The run configuration with the entries that options replace. Raises UserError.

    robot: none: the description among the options. Of a Solver nothing is replaced that it was made of.
    """
    given: dict[str, Any] = {k: v for k, v in options.items() if k in Overrides.__annotations__}
    late = [k for k in _OF_SOLVERS if given.get(k) is not None]
    if isinstance(robot, Solver) and late:
        raise RobotError(
            f"{late[0]}: expected none beside a Solver, which is made already; give it to Solver()"
        )
    if (urdf := options.get("urdf")) is not None:
        given["urdf"] = Path(urdf)
    if (joints := options.get("joints")) is not None:
        given["joints"] = tuple(joints)
    return with_changes(robot_of(robot, options.get("urdf")), **given)


def of_run(options: Mapping[str, Any]) -> RunOptions:
    """Those of open_run() among options of which it has some."""
    return cast("RunOptions", {k: v for k, v in options.items() if k in RunOptions.__annotations__})


def of_recording(options: RunOptions) -> RunOptions:
    """Those that say something about a recording, not about the robot."""
    kept = {k: v for k, v in options.items() if k == "topic" or k not in Overrides.__annotations__}
    return cast("RunOptions", kept)


def open_run(
    recording: Recorded,
    robot: Robot | Solver | Path | str | None = None,
    *,
    progress: Progress = no_progress,
    scratch: Path | str = "",
    **options: Unpack[RunOptions],
) -> Run:
    """Read a recording, and make its robot's solver.

    Parameters
    ----------
    recording, robot, scratch, **options
        As evaluate() takes them.

    Raises
    ------
    UserError
        BagError, RobotError, SolverError, EvaluationError.
    """
    solver = robot if isinstance(robot, Solver) else None
    robot = overridden(robot, options)
    topic, clock = options.get("topic"), options.get("clock", "auto")
    source = Path(recording) if isinstance(recording, str) else recording
    bag = source if isinstance(source, Path) else ARRAYS
    window = TimeWindow(options.get("start"), options.get("end"))

    arm, posture = Arm(robot, solver), Posture()
    if solver is None:
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
    core = _core.EvaluationOptions(
        joints=list(arm.recorded_names),
        clock=clock,
        window=window.span,
        method=robot.accelerations,
        cutoff=robot.cutoff or 0.0,
        without_rules=list(options.get("without_rules", ())),
        effort=_core.effort_options(robot, arm.solver, options.get("effort_is"), motion.effort_is),
        recording=", ".join(filter(None, (f"{bag}", f"{window}"))),
        topic=motion.topic,
        units=list(arm.units),
        notes=list(motion.notes),
        scratch=scratch,
    )
    told = _share_of(motion, progress)
    recorded = motion if isinstance(motion, JointLog) else motion.recording
    found = _core.read_motion(arm.solver, recorded, core, told)
    arrays = found.table.series
    return Run(
        bag=bag,
        arm=arm,
        # continuous joints go on beyond a driver's seam
        log=replace(motion, q=arrays["q"])
        if isinstance(motion, JointLog)
        else motion.log(found.table),
        accelerations=found.accelerations,
        samples=SampleReport(
            **{name: arrays[name] for name in MASKS}, period=found.period, jitter=found.jitter
        ),
        time=arrays["time"],
        qdd=arrays["qdd"],
        notes=(
            *window.notes,
            *_topic_notes(bag, motion, topic or robot.topic),
            *posture.notes,
            *filter(None, [arm.guess]),
            *(description_notes(robot, "drawing") if options.get("urdf") is not None else ()),
        ),
        posture_changes=posture.moves,
        motion=found,
        options=core,
        progress=told,
    )


def _share_of(motion: JointLog | JointStateTopic, progress: Progress) -> Callable[[float], None]:
    """What tells the share that is done to a progress of samples."""
    expected = (
        len(motion)
        if isinstance(motion, JointLog)
        else motion.recording.expected_messages(motion.topic)
    )
    return lambda share: progress("evaluating", round(share * expected), expected)


def _topic_notes(bag: Path, motion: JointLog | JointStateTopic, expected: str) -> list[str]:
    """That a recording has its joint states on another topic, where it has just one."""
    if isinstance(motion, JointLog) or motion.topic == expected or "+" in motion.topic:
        return []
    if expected in (topic.name for topic in topics_of(motion.recording)):
        return [f"{expected} lacks joints, efforts or velocities: {motion.topic} is taken"]
    return [f"{bag} has no topic {expected}: its only one of joint states is {motion.topic}"]


def check_options(robot: Robot, options: RunOptions) -> None:
    """Raise UserError for options of open_run() that are wrong whatever the recording is."""
    changed = overridden(robot, options)
    rules = list(options.get("without_rules", ()))
    _core.check_options(changed.accelerations, changed.cutoff, rules, options.get("effort_is"))
    check_clock(options.get("clock", "auto"))
    TimeWindow(options.get("start"), options.get("end"))

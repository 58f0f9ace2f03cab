# SPDX-License-Identifier: Apache-2.0
"""From a recording to computed torques and their errors.

result = evaluate("recording", "ur10_real")
for error in result.errors:
    print(error.joint, error.rmse, error.unit)
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics._core import Accelerations, Effort, JointError, joint_errors
from inverse_dynamics.arguments import checked
from inverse_dynamics.evaluation.accelerations import Samples
from inverse_dynamics.evaluation.bands import read_band
from inverse_dynamics.evaluation.run import Run, RunOptions, open_run
from inverse_dynamics.evaluation.seen_range import outside_of_seen
from inverse_dynamics.evaluation.views import Views
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import Robot

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import Unpack

    from inverse_dynamics.arrays import DataFrame, Floats
    from inverse_dynamics.diagnosis.compare import Cause
    from inverse_dynamics.progress import Progress

__all__ = [
    "Evaluation",
    "JointError",
    "Run",
    "evaluate",
    "evaluate_run",
    "joint_errors",
    "open_run",
]

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
    joint_types: tuple[str, ...] = ()  # as Solver.joint_types; not in files
    band: Floats | None = None  # (N, n) half the width of the model's 95 % band; None: not known
    run: Run | None = field(default=None, compare=False)  # what was evaluated; not in files
    causes: tuple[Cause, ...] | None = None  # those that `explained` has found; not in files

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

    @cached_property
    def explained(self) -> Evaluation:
        """The same with the likely causes of its errors: the last of the notes; efforts are doubted with them."""
        from inverse_dynamics.diagnosis.diagnose import diagnose

        return self if self.run is None or self.causes is not None else diagnose(self)

    @cached_property
    def arm(self) -> Arm:
        """The robot and its solver, those of the run if there is one. Raises UserError."""
        return Arm(self.robot) if self.run is None else self.run.arm

    @property
    def diagnosis(self) -> tuple[Cause, ...]:
        """Likely causes of the errors."""
        return self.explained.causes or ()

    @property
    def mean_rmse(self) -> float:
        """Mean over the joints of the root mean square errors."""
        return sum(e.rmse for e in self.errors) / len(self.errors)


write_evaluation = Evaluation.save


@checked
def evaluate(
    bag: Path | str | Mapping[str, Any] | DataFrame,
    robot: Robot | Path | str,
    *,
    progress: Progress = no_progress,
    scratch: Path | str = "",
    **options: Unpack[RunOptions],
) -> Evaluation:
    """Compute the torques of a recorded motion, compare them with the measured ones, explain the errors.

    evaluate_run(open_run(...)) leaves the explanation out.

    Parameters
    ----------
    bag
        A recording or a table, see recordings.py; or arrays by name, (N,) or (N, n), or a table of pandas
        or polars, with columns as docs/tables.md has them.
    robot
        A name of robot_names(), the file of a run configuration, or one that is loaded.
    scratch
        Directory for unnamed files that hold the arrays of a recording that needn't fit into memory.
    **options
        What else is said about the recording: run.RunOptions; what replaces entries of the run configuration:
        run.Overrides.

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
    run = open_run(bag, robot, progress=progress, scratch=scratch, **options)
    return evaluate_run(run).explained


def evaluate_run(run: Run) -> Evaluation:
    """Computed torques of a run against its measured ones. Raises EvaluationError, RobotError."""
    arm, log = run.arm, run.log
    found = _core.compute_torques(run.motion, arm.solver, run.options, run.progress)
    verdict = None
    if found.effort.meaning == "auto":
        from inverse_dynamics.diagnosis.diagnose import verdict_of

        verdict = verdict_of(run, found.table.series["effort"])
    found = _core.compare_torques(
        found, arm.solver, run.options, run.progress, arm.subtracted, verdict
    )
    arrays, types = found.table.series, arm.solver.joint_types
    states = (log.q, log.qd, run.qdd)
    outside = outside_of_seen(
        arm.solver.seen, states, run.samples.kept, arm.joint_names, arm.units, types=types
    )
    band, other = read_band(arm.robot.model, arm.solver)
    return Evaluation(
        robot=replace(
            arm.robot, joints=arm.recorded_names, topic=log.topic, effort=found.effort.meaning
        ),
        bag=run.bag,
        log=log,
        joint_names=arm.joint_names,
        units=arm.units,
        accelerations=run.accelerations,
        samples=run.samples,
        time=run.time,
        qdd=run.qdd,
        measured=arrays["measured"],
        computed=arrays["computed"],
        errors=found.errors(arm.units),
        errors_of_kept=found.errors_of_kept(arm.units),
        effort=found.effort,
        notes=(*run.notes, *found.notes, *filter(None, [outside, other])),
        joint_types=types,
        band=None if band is None else band.of_recording(arm.solver, *states),
        run=run,
    )


def torques_with_gravity(evaluation: Evaluation, robot: Robot | None = None) -> Floats:
    """(N, n) measured torques; to efforts without gravity, that of Arm(robot).subtracted is added."""
    if evaluation.effort.meaning != "torque_without_gravity":
        return evaluation.measured
    arm = evaluation.arm if robot is None else Arm(robot)
    return evaluation.measured + arm.subtracted.gravity_vector(evaluation.log.q)

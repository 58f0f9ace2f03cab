# SPDX-License-Identifier: Apache-2.0
"""From a recording to computed torques and their errors.

result = evaluate("recording", "ur10_real")
for error in result.errors:
    print(error.joint, error.rmse, error.unit)
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from html import escape
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics._core import Accelerations, Effort, JointError, joint_errors
from inverse_dynamics.arguments import checked
from inverse_dynamics.evaluation.bands import read_band
from inverse_dynamics.evaluation.exports import series_columns
from inverse_dynamics.evaluation.ranges import outside_of_seen
from inverse_dynamics.evaluation.run import Run, RunOptions, open_run
from inverse_dynamics.evaluation.samples import SampleReport
from inverse_dynamics.evaluation.tables import FITTED, evaluation_table, heading
from inverse_dynamics.installation.extras import require
from inverse_dynamics.outputs.files import write_text
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.bags import write_torques
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.recordings.sketch import has_samples_of
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import Robot
from inverse_dynamics.show.result import PAGE, ResultDirectory, files_of
from inverse_dynamics.show.tables import error_columns

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from typing_extensions import Unpack

    from inverse_dynamics._core import Solver
    from inverse_dynamics.arrays import DataFrame, Floats
    from inverse_dynamics.diagnosis.compare import Cause
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Recorded, Storage
    from inverse_dynamics.show.result import Line

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

SCHEMA = 4

_MOST_JOINTS = 12  # of a text on one screen


@dataclass(frozen=True, repr=False)
class Evaluation(ResultDirectory):
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

    contents = files_of(
        "evaluation.json",
        "torques",
        "metrics.json",
        "bag/metadata.yaml",
        "bag/bag.db3*",
        "bag/bag.mcap",
        added=("series.csv", "series.parquet", PAGE),  # by `ids export` and `ids report`, for one
    )
    data = "metrics.json"

    robot: Robot
    bag: Path
    log: JointLog  # its efforts are as recorded
    joint_names: tuple[str, ...]  # those of the solver; the recording's are log.joint_names
    units: tuple[str, ...]
    accelerations: Accelerations
    samples: SampleReport
    time: Floats  # (N,) s since the first sample
    qdd: Floats  # (N, n) rad/s^2 or m/s^2
    measured: Floats  # (N, n) N m or N: the torques that recorded efforts mean
    computed: Floats  # (N, n) N m or N; without gravity if the efforts are
    errors: tuple[JointError, ...]  # over all samples, but those of a second publisher
    errors_of_kept: tuple[JointError, ...]  # over samples.kept, the valid samples
    effort: Effort = field(default_factory=Effort)  # what recorded efforts mean
    notes: tuple[str, ...] = ()  # what was left out or assumed, in words
    joint_types: tuple[str, ...] = ()  # as Solver.joint_types
    fitted: bool = False  # whether the model was fitted to samples of this recording
    band: Floats | None = None  # (N, n) half the width of the model's 95 % band; None: not known
    run: Run | None = field(default=None, compare=False)  # what was evaluated; not in files
    causes: tuple[Cause, ...] | None = None  # those that `explained` has found

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
    def explained(self) -> Evaluation:
        """The same with the likely causes of its errors: the last of the notes; efforts are doubted with them."""
        return self if self.run is None or self.causes is not None else self._diagnosed

    @cached_property
    def _diagnosed(self) -> Evaluation:
        from inverse_dynamics.diagnosis.diagnose import diagnose

        return diagnose(self)

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

    def numbers(self) -> dict[str, Any]:
        """For people and scripts: errors, what was evaluated, notes and the likely cause of the errors; for JSON."""
        found = self.explained
        return {
            "robot": found.robot.name,
            "plugin": found.robot.plugin,
            "friction": found.robot.friction,
            "bag": found.bag,
            "samples": len(found.log),
            "accelerations": found.accelerations,
            "effort": found.effort,
            "joints": found.errors,
            "mean_rmse": found.mean_rmse if len(set(found.units)) == 1 else None,
            "fitted": found.fitted,
            **({} if found.band is None else {"in_band": found.coverage}),
            "kept": {
                "samples": len(found.log) - found.samples.left_out,
                "joints": found.errors_of_kept,
            },
            "notes": found.notes,
            "diagnosis": [{**vars(c), "reference": c.reference} for c in found.diagnosis],
        }

    def lines(self) -> list[Line]:
        """What the screen shows."""
        return [
            *heading(self),
            ("accelerations", self.accelerations.summary),
            ("effort means", self.effort.summary),
            ("note", self.notes),
            evaluation_table(self),
        ]

    def inputs(self) -> tuple[Path | None, ...]:
        """The recording and the robot's files."""
        return self.bag, *self.robot.files

    def write_more(self, directory: Path, storage: Storage | None, progress: Progress) -> None:
        """Write the recording, and evaluation.json: what was assumed."""
        found = self.explained
        log, torques = found.log, (found.computed, found.measured)
        write_torques(
            directory / "bag", storage or log.storage, "/torques", log, torques, progress=progress
        )
        names = (
            "robot",
            "bag",
            "joint_names",
            "units",
            "accelerations",
            "effort",
            "notes",
            "fitted",
        )
        recording = ("joint_names", "frame_id", "clock", "topic", "storage", "effort_is", "notes")
        about = {
            "schema": SCHEMA,
            **{name: getattr(found, name) for name in names},
            "samples": len(log),
            "duration": log.duration,
            "sampling": {"period": found.samples.period, "jitter": found.samples.jitter},
            "recording": {name: getattr(log, name) for name in recording},
        }
        write_text(directory / self.contents.mark, json_text(about))

    def __getstate__(self) -> dict[str, Any]:
        """All that files hold: a copy has no run, whose solver can't be copied."""
        found = self.explained
        return {field.name: getattr(found, field.name) for field in fields(found)} | {"run": None}

    def __repr__(self) -> str:
        rows = self._rows()
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [
            f"Evaluation of {self.bag.name} as {self.robot.name}: {len(self.log)} samples, "
            f"{self.log.duration:.1f} s, mean RMSE {self.mean_rmse:.4g}",
            *("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows[: _MOST_JOINTS + 1]),
        ]
        if len(rows) > _MOST_JOINTS + 1:
            lines.append(f"... and {len(rows) - _MOST_JOINTS - 1} more joints")
        return "\n".join([*lines, *self.explained.notes[-1:]])

    def _repr_html_(self) -> str:
        """For notebooks."""
        names, *rows = self._rows()
        head = "".join(f"<th>{name}</th>" for name in names)
        body = "".join(
            f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows
        )
        notes = "".join(f"<li>{escape(note)}</li>" for note in self.explained.notes)
        title = f"{self.bag.name}, {self.robot.name}: mean RMSE {self.mean_rmse:.4g}"
        return f"<b>{escape(title)}</b><table><tr>{head}</tr>{body}</table>" + (
            notes and f"<ul>{notes}</ul>"
        )

    def _rows(self) -> list[tuple[str, ...]]:
        """Headings, and the errors of each joint."""
        columns, texts = error_columns(self.errors), []
        for name, values in columns.items():
            form = "{:.3g} %" if name.endswith(" [%]") else "{:.4g}"
            texts.append([name.removesuffix(" [%]"), *map(form.format, values)])
        joints = [("joint", "unit"), *((e.joint, e.unit) for e in self.errors)]
        return [(*joint, *row) for joint, *row in zip(joints, *texts, strict=True)]

    def plot(self) -> Figure:
        """Measured and computed torque and the error of each joint, as a figure of matplotlib.

        Raises MissingPackageError.
        """
        require("a figure", "matplotlib")
        from inverse_dynamics.evaluation.figure import torque_figure

        return torque_figure(self)

    def to_pandas(self) -> DataFrame:
        """All series as a pandas.DataFrame, a row per sample; columns: evaluation/exports.py.

        Raises MissingPackageError.
        """
        return self._frame("pandas")

    def to_polars(self) -> DataFrame:
        """The same as a polars.DataFrame."""
        return self._frame("polars")

    def _frame(self, library: str) -> DataFrame:
        require("a data frame", library)
        columns = {column.name: column.values for column in series_columns(self)}
        return import_module(library).DataFrame(columns)


write_evaluation = Evaluation.save


@checked
def evaluate(
    bag: Recorded,
    robot: Robot | Solver | Path | str | None = None,
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
        A recording or a table, see recordings.py; its samples; or arrays by name, (N,) or (N, n), a structured
        array or a DataFrame of pandas or polars, with columns as docs/tables.md has them. Columns that are named
        like joints are taken by name; NaN, null and masked numbers leave their row out.
    robot
        A name of robot_names(), the file of a run configuration, or one that is loaded; a Solver, which is taken
        as it is; none: the description `urdf` alone.
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
    band, other, sketch = read_band(arm.robot.model, arm.solver)
    fitted = bool(sketch) and has_samples_of(log, sketch)
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
        notes=(*run.notes, *found.notes, *filter(None, [outside, other, FITTED * fitted])),
        fitted=fitted,
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

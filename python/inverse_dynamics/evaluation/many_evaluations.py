# SPDX-License-Identifier: Apache-2.0
"""Many recordings evaluated at once: on the cores of this machine, or on a Dask cluster.

result = evaluate_many(["monday", "tuesday"], "ur10_real", "week", jobs=4)
for row in result.rows:
    print(row["recording"], row["joint"], row["rmse"])

Files of the result, and columns of summary.csv: docs/many_recordings.md.
"""

from __future__ import annotations

import csv
import math
import os
import shutil
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.arguments import checked
from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation import files as evaluations
from inverse_dynamics.evaluation.cluster import check_stopped, on_cluster
from inverse_dynamics.evaluation.evaluation import Evaluation
from inverse_dynamics.evaluation.run import RunOptions, check_options, of_run, overridden
from inverse_dynamics.evaluation.workers import Failure, cores, in_processes
from inverse_dynamics.outputs.files import Contents, write_text, written_whole
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.several_recordings import named_recordings
from inverse_dynamics.recordings.time_window import TimeWindow
from inverse_dynamics.robots.robots import Robot, load_robot
from inverse_dynamics.show.result import PAGE
from inverse_dynamics.wording import counted, printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from typing_extensions import Unpack

    from inverse_dynamics._core import Accelerations, JointError
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Storage

SCHEMA = 1
MARK = evaluations.MARK_OF_SEVERAL
OWN_FILES = (MARK, "summary.csv", PAGE)

_OF_EACH = (*Evaluation.contents.files, *Evaluation.contents.added)
CONTENTS = Contents(MARK, (*OWN_FILES, *(f"*/{file}" for file in _OF_EACH)))

Row = dict[str, Any]

COLUMNS = (
    *("recording", "bag", "robot", "plugin", "joint", "unit"),
    *("start", "duration", "window_from", "window_to", "samples"),
    *("mae", "rmse", "nrmse", "bias", "r2", "max_abs", "kept_samples", "kept_rmse"),
    *("accelerations", "cutoff", "effort"),
)

_MOST_TOLD = 5  # failures, in a text


@dataclass(frozen=True)
class EvaluationSummary:
    """An evaluation without its samples, and the name that its recording has among others."""

    name: str
    bag: Path
    robot: str
    plugin: str
    start: float  # s: stamp of the first sample
    duration: float  # s
    window: TimeWindow  # the requested one
    samples: int
    kept_samples: int  # those of errors_of_kept
    accelerations: Accelerations
    effort: str  # what recorded efforts mean: torque, current, torque_without_gravity
    errors: tuple[JointError, ...]
    errors_of_kept: tuple[JointError, ...]
    notes: tuple[str, ...] = ()

    @property
    def mean_rmse(self) -> float:
        """Mean over the joints of the root mean square errors."""
        return sum(error.rmse for error in self.errors) / len(self.errors)


@dataclass(frozen=True)
class FailedRecording:
    """A recording that failed; `error` is one line."""

    name: str
    bag: Path
    error: str


@dataclass(frozen=True, repr=False)
class ManyEvaluations:
    """Results of evaluate_many(), in the order of the recordings."""

    directory: Path
    summaries: tuple[EvaluationSummary, ...]
    failures: tuple[FailedRecording, ...]

    @property
    def rows(self) -> list[Row]:
        """One per recording and joint, as in summary.csv: for pandas.DataFrame(rows) and the like."""
        return _rows(self.summaries)

    @property
    def directories(self) -> dict[str, Path]:
        """Directories of the results, by name of the recording."""
        return {summary.name: self.directory / summary.name for summary in self.summaries}

    def evaluation(self, name: str) -> Evaluation:
        """One of them, with its samples. Raises OutputError."""
        return evaluations.read_evaluation(self.directory / name)

    def __repr__(self) -> str:
        recordings = counted(len(self.summaries), "recording")
        return f"<ManyEvaluations in {self.directory}: {recordings}, {len(self.failures)} failed>"


@dataclass(frozen=True)
class _Task:
    """One recording, for a worker: where it is, where its result goes, and how it is evaluated."""

    name: str
    bag: Path
    target: Path
    robot: Robot
    parquet: bool
    writing: Mapping[str, Any]  # storage and figures
    options: RunOptions


class ManyOptions(RunOptions, total=False):
    """What is written of each recording.

    storage, figures: as in Evaluation.save(). Without figures no page of a recording either, nor of one with more than
    a million samples. parquet: write NAME/series.parquet too.
    """

    storage: Storage | None
    figures: Sequence[str]
    parquet: bool


@checked
def evaluate_many(
    recordings: Iterable[Path | str] | Path | str,
    robot: Robot | Path | str,
    out: Path | str,
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    overwrite: bool = False,
    progress: Progress = no_progress,
    **options: Unpack[ManyOptions],
) -> ManyEvaluations:
    """Evaluate recordings of one robot, each in a process of its own, into one directory.

    A recording that fails, or whose process dies, is among `failures`; the others are finished.

    Parameters
    ----------
    recordings
        As evaluate() takes them, or directories that hold some.
    robot, **options
        As in evaluate(), and ManyOptions.
    out
        The directory; written whole or not at all.
    jobs
        How many at the same time; by default one per core.
    scheduler
        Address of a Dask scheduler, whose workers do it instead. They need this software, and see
        recordings and `out` by the same paths.
    overwrite
        Replace an older result.

    Raises
    ------
    UserError
        Arguments, robot or output can't be used, or every recording fails.

    Examples
    --------
    >>> from inverse_dynamics import evaluate_many
    >>> from inverse_dynamics.demo.demo import stored_recording
    >>> recording = stored_recording("ur10_simulated")
    >>> many = evaluate_many([recording], "ur10_simulated", "results", figures=())
    >>> len(many.summaries), many.failures
    (1, ())
    """
    given = [recordings] if isinstance(recordings, (str, os.PathLike)) else list(recordings)
    names = named_recordings(given, taken=OWN_FILES)
    if not names:
        raise UserError("evaluate_many: recordings: expected one or more, got none")
    if jobs is not None and jobs < 1:
        raise UserError(f"jobs: expected a number of processes above zero, got {jobs}")
    robot = robot if isinstance(robot, Robot) else load_robot(robot)
    run = of_run(options)
    check_options(robot, run)
    storage, figures = options.get("storage"), tuple(options.get("figures", ("png",)))
    parquet = options.get("parquet", False)
    evaluations.check_writing(storage, figures, parquet=parquet)
    writing = {"storage": storage, "figures": figures}
    inputs = (*names.values(), *overridden(robot, run).files)
    with written_whole(Path(out), overwrite=overwrite, contents=CONTENTS, inputs=inputs) as target:
        tasks = [
            _Task(name, bag, target / name, robot, parquet, writing, run)
            for name, bag in names.items()
        ]
        outcomes = _outcomes(tasks, jobs, scheduler, progress)
        result = _sorted_out(Path(out), tasks, outcomes)
        for remains in {*target.iterdir()} - {target / s.name for s in result.summaries}:
            shutil.rmtree(remains, ignore_errors=True)  # of failed tasks
        _write(result, target, tuple(names), robot)
    return result


def _outcomes(
    tasks: Sequence[_Task], jobs: int | None, scheduler: str | None, progress: Progress
) -> list[EvaluationSummary | Failure]:
    """Run the tasks; gives a summary or a Failure for each."""
    found: dict[int, EvaluationSummary | Failure] = {}

    def done(index: int, outcome: EvaluationSummary | Failure) -> None:
        found[index] = outcome
        progress("evaluating", len(found), len(tasks))

    progress("evaluating", 0, len(tasks))
    if scheduler is None:
        in_processes(_evaluate_one, tasks, jobs=jobs or cores(), done=done)
    else:
        far = [_with_whole_paths(task) for task in tasks]
        there = [task.bag for task in far if task.bag.exists()]
        paths = [far[0].target.parent, *there, *filter(None, far[0].robot.files)]
        on_cluster(_evaluate_one, far, scheduler, paths=paths, done=done)
    return [found[index] for index in range(len(tasks))]


def _evaluate_one(task: _Task) -> EvaluationSummary:
    """Evaluate one recording, in a worker. Raises UserError."""

    def progress(_what: str, _done: int, _total: int) -> None:
        check_stopped()

    shutil.rmtree(task.target, ignore_errors=True)  # of an earlier try, on a cluster
    evaluation = evaluations.evaluate_into(
        task.target,
        task.bag,
        task.robot,
        parquet=task.name if task.parquet else None,
        progress=progress,
        **task.writing,
        **task.options,
    )
    window = TimeWindow(task.options.get("start"), task.options.get("end"))
    return summary_of(evaluation, task.name, window)


def summary_of(evaluation: Evaluation, name: str, window: TimeWindow) -> EvaluationSummary:
    """The summary of an evaluation. window: of the recording, that was evaluated."""
    samples = len(evaluation.log)
    return EvaluationSummary(
        name=name,
        bag=evaluation.bag,
        robot=evaluation.robot.name,
        plugin=evaluation.robot.plugin,
        start=float(evaluation.log.stamps[0]) * 1e-9,
        duration=evaluation.log.duration,
        window=window,
        samples=samples,
        kept_samples=samples - evaluation.samples.left_out,
        accelerations=evaluation.accelerations,
        effort=evaluation.effort.meaning,
        errors=evaluation.errors,
        errors_of_kept=evaluation.errors_of_kept,
        notes=evaluation.explained.notes,
    )


def _sorted_out(
    out: Path, tasks: Sequence[_Task], outcomes: Sequence[EvaluationSummary | Failure]
) -> ManyEvaluations:
    """Raises UserError where everything has failed."""
    summaries, failures = [], []
    for task, outcome in zip(tasks, outcomes, strict=True):
        if isinstance(outcome, Failure):
            text = outcome.text.replace(str(task.target.parent), str(out))
            failures.append(FailedRecording(task.name, task.bag, text))
        else:
            summaries.append(replace(outcome, bag=task.bag))
    if not summaries:
        what = "none of the recordings could be evaluated"
        if len({failure.error for failure in failures}) == 1:  # of the robot, say
            raise UserError(f"{what}: {failures[0].error}")
        raise UserError(failures_text(what, failures))
    return ManyEvaluations(out, tuple(summaries), tuple(failures))


def summary(result: ManyEvaluations, robot: Robot) -> dict[str, Any]:
    """Recordings, why some failed, and the rows of summary.csv, for JSON."""
    return {"robot": robot.name, "recordings": _recordings(result), "rows": result.rows}


def _recordings(result: ManyEvaluations) -> list[dict[str, Any]]:
    done = [{"name": s.name, "bag": s.bag, "error": None} for s in result.summaries]
    return [*done, *map(vars, result.failures)]


def failures_text(what: str, failures: Sequence[FailedRecording]) -> str:
    """Failures as a text of a few lines."""
    lines = [f"  {failure.name}: {failure.error}" for failure in failures[:_MOST_TOLD]]
    if len(failures) > _MOST_TOLD:
        lines.append(f"  and {len(failures) - _MOST_TOLD} others")
    return "\n".join([f"{what}:", *lines])


def _write(result: ManyEvaluations, target: Path, names: Sequence[str], robot: Robot) -> None:
    from inverse_dynamics.evaluation.page_of_many import render_recordings_page

    _write_csv(target / "summary.csv", result.rows)
    recordings = sorted(_recordings(result), key=lambda recording: names.index(recording["name"]))
    about = {"schema": SCHEMA, "robot": robot.name, "recordings": recordings}
    write_text(target / MARK, json_text(about))
    title = f"{robot.description or robot.name}: {counted(len(recordings), 'recording')}"
    failures = {failure.name: failure.error for failure in result.failures}
    links = {s.name: PAGE for s in result.summaries if (target / s.name / PAGE).is_file()}
    page = render_recordings_page(title, result.summaries, failures, links)
    write_text(target / PAGE, page)


def _with_whole_paths(task: _Task) -> _Task:
    """For a worker with another working directory."""

    def whole(path: Path | str | None) -> Path | None:
        return None if path is None else Path(path).absolute()

    robot, options = task.robot, task.options.copy()
    options["urdf"] = whole(options.get("urdf"))
    paths = {name: whole(getattr(robot, name)) for name in ("file", "urdf", "model")}
    bag, target = task.bag.absolute(), task.target.absolute()
    return replace(task, bag=bag, target=target, robot=replace(robot, **paths), options=options)


def _rows(summaries: Iterable[EvaluationSummary]) -> list[Row]:
    """The table, row by row; None where a value is undefined."""
    rows = []
    for summary in summaries:
        of_all = {
            **vars(summary),
            "recording": summary.name,
            "bag": str(summary.bag),
            "window_from": summary.window.start,
            "window_to": summary.window.end,
            "accelerations": summary.accelerations.method,
            "cutoff": summary.accelerations.cutoff,
        }
        for error, kept in zip(summary.errors, summary.errors_of_kept, strict=True):
            row = {**of_all, **asdict(error), "kept_rmse": kept.rmse}
            rows.append({name: _defined(row[name]) for name in COLUMNS})
    return rows


def _write_csv(file: Path, rows: Iterable[Row]) -> None:
    """Every digit is kept; an undefined value is empty; names that aren't UTF-8 become escapes."""
    with file.open("w", encoding="utf-8", newline="") as sink:
        writer = csv.DictWriter(sink, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: printable(v) if isinstance(v, str) else v for k, v in row.items()})


def _defined(value: object) -> object:
    return None if isinstance(value, float) and math.isnan(value) else value

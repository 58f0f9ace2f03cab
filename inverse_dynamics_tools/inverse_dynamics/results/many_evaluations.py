# SPDX-License-Identifier: Apache-2.0
"""Many recordings evaluated at once: on the cores of this machine, or on a Dask cluster.

result = evaluate_many(["monday", "tuesday"], "ur10_real", "week", jobs=4)
for row in result.rows:
    print(row["recording"], row["joint"], row["rmse"])

recordings.json   what was evaluated, and what failed, with its message; marks the directory
summary.csv       errors, a row per recording and joint: see summaries.py
summary.parquet   the same with types, where pyarrow is installed
report.html       all recordings on one page
NAME/             an evaluation of each recording: see evaluations.py; with figures, its page too
NAME/series.parquet   its series, with a column `recording`, where that is asked for
"""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.base.arguments import check_call, checked
from inverse_dynamics.base.cluster import check_stopped, on_cluster
from inverse_dynamics.base.files import Contents, write_text, written_whole
from inverse_dynamics.base.plain import json_text
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.replacement import restore_interrupted
from inverse_dynamics.base.wording import counted
from inverse_dynamics.base.workers import Failure, cores, in_processes
from inverse_dynamics.data.several_recordings import named_recordings
from inverse_dynamics.data.time_window import TimeWindow
from inverse_dynamics.errors import ArgumentError, OutputError, UserError
from inverse_dynamics.evaluation.evaluation import check_options, evaluate
from inverse_dynamics.evaluation.summary import EvaluationSummary, summary_of
from inverse_dynamics.results import evaluations
from inverse_dynamics.results.evaluations import check_writing
from inverse_dynamics.results.summaries import (
    Row,
    summary_rows,
    write_summary_csv,
    write_summary_parquet,
)
from inverse_dynamics.robot.robots import Robot, load_robot

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Storage
    from inverse_dynamics.evaluation.evaluation import Evaluation

SCHEMA = 1
MARK = evaluations.MARK_OF_SEVERAL
PAGE = "report.html"
OWN_FILES = (MARK, "summary.csv", "summary.parquet", PAGE)

CONTENTS = Contents(
    MARK,
    (
        *OWN_FILES,
        *(f"*/{file}" for file in (*evaluations.CONTENTS.files, *evaluations.CONTENTS.added)),
    ),
)

_MOST_TOLD = 5  # failures, in a text
_MOST_ON_A_PAGE = 1_000_000  # samples: the page of a recording holds them in memory


@dataclass(frozen=True)
class FailedRecording:
    """A recording that wasn't evaluated, and why, in one line."""

    name: str
    bag: Path
    error: str


@dataclass(frozen=True)
class ManyEvaluations:
    """What evaluate_many() has written. In the order of the recordings."""

    directory: Path
    summaries: tuple[EvaluationSummary, ...]
    failures: tuple[FailedRecording, ...]

    @property
    def rows(self) -> list[Row]:
        """One per recording and joint, as in summary.csv: for pandas.DataFrame(rows) and the like."""
        return summary_rows(self.summaries)

    @property
    def directories(self) -> dict[str, Path]:
        """Where the result of each recording is, by its name."""
        return {summary.name: self.directory / summary.name for summary in self.summaries}

    def evaluation(self, name: str) -> Evaluation:
        """One of them, with its samples. Raises OutputError."""
        return evaluations.read_evaluation(self.directory / name)


@dataclass(frozen=True)
class _Task:
    """One recording, for a worker: where it is, where its result goes, and how it is evaluated."""

    name: str
    bag: Path
    target: Path
    robot: Robot | str
    options: Mapping[str, Any]
    storage: Storage | None
    figures: tuple[str, ...]
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
    storage: Storage | None = None,
    figures: Sequence[str] = ("png",),
    parquet: bool = False,
    progress: Progress = no_progress,
    **options: Any,
) -> ManyEvaluations:
    """Evaluate recordings of one robot, each in a process of its own, into one directory.

    recordings: as evaluate() takes them, or directories that hold some. out: the directory; it is
    written whole or not at all. jobs: how many at the same time; None: one per core. scheduler: address
    of a Dask scheduler, whose workers do it instead: they need this software, and see recordings and
    `out` by the same paths. storage, figures: see write_evaluation(); figures: none of them, no page of
    each recording either, nor of one with more than a million samples. parquet: write
    NAME/series.parquet too. options: those of evaluate().

    A recording that fails, or whose process dies, is among `failures`; the others are finished.
    Raises UserError: arguments, robot or output can't be used, or every recording fails.
    """
    given = [recordings] if isinstance(recordings, (str, os.PathLike)) else list(recordings)
    names = named_recordings(given, taken=OWN_FILES)
    _check(names, jobs, parquet, robot, options)
    loaded = robot if isinstance(robot, Robot) else load_robot(robot)
    check_options(loaded, **options)
    check_writing(storage, figures)
    inputs = (*names.values(), options.get("urdf"), *loaded.files)
    with written_whole(Path(out), overwrite=overwrite, contents=CONTENTS, inputs=inputs) as target:
        task = _Task("", Path(), target, _for_workers(robot, loaded), options, storage,
                     tuple(figures), parquet)  # fmt: skip
        tasks = [replace(task, name=n, bag=bag, target=target / n) for n, bag in names.items()]
        outcomes = _outcomes(tasks, jobs, scheduler, progress)
        result = _sorted_out(Path(out), tasks, outcomes)
        _write(result, target, names, loaded)
    return result


def _check(
    names: Mapping[str, Path], jobs: int | None, parquet: bool, robot: object, options: Any
) -> None:
    """Raise UserError for what no recording could be evaluated with."""
    if not names:
        raise UserError("evaluate_many: recordings: expected one or more, got none")
    if jobs is not None and jobs < 1:
        raise UserError(f"jobs: expected a number of processes above zero, got {jobs}")
    if "series" in options:
        raise ArgumentError(
            "evaluate_many: argument series: unknown; samples go into the directory"
        )
    check_call(evaluate, next(iter(names.values())), robot, **options)
    if parquet:
        from inverse_dynamics.results.exports import check_pyarrow

        check_pyarrow()


def _for_workers(given: Robot | Path | str, loaded: Robot) -> Robot | str:
    """The robot as a worker finds it, whose working directory may be another one."""
    if isinstance(given, Robot) or str(given) == loaded.file.stem:
        return given if isinstance(given, Robot) else str(given)
    return str(loaded.file.absolute())


def _outcomes(
    tasks: Sequence[_Task], jobs: int | None, scheduler: str | None, progress: Progress
) -> list[EvaluationSummary | Failure]:
    """What became of each task."""
    found: dict[int, EvaluationSummary | Failure] = {}

    def done(index: int, outcome: EvaluationSummary | Failure) -> None:
        found[index] = outcome
        if isinstance(outcome, Failure):
            _remove_remains(tasks[index].target)
        progress("evaluating", len(found), len(tasks))

    progress("evaluating", 0, len(tasks))
    if scheduler is None:
        in_processes(_evaluate_one, tasks, jobs=jobs or cores(), done=done)
    else:
        far = [_with_whole_paths(task) for task in tasks]
        on_cluster(_evaluate_one, far, scheduler, paths=_seen_by_workers(far), done=done)
    return [found[index] for index in range(len(tasks))]


def _evaluate_one(task: _Task) -> EvaluationSummary:
    """What a worker does. Raises UserError."""

    def progress(_what: str, _done: int, _total: int) -> None:
        check_stopped()

    _remove_remains(task.target)  # of an earlier try, on a cluster
    evaluation = evaluations.evaluate_into(
        task.target,
        task.bag,
        task.robot,
        storage=task.storage,
        figures=task.figures,
        parquet=task.name if task.parquet else None,
        progress=progress,
        **task.options,
    )
    if task.figures and len(evaluation.log) <= _MOST_ON_A_PAGE:
        from inverse_dynamics.report import report_run, write_page

        write_page(task.target / PAGE, task.name, [report_run(evaluation, task.name)])
    window = TimeWindow(task.options.get("start"), task.options.get("end"))
    return summary_of(evaluation, task.name, window)


def _remove_remains(target: Path) -> None:
    """What a failed task has left."""
    with suppress(OSError, OutputError):
        restore_interrupted(target)
    shutil.rmtree(target, ignore_errors=True)


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
        raise UserError(failures_told(what, failures))
    return ManyEvaluations(out, tuple(summaries), tuple(failures))


def summary(result: ManyEvaluations, robot: Robot) -> dict[str, Any]:
    """Recordings, why some failed, and the rows of summary.csv, for JSON."""
    done = [{"name": s.name, "bag": s.bag, "error": None} for s in result.summaries]
    return {
        "robot": robot.name,
        "recordings": [*done, *result.failures],
        "rows": result.rows,
    }


def failures_told(what: str, failures: Sequence[FailedRecording]) -> str:
    """Failures as a text of a few lines."""
    lines = [f"  {failure.name}: {failure.error}" for failure in failures[:_MOST_TOLD]]
    if len(failures) > _MOST_TOLD:
        lines.append(f"  and {len(failures) - _MOST_TOLD} others")
    return "\n".join([f"{what}:", *lines])


def _write(result: ManyEvaluations, target: Path, names: Mapping[str, Path], robot: Robot) -> None:
    from inverse_dynamics.report.recordings import write_recordings_page

    write_summary_csv(target / "summary.csv", result.rows)
    write_summary_parquet(target / "summary.parquet", result.rows)
    failures = {failure.name: failure.error for failure in result.failures}
    about = {
        "schema": SCHEMA,
        "robot": robot.name,
        "recordings": [
            {"name": name, "bag": str(bag), "error": failures.get(name)}
            for name, bag in names.items()
        ],
    }
    write_text(target / MARK, json_text(about))
    title = f"{robot.description or robot.name}: {counted(len(names), 'recording')}"
    links = {s.name: PAGE for s in result.summaries if (target / s.name / PAGE).is_file()}
    write_recordings_page(target / PAGE, title, result.summaries, failures, links)


def _with_whole_paths(task: _Task) -> _Task:
    """For a worker with another working directory."""
    options = dict(task.options)
    if options.get("urdf") is not None:
        options["urdf"] = Path(options["urdf"]).absolute()
    return replace(task, bag=task.bag.absolute(), target=task.target.absolute(), options=options)


def _seen_by_workers(tasks: Sequence[_Task]) -> list[Path]:
    """What workers must see: recordings, the directory of results, files of the robot."""
    robot = tasks[0].robot
    files = [Path(robot)] if isinstance(robot, str) and Path(robot).is_absolute() else []
    there = [task.bag for task in tasks if task.bag.exists()]
    return [tasks[0].target.parent, *there, *files]

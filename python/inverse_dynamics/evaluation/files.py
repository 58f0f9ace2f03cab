# SPDX-License-Identifier: Apache-2.0
"""An evaluation as a directory of files, and back: `ids evaluate --help` lists the files."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import Accelerations, Effort, JointError, Verdict
from inverse_dynamics.errors import OutputError
from inverse_dynamics.evaluation.accelerations import MASKS
from inverse_dynamics.evaluation.evaluation import Evaluation, evaluate
from inverse_dynamics.evaluation.run import RunOptions, overridden
from inverse_dynamics.installation.extras import require
from inverse_dynamics.outputs.files import Contents, write_text, written_whole
from inverse_dynamics.outputs.plain import json_text, read_back
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.bags import write_torques
from inverse_dynamics.recordings.joint_log import check_storage
from inverse_dynamics.robots.robots import Robot, load_robot
from inverse_dynamics.show.plots import FORMATS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Unpack

    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Storage

SCHEMA = 4
MARK = "evaluation.json"
PAGE = "report.html"
MARK_OF_SEVERAL = "recordings.json"  # see many_evaluations.py
_MOST_ON_A_PAGE = 3_000_000  # samples: 1 s, 170 MiB; 60 bytes more for each

CONTENTS = Contents(
    MARK,
    (
        MARK,
        "metrics.json",
        "series.npz",
        *(f"torques.{suffix}" for suffix in FORMATS),
        "bag/metadata.yaml",
        "bag/bag.db3*",
        "bag/bag.mcap",
    ),
    added=("series.csv", "series.parquet", PAGE),
)
"""Files of a result; `ids export` and `ids report` add theirs."""

COMPUTED_TOPIC = "/torques"


def write_evaluation(
    evaluation: Evaluation,
    directory: Path | str,
    *,
    overwrite: bool = False,
    storage: Storage | None = None,
    figures: Sequence[str] = ("png",),
    progress: Progress = no_progress,
) -> None:
    """Write all files of an evaluation, or none of them.

    Parameters
    ----------
    directory
        To write.
    overwrite
        Replace an older result.
    storage
        "sqlite3" or "mcap"; by default that of the recording.
    figures
        Of "png", "svg", "pdf"; none of them: no figure.

    Raises
    ------
    UserError
        OutputError, BagError.
    """
    check_writing(storage, figures)
    inputs = (evaluation.bag, *evaluation.robot.files)
    with written_whole(
        Path(directory), overwrite=overwrite, contents=CONTENTS, inputs=inputs
    ) as target:
        _write(evaluation.explained, target, storage, figures, progress)


def evaluate_into(
    directory: Path | str,
    bag: Path | str,
    robot: Robot | Path | str,
    *,
    overwrite: bool = False,
    storage: Storage | None = None,
    figures: Sequence[str] = ("png",),
    parquet: str | None = None,
    progress: Progress = no_progress,
    **options: Unpack[RunOptions],
) -> Evaluation:
    """evaluate() and write_evaluation() of a recording that needn't fit into memory; with figures, a page too.

    parquet: name of the recording in series.parquet; None: no such file. options: those of evaluate().
    The arrays of the result lie in unnamed files, in memory only where they are looked at.

    Raises UserError.
    """
    check_writing(storage, figures, parquet=parquet is not None)
    robot = robot if isinstance(robot, Robot) else load_robot(robot)
    inputs = (Path(bag), *overridden(robot, options).files)
    with written_whole(
        Path(directory), overwrite=overwrite, contents=CONTENTS, inputs=inputs
    ) as target:
        evaluation = evaluate(bag, robot, progress=progress, scratch=target, **options)
        _write(evaluation, target, storage, figures, progress)
        if parquet is not None:
            from inverse_dynamics.evaluation.exports import export_series

            file = target / "series.parquet"
            export_series(evaluation, file, recording=parquet, progress=progress)
        if figures and len(evaluation.log) <= _MOST_ON_A_PAGE:
            from inverse_dynamics.evaluation.page import report_run
            from inverse_dynamics.show.page import write_page

            progress("drawing", 0, 1)
            name = Path(directory).name
            write_page(target / PAGE, name, [report_run(evaluation, name)])
        return evaluation


def check_writing(storage: str | None, figures: Sequence[str], *, parquet: bool = False) -> None:
    """Raise UserError for a storage or a format that can't be written."""
    from inverse_dynamics.show.plots import check_formats

    check_formats(figures)
    if storage is not None:
        check_storage(storage)
    if parquet:
        require("a table", "pyarrow")


def _write(
    evaluation: Evaluation,
    target: Path,
    storage: Storage | None,
    figures: Sequence[str],
    progress: Progress,
) -> None:
    from inverse_dynamics.evaluation.figure import save_torque_figure

    storage = storage or evaluation.log.storage
    torques = (evaluation.computed, evaluation.measured)
    write_torques(
        target / "bag", storage, COMPUTED_TOPIC, evaluation.log, torques, progress=progress
    )
    np.savez(target / "series.npz", **_series(evaluation))
    write_text(target / "metrics.json", json_text(metrics(evaluation)))
    write_text(target / MARK, json_text(_about(evaluation)))
    if figures:
        progress("plotting", 0, 1)
        save_torque_figure(evaluation, *(target / f"torques.{suffix}" for suffix in figures))
        progress("plotting", 1, 1)


def read_evaluation(directory: Path | str) -> Evaluation:
    """An evaluation that write_evaluation() wrote. Raises OutputError."""
    directory = Path(directory)
    _check_marked(directory)
    try:
        about = json.loads((directory / MARK).read_text(encoding="utf-8"))
        if about["schema"] != SCHEMA:
            raise OutputError(
                f"{directory / MARK}: expected schema {SCHEMA}, got {about['schema']}; evaluate again"
            )
        metrics = json.loads((directory / "metrics.json").read_text(encoding="utf-8"))
        with np.load(directory / "series.npz", allow_pickle=False) as series:
            arrays = {name: series[name] for name in series.files}
        return _read_back(about, metrics, arrays)
    except OutputError:
        raise
    except Exception as error:  # of files that were edited or damaged, whatever their readers raise
        raise OutputError(
            f"{directory}: isn't a complete evaluation ({type(error).__name__}: {error}); evaluate "
            "again"
        ) from error


def _read_back(
    about: dict[str, Any], metrics: dict[str, Any], arrays: dict[str, Any]
) -> Evaluation:
    """The evaluation that files hold. Raises ValueError, TypeError, KeyError."""
    recorded = {name: arrays[name] for name in _RECORDED}
    verdict = about["effort"]["verdict"]
    parts = {
        **arrays,
        **about,
        "robot": Robot(**about["robot"]),
        "accelerations": Accelerations(**about["accelerations"]),
        "effort": Effort(**{**about["effort"], "verdict": verdict and Verdict(**verdict)}),
        "log": {**about["recording"], **recorded},
        "samples": {**about["sampling"], **arrays},
        "errors": [_joint_error(joint) for joint in metrics["joints"]],
        "errors_of_kept": [_joint_error(joint) for joint in metrics["kept"]["joints"]],
    }
    evaluation: Evaluation = read_back(Evaluation, parts, "evaluation")
    samples, joints = len(evaluation.log.header_stamps), len(evaluation.log.joint_names)
    for name, array in _series(evaluation).items():
        shape = (samples, joints) if name in _PER_JOINT else (samples,)
        if array.shape != shape or not samples:
            raise ValueError(f"{name}: expected the shape {shape}, got {array.shape}")
    counts = {name: getattr(evaluation, name) for name in ("joint_names", "units", "errors")}
    counts["kept"] = evaluation.errors_of_kept
    if evaluation.effort.meaning == "current":
        counts["drive_gains"] = evaluation.effort.drive_gains
    for name, entries in counts.items():
        if len(entries) != joints or not joints:
            raise ValueError(f"{name}: expected {joints}, one per joint, got {len(entries)}")
    return evaluation


def _joint_error(joint: dict[str, Any]) -> JointError:
    values: dict[str, Any] = {k: math.nan if v is None else v for k, v in joint.items()}
    return JointError(**values)


def _check_marked(directory: Path) -> None:
    """Raise OutputError unless it is the result of one recording."""
    if (directory / MARK_OF_SEVERAL).is_file():
        raise OutputError(
            f"{directory}: holds results of several recordings; name one of them, {directory}/NAME"
        )
    if not (directory / MARK).is_file():
        found = f"holds no {MARK}" if directory.is_dir() else "no such directory"
        raise OutputError(f"{directory}: {found}; expected one written by `ids evaluate`")


_RECORDED = ("header_stamps", "receive_stamps", "q", "qd", "effort")
_PER_JOINT = ("q", "qd", "effort", "qdd", "measured", "computed", "band")


def _series(evaluation: Evaluation) -> dict[str, Any]:
    """Arrays of series.npz, not copied."""
    computed = ["time", "qdd", "measured", "computed"]
    computed += [] if evaluation.band is None else ["band"]
    return {
        **{name: getattr(evaluation.log, name) for name in _RECORDED},
        **{name: getattr(evaluation, name) for name in computed},
        **{name: getattr(evaluation.samples, name) for name in MASKS},
    }


def metrics(evaluation: Evaluation) -> dict[str, Any]:
    """For people and scripts: errors, what was evaluated, notes and the likely cause of the errors; for JSON."""
    return {
        "robot": evaluation.robot.name,
        "plugin": evaluation.robot.plugin,
        "friction": evaluation.robot.friction,
        "bag": str(evaluation.bag),
        "samples": len(evaluation.log),
        "accelerations": evaluation.accelerations,
        "effort": evaluation.effort,
        "joints": evaluation.errors,
        "mean_rmse": evaluation.mean_rmse if len(set(evaluation.units)) == 1 else None,
        **({} if evaluation.band is None else {"in_band": evaluation.coverage}),
        "kept": {
            "samples": len(evaluation.log) - evaluation.samples.left_out,
            "joints": evaluation.errors_of_kept,
        },
        "notes": evaluation.notes,
        "diagnosis": [{**vars(c), "reference": c.reference} for c in evaluation.diagnosis],
    }


def _about(evaluation: Evaluation) -> dict[str, Any]:
    """Content of evaluation.json: all that metrics.json and series.npz lack."""
    names = ("robot", "bag", "joint_names", "units", "accelerations", "effort", "notes")
    recording = ("joint_names", "frame_id", "clock", "topic", "storage", "effort_is", "notes")
    samples = evaluation.samples
    return {
        "schema": SCHEMA,
        **{name: getattr(evaluation, name) for name in names},
        "samples": len(evaluation.log),
        "duration": evaluation.log.duration,
        "sampling": {"period": samples.period, "jitter": samples.jitter},
        "recording": {name: getattr(evaluation.log, name) for name in recording},
    }

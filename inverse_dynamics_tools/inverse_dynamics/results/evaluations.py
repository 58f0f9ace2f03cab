# SPDX-License-Identifier: Apache-2.0
"""An evaluation as a directory of files, and back.

evaluation.json   what was evaluated, how, and what was assumed; marks the directory
metrics.json      errors of each joint
series.npz        time, q, qd, qdd, effort as recorded, measured and computed torques, stamps; one row
                  per sample
bag/              recording with /torques (computed) and /torques_gt (measured)
plotjuggler.xml   layout for PlotJuggler that opens it
torques.png     figure; or .svg, .pdf, where they are asked for
"""

from __future__ import annotations

import json
import math
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.base.files import Contents, write_text, written_whole
from inverse_dynamics.base.plain import json_text
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.base.replacement import restore_interrupted
from inverse_dynamics.data.bags import write_torques
from inverse_dynamics.data.joint_log import JointLog, check_storage
from inverse_dynamics.errors import OutputError
from inverse_dynamics.evaluation.accelerations import MASKS, Accelerations, Samples
from inverse_dynamics.evaluation.effort import Effort, Verdict
from inverse_dynamics.evaluation.evaluation import Evaluation, JointError, evaluate
from inverse_dynamics.figures.plots import FORMATS
from inverse_dynamics.results.stated_types import check_types
from inverse_dynamics.robot.robots import Robot, load_robot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.data.joint_log import Storage

SCHEMA = 4
MARK = "evaluation.json"
MARK_OF_SEVERAL = "recordings.json"  # see many_evaluations.py

CONTENTS = Contents(
    MARK,
    (
        MARK,
        "metrics.json",
        "series.npz",
        "plotjuggler.xml",
        *(f"torques.{suffix}" for suffix in FORMATS),
        "bag/metadata.yaml",
        "bag/bag.db3*",
        "bag/bag.mcap",
    ),
    added=("series.csv", "series.parquet", "report.html"),
)
"""Of a directory of results: `ids export` and `ids report` may have added theirs."""

COMPUTED_TOPIC = "/torques"
MEASURED_TOPIC = "/torques_gt"


def write_evaluation(
    evaluation: Evaluation,
    directory: Path | str,
    *,
    overwrite: bool = False,
    storage: Storage | None = None,
    figures: Sequence[str] = ("png",),
    progress: Progress = no_progress,
) -> dict[str, float]:
    """Write all files of an evaluation, or none of them; gives what took how long [s].

    overwrite: replace an older result. storage: sqlite3 or mcap; None: that of the recording.
    figures: of "png", "svg", "pdf"; none of them: no figure.
    Raises OutputError, BagError.
    """
    check_writing(storage, figures)
    inputs = (evaluation.bag, *evaluation.robot.files)
    with written_whole(
        Path(directory), overwrite=overwrite, contents=CONTENTS, inputs=inputs
    ) as target:
        return _write(evaluation, target, storage, figures, progress)


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
    **options: Any,
) -> Evaluation:
    """evaluate() and write_evaluation() of a recording that needn't fit into memory.

    parquet: name of the recording in series.parquet; None: no such file. options: those of evaluate().
    The arrays of the result lie in unnamed files, in memory only where they are looked at.

    Raises UserError.
    """
    check_writing(storage, figures)
    robot = robot if isinstance(robot, Robot) else load_robot(robot)
    inputs = (Path(bag), *robot.files, options.get("urdf"))
    with written_whole(
        Path(directory), overwrite=overwrite, contents=CONTENTS, inputs=inputs
    ) as target:
        evaluation = evaluate(bag, robot, progress=progress, scratch=target, **options)
        seconds = _write(evaluation, target, storage, figures, progress)
        if parquet is not None:
            from inverse_dynamics.results.exports import export_series

            export_series(
                evaluation, target / "series.parquet", recording=parquet, progress=progress
            )
        return replace(evaluation, seconds={**evaluation.seconds, **seconds})


def check_writing(storage: str | None, figures: Sequence[str]) -> None:
    """Raise UserError for a storage or a format of figures that can't be written."""
    from inverse_dynamics.figures.plots import check_formats

    check_formats(figures)
    if storage is not None:
        check_storage(storage)


def _write(
    evaluation: Evaluation,
    target: Path,
    storage: Storage | None,
    figures: Sequence[str],
    progress: Progress,
) -> dict[str, float]:
    """All files; gives what took how long [s]."""
    from inverse_dynamics.figures.plots import save_torque_figure

    start = time.perf_counter()
    storage = storage or evaluation.log.storage
    torques = (evaluation.computed, evaluation.measured)
    write_torques(target / "bag", storage, COMPUTED_TOPIC, evaluation.log, torques, progress)
    np.savez(target / "series.npz", **_series(evaluation))
    layout = _layout(evaluation, target / "bag", storage)
    write_text(target / "plotjuggler.xml", layout)
    write_text(target / "metrics.json", json_text(metrics(evaluation)))
    write_text(target / MARK, json_text(_summary(evaluation)))
    plotting = time.perf_counter()
    if figures:
        progress("plotting", 0, 1)
        files = (target / f"torques.{suffix}" for suffix in figures)
        save_torque_figure(evaluation, *files)
        progress("plotting", 1, 1)
    return {"writing": plotting - start, "plotting": time.perf_counter() - plotting}


def read_evaluation(directory: Path | str) -> Evaluation:
    """An evaluation that write_evaluation() wrote. Raises OutputError."""
    directory = Path(directory)
    file = directory / MARK
    if not directory.exists():
        with suppress(OSError, OutputError):
            restore_interrupted(directory.absolute())
    _check_marked(directory)
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        if data["schema"] != SCHEMA:
            raise OutputError(
                f"{file}: expected schema {SCHEMA}, got {data['schema']}; evaluate again"
            )
        metrics = json.loads((directory / "metrics.json").read_text(encoding="utf-8"))
        with np.load(directory / "series.npz", allow_pickle=False) as series:
            arrays = {name: series[name] for name in series.files}
        evaluation = _from_files(data, metrics, arrays)
        check_types(evaluation, "evaluation")
        _check_sizes(evaluation)
        return evaluation
    except OutputError:
        raise
    except Exception as error:  # of files that were edited or damaged, whatever their readers raise
        raise OutputError(
            f"{directory}: isn't a complete evaluation ({type(error).__name__}: {error}); evaluate "
            "again"
        ) from error


def _check_marked(directory: Path) -> None:
    """Raise OutputError unless it is the result of one recording."""
    if (directory / MARK_OF_SEVERAL).is_file():
        raise OutputError(
            f"{directory}: holds results of several recordings; name one of them, {directory}/NAME"
        )
    if not (directory / MARK).is_file():
        found = f"holds no {MARK}" if directory.is_dir() else "no such directory"
        raise OutputError(f"{directory}: {found}; expected one written by `ids evaluate`")


def _check_sizes(evaluation: Evaluation) -> None:
    """Raise ValueError unless all series have one row per sample and one column per joint."""
    log, effort = evaluation.log, evaluation.effort
    samples, joints = len(log.header_stamps), len(log.joint_names)
    stamps = ("header_stamps", "receive_stamps")
    series = {name: getattr(log, name) for name in ("q", "qd", "effort", *stamps)}
    series |= {name: getattr(evaluation, name) for name in ("qdd", "measured", "computed", "time")}
    series |= {name: getattr(evaluation.samples, name) for name in MASKS}
    for name, array in series.items():
        shape = (samples,) if name in (*MASKS, *stamps, "time") else (samples, joints)
        if array.shape != shape or not samples:
            raise ValueError(f"{name}: expected the shape {shape}, got {array.shape}")
    counts = {name: getattr(evaluation, name) for name in ("joint_names", "units", "errors")}
    counts["kept"] = evaluation.errors_of_kept
    if effort.meaning == "current":
        counts["drive_gains"] = effort.drive_gains
    for name, entries in counts.items():
        if len(entries) != joints or not joints:
            raise ValueError(f"{name}: expected {joints}, one per joint, got {len(entries)}")


def _layout(evaluation: Evaluation, bag: Path, storage: Storage) -> str:
    """For PlotJuggler, beside the bag."""
    from inverse_dynamics.figures.plotjuggler import torque_layout

    opened = next(bag.glob("*.mcap")) if storage == "mcap" else bag / "metadata.yaml"
    recording = f"{bag.name}/{opened.name}"
    topics = (MEASURED_TOPIC, COMPUTED_TOPIC)
    return torque_layout(evaluation.log, evaluation.units, topics, recording, storage)


def _series(evaluation: Evaluation) -> dict[str, Any]:
    """What series.npz holds: the arrays of the evaluation, no copies."""
    log = evaluation.log
    return {
        "time": evaluation.time,
        "header_stamps": log.header_stamps,
        "receive_stamps": log.receive_stamps,
        "q": log.q,
        "qd": log.qd,
        "qdd": evaluation.qdd,
        "effort": log.effort,
        "measured": evaluation.measured,
        "computed": evaluation.computed,
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
        "kept": {
            "samples": len(evaluation.log) - evaluation.samples.left_out,
            "joints": evaluation.errors_of_kept,
        },
        "notes": evaluation.notes,
        "diagnosis": [{**vars(c), "reference": c.reference} for c in evaluation.diagnosis],
    }


def _summary(evaluation: Evaluation) -> dict[str, Any]:
    log, robot = evaluation.log, evaluation.robot
    return {
        "schema": SCHEMA,
        "bag": str(evaluation.bag),
        "samples": len(log),
        "duration": log.duration,
        "robot": robot,
        "joint_names": list(evaluation.joint_names),
        "units": list(evaluation.units),
        "accelerations": evaluation.accelerations,
        "effort": evaluation.effort,
        "sampling": {"period": evaluation.samples.period, "jitter": evaluation.samples.jitter},
        "recording": {
            "joint_names": list(log.joint_names),
            "frame_id": log.frame_id,
            "clock": log.clock,
            "topic": log.topic,
            "storage": log.storage,
            "effort_is": log.effort_is,
            "notes": list(log.notes),
        },
        "notes": list(evaluation.notes),
        "seconds": evaluation.seconds,
    }


def _from_files(
    data: dict[str, Any], metrics: dict[str, Any], arrays: dict[str, Any]
) -> Evaluation:
    robot = data["robot"]
    for name in ("file", "urdf", "model"):
        robot[name] = None if robot[name] is None else Path(robot[name])
    robot["gravity"] = None if robot["gravity"] is None else tuple(robot["gravity"])
    for name in ("joints", "drive_gains"):
        robot[name] = tuple(robot[name])
    recording = data["recording"]
    log = JointLog(
        joint_names=tuple(recording["joint_names"]),
        header_stamps=arrays["header_stamps"],
        receive_stamps=arrays["receive_stamps"],
        q=arrays["q"],
        qd=arrays["qd"],
        effort=arrays["effort"],
        frame_id=recording["frame_id"],
        clock=recording["clock"],
        topic=recording["topic"],
        storage=recording["storage"],
        effort_is=recording["effort_is"],
        notes=tuple(recording["notes"]),
    )
    samples = Samples(**{name: arrays[name] for name in MASKS}, **data["sampling"])
    return Evaluation(
        robot=Robot(**robot),
        bag=Path(data["bag"]),
        log=log,
        joint_names=tuple(data["joint_names"]),
        units=tuple(data["units"]),
        accelerations=Accelerations(**data["accelerations"]),
        samples=samples,
        time=arrays["time"],
        qdd=arrays["qdd"],
        measured=arrays["measured"],
        computed=arrays["computed"],
        errors=_errors(metrics["joints"]),
        errors_of_kept=_errors(metrics["kept"]["joints"]),
        effort=_effort(data["effort"]),
        notes=tuple(data["notes"]),
        seconds=data["seconds"],
    )


def _effort(data: dict[str, Any]) -> Effort:
    verdict = data["verdict"]
    if verdict is not None:
        verdict = Verdict(**verdict)
    gains = tuple(data["drive_gains"])
    return Effort(**{**data, "drive_gains": gains, "verdict": verdict})


def _errors(joints: list[dict[str, Any]]) -> tuple[JointError, ...]:
    def error(joint: dict[str, Any]) -> JointError:
        figures: dict[str, Any] = {k: math.nan if v is None else v for k, v in joint.items()}
        return JointError(**figures)

    return tuple(error(joint) for joint in joints)

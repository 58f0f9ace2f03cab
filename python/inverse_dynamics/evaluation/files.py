# SPDX-License-Identifier: Apache-2.0
"""An evaluation straight into a directory of files, and back: `ids evaluate --help` lists the files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import OutputError
from inverse_dynamics.evaluation.evaluation import Evaluation, evaluate
from inverse_dynamics.evaluation.run import RunOptions, overridden
from inverse_dynamics.installation.extras import require
from inverse_dynamics.outputs.files import written_whole
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.joint_log import check_storage
from inverse_dynamics.robots.robots import Robot, load_robot
from inverse_dynamics.show.result import PAGE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Unpack

    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Storage

MARK = Evaluation.contents.mark
MARK_OF_SEVERAL = "recordings.json"  # see many_evaluations.py
_MOST_ON_A_PAGE = 3_000_000  # samples: 1 s, 170 MiB; 60 bytes more for each


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
    """evaluate() and save() of a recording that needn't fit into memory; with figures, a page too.

    parquet: name of the recording in series.parquet; None: no such file. options: those of evaluate().
    The arrays of the result lie in unnamed files, in memory only where they are looked at.

    Raises UserError.
    """
    check_writing(storage, figures, parquet=parquet is not None)
    robot = robot if isinstance(robot, Robot) else load_robot(robot)
    inputs = (Path(bag), *overridden(robot, options).files)
    with written_whole(
        Path(directory), overwrite=overwrite, contents=Evaluation.contents, inputs=inputs
    ) as target:
        evaluation = evaluate(bag, robot, progress=progress, scratch=target, **options)
        evaluation.write(target, figures, storage=storage, progress=progress)
        if parquet is not None:
            from inverse_dynamics.evaluation.exports import export_series

            file = target / "series.parquet"
            export_series(evaluation, file, recording=parquet, progress=progress)
        if figures and len(evaluation.log) <= _MOST_ON_A_PAGE:
            from inverse_dynamics.evaluation.page import report_run
            from inverse_dynamics.show.page import write_page

            progress("drawing", 0, 1)
            run = report_run(evaluation)
            write_page(target / PAGE, run.title, [run])
        return evaluation


def check_writing(storage: str | None, figures: Sequence[str], *, parquet: bool = False) -> None:
    """Raise UserError for a storage or a format that can't be written."""
    from inverse_dynamics.show.plots import check_formats

    check_formats(figures)
    if storage is not None:
        check_storage(storage)
    if parquet:
        require("a table", "pyarrow")


def read_evaluation(directory: Path | str) -> Evaluation:
    """An evaluation that save() wrote. Raises OutputError."""
    directory = Path(directory)
    _check_marked(directory)
    return Evaluation.load(directory)


def _check_marked(directory: Path) -> None:
    """Raise OutputError unless it is the result of one recording."""
    if (directory / MARK_OF_SEVERAL).is_file():
        raise OutputError(
            f"{directory}: holds results of several recordings; name one of them, {directory}/NAME"
        )
    if not (directory / MARK).is_file():
        found = f"holds no {MARK}" if directory.is_dir() else "no such directory"
        raise OutputError(f"{directory}: {found}; expected one written by `ids evaluate`")

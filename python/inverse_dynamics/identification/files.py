# SPDX-License-Identifier: Apache-2.0
"""An identification as files: a robot for every verb, and its errors.

arm.yaml         run configuration: `ids evaluate RECORDING --robot arm.yaml`
arm_model.yaml   the model: rigid bodies, friction, 95 % band and range of the data (docs/model_file.md)
arm_model.json   what the model may be wrong by, for `ids payload` and `contact`
arm.json         all values
arm.html         the report's page
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics.errors import OutputError
from inverse_dynamics.identification.page import render_identification
from inverse_dynamics.identification.result import model_file_text
from inverse_dynamics.identification.tables import held_out_table
from inverse_dynamics.identification.uncertainty import uncertainty_text
from inverse_dynamics.outputs.files import check_output_file, files_written_whole, write_text
from inverse_dynamics.outputs.plain import json_text, plain
from inverse_dynamics.robots.model_errors import model_errors_file
from inverse_dynamics.robots.robot_files import robot_text
from inverse_dynamics.robots.robots import RIGID_BODY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.identification.hold_out import HoldOut
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.show.tables import ReportTable

SCHEMA = 1


class IdentificationFiles(NamedTuple):
    """The files of an identification."""

    robot: Path
    model: Path
    uncertainty: Path
    figures: Path
    page: Path


def identification_files(out: Path | str) -> IdentificationFiles:
    """The files that belong to the run configuration `out`. Raises OutputError."""
    out = Path(out)
    if out.suffix not in (".yaml", ".yml"):
        raise OutputError(
            f"{out}: expected a name ending in .yaml, as --robot takes it; name another file with --out"
        )
    model = out.with_name(f"{out.stem}_model{out.suffix}")
    return IdentificationFiles(
        out,
        model,
        model_errors_file(model),
        out.with_suffix(".json"),
        out.with_suffix(".html"),
    )


def check_identification_files(
    out: Path | str,
    *,
    overwrite: bool = False,
    more: Mapping[str, Path] | None = None,
    inputs: tuple[Path | None, ...] = (),
) -> IdentificationFiles:
    """The files, which may be written. more: others, by option. Raises OutputError."""
    files = identification_files(out)
    named = [("--out", file) for file in files] + list((more or {}).items())
    for option, file in named:
        check_output_file(file, overwrite=overwrite, option=option, inputs=inputs)
    places = [file.absolute() for _, file in named]
    for (option, file), place in reversed(list(zip(named, places, strict=True))):
        if places.count(place) > 1:
            raise OutputError(
                f"{file}: expected a file of its own for {option}, got one of the other results; "
                "name another file"
            )
    return files


def write_identification(
    found: Identification,
    out: Path | str,
    *,
    overwrite: bool = False,
    more: Mapping[Path, str] | None = None,
    tests: Sequence[HoldOut] = (),
) -> IdentificationFiles:
    """Write all files of a model, or none of them: those that `ids identify --help` lists.

    Parameters
    ----------
    found
        The model.
    out
        The run configuration, a .yaml file; the others have its name.
    overwrite
        Replace older files.
    more
        Texts of further files, by file.
    tests
        Errors on recordings that nothing was fitted to.

    Raises
    ------
    UserError
        OutputError.
    """
    more = more or {}
    inputs = (*found.recordings, *found.robot.files)
    options = {f"{file}": file for file in more}
    files = check_identification_files(out, overwrite=overwrite, more=options, inputs=inputs)
    name = files.robot.stem
    model = model_file_text(found, f"{name}_model")
    texts = {
        files.model: model,
        files.uncertainty: uncertainty_text(found, model),
        files.figures: json_text(summary(found, tests)),
        files.page: render_identification(found, [_table_of(found, test) for test in tests]),
        **more,
        files.robot: _run_configuration(found, files),  # last: it names the model
    }
    with files_written_whole(list(texts)) as fresh:
        for file, text in zip(fresh, texts.values(), strict=True):
            write_text(file, text)
        # the solver's own reader computes the rows of checks, or raises SolverError
        _core.Solver(RIGID_BODY, model=str(dict(zip(texts, fresh, strict=True))[files.model]))
    return files


def _run_configuration(found: Identification, files: IdentificationFiles) -> str:
    robot, gains = found.robot, found.model.drive_gains
    names = ", ".join(path.name for path in found.recordings)
    identified = replace(
        robot,
        name=files.robot.stem,
        description=f"{robot.name}, identified from {names}",
        plugin=RIGID_BODY,
        model=files.model,
        friction=True,
        drive_gains=robot.drive_gains if gains is None else tuple(gains.tolist()),
        source=f"identified from {names}: {files.page.name}, {files.figures.name}",
    )
    return robot_text(identified, files.robot)


def _table_of(found: Identification, test: HoldOut) -> ReportTable:
    title, notes = f"Error on {test.recording.name}", "; ".join(test.notes)
    return held_out_table(found, title, notes, rmse=test.rmse, coverage=test.coverage)


def summary(found: Identification, tests: Sequence[HoldOut] = ()) -> dict[str, Any]:
    """Everything but the samples, for JSON. tests: recordings that were held out."""
    robot = found.robot
    return {
        "schema": SCHEMA,
        "robot": robot.name,
        "plugin": robot.plugin,
        "urdf": None if robot.urdf is None else str(robot.urdf),
        **{
            name: plain(getattr(found, name))
            for name in found.__dataclass_fields__
            if name not in ("robot", "blocks", "factor", "band")
        },
        "hold_out": [plain(test) for test in tests],
        "blocks": [
            {
                "recording": block.recording,
                "from": float(block.time[0]),
                "to": float(block.time[-1]),
                "samples": int(block.counts.sum()),
                "law": block.law,
                "prior_strength": block.prior_strength,
                "delay": block.delay,
                "band": plain(block.band.mean(axis=0)),
                "rmse": {
                    column: plain(np.sqrt((errors**2).mean(axis=0)))
                    for column, errors in block.errors.items()
                },
            }
            for block in found.blocks
        ],
    }

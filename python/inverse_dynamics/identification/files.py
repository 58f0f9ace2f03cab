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
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from inverse_dynamics.identification.result import model_file_text
from inverse_dynamics.identification.uncertainty import uncertainty_text
from inverse_dynamics.outputs.plain import json_text, plain
from inverse_dynamics.robots.robot_files import robot_text
from inverse_dynamics.robots.robots import RIGID_BODY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from inverse_dynamics.identification.hold_out import HoldOut
    from inverse_dynamics.identification.result import Identification

SCHEMA = 1


class IdentificationFiles(NamedTuple):
    """The files of an identification."""

    robot: Path
    model: Path
    uncertainty: Path
    figures: Path
    page: Path


def write_identification(
    found: Identification,
    out: Path | str,
    *,
    overwrite: bool = False,
    more: Mapping[Path, str] | None = None,
    tests: Sequence[HoldOut] = (),
) -> IdentificationFiles:
    """Write all files of a model, or none of them, and give their names.

    Parameters
    ----------
    found, out, overwrite, more
        As Identification.save() takes them.
    tests
        Errors on recordings that nothing was fitted to.

    Raises
    ------
    UserError
        OutputError.
    """
    found = replace(found, hold_out=(*found.hold_out, *tests))
    found.save(out, overwrite=overwrite, more=more)
    return IdentificationFiles(*found.files(out))


def identification_texts(found: Identification, files: Sequence[Path]) -> tuple[str, ...]:
    """Contents of the files, in their order. Raises RobotError, SolverError."""
    named = IdentificationFiles(*files)
    model = model_file_text(found, f"{named.robot.stem}_model")
    return (
        _run_configuration(found, named),
        model,
        uncertainty_text(found, model),
        json_text(found.numbers()),
        found.page(),
    )


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


def identification_numbers(found: Identification) -> dict[str, Any]:
    """Everything but the samples, for JSON."""
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

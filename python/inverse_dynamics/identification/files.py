# SPDX-License-Identifier: Apache-2.0
"""An identification as files: a robot for every verb, and its errors.

arm.yaml         run configuration: `ids evaluate RECORDING --robot arm.yaml`
arm_model.yaml   the model: rigid bodies, friction, 95 % band and range of the data (docs/model_file.md)
arm_model.json   what the model may be wrong by, for `ids payload` and `contact`
arm.json         all numbers
arm.html         the report's page
arm.npz          the Identification, for Identification.load()
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from inverse_dynamics.evaluation.posture import locked_joints
from inverse_dynamics.identification.result import identified_model, urdf_of
from inverse_dynamics.robots.robot_files import robot_text
from inverse_dynamics.robots.robots import RIGID_BODY
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.identification.hold_out import HoldOut
    from inverse_dynamics.identification.result import Identification


class IdentificationFiles(NamedTuple):
    """The files of an identification."""

    robot: Path
    series: Path
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


def model_file_text(found: Identification, name: str, origin: str = "`ids identify`") -> str:
    """The model as a model file (docs/model_file.md), with every digit. Raises RobotError, SolverError.

    origin: what made the model.
    """
    names = listed([path.name for path in found.recordings])
    errors = "; ".join(
        f"{where}{_errors_told(found, rmse)}"
        for where, rmse in (
            ("", found.held_out["identified"]),
            *((f"on {test.recording.name} ", test.rmse["identified"]) for test in found.hold_out),
        )
    )
    findings = "".join(f" {finding.text}." for finding in found.findings)
    at = [f"{joint} at {q:.4g}" for joint, q in locked_joints(found.robot).items()]
    posture = f"Joints that it lacks are held: {listed(at)}. " if at else ""
    return identified_model(found).file_text(
        name=name,
        source=f"{origin} on {counted(len(found.recordings), 'recording')} ({names}): {found.samples} samples, "
        f"{found.duration:.1f} s; prior and geometry: {urdf_of(found).name}; friction law "
        f"{found.law}, prior strength {found.prior_strength:g}, torque delay {1e3 * found.delay:.1f} "
        f"ms; {found.filter}; efforts: {found.effort}",
        validity=f"All links are physically consistent, so H is positive definite. {posture}Root mean square error on "
        f"data that were held out: {errors}. Within the ranges stated as `seen`, of the robot, load and "
        "temperature of the recordings: friction and offset differ on another day. Masses of single "
        f"links are mostly those of the description: torques don't determine them.{findings}",
    )


def _errors_told(found: Identification, rmse: Floats) -> str:
    """RMSE (n,) of each joint."""
    return ", ".join(
        f"{joint} {value:.3g} {unit}"
        for joint, value, unit in zip(found.joints, rmse, found.units, strict=True)
    )


def run_configuration_text(found: Identification, files: Sequence[Path]) -> str:
    """The identified robot, for --robot of every verb. Raises RobotError."""
    file, model, _, figures, page = files
    robot, gains = found.robot, found.model.drive_gains
    names = ", ".join(path.name for path in found.recordings)
    identified = replace(
        robot,
        name=file.stem,
        description=f"{robot.name}, identified from {names}",
        plugin=RIGID_BODY,
        model=model,
        friction=True,
        drive_gains=robot.drive_gains if gains is None else tuple(gains.tolist()),
        source=f"identified from {names}: {page.name}, {figures.name}",
    )
    return robot_text(identified, file)

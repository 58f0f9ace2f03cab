# SPDX-License-Identifier: Apache-2.0
"""An identified model as a model file (docs/model_file.md), with every digit.

text = model_file_text(found, "arm")
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics._core import FastModel
from inverse_dynamics.base.wording import counted, listed
from inverse_dynamics.errors import RobotError
from inverse_dynamics.robot.descriptions import read_description

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.identification.result import Identification


def model_file_text(found: Identification, name: str) -> str:
    """The text of the model file. Raises RobotError, SolverError."""
    return identified_model(found).file_text(
        name=name, source=_source(found), validity=_validity(found)
    )


def identified_model(found: Identification) -> FastModel:
    """The description's chain with the identified links, rotors and friction. Raises RobotError."""
    robot = found.robot
    described = FastModel.from_urdf(
        read_description(urdf_of(found)), root=robot.root, tip=robot.tip, gravity=robot.gravity
    )
    return described.identified(found.model)


def urdf_of(found: Identification) -> Path:
    """The description that was started from. Raises RobotError."""
    if found.robot.urdf is None:
        raise RobotError(
            f"robot {found.robot.name}: expected a description, whose geometry the model has; give --urdf"
        )
    return found.robot.urdf


def _source(found: Identification) -> str:
    names = listed([path.name for path in found.recordings])
    return (
        f"`ids identify` on {counted(len(found.recordings), 'recording')} ({names}): {found.samples} samples, "
        f"{found.duration:.1f} s; prior and geometry: {urdf_of(found).name}; friction law "
        f"{found.law}, prior strength {found.prior_strength:g}, torque delay {1e3 * found.delay:.1f} "
        f"ms; {found.filter}; efforts: {found.effort}"
    )


def _validity(found: Identification) -> str:
    error = ", ".join(
        f"{joint} {value:.3g} {unit}"
        for joint, value, unit in zip(
            found.joints, found.held_out["identified"], found.units, strict=True
        )
    )
    return (
        "All links are physically consistent, so H is positive definite. Root mean square error on "
        f"data that were held out: {error}. Within the ranges stated as `seen`, of the robot, load and "
        "temperature of the recordings: friction and offset differ on another day. Masses of single "
        "links are mostly those of the description: torques don't determine them."
    )

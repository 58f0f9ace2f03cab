# SPDX-License-Identifier: Apache-2.0
"""An identified model as a model file (docs/model_file.md), with every digit.

    text = model_file_text(found, "arm")

The frames of the links are those of the description, so that parameters can be compared with it. Rows of
checks are what the identification predicts, computed from the description and the identified values
and not from the file: whoever reads the file checks that it gives the same torques.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics.base.wording import counted, listed
from inverse_dynamics.errors import RobotError
from inverse_dynamics.results.yaml_text import (
    yaml_entries,
    yaml_list,
    yaml_mapping,
    yaml_number,
    yaml_text,
)
from inverse_dynamics.robot.chain_geometry import chain_geometry, roll_pitch_yaw
from inverse_dynamics.robot.descriptions import read_description
from inverse_dynamics.robot.link_parameters import turned

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.identification.result import Identification, IdentifiedModel
    from inverse_dynamics.robot.chain_geometry import JointGeometry

SCHEMA = 2
LAW = "smooth_coulomb"
PLACES = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")

_CHECKED_STATES = 4
_TOLERANCE = 1e-9  # N m: rounding, of frames that are turned to the axes of the joints and back


def model_file_text(found: Identification, name: str) -> str:
    """The text of the model file. Raises RobotError, SolverError."""
    description = read_description(urdf_of(found))
    engine = _engine(found, description)
    geometry = chain_geometry(description, found.robot.root, found.joints)
    links = parameters_in_links(found, geometry)
    lines = [
        "# SPDX-License-Identifier: Apache-2.0",
        "#",
        "# Written by `ids identify`; what each key means: docs/model_file.md. A row of `link` is",
        f"# {', '.join(PLACES)}.",
        f"schema: {SCHEMA}",
        f"name: {yaml_text(name)}",
        f"source: {yaml_text(_source(found))}",
        f"validity: {yaml_text(_validity(found))}",
        "units: SI",
        "",
        "geometry: placements",
        f"gravity: {yaml_list(_gravity(found))}",
        "parameters: about_origin",
        f"tip: {_tip(engine, geometry)}",
        "",
        "joints:",
    ]
    for j, joint in enumerate(geometry):
        lines += _joint_lines(found.model, j, joint, links[j])
    lines += ["checks:", f"  tolerance: {_TOLERANCE!r}", "  states:"]
    lines += [f"    - {yaml_mapping(state)}" for state in _checks(found, engine)]
    return "\n".join(lines) + "\n"


def parameters_in_links(
    found: Identification, geometry: Iterable[JointGeometry], *, prior: bool = False
) -> Floats:
    """(n, 10) about the origins of the description's link frames. prior: those of the prior."""
    of_engine = found.prior if prior else found.model.parameters
    return np.array(
        [turned(row, joint.rotation_from_z) for row, joint in zip(of_engine, geometry, strict=True)]
    )


def predicted_torques(
    model: IdentifiedModel, engine: _core.FastModel, q: Floats, qd: Floats, qdd: Floats
) -> Floats:
    """(N, n) of the identification's values, by the regressor of the description's chain.

    engine: of the description. Independent of the model file and of its reader.
    """
    still = np.zeros_like(q)
    parameters = model.parameters.ravel()
    torques = engine.regressor(q, qd, qdd) @ parameters + model.rotor_inertia * qdd
    gravity = engine.regressor(q, still, still) @ parameters
    for j, law in enumerate(model.friction):
        torques[:, j] += friction_torque(law, qd[:, j], gravity[:, j])
    return np.asarray(torques)


def friction_torque(law: Mapping[str, float], qd: Floats, gravity: Floats) -> Floats:
    """(N,) of the law smooth_coulomb: docs/model_file.md."""
    height = law["fc"] + law.get("fl", 0.0) * np.abs(gravity)
    if law.get("fs", 0.0):
        height = height + law["fs"] * np.exp(-((qd / law["vs"]) ** 2))
    step = np.tanh((qd + law.get("shift", 0.0)) / law["width"])
    return np.asarray(law["fv"] * qd + law.get("fo", 0.0) + height * step)


def urdf_of(found: Identification) -> Path:
    """The description that was started from. Raises RobotError."""
    if found.robot.urdf is None:
        raise RobotError(
            f"robot {found.robot.name}: expected a description, whose geometry the model has; give --urdf"
        )
    return found.robot.urdf


def _gravity(found: Identification) -> tuple[float, float, float]:
    return found.robot.gravity or (0.0, 0.0, -9.81)


def _engine(found: Identification, description: str) -> _core.FastModel:
    robot = found.robot
    return _core.FastModel.from_urdf(
        description, root=robot.root, tip=robot.tip, gravity=_gravity(found)
    )


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


def _tip(engine: _core.FastModel, geometry: Iterable[JointGeometry]) -> str:
    """Pose of the tip in the last link's frame."""
    last = np.eye(4)
    for joint in geometry:
        last = last @ joint.pose
    rotation, position = engine.tip_pose(np.zeros(len(engine.joint_names)))
    xyz = last[:3, :3].T @ (position - last[:3, 3])
    rpy = roll_pitch_yaw(last[:3, :3].T @ rotation)
    return yaml_mapping({"xyz": _without_rounding(xyz), "rpy": _without_rounding(rpy)})


def _without_rounding(numbers: Floats) -> Floats:
    return np.where(np.abs(numbers) < 1e-14, 0.0, numbers)


def _joint_lines(
    model: IdentifiedModel, j: int, joint: JointGeometry, parameters: Floats
) -> list[str]:
    lines = [
        f"  - name: {yaml_text(joint.name)}",
        f"    type: {joint.type}",
        f"    placement: {yaml_mapping({'xyz': joint.xyz, 'rpy': joint.rpy, 'axis': joint.axis})}",
    ]
    if joint.limits:
        lines.append(f"    limits: {yaml_mapping(joint.limits)}")
    if model.rotor_inertia[j] > 0:
        lines.append(f"    rotor_inertia: {yaml_number(model.rotor_inertia[j])}")
    seen = {name: model.seen[k, j] for k, name in enumerate(("q", "qd", "qdd"))}
    friction = {key: value for key, value in model.friction[j].items() if key != "law"}
    return [
        *lines,
        f"    friction: {{law: {LAW}, {yaml_entries(friction)}}}",
        f"    link: {yaml_list(parameters)}",
        f"    torque_deviation: {yaml_number(model.torque_deviation[j])}",
        f"    seen: {yaml_mapping(seen)}",
        "",
    ]


def _checks(found: Identification, engine: _core.FastModel) -> list[dict[str, Floats]]:
    """States within what was seen, and the torques that the identification predicts there."""
    low, high = np.moveaxis(found.model.seen, 2, 0)  # (3, n) each
    shares = np.random.default_rng(0).uniform(size=(_CHECKED_STATES, *low.shape))
    states = low + (high - low) * shares
    q, qd, qdd = (np.ascontiguousarray(states[:, k]) for k in range(3))
    torques = predicted_torques(found.model, engine, q, qd, qdd)
    return [
        {"q": q[k], "qd": qd[k], "qdd": qdd[k], "torques": torques[k]}
        for k in range(_CHECKED_STATES)
    ]

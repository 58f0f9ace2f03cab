# SPDX-License-Identifier: Apache-2.0
"""Where a recording has the joints that the chain carries but doesn't consist of.

    posture = posture_of("recording", robot, description, solver.joint_names)
    robot = replace(robot, parameters={**robot.parameters, **posture.parameters})

A waist carries both arms, though the chain is one of them: the posture of the other one decides what the
waist has to bear. A solver holds such joints at one position each, `locked_joints.JOINT`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import RobotDescription
from inverse_dynamics.recordings.log_format import LogFormat
from inverse_dynamics.recordings.recordings import position_ranges
from inverse_dynamics.robots.solvers import brings_own_model
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Parameter
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.recordings.joint_log import Recorded
    from inverse_dynamics.robots.robots import Robot

LOCKED = "locked_joints."

# A joint that moves less is held: 10 kg at 1 m load a joint by 2 N m more or less then, and the finger
# of a gripper, which travels as far, weighs some grams.
_STILL = {"rad": 0.02, "m": 0.05}


@dataclass(frozen=True)
class Posture:
    """Parameters of the solver that hold the joints, and notes that say so."""

    parameters: dict[str, Parameter] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    moves: bool = False  # then no held position is right


def motors_of(robot: Robot) -> dict[str, Parameter]:
    """Parameters of a run configuration that make motors the coordinates of the mechanism."""
    return {
        key: robot.parameters[key] for key in ("motors", "motor_names") if robot.parameters.get(key)
    }


def locked_joints(robot: Robot) -> dict[str, float]:
    """Positions of `locked_joints.JOINT` among the parameters of a run configuration, by joint."""
    return {
        name.removeprefix(LOCKED): float(value)
        for name, value in robot.parameters.items()
        if name.startswith(LOCKED)
    }


def posture_of(
    bag: Recorded,
    robot: Robot,
    description: str,
    joint_names: Sequence[str],
    *,
    topic: str | None = None,
) -> Posture:
    """Positions of the joints that the chain of joint_names carries.

    Positions that the run configuration gives stay, and a note says where the recording has others.
    Nothing where torques aren't computed from the description. Raises BagError.
    """
    if not description or robot.model is not None or robot.parameters.get("attached") == "ignore":
        return Posture()
    units = carried_joints(RobotDescription(description), joint_names, robot.root)
    if not units or brings_own_model(robot):
        return Posture()
    turning = [joint for joint, unit in units.items() if unit == "rad"]
    ranges = position_ranges(
        bag,
        list(units),
        turning=turning,
        topic=topic or "",
        usual_topic=robot.topic,
        form=LogFormat.of(robot),
    )
    held: dict[str, Parameter] = {}
    stated = locked_joints(robot)
    told, moving, others = [], [], []
    for joint, (least, mean, greatest) in ranges.items():
        unit, position = units[joint], stated.get(joint, mean)
        if joint not in stated and mean != 0.0:
            held[f"{LOCKED}{joint}"] = mean
            told.append(f"{joint} {mean:.4g} {unit}")
        if greatest - least > _STILL[unit]:
            moving.append(f"{joint} ({least:.3g} to {greatest:.3g} {unit})")
        elif abs(position - mean) > _STILL[unit]:
            others.append(f"{joint} at {mean:.4g} {unit}, locked_joints at {position:.4g} {unit}")
    return Posture(held, tuple(_notes(told, moving, others)), bool(moving))


def still_joints(evaluations: Sequence[Evaluation]) -> Posture:
    """Where joints of the chain are held that stand still in all recordings: they show neither friction nor inertia."""
    low = np.min([e.log.q.min(axis=0) for e in evaluations], axis=0)
    high = np.max([e.log.q.max(axis=0) for e in evaluations], axis=0)
    units = ["m" if unit == "N" else "rad" for unit in evaluations[0].units]
    found = {
        joint: (float(q), unit)
        for joint, q, way, unit in zip(
            evaluations[0].joint_names, (low + high) / 2, high - low, units, strict=True
        )
        if way < _STILL[unit]
    }
    held = listed([f"{joint} at {q:.4g} {unit}" for joint, (q, unit) in found.items()])
    note = f"held, as they stand still: {held}; the model is that of the other joints, and of this posture"
    return Posture({f"{LOCKED}{joint}": q for joint, (q, _) in found.items()}, (note,))


def carried_joints(robot: RobotDescription, chain: Sequence[str], root: str = "") -> dict[str, str]:
    """Units (rad, m) of the joints that move by themselves beside a chain, on a link that it moves.

    chain: names of its joints; root: the link it starts at; none: the description's.
    """
    others = [joint for joint in robot.joints if joint.name not in chain]
    still = [root or robot.root]
    for link in still:  # grows by what is connected to the root without a joint of the chain
        near = [ends for j in others if link in (ends := (j.parent, j.child))]
        still += [end for ends in near for end in ends if end not in still]
    return {
        joint.name: "m" if joint.type == "prismatic" else "rad"
        for joint in others
        if joint.type in ("revolute", "continuous", "prismatic")
        and joint.mimic is None
        and joint.parent not in still
    }


def _notes(told: list[str], moving: list[str], others: list[str]) -> list[str]:
    notes = []
    if told:
        notes.append(
            f"joints beside the chain are held where the recording has them (mean): {listed(told)}; "
            "another position: --parameter locked_joints.JOINT=..."
        )
    if others:
        notes.append(
            f"joints beside the chain are held, but not where the recording has them: {listed(others)}"
        )
    if moving:
        notes.append(
            f"joints beside the chain move: {listed(moving)}; the torques don't include it, so joints that "
            "carry them are wrong by that motion; no cause of the errors is looked for: record with "
            "these joints at rest, or choose a root behind them"
        )
    return notes

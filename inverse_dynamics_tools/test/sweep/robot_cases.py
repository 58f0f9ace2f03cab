# SPDX-License-Identifier: Apache-2.0
"""Run configurations, spoiled one line at a time; checked by `ids robots FILE`."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from entry_points import ids
from outcome import Case, Expected
from yaml_text import NOT_A_MAPPING, spoiled

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

ROBOT = """schema: 1
name: arm
description: An arm
plugin: rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody
urdf: package://inverse_dynamics_robots/urdf/ur10.urdf
root: base_link
tip: tool0
gravity: [0, 0, -9.81]
topic: /joint_states
friction: true
effort: torque
accelerations:
  method: low-pass
  cutoff: 10
"""

_FAULTS = {
    "unknown plugin": ("RigidBody", "RigidBodi"),
    "plugin without a class": ("/InverseDynamicsSolverRigidBody", ""),
    "unknown tip": ("tip: tool0", "tip: tol0"),
    "unknown root": ("root: base_link", "root: bas_link"),
    "missing URDF": ("ur10.urdf", "ur11.urdf"),
    "missing package": ("inverse_dynamics_robots", "inverse_dynamics_robot"),
    "a URDF that is a directory": ("/urdf/ur10.urdf", "/urdf"),
    "a URDF that is something else": ("urdf/ur10.urdf", "models/ur10_identified.yaml"),
    "two numbers of gravity": ("[0, 0, -9.81]", "[0, -9.81]"),
    "gravity as a number": ("[0, 0, -9.81]", "-9.81"),
    "friction as a text": ("friction: true", "friction: 'true'"),
    "friction as yes": ("friction: true", "friction: yes"),
    "unknown method": ("low-pass", "low pass"),
    "negative cut-off": ("cutoff: 10", "cutoff: -10"),
    "unknown effort": ("effort: torque", "effort: torqe"),
    "a joint that the URDF lacks": ("topic:", "joints: [a, b, c, d, e]\ntopic:"),
    "joints twice": ("topic:", "joints: [a, a, b, c, d, e]\ntopic:"),
    "negative drive gains": ("topic:", "drive_gains: [-1, 1, 1, 1, 1, 1]\ntopic:"),
    "too few drive gains": ("topic:", "drive_gains: [1, 1]\ntopic:"),
    "a name that leaves the folder": ("name: arm", "name: ../../../escaped"),
    "a parameter that no solver knows": ("topic:", "parameters: {max_thread: 3}\ntopic:"),
    "a parameter of another type": ("topic:", "parameters: {batch_threads: many}\ntopic:"),
    "an unknown key of no meaning": ("topic:", "colour: red\ntopic:"),
}


def cases(directory: Path) -> Iterator[Case]:
    """Each fault, in a file of its own."""
    yield _case("as it is", directory, ROBOT.encode(), Expected(refused=False, right=True))
    for fault in spoiled(ROBOT):
        yield _case(fault.name, directory, fault.text.encode(), Expected(place=r"\.yaml:\d+"))
    for name, (before, after) in _FAULTS.items():
        assert before in ROBOT
        changed = ROBOT.replace(before, after).encode()
        yield _case(name, directory, changed, Expected(place=r"\.yaml|robot arm|arm"))
    swapped = ROBOT.replace("root: base_link\ntip: tool0", "root: tool0\ntip: base_link")
    held = Expected(refused=False, warned=True, mention="swap root and tip")
    yield _case("root and tip swapped", directory, swapped.encode(), held)
    for name, content in NOT_A_MAPPING.items():
        yield _case(name, directory, content, Expected(place=r"\.yaml"))


def _case(name: str, directory: Path, content: bytes, expected: Expected) -> Case:
    place = directory / f"{sum(1 for _ in directory.iterdir())}"
    place.mkdir()
    file = place / "arm.yaml"
    file.write_bytes(content)
    return Case(f"{name} [ids robots]", partial(ids, "robots", file, capture=place), expected)

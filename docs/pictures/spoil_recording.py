# SPDX-License-Identifier: Apache-2.0
"""Put a mistake into a recording: those of docs/why_dont_my_torques_match.md that no simulator makes.

python3 docs/pictures/spoil_recording.py degrees RECORDING SPOILED
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import load_robot, read_joint_log, write_joint_logs
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.solvers import open_solver

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics import JointLog

ROBOT = "ur10_simulated"
DRIVE_GAINS = np.array([13.5841, 14.2959, 11.3716, 11.2408, 11.7681, 11.7682])  # N m/A, UR10


def currents(log: JointLog) -> JointLog:
    """Efforts are motor currents [A]."""
    return replace(log, effort=log.effort / DRIVE_GAINS)


def without_gravity(log: JointLog) -> JointLog:
    """The driver has taken the torque of gravity off."""
    robot = load_robot(ROBOT)
    assert robot.urdf is not None
    solver = open_solver(robot, read_description(robot.urdf))
    return replace(log, effort=log.effort - solver.gravity_vector(log.q))


def numbered(log: JointLog) -> JointLog:
    """Joints are numbered in the order of a message that begins with the elbow."""
    order = [2, 1, 0, 3, 4, 5]
    return replace(
        log,
        joint_names=tuple(f"joint_{i + 1}" for i in range(len(order))),
        q=log.q[:, order],
        qd=log.qd[:, order],
        effort=log.effort[:, order],
    )


def degrees(log: JointLog) -> JointLog:
    """Positions and velocities in degrees."""
    return replace(log, q=np.degrees(log.q), qd=np.degrees(log.qd))


def reversed_effort(log: JointLog) -> JointLog:
    """The elbow's effort counts against the direction of its joint."""
    return replace(log, effort=log.effort * [1, 1, -1, 1, 1, 1])


def slow_clock(log: JointLog) -> JointLog:
    """Stamps of a clock at half speed: of a simulator, or a recording played again."""
    stamps = log.header_stamps
    return replace(log, header_stamps=stamps[0] + (stamps - stamps[0]) // 2)


MISTAKES: dict[str, Callable[[JointLog], JointLog]] = {
    make.__name__: make
    for make in (currents, without_gravity, numbered, degrees, reversed_effort, slow_clock)
}


def main() -> None:
    """Read, spoil, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mistake", choices=tuple(MISTAKES))
    parser.add_argument("recording", type=Path)
    parser.add_argument("spoiled", type=Path)
    given = parser.parse_args()
    log = MISTAKES[given.mistake](read_joint_log(given.recording))
    write_joint_logs(given.spoiled, {log.topic: log}, storage=log.storage)


if __name__ == "__main__":
    main()

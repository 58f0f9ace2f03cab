# SPDX-License-Identifier: Apache-2.0
"""What few false alarms cost in sensitivity: prints the table of docs/contact.md."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from studies import ROBOTS, identified, recording_of, table

from inverse_dynamics.contacts.contacts import find_contacts
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import load_robot

RATES = (0.01, 0.1, 1.0, 10.0, 100.0)  # false alarms per hour
DIRECTIONS = 2000


def least_forces(robot: Path, recording: Path, rate: float) -> str:
    """Forces [N] at the tip that are a contact in half, and in nine tenths, of states and directions."""
    found = find_contacts(recording, robot, false_alarms=rate)
    random = np.random.default_rng(0)
    states = random.choice(found.evaluation.log.q, DIRECTIONS)
    forces = random.standard_normal((DIRECTIONS, 3))
    forces /= np.linalg.norm(forces, axis=1)[:, None]
    wrenches = np.hstack([forces, np.zeros_like(forces)])
    solver = Arm(load_robot(robot)).solver
    torques = np.array(
        [solver.external_torques(q, wrench) for q, wrench in zip(states, wrenches, strict=True)]
    )
    least = 1 / (np.abs(torques) / found.thresholds.torques).max(axis=1)
    return f"{np.median(least):.0f}, {np.quantile(least, 0.9):.0f}"


if __name__ == "__main__":
    rows = []
    for name in ROBOTS:
        with TemporaryDirectory() as directory:
            robot = write_identification(identified(name), Path(directory) / "arm.yaml").robot
            forces = [least_forces(robot, recording_of(name), rate) for rate in RATES]
        rows.append((name, *forces))
    print(table(("false alarms per hour", *(f"{rate:g}" for rate in RATES)), rows))

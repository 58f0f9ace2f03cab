# SPDX-License-Identifier: Apache-2.0
"""What few false alarms cost in sensitivity: prints the tables of docs/contact.md.

    ./scripts/contact_sensitivity      # five minutes

The recordings are those of `ids data`, or of $IDS_DATA_DIR.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from inverse_dynamics.contact import ContactDetector, contact_thresholds
from inverse_dynamics.data.public_recordings import data_directory
from inverse_dynamics.evaluation.contacts import find_contacts
from inverse_dynamics.evaluation.evaluation import Arm
from inverse_dynamics.identification.identify import identify
from inverse_dynamics.results.identifications import write_identification
from inverse_dynamics.robot.robots import load_robot

ROBOTS = {"ur10_real": "ur10_exciting_trajectory", "panda_real": "panda_exciting_trajectory"}
RATES = (0.01, 0.1, 1.0, 10.0, 100.0)  # false alarms per hour
LENGTHS = (10, 30, 100, 300, 1000, 3000)  # correlation times
TAILS = {"Gaussian": 1.0, "between": 1.5, "exponential": 2.0}  # powers of Gaussian noise
JOINTS = 6
PERIOD, TIME = 0.02, 0.1  # s; of samples; of correlation
TRIALS = 20
HOURS = 2.0
DIRECTIONS = 2000


def noise(random: np.random.Generator, count: int, joints: int, power: float) -> np.ndarray:
    """Noise (count, joints) whose correlation falls to 1/e within TIME."""
    share = np.exp(-PERIOD / TIME)
    values = np.sqrt(1 - share**2) * random.standard_normal((count, joints))
    for k in range(1, count):
        values[k] += share * values[k - 1]
    powers: np.ndarray = np.sign(values) * np.abs(values) ** power
    return powers


def print_lengths() -> None:
    """Thresholds and false alarms by the length of the quiet part."""
    random = np.random.default_rng(0)
    names = [f"joint {j}" for j in range(JOINTS)]
    print("| quiet part | " + " | ".join(TAILS) + " |")
    print("|---|" + "---|" * len(TAILS))
    samples = round(HOURS * 3600 / PERIOD)
    hours = {tail: noise(random, samples, JOINTS, power) for tail, power in TAILS.items()}
    time = PERIOD * np.arange(samples)
    for length in LENGTHS:
        row = []
        for tail, power in TAILS.items():
            multiples, alarms = [], 0
            quiet = noise(random, round(length * TIME / PERIOD), JOINTS * TRIALS, power)
            for trial in range(TRIALS):
                part = quiet[:, trial * JOINTS : (trial + 1) * JOINTS]
                thresholds = contact_thresholds(part, PERIOD, 1.0, names).torques
                multiples.append(np.median(thresholds / hours[tail].std(axis=0)))
                found = ContactDetector(thresholds, names).run(time, hours[tail])
                alarms += int((np.diff(found, prepend=False) & found).sum())
            row.append(f"{np.median(multiples):.1f}, {alarms / HOURS / TRIALS:.2f}")
        print(f"| {length} t | " + " | ".join(row) + " |")


def least_forces(robot: Path, recording: Path, rate: float) -> tuple[float, float]:
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
    return float(np.median(least)), float(np.quantile(least, 0.9))


def print_forces() -> None:
    """Forces that are found on real robots, by the stated rate."""
    print("| false alarms per hour | " + " | ".join(f"{rate:g}" for rate in RATES) + " |")
    print("|---|" + "---|" * len(RATES))
    for name, folder in ROBOTS.items():
        recording = data_directory() / "bags" / folder
        with TemporaryDirectory() as directory:
            identified = identify([recording], name)
            robot = write_identification(identified, Path(directory) / "arm.yaml").robot
            forces = [least_forces(robot, recording, rate) for rate in RATES]
        cells = (f"{half:.0f}, {most:.0f}" for half, most in forces)
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    print_lengths()
    print()
    print_forces()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How good a motion for identification can be: the table of docs/excitation.md.

    python benchmarks/excitation_frontier.py --robot panda_simulated --repeat 1 2 3

The standard deviation of predicted torques after what `ids excite` finds in 20 s, so many times, over that after the
stored motion in 20 s, both within the same limits; and the ratio for the best set of states within the limits in the
same time, as if the arm could jump from one to the next. The best set is searched for among random states by the
multiplicative algorithm [Silvey, Titterington, Torsney, Communications in Statistics A 7(14), 1978].
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from inverse_dynamics.excitation.excitation import (
    ExcitationOptions,
    motion_gram,
    optimise_excitation,
)
from inverse_dynamics.excitation.information import CORRELATION, Unknowns
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import load_robot
from inverse_dynamics.simulation.collision import ContactChecker
from inverse_dynamics.simulation.configuration import StatedSimulation
from inverse_dynamics.simulation.model import SimulatedRobot
from inverse_dynamics.simulation.trajectory import read_trajectory

STORED = 20.0  # s
CANDIDATES = 3000
STEPS = 60
# Velocities and accelerations of the candidates, in parts of the limits, and how often.
PARTS, SHARES = (-1, -0.5, -0.02, 0.02, 0.5, 1), (0.35, 0.1, 0.05, 0.05, 0.1, 0.35)


def best_states(robot: SimulatedRobot, unknowns: Unknowns, duration: float) -> np.ndarray:
    """Information of the best set of states that are clear of contacts and within the effort limits."""
    random, limits = np.random.default_rng(5), unknowns.limits
    lower, upper = limits.window()
    q = random.uniform(lower, upper, (4 * CANDIDATES, len(lower)))
    q = q[ContactChecker(robot).violations(q) <= 0.0][:CANDIDATES]
    qd, qdd = random.choice(PARTS, (2, *q.shape), p=SHARES)
    Z, tau = unknowns.rows_and_torques(q, qd * limits.velocity, qdd * limits.acceleration)
    Z = Z[(np.abs(tau) < limits.effort).all(axis=1)] / unknowns.noise[:, None]
    tested = unknowns.rows(*unknowns.random_states(300, seed=1))
    A = np.einsum("kjm,kjl->jml", tested, tested, optimize=True) / len(tested)
    weights = np.full(len(Z), 1.0 / len(Z))
    for _ in range(STEPS):
        gram = np.einsum("k,kjm,kjl->ml", weights, Z, Z, optimize=True) * duration / CORRELATION
        V = unknowns.covariance(gram)
        B = V @ np.einsum("jml,j->ml", A, 1.0 / np.einsum("jml,lm->j", A, V)) @ V
        weights = weights * np.sqrt(np.einsum("kjm,kjm->k", Z @ B, Z))
        weights /= weights.sum()
    return gram


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", required=True)
    parser.add_argument("--repeat", metavar="N", type=int, nargs="+", default=[1, 2, 3, 4])
    arguments = parser.parse_args()
    robot = load_robot(arguments.robot)
    simulated = SimulatedRobot.from_urdf(read_description(robot.urdf), robot.root, robot.tip)
    stored, _ = read_trajectory(
        StatedSimulation.of(robot, simulated.chain.joint_names).trajectory, robot.joints
    )
    begin = time.process_time()
    found = optimise_excitation(simulated, ExcitationOptions(duration=STORED))
    print(f"search: {time.process_time() - begin:.1f} s of CPU")
    unknowns, states = found.unknowns, found.unknowns.random_states(1000, seed=2)
    old = unknowns.deviations(motion_gram(unknowns, stored, STORED), states).mean()
    print("duration [s]  found  best states")
    for times in arguments.repeat:
        best = best_states(simulated, unknowns, times * STORED)
        grams = (times * found.gram, best)
        new, least = (unknowns.deviations(gram, states).mean() for gram in grams)
        print(f"{times * STORED:12g}  {new / old:5.2f}  {least / old:11.2f}", flush=True)


if __name__ == "__main__":
    main()

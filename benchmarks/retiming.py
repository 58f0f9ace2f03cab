#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""CPU that the timing of a path takes, in a sourced workspace: beside toppra and Drake where they are installed.

python3 benchmarks/retiming.py

Panda, splines through 5 random waypoints, torques and velocities limited. Ours has friction of the identified model
in it; toppra and Drake have none, and get the same torques (toppra: computed by this library). CPU time of the
process, the least of some runs, mean over the paths.
"""

from __future__ import annotations

import argparse
import logging
import os
import time
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import load_robot
from inverse_dynamics._core import JointPath, MotionLimits, RetimeOptions, retime_path

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.robots.robots import Robot

TORQUE = np.array([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0])
VELOCITY = np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61])
POINTS = 1000


def cpu(work: Callable[[Floats], object], paths: Sequence[Floats], runs: int) -> float:
    """Least CPU time per path [ms]."""
    times = []
    for _ in range(runs):
        start = time.process_time()
        for waypoints in paths:
            work(waypoints)
        times.append(time.process_time() - start)
    return 1e3 * min(times) / len(paths)


def ours(robot: Robot, points: int = POINTS) -> Callable[[Floats], object]:
    """Path and timing."""
    solver, options = robot.solver(), RetimeOptions(points=points)
    limits = MotionLimits(torque=TORQUE, velocity=VELOCITY)
    return lambda waypoints: retime_path(solver, JointPath.spline(waypoints), limits, options)


def of_toppra(robot: Robot) -> Callable[[Floats], object]:
    """Its compiled solver, from Python."""
    import toppra
    from toppra.constraint import JointTorqueConstraint, JointVelocityConstraint

    toppra.setup_logging("ERROR")
    solver = robot.solver()

    def work(waypoints: Floats) -> object:
        knots = JointPath.spline(waypoints).knots
        constraints = [
            JointVelocityConstraint(np.c_[-VELOCITY, VELOCITY]),
            JointTorqueConstraint(solver.torques, np.c_[-TORQUE, TORQUE], np.zeros(7)),
        ]
        path = toppra.SplineInterpolator(knots, waypoints, bc_type="natural")
        grid = np.linspace(0.0, knots[-1], POINTS + 1)
        return toppra.algorithm.TOPPRA(constraints, path, gridpoints=grid).compute_trajectory(0, 0)

    return work


def of_drake(robot: Robot) -> Callable[[Floats], object]:
    """In C++, called from Python."""
    from pydrake.all import MultibodyPlant, Parser, PiecewisePolynomial, Toppra

    logging.getLogger("drake").setLevel(logging.ERROR)  # of inertia and friction in the URDF
    assert robot.urdf is not None
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(robot.urdf))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(robot.root))
    plant.Finalize()

    def work(waypoints: Floats) -> object:
        knots = JointPath.spline(waypoints).knots
        zero = np.zeros((7, 1))
        path = PiecewisePolynomial.CubicWithContinuousSecondDerivatives(
            knots, waypoints.T, zero, zero
        )
        timing = Toppra(path, plant, np.linspace(0.0, knots[-1], POINTS + 1))
        timing.AddJointVelocityLimit(-VELOCITY, VELOCITY)
        timing.AddJointTorqueLimit(-TORQUE, TORQUE)
        return timing.SolvePathParameterization()

    return work


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="CPU of the timing of paths")
    parser.add_argument("--runs", type=int, default=5, help="of each measurement (default: 5)")
    parser.add_argument("--paths", type=int, default=20, help="in each run (default: 20)")
    arguments = parser.parse_args()
    real, described = load_robot("panda_real"), load_robot("panda_simulated")
    random = np.random.default_rng(1)
    paths = list(random.uniform(-1.0, 1.0, (arguments.paths, 5, 7)))

    print(f"{POINTS} points, 7 joints [ms of CPU]")
    print(f"  friction {cpu(ours(real), paths, arguments.runs):10.2f}")
    print(f"  without  {cpu(ours(described), paths, arguments.runs):10.2f}")
    for name, package, peer in (("toppra", "toppra", of_toppra), ("Drake", "pydrake", of_drake)):
        if find_spec(package):
            print(f"  {name:8} {cpu(peer(described), paths[:5], arguments.runs):10.2f}")

    print("friction, by points [ms of CPU]")
    for points in (250, 500, 1000, 2000, 4000, 8000):
        print(f"  {points:8} {cpu(ours(real, points), paths[:5], arguments.runs):10.2f}")

    cores = len(os.sched_getaffinity(0))
    many = list(random.uniform(-1.0, 1.0, (1000, 5, 7)))
    print(f"1000 paths with friction, {POINTS} points each [s of wall time]")
    for threads in sorted({1, cores}):
        start = time.perf_counter()
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(ours(real), many))
        print(f"  {threads} threads {time.perf_counter() - start:8.2f}")


if __name__ == "__main__":
    main()

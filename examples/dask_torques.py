# SPDX-License-Identifier: Apache-2.0
"""How much torque does each joint of a UR10 need? Ten million random states, a block at a time.

python dask_torques.py --states 10_000_000 --scheduler processes
"""

import argparse

import dask.array as da
import numpy as np

from inverse_dynamics import Solver

UR10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"


def random_states(joints: int, states: int, block: int) -> tuple[da.Array, da.Array, da.Array]:
    """Each (states, joints), in blocks that are made when they are needed: rad, rad/s, rad/s^2."""
    random = da.random.default_rng(1)
    shape, blocks = (states, joints), (block, joints)
    q = random.uniform(-np.pi, np.pi, size=shape, chunks=blocks)
    qd = random.uniform(-2, 2, size=shape, chunks=blocks)
    qdd = random.uniform(-5, 5, size=shape, chunks=blocks)
    return q, qd, qdd


def torques_of_block(
    q: np.ndarray, qd: np.ndarray, qdd: np.ndarray, *, solver: Solver
) -> np.ndarray:
    return solver.torques(q, qd, qdd)


def torques(solver: Solver, q: da.Array, qd: da.Array, qdd: da.Array) -> da.Array:
    """Torques (states, joints); nothing is computed before they are asked for."""
    # Threads share the solver; processes get a copy with their blocks.
    no_states = np.empty((0, q.shape[1]))
    return da.map_blocks(torques_of_block, q, qd, qdd, solver=solver, meta=no_states)


def count(text: str) -> int:
    """A whole number above zero, of an option."""
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number above 0, got {text!r}")
    return number


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--states", type=count, default=10_000_000)
    parser.add_argument("--block", type=count, default=100_000, help="states at a time")
    parser.add_argument("--scheduler", choices=["threads", "processes"], default="threads")
    args = parser.parse_args()

    solver = Solver(UR10)
    states = random_states(len(solver.joint_names), args.states, args.block)
    tau = torques(solver, *states)
    # In one pass: asked for one after the other, all torques would be computed twice.
    peak, mean_square = da.compute(
        abs(tau).max(axis=0), (tau**2).mean(axis=0), scheduler=args.scheduler
    )
    print(f"{args.states} states; N m        peak     RMS")
    for name, largest, rms in zip(solver.joint_names, peak, np.sqrt(mean_square), strict=True):
        print(f"{name:22} {largest:8.1f} {rms:7.1f}")


if __name__ == "__main__":
    main()

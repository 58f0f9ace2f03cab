# SPDX-License-Identifier: Apache-2.0
import numpy as np

from inverse_dynamics import Solver

solver = Solver("ur10_real")
q = np.random.default_rng(1).uniform(-3, 3, size=(100_000, 6))  # rad, one state per row
qd = np.full_like(q, 0.5)  # rad/s
tau = solver.torques(q, qd, np.zeros_like(q))  # all states in one call
print(tau.shape, solver.joint_names[0], tau[0].round(3), "N m")

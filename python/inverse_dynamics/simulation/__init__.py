# SPDX-License-Identifier: Apache-2.0
"""Simulated robots: MuJoCo under a joint trajectory controller, recorded like a real one.

    from inverse_dynamics.simulation import simulate, write_run

    run = simulate(load_robot("ur10_simulated"))
    write_run(run, Path("bag"))

MuJoCo is independent of the engine and of every solver here, so a simulated recording checks them.
"""

from inverse_dynamics.simulation.errors import SimulationError, TrajectoryError
from inverse_dynamics.simulation.model import MOUNTS, JointFriction, Payload
from inverse_dynamics.simulation.run import SimulatedRun, simulate, write_run
from inverse_dynamics.simulation.sensors import EffortNoise, Resolution, Sensors

__all__ = [
    "MOUNTS",
    "EffortNoise",
    "JointFriction",
    "Payload",
    "Resolution",
    "Sensors",
    "SimulatedRun",
    "SimulationError",
    "TrajectoryError",
    "simulate",
    "write_run",
]

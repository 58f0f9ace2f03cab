# SPDX-License-Identifier: Apache-2.0
"""Simulated robots: MuJoCo under a joint trajectory controller, recorded like a real one.

    from inverse_dynamics.simulation import simulate, write_run

    run = simulate(load_robot("ur10_simulated"))
    write_run(run, Path("bag"))

MuJoCo is independent of the engine and of every solver here, so a simulated recording checks them.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics.simulation.errors import SimulationError as SimulationError
    from inverse_dynamics.simulation.errors import TrajectoryError as TrajectoryError
    from inverse_dynamics.simulation.model import MOUNTS as MOUNTS
    from inverse_dynamics.simulation.model import JointFriction as JointFriction
    from inverse_dynamics.simulation.model import Payload as Payload
    from inverse_dynamics.simulation.run import SimulatedRun as SimulatedRun
    from inverse_dynamics.simulation.run import simulate as simulate
    from inverse_dynamics.simulation.run import write_run as write_run
    from inverse_dynamics.simulation.sensors import EffortNoise as EffortNoise
    from inverse_dynamics.simulation.sensors import Resolution as Resolution
    from inverse_dynamics.simulation.sensors import Sensors as Sensors

_MODULES = {  # imported when one of their names is used: `ids --help` takes no time
    "errors": ("SimulationError", "TrajectoryError"),
    "model": ("MOUNTS", "JointFriction", "Payload"),
    "run": ("SimulatedRun", "simulate", "write_run"),
    "sensors": ("EffortNoise", "Resolution", "Sensors"),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)

# SPDX-License-Identifier: Apache-2.0
"""Settings of a simulation in a run configuration.

All of it may be left out:

    simulation:
      trajectory: package://inverse_dynamics_robots/trajectories/ur10.yaml   # the default one; a path as for urdf
      rate: 125                                                              # Hz, the default one
      gains:                                                                 # those left out are chosen
        shoulder_pan_joint: {p: 100, i: 10, d: 20, i_clamp: 50, ff_velocity_scale: 0}
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import RobotError
from inverse_dynamics.installation.ament import resolve
from inverse_dynamics.robots.located_yaml import read_mapping
from inverse_dynamics.simulation.controller import Gains
from inverse_dynamics.simulation.physics import RATES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.robots.located_yaml import Mapping
    from inverse_dynamics.robots.robots import Robot

DEFAULT_RATE = 500  # Hz, where neither the caller nor the run configuration states one


@dataclass(frozen=True)
class StatedSimulation:
    """Contents of the key `simulation` of a run configuration."""

    trajectory: Path | None = None
    rate: int = DEFAULT_RATE  # Hz
    gains: dict[tuple[int, str], float] = field(default_factory=dict)  # by joint index and name

    def with_gains(self, gains: Gains) -> Gains:
        """The gains with those that are stated in their places."""
        columns = {name: np.array(values) for name, values in vars(gains).items()}
        for (joint, name), value in self.gains.items():
            columns[name][joint] = value
        return Gains(**columns)

    @classmethod
    def of(cls, robot: Robot, joint_names: Sequence[str]) -> StatedSimulation:
        """Reads them. Raises RobotError with file, line and key."""
        # made of a description, or by a program
        if robot.file == robot.urdf or not robot.file.is_file():
            return cls()
        value = read_mapping(robot.file, RobotError).optional("simulation")
        if value is None:
            return cls()
        mapping = value.mapping()
        trajectory = mapping.optional("trajectory")
        file = None if trajectory is None else resolve(trajectory.text(), robot.file.parent)
        if trajectory is not None and file is not None and not file.is_file():
            trajectory.fail("a file", f"{file} isn't there")
        rate = mapping.optional("rate")
        if rate is not None and rate.integer() not in RATES:
            rate.fail(f"one of {', '.join(map(str, RATES))} Hz")
        gains = mapping.optional("gains")
        stated = {} if gains is None else _gains(gains.mapping(), joint_names)
        mapping.reject_others()
        return cls(file, DEFAULT_RATE if rate is None else rate.integer(), stated)


def _gains(mapping: Mapping, joint_names: Sequence[str]) -> dict[tuple[int, str], float]:
    found = {}
    for index, joint in enumerate(joint_names):
        value = mapping.optional(joint)
        if value is None:
            continue
        gains = value.mapping()
        for name in (gain.name for gain in fields(Gains)):
            if (number := gains.optional(name)) is not None:
                found[index, name] = number.number()
        gains.reject_others()
    mapping.reject_others()
    return found

# SPDX-License-Identifier: Apache-2.0
"""Does an arm touch itself or the table it stands on?

    checker = ContactChecker(robot, clearance=0.01)
    checker.violations(q)               # (N,) m: how far each state is within the clearance, 0 where it is free
    checker.closest_pair(q[k])          # distance and names of the two links

Shapes are the URDF's collision boxes, cylinders and spheres. The table is the infinite plane z = 0 of the root
link. Neighbours in the chain are not compared, nor are links whose shapes always overlap.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.installation.extras import lazily_imported
from inverse_dynamics.simulation.model import spec_of

if TYPE_CHECKING:
    import mujoco

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.simulation.model import SimulatedRobot
else:
    mujoco = lazily_imported("mujoco", "a simulation")

TABLE = "the table"

_RANDOM_STATES = 200  # to find links whose shapes always overlap
_ALWAYS = 0.95  # touching in this part of them


@dataclass
class ContactChecker:
    """Distances between the links of one robot and to its table. Not for several threads at once."""

    robot: SimulatedRobot
    clearance: float = 0.01
    """Distance to keep [m]."""
    table: bool = True
    _model: mujoco.MjModel = field(init=False, repr=False)
    _data: mujoco.MjData = field(init=False, repr=False)
    _ignored: set[tuple[int, int]] = field(init=False, repr=False, default_factory=set)

    def __post_init__(self) -> None:
        self._model = _collision_model(self.robot, self.clearance, self.table)
        self._data = mujoco.MjData(self._model)
        self._ignored = self._always_touching()

    @property
    def notes(self) -> tuple[str, ...]:
        """What can't be checked, in words."""
        if self._model.ngeom > int(self.table):
            return ()
        return ("the description has no collision shapes: self-collision can't be checked",)

    def violations(self, q: Floats) -> Floats:
        """How far each state (N, n) is within the clearance: (N,) m, 0 where it is free."""
        return np.array([self.clearance - self._closest(state)[0] for state in q])

    def closest_pair(self, q: Floats) -> tuple[float, str, str]:
        """The distance and names of the two links that are closest in one state (n,), closer than the clearance."""
        distance, (a, b) = self._closest(q)
        return distance, self._name(a), self._name(b)

    def _closest(self, q: Floats) -> tuple[float, tuple[int, int]]:
        return min(self._pairs(q), default=(self.clearance, (-1, -1)))

    def _pairs(self, q: Floats) -> list[tuple[float, tuple[int, int]]]:
        """Distance and geoms of what is within the clearance."""
        self._data.qpos[:] = self.robot.S @ q + self.robot.s
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_collision(self._model, self._data)
        if self._data.ncon == 0:
            return []
        contacts = self._data.contact
        return [
            (distance, pair)
            for distance, (a, b) in zip(contacts.dist.tolist(), contacts.geom.tolist(), strict=True)
            if (pair := (a, b)) not in self._ignored and distance < self.clearance
        ]

    def _always_touching(self) -> set[tuple[int, int]]:
        random = np.random.default_rng(0)
        chain = self.robot.chain
        lower, upper = np.maximum(chain.lower, -np.pi), np.minimum(chain.upper, np.pi)
        states = random.uniform(lower, upper, (_RANDOM_STATES, len(lower)))
        counts = Counter(pair for q in states for pair in {pair for _, pair in self._pairs(q)})
        return {pair for pair, count in counts.items() if count >= _ALWAYS * _RANDOM_STATES}

    def _name(self, geom: int) -> str:
        body = self._model.geom_bodyid[geom]
        return TABLE if body == 0 else str(self._model.body(body).name)


def _collision_model(robot: SimulatedRobot, clearance: float, table: bool) -> mujoco.MjModel:
    spec, _ = spec_of(robot.chain.urdf)
    spec.compiler.fusestatic = False
    spec.compiler.discardvisual = True
    spec.compiler.balanceinertia = True
    if table:
        data = robot.new_data()
        mujoco.mj_kinematics(robot.model, data)
        root = data.body(robot.chain.root)
        spec.worldbody.add_geom(
            name=TABLE,
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=[0.0, 0.0, 1.0],
            pos=root.xpos,
            quat=root.xquat,
        )
    model = spec.compile()
    model.geom_margin[:] = clearance
    return model

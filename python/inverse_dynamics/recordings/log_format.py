# SPDX-License-Identifier: Apache-2.0
"""What a recording's names don't say, and its owner states: columns, units, signs, rate, gears.

LogFormat(columns="q=axis*_angle", scale=["q=deg"], sign=[1, -1]).scaled(numbers, units, 2, "log.csv")
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.decimals import decimal
from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.columns import quantity_named
from inverse_dynamics.recordings.vocabulary import CURRENT, EFFORT, TIME, UNITS
from inverse_dynamics.wording import counted, listed, shown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics.arrays import Floats

_SINGULAR = 1e-9  # of a matrix of gears: its determinant by the lengths of its rows


@dataclass(frozen=True)
class LogFormat:
    """What a recording's names don't say. Empty: nothing.

    columns: see match_columns(). scale: texts `KEY=FACTOR` or `KEY=FACTOR,FACTOR,...`, one for each joint:
    what the quantity's numbers are multiplied by, a number or one of UNITS. sign: of each joint, 1 or -1;
    -1 turns its positions, velocities and efforts around. rate: Hz, of a table without time. gears: of motors
    whose states are recorded, `q_motor = G q`: a ratio of each joint, or the rows of G one after the other.
    """

    columns: str = ""
    scale: Sequence[str] = ()
    sign: Sequence[float] = ()
    rate: float | None = None
    gears: Sequence[float] = ()

    @staticmethod
    def of(robot: Any) -> LogFormat:
        """What a run configuration states."""
        return LogFormat(robot.columns, robot.scale, robot.sign, robot.rate, robot.gears)

    def factors(self, where: str) -> dict[str, Floats]:
        """What `scale` states, by quantity. Raises BagError."""
        found = {}
        for text in self.scale:
            key, _, factors = text.partition("=")
            kind = quantity_named(key.strip(), f"{where}: scale")
            found[kind] = np.array([_factor(factor, where) for factor in factors.split(",")])
        return found

    def scaled(
        self, numbers: Mapping[str, Floats], units: Mapping[str, str], joints: int, where: str
    ) -> dict[str, Floats]:
        """Numbers (N, joints) by quantity in SI units. units: those that are known. Raises BagError."""
        stated = self.factors(where)
        if others := [kind for kind in stated if kind not in numbers]:
            raise BagError(
                f"{where}: scale: expected one of {listed([*numbers])}, which the file has, got "
                f"{listed(others)}"
            )
        for kind, unit in units.items():
            if kind not in stated and unit not in UNITS:
                raise BagError(
                    f"{where}: {kind}: expected a known unit, got {unit}: what is one in SI units? State "
                    f"--scale {kind}=FACTOR, or one factor for each joint"
                )
        if self.sign and (len(self.sign) != joints or {*self.sign} - {1.0, -1.0}):
            raise BagError(
                f"{where}: sign: expected 1 or -1 for each of {counted(joints, 'joint')}, got "
                f"{listed([f'{sign:g}' for sign in self.sign], 20)}"
            )
        scaled = {}
        for kind, columns in numbers.items():
            factors = stated.get(kind, np.array([UNITS.get(units.get(kind, ""), 1.0)]))
            if len(factors) not in (1, columns.shape[1]):
                raise BagError(
                    f"{where}: scale: {kind}: expected 1 or {counted(columns.shape[1], 'number')}, got "
                    f"{len(factors)}"
                )
            signs = np.array(self.sign) if self.sign and kind != TIME else 1.0
            scaled[kind] = columns * (factors * signs)
        return self._behind_gears(scaled, joints, where) if self.gears else scaled

    def _behind_gears(
        self, numbers: Mapping[str, Floats], joints: int, where: str
    ) -> dict[str, Floats]:
        """Those of joints, where the numbers are those of motors: q = inv(G) q_motor, tau = G' tau_motor."""
        G = np.array(self.gears)
        if G.size not in (joints, joints**2):
            raise BagError(
                f"{where}: gears: expected {joints} ratios or the {joints**2} numbers of a matrix, got {G.size}"
            )
        G = np.diag(G) if G.size == joints else G.reshape(joints, joints)
        if abs(np.linalg.det(G)) <= _SINGULAR * np.prod(np.linalg.norm(G, axis=1)):
            raise BagError(
                f"{where}: gears: expected a matrix that can be inverted, as each joint has a motor, got "
                f"{listed([f'{x:g}' for x in self.gears], 20)}"
            )
        if CURRENT in numbers and np.count_nonzero(G - np.diag(np.diag(G))):
            raise BagError(
                f"{where}: gears: expected torques of the motors, which a matrix turns into torques of the joints, got "
                "currents; state --columns effort=... and --scale effort=... with the motors' N m/A"
            )
        to_joints = {EFFORT: G, CURRENT: G, TIME: None}
        return {
            kind: columns
            if (by := to_joints.get(kind, np.linalg.inv(G).T)) is None
            else columns @ by
            for kind, columns in numbers.items()
        }


PLAIN = LogFormat()


def _factor(text: str, where: str) -> float:
    try:
        factor = UNITS.get(text.strip().lower()) or decimal(text)
    except ValueError:
        factor = math.nan
    if not math.isfinite(factor) or factor == 0:
        raise BagError(
            f"{where}: scale: expected a number other than 0 or one of {', '.join(UNITS)}, got {shown(text)}"
        )
    return factor

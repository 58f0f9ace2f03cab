# SPDX-License-Identifier: Apache-2.0
"""Search for an exciting trajectory: a motion that tells as much as possible about the inertial parameters.

    found = optimise_excitation(robot, seed=0)
    found.trajectory, found.condition_number

The measure is the condition number of the base regressor, stacked over the motion [Gautier and Khalil 1992]: how much
measurement noise grows into errors of parameters. The base parameters are taken in an orthonormal basis, so the measure
is the ratio of the nonzero singular values of the regressor. Each trial is a Fourier series that starts and ends at
rest; its amplitudes are scaled into the limits of position, velocity and acceleration, so those always hold; what goes
beyond the effort limits or comes too close to itself or to the table is penalised until nothing does.

The search is an evolution strategy (CMA-ES with a diagonal covariance [Ros and Hansen 2008]): no gradients, few
parameters, and the same seed gives the same trajectory (on one kind of machine: rounding differs between processors).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.simulation.collision import ContactChecker
from inverse_dynamics.simulation.errors import SimulationError, TrajectoryError
from inverse_dynamics.simulation.evolution import minimise
from inverse_dynamics.simulation.limits import MotionLimits, check_trajectory
from inverse_dynamics.simulation.regressor import (
    ArmGeometry,
    base_count,
    condition_number,
    inertial_parameters,
    regressor,
)
from inverse_dynamics.simulation.trajectory import FourierTrajectory

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.simulation.model import SimulatedRobot

PERIOD = 20.0  # s
HARMONICS = 8  # the highest at 0.4 Hz
MARGIN = 0.8  # part of each limit that a trajectory may use
TIME_TO_FULL_SPEED = 0.5  # s, what limits accelerations, since a URDF states no limit of them

_EVALUATIONS = 6000
_SAMPLES = 120  # points of a trajectory at which a trial is judged
_CONTACT_SAMPLES = 200  # points of a trajectory at which contacts are looked for
_STARTS = 100  # random ones, of which the best is improved
_FIRST_AMPLITUDE = 0.3
_PENALTY = 10.0  # per unit of relative excess of effort, and per 0.1 m of lacking clearance


@dataclass(frozen=True)
class Excitation:
    """An exciting trajectory and how good it is."""

    trajectory: FourierTrajectory
    condition_number: float


def optimise_excitation(
    robot: SimulatedRobot,
    *,
    seed: int = 0,
    period: float = PERIOD,
    harmonics: int = HARMONICS,
    evaluations: int = _EVALUATIONS,
    table: bool = True,
    progress: Progress = no_progress,
) -> Excitation:
    """Exciting trajectory of a robot; the same seed gives the same one.

    Raises SimulationError if none was found within the limits, and where the URDF lacks limits.
    """
    limits = MotionLimits.of(robot, TIME_TO_FULL_SPEED).fraction(MARGIN)
    for name, values in (("velocity", limits.velocity), ("effort", limits.effort)):
        for joint, value in zip(robot.chain.joint_names, values, strict=True):
            if not (np.isfinite(value) and value > 0):
                raise SimulationError(
                    f"robot description: joint {joint}: the search needs a {name} limit, got {value:g}; "
                    f"add <limit {name}=.../>, or give a trajectory by --trajectory"
                )
    checker = ContactChecker(robot, table=table)
    family = _Family(robot.chain.joint_names, limits, period, harmonics)
    judge = _Judge(robot, family, limits, checker)
    random = np.random.default_rng(seed)
    starts = _FIRST_AMPLITUDE * random.standard_normal((_STARTS, family.size))
    start = min(starts, key=judge.cost)
    best = minimise(
        judge.cost, start, step=0.2, evaluations=evaluations, seed=seed, progress=progress
    )
    trajectory = _shrunk_until_free(robot, family.member(best), checker)
    return Excitation(trajectory, condition_of(robot, trajectory))


def condition_of(robot: SimulatedRobot, trajectory: FourierTrajectory) -> float:
    """Condition number of the base regressor over a trajectory."""
    arm = ArmGeometry.of(robot)
    time = np.linspace(0.0, trajectory.duration, _SAMPLES, endpoint=False)
    return condition_number(regressor(arm, *trajectory.at(time)), base_count(arm))


def _shrunk_until_free(
    robot: SimulatedRobot, found: FourierTrajectory, checker: ContactChecker
) -> FourierTrajectory:
    """The trajectory, with amplitudes small enough that the check between the search's points passes too."""
    limits = MotionLimits.of(robot)
    for factor in np.linspace(1.0, 0.5, 11):
        trajectory = replace(found, sine=factor * found.sine, cosine=factor * found.cosine)
        try:
            check_trajectory(robot, trajectory, limits, checker)
        except TrajectoryError as error:
            reason = error
        else:
            return trajectory
    raise SimulationError(
        f"no exciting trajectory was found (the last one: {reason}); try another --seed"
    )


@dataclass(frozen=True)
class _Family:
    """Fourier trajectories within limits of position, velocity and acceleration, made from free numbers."""

    joint_names: tuple[str, ...]
    limits: MotionLimits
    period: float
    harmonics: int

    @property
    def size(self) -> int:
        return len(self.joint_names) * (1 + 2 * self.harmonics)

    def member(self, x: Floats) -> FourierTrajectory:
        """The trajectory that belongs to free numbers x (size,)."""
        joints = len(self.joint_names)
        free_center, sine, cosine = np.split(x, [joints, joints * (1 + self.harmonics)])
        sine, cosine = sine.reshape(joints, -1), cosine.reshape(joints, -1)
        # at rest, without acceleration, at the beginning
        order = np.arange(1, self.harmonics + 1)
        sine = sine - sine.mean(axis=1, keepdims=True)
        cosine = cosine - np.outer(cosine @ order / (order @ order), order)
        # numbers of size one are amplitudes that use up the velocity limit
        scale = self.limits.velocity[:, None] / np.sqrt(self.harmonics)
        lower, upper = self._window()
        center = lower + (upper - lower) / (1.0 + np.exp(-free_center))
        trial = FourierTrajectory(
            self.joint_names, self.period, center, scale * sine, scale * cosine
        )
        reach = self._reach(trial)[:, None]
        return FourierTrajectory(
            self.joint_names, self.period, center, trial.sine * reach, trial.cosine * reach
        )

    def _window(self) -> tuple[Floats, Floats]:
        """Ranges of positions: at most one turn."""
        lower, upper = np.maximum(self.limits.lower, -np.pi), np.minimum(self.limits.upper, np.pi)
        return lower, upper

    def _reach(self, trial: FourierTrajectory) -> Floats:
        """The greatest factors (n,) up to 1 by which the amplitudes may be multiplied."""
        q, qd, qdd = trial.at(np.linspace(0.0, self.period, 10 * _SAMPLES))
        lower, upper = self._window()
        room = np.minimum(upper - trial.center, trial.center - lower)
        used = [
            np.abs(values).max(axis=0) / limit
            for values, limit in (
                (q - trial.center, room),
                (qd, self.limits.velocity),
                (qdd, self.limits.acceleration),
            )
        ]
        return np.asarray(1.0 / np.maximum(1.0, np.max(used, axis=0)))


class _Judge:
    """The cost of a trial: logarithm of the condition number, and penalties."""

    def __init__(
        self,
        robot: SimulatedRobot,
        family: _Family,
        limits: MotionLimits,
        checker: ContactChecker,
    ) -> None:
        self._robot, self._family, self._limits, self._checker = robot, family, limits, checker
        self._arm = ArmGeometry.of(robot)
        self._count = base_count(self._arm)
        self._parameters = inertial_parameters(robot)
        self._contact_time = np.linspace(0.0, family.period, _CONTACT_SAMPLES, endpoint=False)
        self._time = np.linspace(0.0, family.period, _SAMPLES, endpoint=False)

    def cost(self, x: Floats) -> float:
        trajectory = self._family.member(x)
        Y = regressor(self._arm, *trajectory.at(self._time))
        excess = np.abs(Y @ self._parameters) / self._limits.effort - 1.0
        violations = self._checker.violations(trajectory.at(self._contact_time)[0])
        penalty = sum(
            values.max() + values.mean()
            for values in (np.maximum(excess, 0.0), 10.0 * np.maximum(violations, 0.0))
        )
        return float(np.log10(condition_number(Y, self._count)) + _PENALTY * penalty)

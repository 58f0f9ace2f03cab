# SPDX-License-Identifier: Apache-2.0
"""How well a robot that is known is identified: a simulated arm that is what a real one was found to be.

    recording = recordings / "ur10_exciting_trajectory"
    truth = Truth.of(recording, "ur10", directory, identify([recording], "ur10_real"))
    result = truth.identified_again(seed=0)
    result.error, result.delay_error

The truth is the model that `ids identify` finds in a real recording: links, rotor inertias, friction, delay. MuJoCo
moves it as the real arm was moved, for as long, and records as many messages with quantised encoders. What the real
recording has beyond the truth, the residuals, is the noise, in other order: were they in their own places, the real
recording would be there again. From there on nothing is known but the description: the prior, as for the real arm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import evaluate, identify, load_robot
from inverse_dynamics.identification.blocks import blocks_of
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.identify import BLOCKS
from inverse_dynamics.identification.knowledge import _combinations
from inverse_dynamics.identification.result import identified_model
from inverse_dynamics.robots.robots import RIGID_BODY
from inverse_dynamics.simulation import EffortNoise, Resolution, Sensors, simulate, write_run
from inverse_dynamics.simulation.trajectory import WaypointTrajectory

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.robots.robots import Robot

# Mean over the joints of the RMSE on random states [N m], median of the seeds.
MOST_ERROR = {"ur10": 0.3, "panda": 0.07}
LEAST_DELAY_ERROR = 2e-3  # s, or half a sample where that is more

STATES = 2000
WAYPOINTS_APART = 0.1  # s
RATES = {"ur10": 125, "panda": 1000}  # Hz, of the controllers
ENCODER = Resolution(1e-5, 1e-4, 0.0)  # steps, rad and rad/s; standard deviations of noise too


@dataclass(frozen=True)
class Result:
    """What was identified of a simulated recording. n joints."""

    error: Floats  # (n,) N m, RMSE on states that are uniform in the ranges that were seen
    delay_error: float  # s
    inside: Mask  # of each inertial combination that torques depend on, whether its 95 % interval holds the truth

    @property
    def mean(self) -> float:
        """Over the joints [N m]."""
        return float(self.error.mean())


@dataclass(frozen=True)
class Truth:
    """A real arm as it was identified, and how it was recorded."""

    name: str
    found: Identification
    modelled: Robot  # its run configuration: what is simulated
    noise: EffortNoise
    motion: WaypointTrajectory
    period: float  # s between messages
    directory: Path

    @classmethod
    def of(cls, recording: Path, name: str, directory: Path, found: Identification) -> Truth:
        """Of ur10 or panda, as it was identified from the recording; files go to the directory."""
        files = write_identification(found, directory / f"{name}.yaml")
        evaluation = evaluate(recording, found.robot)
        log = evaluation.log
        period = float(np.median(np.diff(log.time)))
        times = np.arange(0.0, log.time[-1], WAYPOINTS_APART)
        positions = np.transpose([np.interp(times, log.time, column) for column in log.q.T])
        return cls(
            name=name,
            found=found,
            modelled=load_robot(files.robot),
            noise=EffortNoise(_residuals(found, evaluation), period),
            motion=WaypointTrajectory.through(found.joints, times, positions),
            period=period,
            directory=directory,
        )

    def record(self, seed: int) -> Path:
        """A simulated recording."""
        sensors = Sensors(
            noise=ENCODER,
            quantisation=ENCODER,
            effort_noise=self.noise,
            effort_delay=max(self.found.delay, 0.0),
            message_rate=1 / self.period if self.name == "panda" else None,
        )
        run = simulate(
            self.modelled,
            trajectory=self.motion,
            from_model=True,
            rate=RATES[self.name],
            seed=seed,
            sensors=sensors,
            table=False,
        )
        bag = self.directory / f"{self.name}_{seed}"
        write_run(run, bag)
        return bag

    def identified_again(self, seed: int) -> Result:
        """From the description, by what `ids identify` does."""
        robot = replace(self.found.robot, plugin=RIGID_BODY, model=None, effort="torque")
        again = identify([self.record(seed)], robot)
        q, qd, qdd = self.states(seed)
        error = _torques(again, q, qd, qdd) - _torques(self.found, q, qd, qdd)
        # Combinations of inertial parameters come first.
        combinations = _combinations(identified_model(self.found))
        true = [c @ self.found.model.parameters.ravel() for c, _, _ in combinations]
        return Result(
            error=np.sqrt((error**2).mean(axis=0)),
            delay_error=again.delay - max(self.found.delay, 0.0),
            inside=np.array(
                [
                    abs(interval.value - value) <= interval.half_width
                    for interval, value in zip(again.intervals, true, strict=False)
                ]
            ),
        )

    def states(self, seed: int) -> tuple[Floats, Floats, Floats]:
        """q, qd, qdd, uniform in the ranges that were seen."""
        low, high = np.moveaxis(self.found.model.seen, 2, 0)
        random = np.random.default_rng((seed, 1))
        shares = random.uniform(size=(STATES, *low.shape))
        q, qd, qdd = np.moveaxis(low + (high - low) * shares, 1, 0)
        return q, qd, qdd

    @property
    def most_delay_error(self) -> float:
        """Half a sample, or 2 ms."""
        return max(LEAST_DELAY_ERROR, 0.5 * self.period)


def _residuals(found: Identification, evaluation: Evaluation) -> Floats:
    """(M, n) measured minus torques of the model, with the delay made up for, of valid samples."""
    residuals = []
    solver = found.solver()
    for block in blocks_of(evaluation, BLOCKS):
        q, qd, qdd, measured = block.later(found.delay).fitted
        friction = solver.friction_state()
        friction.along(block.before, np.zeros_like(block.before))
        residuals.append(measured - solver.torques(q, qd, qdd) - friction.along(q, qd))
    return np.concatenate(residuals)


def _torques(found: Identification, q: Floats, qd: Floats, qdd: Floats) -> Floats:
    return identified_model(found).torques(q, qd, qdd)

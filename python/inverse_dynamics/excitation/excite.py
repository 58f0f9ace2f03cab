# SPDX-License-Identifier: Apache-2.0
"""A motion to record before identification, chosen for a robot and for what is known already.

    result = excite("ur10_simulated", given=["recording"])
    result.deviation["motion"]                        # (n,) N m, after it
    result.save("motion.yaml")

What is searched for, and how: excitation.py.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.errors import EvaluationError
from inverse_dynamics.evaluation.evaluation import evaluate_run, open_run, torques_with_gravity
from inverse_dynamics.evaluation.ranges import on_one_turn
from inverse_dynamics.excitation.excitation import (
    Excitation,
    ExcitationOptions,
    motion_gram,
    optimise_excitation,
)
from inverse_dynamics.excitation.files import message_text, motion_text
from inverse_dynamics.excitation.information import sample_weight
from inverse_dynamics.excitation.tables import excitation_lines, excitation_numbers
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import Robot, load_robot
from inverse_dynamics.show.result import ResultFiles
from inverse_dynamics.simulation.configuration import StatedSimulation
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.limits import MotionLimits
from inverse_dynamics.simulation.modelled import description_of, simulated_robot
from inverse_dynamics.simulation.trajectory import read_trajectory
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.excitation.information import Unknowns
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.simulation.model import SimulatedRobot

_TEST_STATES = 1000
_BAND = 1.96  # half the width of the 95 % band of a normal distribution, in standard deviations
_REWEIGHTED = 4  # times that the noise is taken from the residuals
_GIVEN_STEP = 0.02  # s between samples of recordings that are used
_HARDLY = 0.05  # part of the range of positions: less motion is hardly any


@dataclass(frozen=True, repr=False)
class ExcitationResult(ResultFiles):
    """A motion, and the uncertainty after it. n joints, in the order of the chain.

    deviation: N m (prismatic N), (n,) each: standard deviation of the torques that are predicted
    after it, mean over random states within the limits; of
    "description": without a recording; "given": after the recordings that were given; "stored":
    after them and the stored motion of the robot, for the same time; "motion": after them and the new one.
    """

    names = ("{stem}_joint_trajectory.yaml",)
    numbers, lines = excitation_numbers, excitation_lines

    robot: Robot
    joint_names: tuple[str, ...]  # of the recordings and controllers
    units: tuple[str, ...]
    options: ExcitationOptions
    excitation: Excitation
    deviation: dict[str, Floats]
    noise: Floats  # (n,) N m, of the efforts
    noise_source: str
    greatest: Floats  # (3, n) greatest velocity, acceleration and torque, share of each limit
    travel: Floats  # (n, 2) lowest and highest position
    notes: tuple[str, ...]
    step: float | None = None  # s between points of the message to send; None: at the waypoints

    def inputs(self) -> tuple[Path | None, ...]:
        """The robot's files."""
        return self.robot.files

    def texts(self, files: Sequence[Path]) -> tuple[str, str]:
        """The motion, and the message to send."""
        message = message_text(self.excitation.trajectory, self.joint_names, self.step)
        return motion_text(self), message


def write_excitation(
    result: ExcitationResult,
    out: Path | str,
    *,
    overwrite: bool = False,
    step: float | None = None,
) -> None:
    """Write the motion for `ids simulate` and the message to send, both or none.

    Parameters
    ----------
    result, out, overwrite
        As ExcitationResult.save() takes them.
    step
        s between the message's points; by default at the waypoints.

    Raises
    ------
    UserError
        OutputError.
    """
    replace(result, step=step).save(out, overwrite=overwrite)


def excite(
    robot: Robot | Path | str,
    *,
    given: Sequence[Path | str] = (),
    options: ExcitationOptions | None = None,
    seed: int = 0,
    say: Callable[[str], None] = lambda text: None,
    progress: Progress = no_progress,
) -> ExcitationResult:
    """Search for the motion after which torques of the robot are predicted best.

    The same arguments give the same motion.

    Parameters
    ----------
    robot
        As evaluate() takes it, with a description.
    given
        Recordings that will be used too.
    options
        Purpose and constraints of the motion.
    seed
        Of the random start.
    say
        Called with a sentence before what takes long.

    Raises
    ------
    UserError
        SimulationError, RobotError, BagError, EvaluationError.
    """
    robot = robot if isinstance(robot, Robot) else load_robot(robot)
    options = options or ExcitationOptions()
    if options.payload and given:
        raise SimulationError(
            "expected either recordings that are given or a motion for a payload, got both: "
            "recordings of the arm contain no information about a payload"
        )
    simulated = simulated_robot(robot, description_of(robot))
    arm = Arm(robot)
    noise = _band_noise(arm, simulated)
    unknowns = options.unknowns(simulated, noise)
    noise_source = "1 % of each effort limit" if noise is None else "95 % band of the robot's model"
    known = np.zeros_like(unknowns.scale)
    motions: dict[str, Floats] = {}
    notes: list[str] = []
    if given:
        recordings = on_one_turn([_read(recording, robot, progress) for recording in given])
        unknowns = _with_noise_of(unknowns, recordings)
        noise_source = "residuals of the given recordings"
        for recording in recordings:
            (q, qd, qdd, _), period = _samples(recording)
            known += unknowns.gram(q, qd, qdd, period)
        motions["given"] = known
        notes += _resting(simulated, recordings)
    say("searching for the motion, which takes about a minute")
    found = optimise_excitation(
        simulated, options, seed=seed, unknowns=unknowns, given=known, progress=progress
    )
    stored = StatedSimulation.of(robot, simulated.chain.joint_names).trajectory
    if stored is not None:
        trajectory, _ = read_trajectory(stored, simulated.chain.joint_names)
        motions["stored"] = known + motion_gram(unknowns, trajectory, options.duration)
    motions["motion"] = known + found.gram
    states = unknowns.random_states(_TEST_STATES, seed=2)
    deviation = {"description": unknowns.deviations(None, states)}
    deviation |= {name: unknowns.deviations(gram, states) for name, gram in motions.items()}
    greatest, travel = _use_of_limits(found, MotionLimits.of(simulated, options.time_to_full_speed))
    return ExcitationResult(
        robot=robot,
        joint_names=robot.joints or simulated.chain.joint_names,
        units=arm.units,
        options=options,
        excitation=found,
        deviation=deviation,
        noise=unknowns.noise,
        noise_source=noise_source,
        greatest=greatest,
        travel=travel,
        notes=(*filter(None, [arm.guess]), *simulated.chain.notes, *notes, *found.notes),
    )


def _read(recording: Path | str, robot: Robot, progress: Progress) -> Evaluation:
    """Valid samples of a recording. Raises UserError."""
    found = evaluate_run(open_run(recording, robot, progress=progress))
    if not found.samples.kept.any():
        raise EvaluationError(f"{recording}: expected samples of a motion, got no valid one")
    return found


def _samples(recording: Evaluation) -> tuple[list[Floats], float]:
    """q, qd, qdd, measured with gravity (N, n), and the time between them [s]."""
    stride = max(1, round(_GIVEN_STEP / recording.samples.period))
    measured = torques_with_gravity(recording)
    arrays = (recording.log.q, recording.log.qd, recording.qdd, measured)
    whole = np.all([np.isfinite(array).all(axis=1) for array in arrays], axis=0)
    chosen = np.flatnonzero(recording.samples.kept & whole)[::stride]
    return [array[chosen] for array in arrays], stride * recording.samples.period


def _band_noise(arm: Arm, simulated: SimulatedRobot) -> Floats | None:
    """(n,) N m, standard deviation of the errors of the robot's model, where it states them."""
    deviation = arm.solver.torque_deviation
    if deviation is None or arm.joint_names != simulated.chain.joint_names:
        return None
    return np.asarray(deviation / _BAND)


def _with_noise_of(unknowns: Unknowns, recordings: Sequence[Evaluation]) -> Unknowns:
    """The noise that the given efforts have: what the best fitting model leaves."""
    for _ in range(_REWEIGHTED):
        gram = np.zeros_like(unknowns.scale)
        right = np.zeros(len(gram))
        parts = []
        for recording in recordings:
            (q, qd, qdd, measured), period = _samples(recording)
            Z, computed = unknowns.rows_and_torques(q, qd, qdd)
            difference = measured - computed
            gram += unknowns.weighted_gram(Z, period)
            weighted = difference / unknowns.noise**2 * sample_weight(period)
            right += np.einsum("kjm,kj->m", Z, weighted)
            parts.append((Z, difference))
        change = unknowns.covariance(gram) @ right
        residual = np.concatenate([difference - Z @ change for Z, difference in parts])
        noise = np.sqrt(np.mean(residual**2, axis=0))
        unknowns = replace(unknowns, noise=np.maximum(noise, 1e-4 * unknowns.limits.effort))
    return unknowns


def _resting(robot: SimulatedRobot, recordings: Sequence[Evaluation]) -> list[str]:
    """Joints that the given recordings hardly move."""
    notes = []
    lower, upper = robot.chain.lower, robot.chain.upper
    for j, joint in enumerate(robot.chain.joint_names):
        q = np.concatenate([recording.log.q[:, j] for recording in recordings])
        travel, room = float(np.ptp(q)), min(float(upper[j] - lower[j]), 2.0 * np.pi)
        if travel < _HARDLY * room:
            which = counted(len(recordings), "given recording")
            notes.append(f"{joint} moves by {travel:.3g} of {room:.3g} in the {which}")
    return notes


def _use_of_limits(found: Excitation, limits: MotionLimits) -> tuple[Floats, Floats]:
    """Greatest velocity, acceleration and torque (3, n), share of each limit; range of positions (n, 2)."""
    q, qd, qdd = found.trajectory.at(np.linspace(0.0, found.trajectory.duration, 2001))
    tau = found.unknowns.rows_and_torques(q, qd, qdd)[1]
    greatest = np.abs([qd, qdd, tau]).max(axis=1)
    shares = greatest / [limits.velocity, limits.acceleration, limits.effort]
    return shares, np.column_stack([q.min(axis=0), q.max(axis=0)])

# SPDX-License-Identifier: Apache-2.0
"""What recorded efforts mean, and so what is compared with what.

The meaning is stated by the option, else by the recording's format, else by the run configuration;
`auto` has the data tell: see effort_verdict.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from inverse_dynamics.errors import EvaluationError, RobotError
from inverse_dynamics.robot.choices import EFFORT_CHOICES, EFFORT_MEANINGS

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats, Mask
    from inverse_dynamics.data.joint_log import JointLog
    from inverse_dynamics.evaluation.effort_verdict import Verdict
    from inverse_dynamics.robot.robots import Robot

# Who stated the meaning, in words.
OPTION = "as told"
FORMAT = "as the recording's format says"
CONFIGURATION = "as the run configuration says"
DATA = "found from the data"


@dataclass(frozen=True)
class Effort:
    """What recorded efforts mean, and how that is known."""

    meaning: str = "torque"  # one of EFFORT_MEANINGS
    stated_by: str = CONFIGURATION
    drive_gains: tuple[float, ...] = ()  # N m/A (prismatic N/A), of currents
    verdict: Verdict | None = None  # of the data, if they were asked

    def torques(self, effort: Floats) -> Floats:
        """Measured torques (N, n) [N m] of recorded efforts; without gravity if these are."""
        return effort * self.drive_gains if self.meaning == "current" else effort

    @property
    def summary(self) -> str:
        """In words, as tables show it."""
        said = f"{self.meaning.replace('_', ' ')}, {self.stated_by}"
        if self.drive_gains:
            said += f", with drive gains {_figures(self.drive_gains)} N m/A"
        if self.verdict:
            said += f"; {'sure' if self.verdict.sure else 'not sure'}: {self.verdict.summary}"
        return said


def drive_gains(robot: Robot, solver: Solver) -> tuple[float, ...] | None:
    """The run configuration's drive gains, else the solver's, if there are any. Raises RobotError."""
    if not robot.drive_gains:
        return None if solver.drive_gains is None else tuple(solver.drive_gains.tolist())
    names = solver.joint_names
    if len(robot.drive_gains) != len(names):
        raise RobotError(
            f"{robot.file}: drive_gains: expected {len(names)} figures, one per joint of the chain "
            f"({', '.join(names)}), got {len(robot.drive_gains)}"
        )
    if not all(math.isfinite(gain) and gain > 0 for gain in robot.drive_gains):
        raise RobotError(
            f"{robot.file}: drive_gains: expected figures above zero [N m/A], got "
            f"{_figures(robot.drive_gains)}"
        )
    return robot.drive_gains


def stated_effort(
    option: str | None, log: JointLog, robot: Robot, gains: tuple[float, ...] | None
) -> Effort:
    """What is stated; meaning `auto` where the data are to tell. Raises EvaluationError, RobotError.

    option: what the user says, or None. gains: see drive_gains().
    """
    meaning, stated_by = robot.effort, CONFIGURATION
    if log.effort_is:
        meaning, stated_by = log.effort_is, FORMAT
    if option is not None:
        meaning, stated_by = option, OPTION
    if meaning not in EFFORT_CHOICES:
        raise EvaluationError(
            f"effort, {stated_by}: expected one of {', '.join(EFFORT_CHOICES)}, got '{meaning}'"
        )
    return _with_gains(Effort(meaning, stated_by), robot, gains)


def effort_of_data(
    solver: Solver,
    robot: Robot,
    log: JointLog,
    computed: Floats,
    gains: tuple[float, ...] | None,
    kept: Mask,
) -> Effort:
    """What the data tell, else what is stated without them. Raises RobotError.

    computed: (N, n) N m. kept: (N,) samples that count.
    """
    from inverse_dynamics.evaluation.effort_verdict import compare_meanings

    verdict = compare_meanings(computed, solver.gravity_vector(log.q), log.effort, gains, kept)
    if verdict.sure:
        effort = Effort(verdict.best, DATA, verdict=verdict)
    elif log.effort_is:
        effort = Effort(log.effort_is, FORMAT, verdict=verdict)
    elif robot.effort in EFFORT_MEANINGS:
        effort = Effort(robot.effort, CONFIGURATION, verdict=verdict)
    else:
        effort = Effort(stated_by="as nothing is stated", verdict=verdict)
    return _with_gains(effort, robot, gains)


def compared_torques(
    effort: Effort, solver: Solver, log: JointLog, computed: Floats
) -> tuple[Floats, Floats]:
    """What is compared: computed and measured torques, (N, n) N m; gravity is in both or in none."""
    if effort.meaning == "torque_without_gravity":
        computed = computed - solver.gravity_vector(log.q)
    return computed, effort.torques(log.effort)


def effort_notes(effort: Effort, solver: Solver, robot: Robot, log: JointLog) -> list[str]:
    """What a reader of the results should know of it, a sentence each."""
    said = []
    if len(log) and not log.effort.any():
        said.append(
            "all recorded efforts are zero: does the robot's driver measure them? Some publish zeros"
        )
    if effort.verdict and not effort.verdict.sure:
        said.append(
            f"the data don't tell what effort means: {effort.verdict.reason}; taken as "
            f"{effort.meaning}, {effort.stated_by} ({effort.verdict.summary})"
        )
    others = [(log.effort_is, "the recording's format")]
    if effort.stated_by != OPTION:
        others.append((robot.effort, "the run configuration"))
    said += [
        f"effort is taken as {effort.meaning}, {effort.stated_by}, where {who} says {other}"
        for other, who in others
        if other in EFFORT_MEANINGS and other != effort.meaning
    ]
    own = () if solver.drive_gains is None else tuple(solver.drive_gains.tolist())
    if own and effort.drive_gains and effort.drive_gains != own:
        said.append(
            "drive gains are those of the run configuration; the solver's own are "
            f"{_figures(own)} N m/A"
        )
    if effort.meaning == "torque_without_gravity":
        said.append("computed torques are shown without gravity, as efforts were recorded")
    return said


def _with_gains(effort: Effort, robot: Robot, gains: tuple[float, ...] | None) -> Effort:
    if effort.meaning != "current":
        return effort
    if gains is None:
        raise RobotError(
            f"robot {robot.name}: effort means current, {effort.stated_by}: expected drive gains "
            f"[N m/A], got none from {robot.file} nor from {robot.plugin}; add drive_gains: [...], "
            "one per joint, to the run configuration"
        )
    return Effort(effort.meaning, effort.stated_by, gains, effort.verdict)


def _figures(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.4g}" for value in values)

# SPDX-License-Identifier: Apache-2.0
"""The first lines of what a verb prints of an evaluated recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.verbs.screen import Screen


def print_heading(
    screen: Screen,
    evaluation: Evaluation,
    *,
    samples: int | None = None,
    duration: float | None = None,
) -> None:
    """Robot, solver and recording. samples, duration [s]: those that are used; None: all."""
    robot, log = evaluation.robot, evaluation.log
    samples = len(log) if samples is None else samples
    duration = log.duration if duration is None else duration
    source = ", ".join(filter(None, (str(evaluation.bag), log.topic)))
    screen.print(robot.description or robot.name, style="bold")
    screen.print(f"solver         {robot.plugin}{'' if robot.friction else ', friction left out'}")
    screen.print(f"recording      {source}: {samples} samples, {duration:.1f} s")

# SPDX-License-Identifier: Apache-2.0
"""`ids torques`: fill in the efforts of a planned trajectory."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import SOLVER, TABLE, Options, chosen_robot, given_overrides
from inverse_dynamics.wording import counted

if TYPE_CHECKING:
    import argparse

PLACE = ("plan", 2)
SUMMARY = "fill in the efforts of a planned trajectory"
DESCRIPTION = "Fill in the efforts of a planned trajectory, and check them against the limits."
EPILOG = """\
examples:
  ids torques planned --robot ur10_simulated --out filled
      a recording of trajectory_msgs/JointTrajectory; `filled` is a copy with the effort of each
      point, which a joint_trajectory_controller uses as feed-forward; other topics are copied

  ids torques planned.csv --robot my_robot.yaml --out filled.csv
      a table: columns time [s] and, for each joint, position.JOINT, velocity.JOINT,
      acceleration.JOINT; effort.JOINT is filled in, further columns are copied

  ids torques planned --robot panda_real --no-friction --out filled
      for a robot whose controller compensates friction itself

Each point needs positions, velocities and accelerations. An output directory also holds torques.json:
how efforts were computed, energy and peak power, and the peak of each joint. The printed table shows which
joints would exceed the effort limits of the robot description, and when first.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.argument(
        "trajectory",
        metavar="TRAJECTORY",
        type=Path,
        help="rosbag2 recording of trajectory_msgs/JointTrajectory, or a table of text (.csv, .tsv, .txt, .dat, .log, "
        ".asc)",
    )
    options.robot()
    options.output(
        "OUT",
        "the copy with efforts: a directory for a recording, a file for a table",
        required=True,
    )
    options.shared("--json", "--topic")
    options.overrides(*SOLVER, *TABLE)


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.feedforward.files import check_output
    from inverse_dynamics.robots.robots import with_changes

    robot = with_changes(chosen_robot(arguments), **given_overrides(arguments))
    check_output(arguments.trajectory, arguments.out, robot, overwrite=arguments.overwrite)

    from inverse_dynamics.feedforward.files import summary, write_trajectory_torques
    from inverse_dynamics.feedforward.tables import load_table
    from inverse_dynamics.feedforward.trajectory_torques import trajectory_torques
    from inverse_dynamics.robots.solvers import description_notes
    from inverse_dynamics.terminal.screen import progress_bar, show
    from inverse_dynamics.terminal.tables import on_screen

    with progress_bar() as progress:
        result = trajectory_torques(
            arguments.trajectory, robot, topic=arguments.topic or "", progress=progress
        )
        notes = write_trajectory_torques(
            result, arguments.out, overwrite=arguments.overwrite, progress=progress
        )
    notes = (*result.notes, *notes)
    if arguments.urdf is not None:
        notes = (*notes, *description_notes(robot, "effort limits"))
    points = counted(sum(map(len, result.times)), "point")
    show(
        arguments,
        {**summary(result), "notes": notes},
        [arguments.out],
        [
            ("", robot.description or robot.name),
            ("solver", f"{robot.plugin}{'' if robot.friction else ', friction left out'}"),
            ("trajectories", f"{len(result.times)}, with {points} together"),
            ("energy", str(result.energy)),
            ("note", notes),
            on_screen(load_table(result)),
            ("written", arguments.out),
        ],
    )

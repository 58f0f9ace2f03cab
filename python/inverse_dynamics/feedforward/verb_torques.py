# SPDX-License-Identifier: Apache-2.0
"""`ids torques`: fill in the efforts of a planned trajectory."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import SOLVER, TABLE, Options, changed_robot, stated

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

Points of control_msgs/JointWrenchTrajectory state what the robot exerts on its surroundings, at the link that frame_id
names, or in the axes and about the origin of a frame at rest at the tip; efforts include what that needs.
Each point needs positions, velocities and accelerations, and a later time than the one before. Notes name what
contradicts itself, such as zero velocities in a motion, degrees and jumps, and limits that are passed. An output
directory also holds torques.json: how efforts were computed, energy and peak power, and the peak of each joint. The
printed table shows which joints would exceed the effort limits of the robot description, and when first.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.argument(
        "trajectory",
        metavar="TRAJECTORY",
        type=Path,
        help="rosbag2 recording of trajectory_msgs/JointTrajectory or control_msgs/JointWrenchTrajectory, or a table "
        "of text (.csv, .tsv, .txt, .dat, .log, .asc)",
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
    from inverse_dynamics.feedforward.files import check_output, write_trajectory_torques
    from inverse_dynamics.feedforward.trajectory_torques import trajectory_torques
    from inverse_dynamics.robots.solvers import description_notes
    from inverse_dynamics.terminal.screen import progress_bar, show

    robot = changed_robot(arguments)
    path, out, overwrite = arguments.trajectory, arguments.out, arguments.overwrite
    check_output(path, out, robot, overwrite=overwrite)
    with progress_bar() as progress:
        result = trajectory_torques(path, robot, progress=progress, **stated(arguments, "topic"))
        left_out = write_trajectory_torques(result, out, overwrite=overwrite, progress=progress)
    missing = description_notes(robot, "effort limits") if arguments.urdf else ()
    result = replace(result, notes=(*result.notes, *left_out, *missing))
    show(arguments, result.numbers(), [out], [*result.lines(), ("written", out)])

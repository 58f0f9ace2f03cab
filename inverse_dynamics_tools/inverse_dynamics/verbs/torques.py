# SPDX-License-Identifier: Apache-2.0
"""`ids torques`: fill in the efforts of a planned trajectory."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from inverse_dynamics.verbs.common import names, three_numbers

_EPILOG = """\
examples:
  ids torques planned --robot ur10_simulated --out filled
      a recording of trajectory_msgs/JointTrajectory; `filled` is a copy with the effort of each
      point, which a joint_trajectory_controller takes as feed-forward; other topics are copied

  ids torques planned.csv --robot my_robot.yaml --out filled.csv
      a table: columns time [s] and, for each joint, position.JOINT, velocity.JOINT,
      acceleration.JOINT; effort.JOINT is put in, further columns are copied

  ids torques planned --robot panda_real --no-friction --out filled
      for a robot whose controller compensates friction itself

positions, velocities and accelerations of each point are needed. The table on the screen says which
joint would pass the effort limit of the robot description, and when first.
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = subparsers.add_parser(
        "torques",
        help="fill in the efforts of a planned trajectory, and check them against the limits",
        description="Fill in the efforts of a planned trajectory, and check them against the limits.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "trajectory",
        metavar="TRAJECTORY",
        type=Path,
        help="rosbag2 recording of trajectory_msgs/JointTrajectory, or a table (.csv or .txt)",
    )
    parser.add_argument(
        "--robot",
        metavar="NAME|FILE",
        required=True,
        help="run configuration: a name that `ids robots` lists, or a YAML file",
    )
    parser.add_argument(
        "--out",
        metavar="OUT",
        type=Path,
        required=True,
        help="the copy with efforts: a directory for a recording, a file for a table; a new one",
    )
    parser.add_argument(
        "--topic",
        metavar="NAME",
        default="",
        help="topic of the trajectories, if there are several",
    )
    robot = parser.add_argument_group("instead of what the run configuration says")
    robot.add_argument("--plugin", metavar="PACKAGE/CLASS", help="solver (`ids robots --plugins`)")
    robot.add_argument(
        "--no-friction",
        dest="friction",
        action="store_false",
        default=None,
        help="leave the solver's friction out: for a robot whose controller compensates it",
    )
    robot.add_argument(
        "--gravity",
        metavar="X,Y,Z",
        type=three_numbers,
        help="where things fall [m/s^2], in the frame of the root link (usually 0,0,-9.81)",
    )
    robot.add_argument(
        "--joints",
        metavar="A,B,...",
        type=names,
        help="names of the joints in the trajectory, in the order of the chain",
    )
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.csv_table import is_csv
    from inverse_dynamics.files import check_output_directory, check_output_file
    from inverse_dynamics.robots import load_robot

    check = check_output_file if is_csv(arguments.trajectory) else check_output_directory
    check(arguments.out)  # before the work

    from rich.console import Console

    from inverse_dynamics.feed_forward import trajectory_torques
    from inverse_dynamics.feed_forward_files import write_trajectory_torques
    from inverse_dynamics.tables import load_table

    changes = {
        key: value
        for key in ("plugin", "friction", "gravity", "joints")
        if (value := getattr(arguments, key)) is not None
    }
    robot = replace(load_robot(arguments.robot), **changes)
    result = trajectory_torques(arguments.trajectory, robot, topic=arguments.topic)
    notes = write_trajectory_torques(result, arguments.out)

    console = Console(highlight=False, markup=False, soft_wrap=True)
    console.print(robot.description or robot.name, style="bold")
    console.print(f"solver        {robot.plugin}{'' if robot.friction else ', friction left out'}")
    console.print(
        f"trajectories  {len(result.times)}, with {sum(map(len, result.times))} points together"
    )
    for note in (*result.notes, *notes):
        console.print(f"note          {note}")
    console.print(load_table(result))
    console.print(f"written       {arguments.out}")

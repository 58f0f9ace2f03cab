# SPDX-License-Identifier: Apache-2.0
"""`ids excite`: the motion to record for identification."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.verbs.common import (
    announce,
    positive_number,
    progress_bar,
    share,
    whole_number,
)
from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import add_gravity, add_verb, chosen_robot

if TYPE_CHECKING:
    from inverse_dynamics.results.excitations import ExcitationResult

_EPILOG = """\
examples:
  ids excite --robot ur10_simulated --out motion.yaml
      20 s within 80 % of the limits of the URDF; rehearse it in simulation:
  ids simulate --robot ur10_simulated --trajectory motion.yaml --out rehearsal

  ids excite --urdf arm.urdf --root base --tip flange --out motion.yaml \\
      --duration 30 --share 0.5
      half of the limits, longer: the table shows the effect on the uncertainty

  ids excite --robot my_robot.yaml --given recording --out missing.yaml
      a motion that adds the information that the recording lacks

  ids excite --robot my_robot.yaml --payload --out weigh.yaml
      8 s of motion of the last three joints, to identify a body at the tip

results, written together or not at all; Ctrl-C leaves nothing:
  motion.yaml                    the motion, for `ids simulate --trajectory`
  motion_joint_trajectory.yaml   trajectory_msgs/JointTrajectory, whose first point is the start pose,
                                 3 s after the start: move the arm there first, that path is not checked
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "excite",
        summary="find the motion to record for identification",
        description=(
            "Find the motion after which the torques of a robot can be predicted best: within the "
            "limits, clear of the robot itself and of the table, with slow reversals for friction."
        ),
        epilog=_EPILOG,
        json=True,
    )
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument(
        "--robot",
        metavar="NAME|FILE",
        help="run configuration: a name that `ids robots` lists, or a YAML file",
    )
    which.add_argument(
        "--urdf", metavar="FILE", type=Path, help="robot description, instead of --robot"
    )
    parser.add_argument("--root", metavar="LINK", help="first link of the chain")
    parser.add_argument("--tip", metavar="LINK", help="last link of the chain")
    add_gravity(parser)
    parser.add_argument("--out", metavar="FILE", type=Path, required=True, help="the motion (YAML)")
    parser.add_argument("--overwrite", action="store_true", help="replace older files")
    parser.add_argument(
        "--given",
        metavar="RECORDING",
        type=Path,
        nargs="+",
        default=[],
        help="recordings that will also be used: the motion adds the information that they lack",
    )
    parser.add_argument(
        "--payload",
        action="store_true",
        help="a motion that identifies only the ten parameters of a body at the tip",
    )
    parser.add_argument(
        "--seed",
        type=whole_number,
        default=0,
        help="seed of the search: the same seed gives the same motion",
    )
    _add_limits(parser)
    return parser


def _add_limits(parser: argparse.ArgumentParser) -> None:
    limits = parser.add_argument_group("limits")
    limits.add_argument(
        "--duration",
        metavar="S",
        type=positive_number,
        help="length of the motion (default: 20; with --payload: 8)",
    )
    limits.add_argument(
        "--share",
        metavar="P",
        type=share,
        help="share of the limits of position, velocity, acceleration and effort (default: 0.8)",
    )
    limits.add_argument(
        "--full-speed-in",
        metavar="S",
        type=positive_number,
        help="shortest time to reach the velocity limit, which limits the acceleration (default: 0.5)",
    )
    limits.add_argument(
        "--clearance",
        metavar="M",
        type=positive_number,
        help="least distance to the arm itself and to the table (default: 0.01)",
    )
    limits.add_argument(
        "--no-table",
        dest="table",
        action="store_false",
        help="allow the arm to reach below its base",
    )
    limits.add_argument(
        "--step",
        metavar="S",
        type=positive_number,
        help="time between points of the JointTrajectory (default: at the waypoints, about 0.5 s apart, "
        "which controllers join by polynomials of the fifth order)",
    )


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.results.excitations import (
        check_output,
        default_options,
        excite,
        sending_file,
        summary,
        write_excitation,
    )
    from inverse_dynamics.robot.robots import with_changes

    robot = chosen_robot(arguments)
    robot = with_changes(robot, root=arguments.root, tip=arguments.tip, gravity=arguments.gravity)
    check_output(arguments.out, robot, arguments.given, overwrite=arguments.overwrite)
    options = default_options(
        duration=arguments.duration,
        share=arguments.share,
        time_to_full_speed=arguments.full_speed_in,
        clearance=arguments.clearance,
        table=arguments.table,
        payload=arguments.payload,
    )
    with progress_bar() as progress:
        result = excite(
            robot,
            given=arguments.given,
            options=options,
            seed=arguments.seed,
            say=announce,
            progress=progress,
        )
    write_excitation(result, arguments.out, overwrite=arguments.overwrite, step=arguments.step)
    if arguments.json:
        print_json("excite", summary(result), [arguments.out, sending_file(arguments.out)])
    else:
        _print(result, arguments.out)


def _print(result: ExcitationResult, out: Path) -> None:
    from inverse_dynamics.results.excitations import sending_file
    from inverse_dynamics.verbs.screen import Screen
    from inverse_dynamics.verbs.tables import excitation_table

    console = Screen()
    found = result.excitation
    console.print(result.robot.description or result.robot.name, style="bold")
    for note in result.notes:
        console.print(f"note        {note}")
    console.print(
        f"motion      {found.trajectory.duration:g} s, condition number of the base regressor "
        f"{found.condition_number:.1f}"
    )
    console.print(f"noise       {result.noise_source}")
    console.print(excitation_table(result))
    console.print(f"written     {out}, {sending_file(out)}")

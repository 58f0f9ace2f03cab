# SPDX-License-Identifier: Apache-2.0
"""`ids retime`: the fastest motion along a path within torque limits."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import UserError
from inverse_dynamics.terminal.options import SOLVER, TABLE, Options, changed_robot, stated
from inverse_dynamics.terminal.values import count, numbers, positive_number, share, whole_numbers

if TYPE_CHECKING:
    import argparse

PLACE = ("plan", 3)
SUMMARY = "time a path within torque limits"
EPILOG = """\
examples:
  ids retime waypoints.yaml --robot ur10_real --out fast
      a YAML file of waypoints (docs/retime.md), a table with columns position.JOINT, or a
      recording of trajectory_msgs/JointTrajectory; times must increase, or all be zero

  ids retime picks.csv --robot ur10_real --deviation 0.05 --payload 3 --out fast
      straight lines that pass the waypoints by at most 0.05 rad, with 3 kg at the tip

  ids retime planned --robot my_robot.yaml --margin 0.95 --out fast
      the band that holds 95 % of measured torques stays within limits

The output directory is a recording of the trajectory with efforts; beside it a table, numbers, a
figure, series.npz (all of it, for Retimed.load() of Python), and report.html: the robot moving
beside itself under one acceleration limit. Limits of torque, velocity, acceleration and jerk are
those of the robot description unless they are given.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.argument(
        "path",
        metavar="PATH",
        type=Path,
        help="waypoints: a YAML file, a table, or a recording of trajectory_msgs/JointTrajectory",
    )
    options.robot()
    options.output("DIR", "directory of the result", required=True, replaces=True)
    options.figures()
    way = options.group("the path")
    way.add(
        "--deviation RAD",
        "straight lines, passing waypoints by at most this; 0: it stops there",
        _distance,
    )
    way.add("--stops K,K,...", "waypoints to stand still at, from 0", whole_numbers)
    way.add(
        "--start-speed SPEED",
        "at its start, rad/s of the way from waypoint to waypoint: on straight lines the root of the sum of "
        "squares over the joints (default: 0)",
        _distance,
    )
    way.add("--end-speed SPEED", "and at its end", _distance)
    limits = options.group("limits, one for all joints or one for each")
    limits.add("--torque A,B,...", "N m (default: of the robot description)", numbers)
    limits.add("--velocity A,B,...", "rad/s (default: of the robot description)", numbers)
    limits.add("--acceleration A,B,...", "rad/s^2 (default: of a URDF 1.2)", numbers)
    limits.add("--jerk A,B,...", "rad/s^3 (default: of a URDF 1.2)", numbers)
    limits.add("--torque-rate A,B,...", "N m/s, of the torque over 1 ms (Franka: 1000)", numbers)
    limits.add("--knee-velocity A,B,...", "rad/s, above it torque limits fall in a line", numbers)
    limits.add("--no-load-velocity A,B,...", "rad/s, there they are zero", numbers)
    limits.add("--tip-speed M/S", "speed of the tip, m/s", positive_number)
    limits.add("--margin SHARE", "of measured torques that stay within limits: 0.95", share)
    options.add(
        "--duration SECONDS",
        "of the motion, if not the shortest: slower by the same factor everywhere",
        positive_number,
    )
    options.add(
        "--sample-rate HZ",
        "of the points of the trajectory (default: 250)",
        positive_number,
        dest="sample_rate",
    )
    options.add("--points N", "of the grid that it is computed on, about (default: 1000)", count)
    options.add(
        "--weight S/J",
        "minimise about duration + weight * energy: slower, less energy",
        positive_number,
    )
    options.shared("--json", "--topic")
    options.overrides(*SOLVER, *TABLE)


def _distance(text: str) -> float:
    return 0.0 if text.strip() == "0" else positive_number(text)


def _of_options(text: str) -> str:
    """The text of an error of retime(), with the names of options."""
    text = re.sub("^rate: ", "--sample-rate: ", text)
    text = re.sub("^(duration|weight): ", r"--\1: ", text)
    return re.sub(
        r"retime\(\): (?:limits|options)\.(\w+)", lambda m: "--" + m[1].replace("_", "-"), text
    )


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics._core import MotionLimits, RetimeOptions
    from inverse_dynamics.retiming.retiming import PER_JOINT, Retimed, retime
    from inverse_dynamics.terminal.screen import show

    robot, out = changed_robot(arguments), arguments.out
    inputs, overwrite = (arguments.path, *robot.files), arguments.overwrite
    Retimed.check(out, overwrite=overwrite, inputs=inputs)
    try:
        result = retime(
            arguments.path,
            robot,
            MotionLimits(**stated(arguments, *PER_JOINT, "tip_speed")),
            options=RetimeOptions(
                **stated(arguments, "margin", "start_speed", "end_speed", "points")
            ),
            **stated(arguments, "weight", "duration", "topic", "deviation", "stops"),
            **({"rate": arguments.sample_rate} if arguments.sample_rate else {}),
        )
    except UserError as error:
        raise type(error)(_of_options(f"{error}")) from error
    result.save(out, overwrite=overwrite, figures=arguments.figures, inputs=inputs)
    files = [("page", out / "report.html"), ("written", out)]
    show(arguments, result.numbers(), [out], [*result.lines(), *files])

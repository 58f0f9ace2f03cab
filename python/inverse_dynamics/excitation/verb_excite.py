# SPDX-License-Identifier: Apache-2.0
"""`ids excite`: the motion to record for identification."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import Options, changed_robot, stated
from inverse_dynamics.terminal.values import positive_number, share, whole_number

if TYPE_CHECKING:
    import argparse

PLACE = ("identify", 1)
SUMMARY = "find the motion to record for identification"
DESCRIPTION = (
    "Find the motion after which the torques of a robot can be predicted best: within the "
    "limits, clear of the robot itself and of the table, with slow reversals for friction."
)
EPILOG = """\
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
  motion.npz                     all of it, for ExcitationResult.load() of Python
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    which = options.one_of(required=True)
    which.robot()
    which.add("--urdf FILE", "robot description, instead of --robot", Path)
    options.output("FILE", "the motion (YAML)", required=True)
    options.shared("--json")
    options.add(
        "--given RECORDING",
        "recordings that will also be used: the motion adds the information that they lack",
        Path,
        nargs="+",
        default=[],
    )
    options.add(
        "--payload",
        "a motion that identifies only the ten parameters of a body at the tip, of a tree at the first",
    )
    options.add(
        "--seed SEED", "seed of the search: the same seed gives the same motion", whole_number
    )
    options.overrides("--root", "--tip", "--gravity")
    _declare_limits(options.group("limits"))


def _declare_limits(limits: Options) -> None:
    limits.add(
        "--duration S", "length of the motion (default: 20; with --payload: 8)", positive_number
    )
    limits.add(
        "--share P",
        "share of the limits of position, velocity, acceleration, jerk and effort (default: 0.8)",
        share,
    )
    limits.add(
        "--full-speed-in S",
        "shortest time to reach the velocity limit, which limits the acceleration (default: 0.5)",
        positive_number,
        dest="time_to_full_speed",
    )
    limits.add(
        "--clearance M",
        "least distance to the arm itself and to the table (default: 0.01)",
        positive_number,
    )
    limits.add(
        "--no-table", "allow the arm to reach below its base", dest="table", action="store_false"
    )
    limits.add(
        "--step S",
        "time between points of the JointTrajectory (default: at the waypoints, about 0.5 s apart, "
        "which controllers join by polynomials of the fifth order)",
        positive_number,
    )


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.excitation.excitation import ExcitationOptions
    from inverse_dynamics.excitation.excite import ExcitationResult, excite
    from inverse_dynamics.terminal.screen import announce, progress_bar, show

    robot = changed_robot(arguments)
    out, overwrite, inputs = arguments.out, arguments.overwrite, (*arguments.given, *robot.files)
    ExcitationResult.check(out, overwrite=overwrite, inputs=inputs)
    names = ("duration", "share", "time_to_full_speed", "clearance", "table", "payload")
    with progress_bar() as progress:
        result = excite(
            robot,
            given=arguments.given,
            options=ExcitationOptions(**stated(arguments, *names)),
            say=announce,
            progress=progress,
            **stated(arguments, "seed"),
        )
    replace(result, step=arguments.step).save(out, overwrite=overwrite)
    files = ExcitationResult.files(out)
    written = ("written", ", ".join(map(str, files)))
    show(arguments, result.numbers(), files, [*result.lines(), written])

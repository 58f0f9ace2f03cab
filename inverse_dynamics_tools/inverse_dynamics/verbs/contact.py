# SPDX-License-Identifier: Apache-2.0
"""`ids contact`: what touched the robot."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.base.decimals import decimal
from inverse_dynamics.verbs.common import file_name, positive_number, progress_bar
from inverse_dynamics.verbs.heading import print_heading
from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import (
    add_effort_is,
    add_figures,
    add_robot,
    add_robot_changes,
    add_verb,
    chosen_robot,
    robot_changes,
)

if TYPE_CHECKING:
    from inverse_dynamics.evaluation.contacts import Contacts

_EPILOG = """\
examples:
  ids contact recording --robot panda_real --quiet 0,60
      the first minute is without contact, and contains all motions of the rest

  ids contact recording --robot panda_real --quiet-recording yesterday \\
      --false-alarms 0.1
      thresholds from another recording; one false alarm in ten hours

  ids contact recording --robot my_robot.yaml --quiet 0,60 \\
      --friction-band 1,1,1,0.3,0.3,0.3
      error of the friction model per joint [N m] in addition to that of the quiet part, for a quiet part
      in which the robot hardly moves

  ids contact recording --robot arm.yaml
      thresholds from the errors that `ids identify` has found on held-out data

External torques are those that the robot exerts on its surroundings: measured torques minus the
torques of the model for the motion, low-passed. They include what the model lacks, such as a load.

results, written whole or not at all:
  contacts.json           contacts; thresholds, and how they were chosen
  contacts.png            external torques, thresholds, contacts; with --figures also .svg, .pdf
  series.npz              time, torques, valid, contact, wrenches, unseen, for numpy.load()
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "contact",
        summary="find what touched the robot in a recording, and with which force",
        epilog=_EPILOG,
        json=True,
    )
    parser.add_argument(
        "bag", metavar="RECORDING", type=file_name, help="recording, as for `ids evaluate`"
    )
    add_robot(parser)
    quiet = parser.add_argument_group(
        "thresholds, from a part without contact or from `ids identify`"
    )
    quiet.add_argument(
        "--quiet",
        metavar="FROM,TO",
        type=_span,
        help="the part without contact, in s since the first sample",
    )
    quiet.add_argument(
        "--quiet-recording",
        metavar="RECORDING",
        type=file_name,
        help="a recording without contact; with --quiet, only that part of it",
    )
    quiet.add_argument(
        "--false-alarms",
        metavar="PER_HOUR",
        type=positive_number,
        default=1.0,
        help="false alarms per hour, of all joints together (default: 1)",
    )
    estimator = parser.add_argument_group("estimator")
    estimator.add_argument(
        "--gain",
        metavar="PER_SECOND",
        type=positive_number,
        help="1 / time constant (default: 10 to 60 1/s, 1.9 times the cut-off [Hz] of the accelerations of "
        "the recording that thresholds are made of)",
    )
    estimator.add_argument(
        "--tracking",
        metavar="RAD_PER_SECOND",
        type=positive_number,
        help="take velocities from positions, tracked with this bandwidth (default: recorded velocities)",
    )
    estimator.add_argument(
        "--friction-band",
        metavar="A,B,...",
        type=_numbers,
        default=(),
        help="error of the friction model [N m] in addition to that of the part without contact, one number "
        "per joint, or one for all: only what exceeds it is an external torque",
    )
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        help="output directory (default: RECORDING_ROBOT_contacts in the working directory)",
    )
    parser.add_argument(
        "--overwrite", action="store_true", help="replace an older result in that directory"
    )
    add_figures(parser)
    robot = add_robot_changes(parser, "recording")
    robot.add_argument("--topic", metavar="NAME", help="topic of the joint states")
    add_effort_is(robot)
    return parser


def _span(text: str) -> tuple[float, float]:
    """`from,to` of an option."""
    numbers = _numbers(text)
    if len(numbers) != 2 or not numbers[0] < numbers[1]:
        raise argparse.ArgumentTypeError(f"expected two times, the later one second, got '{text}'")
    return numbers[0], numbers[1]


def _numbers(text: str) -> tuple[float, ...]:
    """`a,b,c` of an option."""
    try:
        numbers = tuple(decimal(part) for part in text.split(","))
    except ValueError:
        numbers = (math.nan,)
    if not all(math.isfinite(number) for number in numbers):
        raise argparse.ArgumentTypeError(f"expected numbers, a,b,c, got '{text}'")
    return numbers


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.base.files import check_output_directory
    from inverse_dynamics.data.several_recordings import name_of
    from inverse_dynamics.evaluation.contacts import find_contacts
    from inverse_dynamics.results.contacts import CONTENTS, summary, write_contacts

    robot = chosen_robot(arguments)
    out = arguments.out or Path(f"{name_of(arguments.bag)}_{robot.name}_contacts")
    inputs = (arguments.bag, arguments.quiet_recording, arguments.urdf, *robot.files)
    check_output_directory(out, overwrite=arguments.overwrite, contents=CONTENTS, inputs=inputs)
    with progress_bar() as progress:
        contacts = find_contacts(
            arguments.bag,
            robot,
            quiet=arguments.quiet,
            quiet_recording=arguments.quiet_recording,
            false_alarms=arguments.false_alarms,
            gain=arguments.gain,
            tracking=arguments.tracking,
            friction_band=arguments.friction_band,
            progress=progress,
            topic=arguments.topic,
            effort_is=arguments.effort_is,
            **robot_changes(arguments),
        )
    write_contacts(contacts, out, overwrite=arguments.overwrite, figures=arguments.figures)
    if arguments.json:
        print_json("contact", summary(contacts), [out])
    else:
        _print(contacts, out, arguments.figures)


def _print(contacts: Contacts, out: Path, figures: tuple[str, ...]) -> None:
    from inverse_dynamics.verbs.screen import Screen
    from inverse_dynamics.verbs.tables import contact_table, threshold_table

    console = Screen()
    evaluation = contacts.evaluation
    print_heading(console, evaluation)
    console.print(f"effort means   {evaluation.effort.summary}")
    console.print(f"estimator      {contacts.estimator}, {contacts.gain:.3g} 1/s")
    console.print(f"quiet          {contacts.quiet}")
    for note in contacts.notes:
        console.print(f"note           {note}")
    console.print(threshold_table(contacts))
    if contacts.contacts:
        console.print(contact_table(contacts))
    else:
        console.print("contacts       none")
    for suffix in figures:
        console.print(f"figure         {out / f'contacts.{suffix}'}")
    console.print(f"contacts       {out / 'contacts.json'}")

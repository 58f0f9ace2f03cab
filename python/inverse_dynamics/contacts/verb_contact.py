# SPDX-License-Identifier: Apache-2.0
"""`ids contact`: what touched the robot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import (
    RECORDING,
    SOLVER,
    Options,
    chosen_robot,
    given_overrides,
)
from inverse_dynamics.terminal.values import file_name, numbers, positive_number, span

if TYPE_CHECKING:
    import argparse

PLACE = ("look", 6)
SUMMARY = "find what touched the robot, and with which force"
DESCRIPTION = "Find what touched the robot in a recording, and with which force."
EPILOG = """\
examples:
  ids contact recording --robot panda_real --quiet 0,60
      the first minute is without contact, and contains all motions of the rest

  ids contact recording --robot panda_real --quiet-recording yesterday \\
      --false-alarms 0.1
      thresholds from another recording; one false alarm in ten hours

  ids contact recording --robot arm.yaml
      thresholds from the errors that `ids identify` has found on held-out data

External torques are those that the robot exerts on its surroundings: measured torques minus the
torques of the model for the motion, low-passed. They include what the model lacks, such as a load.

results, written whole or not at all:
  contacts.json           contacts; thresholds, and how they were chosen
  report.html             a page: contacts, the robot in motion, its external torques
  contacts.png            external torques, thresholds, contacts; with --figures also .svg, .pdf
  series.npz              time, torques, valid, contact, wrenches, unseen, for numpy.load(); all of it, for
                          Contacts.load() of Python
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.recording()
    options.robot()
    quiet = options.group("thresholds, from a part without contact or from `ids identify`")
    quiet.add("--quiet FROM,TO", "the part without contact, in s since the first sample", span)
    quiet.add(
        "--quiet-recording RECORDING",
        "a recording without contact; with --quiet, only that part of it",
        file_name,
    )
    quiet.add(
        "--false-alarms PER_HOUR",
        "false alarms per hour, of all joints together (default: 1)",
        positive_number,
        default=1.0,
    )
    estimator = options.group("estimator")
    estimator.add(
        "--gain PER_SECOND",
        "1 / time constant (default: 10 to 60 1/s, 1.9 times the cut-off [Hz] of the accelerations "
        "of the recording that gives the thresholds)",
        positive_number,
    )
    estimator.add(
        "--tracking RAD_PER_SECOND",
        "take velocities from positions, tracked with this bandwidth (default: recorded velocities)",
        positive_number,
    )
    estimator.add(
        "--friction-band A,B,...",
        "error of the friction model [N m] in addition to that of the part without contact, one "
        "number per joint, or one for all: only what exceeds it is an external torque",
        numbers,
        default=(),
    )
    options.output(
        "DIR",
        "output directory (default: RECORDING_ROBOT_contacts in the working directory)",
        replaces=True,
    )
    options.shared("--json")
    options.figures()
    options.overrides(*SOLVER, *RECORDING)


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.contacts.contacts import Contacts, find_contacts
    from inverse_dynamics.recordings.several_recordings import name_of
    from inverse_dynamics.terminal.screen import progress_bar, show

    robot = chosen_robot(arguments)
    out = arguments.out or Path(f"{name_of(arguments.bag)}_{robot.name}_contacts")
    inputs = (arguments.bag, arguments.quiet_recording, arguments.urdf, *robot.files)
    Contacts.check(out, overwrite=arguments.overwrite, inputs=inputs)
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
            **given_overrides(arguments),
        )
    contacts.save(out, overwrite=arguments.overwrite, figures=arguments.figures)
    files = [
        ("figure", [out / f"contacts.{suffix}" for suffix in arguments.figures]),
        ("contacts", out / "contacts.json"),
        ("page", out / "report.html"),
    ]
    show(arguments, contacts.numbers(), [out], [*contacts.lines(), *files])

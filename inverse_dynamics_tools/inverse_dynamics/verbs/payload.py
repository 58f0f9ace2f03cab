# SPDX-License-Identifier: Apache-2.0
"""`ids payload`: what the robot carries."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.verbs.common import file_name, progress_bar
from inverse_dynamics.verbs.heading import print_heading
from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import (
    add_figures,
    add_robot,
    add_robot_changes,
    add_verb,
    chosen_robot,
    robot_changes,
)

if TYPE_CHECKING:
    from inverse_dynamics.identification.payload import Payload

_EPILOG = """\
examples:
  ids payload loaded --robot ur10_real --out payload.yaml
  ids evaluate loaded --robot ur10_real --payload payload.yaml
      a few seconds of motion with the load, better ten; then the errors with the load in the model

  ids payload loaded --empty before --robot my_robot.yaml --out payload.yaml
      with a recording of the same motion without the load, which provides offsets and noise

All joints should move, and each axis of the wrist should be horizontal for some time: most of the
information comes from gravity. The model of the arm must be accurate; a URDF without friction is not.
The result is in addition to a tool that the run configuration, or --payload, has at the tip.

results, all of them or none:
  payload.yaml    mass, center_of_mass and, where the data determine it, inertia, in the tip frame: for
                  --payload, for `payload:` of a run configuration, for the controllers
  payload.json    the same with intervals, covariance, offsets, noise and errors of each joint
  payload.png     measured minus computed torques with and without the load
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    from inverse_dynamics.robot.choices import EFFORT_CHOICES

    parser = add_verb(
        subparsers,
        "payload",
        summary="estimate what the robot carries in a recording: mass, center of mass, inertia",
        epilog=_EPILOG,
        json=True,
    )
    parser.add_argument(
        "bag", metavar="RECORDING", type=file_name, help="recording, as for `ids evaluate`"
    )
    add_robot(parser)
    parser.add_argument(
        "--empty",
        metavar="RECORDING",
        type=file_name,
        help="recording of the same robot without the load, on the same day",
    )
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=Path,
        required=True,
        help="the load, a YAML file; a .json file and the figure are written next to it",
    )
    parser.add_argument(
        "--overwrite", action="store_true", help="replace older results of these names"
    )
    add_figures(parser)
    robot = add_robot_changes(parser, "recording")
    robot.add_argument("--topic", metavar="NAME", help="topic of the joint states")
    robot.add_argument(
        "--effort-is",
        metavar="MEANING",
        choices=tuple(EFFORT_CHOICES),
        help=f"meaning of the recorded efforts: {', '.join(EFFORT_CHOICES)} (`ids evaluate --help`)",
    )
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.results.payload import (
        check_payload_output,
        payload_files,
        summary,
        write_payload,
    )

    robot = chosen_robot(arguments)
    inputs = (arguments.bag, arguments.empty, arguments.urdf, *robot.files)
    check_payload_output(
        arguments.out, arguments.figures, overwrite=arguments.overwrite, inputs=inputs
    )

    from inverse_dynamics.identification.payload import estimate_payload

    with progress_bar() as progress:
        payload = estimate_payload(
            arguments.bag,
            robot,
            empty=arguments.empty,
            progress=progress,
            topic=arguments.topic,
            effort_is=arguments.effort_is,
            **robot_changes(arguments),
        )
    write_payload(payload, arguments.out, overwrite=arguments.overwrite, figures=arguments.figures)
    if arguments.json:
        print_json("payload", summary(payload), payload_files(arguments.out, arguments.figures))
    else:
        _print(payload, arguments.out, arguments.figures)


def _print(payload: Payload, out: Path, figures: tuple[str, ...]) -> None:
    from inverse_dynamics.results.payload import payload_files
    from inverse_dynamics.verbs.screen import Screen
    from inverse_dynamics.verbs.tables import payload_table, residual_table

    console = Screen()
    print_heading(
        console,
        payload.evaluation,
        samples=len(payload.time),
        duration=payload.estimate.duration,
    )
    if payload.empty is not None:
        console.print(f"without load   {payload.empty}")
    for note in payload.notes:
        console.print(f"note           {note}")
    console.print(payload_table(payload))
    console.print(residual_table(payload))
    for file in payload_files(out, figures):
        console.print(f"written        {file}")

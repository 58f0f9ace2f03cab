# SPDX-License-Identifier: Apache-2.0
"""`ids payload`: what the robot carries."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.terminal.options import (
    RECORDING,
    SOLVER,
    Options,
    chosen_robot,
    given_overrides,
    replaces,
)
from inverse_dynamics.terminal.values import file_name

if TYPE_CHECKING:
    import argparse

PLACE = ("identify", 3)
SUMMARY = "estimate what the robot carries in a recording"
DESCRIPTION = "Estimate what the robot carries in a recording: mass, center of mass, inertia."
EPILOG = """\
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
  payload.html    a page: the load, the robot in motion, its torques with and without the load
  payload.npz     all of it, for Payload.load() of Python
  payload.png     measured minus computed torques with and without the load
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    options.recording()
    options.robot()
    options.add(
        "--empty RECORDING",
        "recording of the same robot without the load, on the same day",
        file_name,
    )
    options.output(
        "FILE",
        "the load, a YAML file; a .json file, a page and the figure are written next to it",
        required=True,
    )
    options.add(
        "--ur FILE",
        "also write the load as the request of Universal Robots' driver, for `ros2 service call`",
        Path,
    )
    options.shared("--json")
    options.figures()
    options.overrides(*SOLVER, *RECORDING)


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.payload.files import payload_request
    from inverse_dynamics.payload.payload import Payload, estimate_payload
    from inverse_dynamics.terminal.screen import progress_bar, show

    robot, out, figures = chosen_robot(arguments), arguments.out, arguments.figures
    inputs = (arguments.bag, arguments.empty, arguments.urdf, *robot.files)
    more = {"--ur": arguments.ur} if arguments.ur else {}
    files = (*Payload.files(out, figures), *more.values())
    overwrite = replaces(arguments, files)
    Payload.check(out, overwrite=overwrite, figures=figures, more=more, inputs=inputs)
    with progress_bar() as progress:
        payload = estimate_payload(
            arguments.bag,
            robot,
            empty=arguments.empty,
            progress=progress,
            **given_overrides(arguments),
        )
    texts = {file: payload_request(payload, file.name) for file in more.values()}
    payload.save(out, overwrite=overwrite, figures=figures, more=texts)
    show(arguments, payload.numbers(), files, [*payload.lines(), ("written", files)])

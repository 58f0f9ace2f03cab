# SPDX-License-Identifier: Apache-2.0
"""`ids identify`: from recordings to a model with friction, and how good it is."""

from __future__ import annotations

import argparse
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.errors import UserError
from inverse_dynamics.terminal.options import (
    CHAIN,
    RECORDING,
    Options,
    chosen_robot,
    given_overrides,
    replaces,
)
from inverse_dynamics.terminal.values import file_name, numbers, stated_payload

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Parameter
    from inverse_dynamics.robots.robots import Robot
    from inverse_dynamics.terminal.screen import Line

PLACE = ("identify", 2)
SUMMARY = "make a model with friction from recordings"
DESCRIPTION = "Identify a model with friction from recordings of a robot, and state its errors."
EPILOG = """\
examples:
  ids identify recording --robot ur10_real --out arm.yaml
      a model of the recorded arm: geometry from its description, masses and friction from the data

  ids evaluate other_recording --robot arm.yaml
      torques of this model for another motion

  ids identify recording --urdf my_arm.urdf --out arm.yaml
      without a run configuration: the description is enough

  ids identify monday tuesday --robot ur10_real --out arm.yaml \\
      --hold-out wednesday
      from two recordings; errors on a third one, which is used for no fit and no choice

  ids identify alone --known-payload loaded=5.0,0,0.02,0.08 \\
      --urdf my_arm.urdf --effort-is current --out arm.yaml
      efforts are motor currents [A] with unknown drive gains: a second
      recording with a known load determines them

Errors are those on held-out parts of the recordings: each of several contiguous
blocks is predicted by a model fitted to the others, with law, prior and delay chosen on the others.
Compare them with `present, friction refitted`. docs/identification.md explains the method, and what to do on the robot.

results, all of them or none:
  arm.yaml                run configuration, for --robot of every verb
  arm_model.yaml          the model: links, friction, rotor inertia, 95 % band of the torques, range of the data
  arm_model.json          what the model may be wrong by, for `ids payload` and `contact`
  arm.html                page: the robot in motion, measured and predicted torques, influence of data and prior
  arm.json                all numbers
  arm.npz                 all of it, for Identification.load() of Python
"""

_OF_RECORDINGS = ("effort_is", "topic", "start", "end")  # arguments of identify()


def declare(options: Options) -> None:
    """Arguments and options."""
    options.recording(
        "recordings",
        "recording, as for `ids evaluate`; several recordings must be of one robot with the same load",
        nargs="+",
    )
    options.robot()
    options.output(
        "FILE",
        "run configuration to write, NAME.yaml; NAME_model.yaml, NAME_model.json, NAME.json and "
        "NAME.html are written with it",
        required=True,
    )
    options.shared("--json")
    options.add(
        "--hold-out RECORDING",
        "a recording to test the model on, for example of another day; may be given several times",
        file_name,
        action="append",
        default=[],
    )
    options.add(
        "--known-payload RECORDING=LOAD",
        "a further recording of motor currents, with a known load, which determines the drive gains. "
        "LOAD as for --payload of other verbs, with its center of mass: "
        "MASS,x,y,z[,Ixx,Ixy,Ixz,Iyy,Iyz,Izz] in the tip frame, or a YAML file; may be given several "
        "times",
        _known_payload,
        action="append",
        default=[],
    )
    options.add(
        "--coupling C,C,...",
        "joints share motors, as a wrist whose last motor turns with the joint before: the rows of C, one after the "
        "other; friction is that of motors with velocities C qd. By default the matrix of --gears",
        numbers,
        default=(),
    )
    options.add(
        "--friction-at PLACE=JOINT:FACTOR,...",
        "friction acts at this place, too, besides the joints: the name of the place, and its velocity as factors of "
        "those of joints, as of the bearing between two bars: elbow=shoulder_joint:-1,drive_joint:1. May be given "
        "several times",
        _friction_place,
        action="append",
        default=[],
    )
    options.add(
        "--spring JOINT[=lever]",
        "find the spring of a joint: a linear one, or with =lever one that pulls a lever around, of the torque "
        "a sin q + b cos q. May be given several times",
        action="append",
        default=[],
    )
    options.add(
        "--accept KIND",
        "identify a model although this mistake is found; a refusal names its KIND. May be given "
        "several times",
        action="append",
        default=[],
    )
    options.add(
        "--urdf-out FILE",
        "also write the description with the identified inertia, and friction as far as <dynamics> "
        "can state it",
        Path,
    )
    options.add(
        "--mjcf-out FILE",
        "also write a MuJoCo model of the chain",
        Path,
    )
    options.add(
        "--ur FILE",
        "also write the shares of friction that the robot compensates, as the request of Universal Robots' driver: "
        "efforts are its commands, and --robot has a model with all of the friction",
        Path,
    )
    options.add(
        "--gallery DIRECTORY",
        "also write what a pull request to the gallery of robots has, into a checkout of the project or another "
        "directory, and its text, NAME.md (docs/robots.md)",
        Path,
    )
    options.overrides(*CHAIN, *RECORDING)


def _known_payload(text: str) -> tuple[Path, dict[str, Parameter]]:
    recording, equals, load = text.rpartition("=")
    if not equals or not recording:
        raise argparse.ArgumentTypeError(
            f"expected RECORDING=MASS,x,y,z, a recording and what the robot carries in it, got '{text}'"
        )
    return file_name(recording), stated_payload(load)


def _friction_place(text: str) -> tuple[str, dict[str, float]]:
    place, _, velocity = text.partition("=")
    factors: dict[str, float] = {}
    for term in velocity.split(","):
        joint, _, factor = term.rpartition(":")
        try:
            factors[joint] = float(factor)
        except ValueError:
            joint = ""
        if not place or not joint:
            raise argparse.ArgumentTypeError(
                "expected PLACE=JOINT:FACTOR,JOINT:FACTOR, a name and the velocity of the place by those of joints, "
                f"got '{text}'"
            )
    return place, factors


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics.identification.gallery import check_gallery, write_gallery
    from inverse_dynamics.identification.identify import identify
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.identification.universal_robots import friction_request
    from inverse_dynamics.identification.urdf_export import mjcf_text, urdf_text
    from inverse_dynamics.recordings.tables import parts_joined
    from inverse_dynamics.terminal.screen import progress_bar, show

    arguments.recordings = parts_joined(arguments.recordings)
    robot = _robot(arguments)
    loads = [recording for recording, _ in arguments.known_payload]
    inputs = (*arguments.recordings, *arguments.hold_out, *loads, *robot.files)
    more = {
        "--urdf-out": arguments.urdf_out,
        "--mjcf-out": arguments.mjcf_out,
        "--ur": arguments.ur,
    }
    more = {option: file for option, file in more.items() if file is not None}
    files = Identification.files(arguments.out)
    overwrite = replaces(arguments, files) and (
        arguments.overwrite or not any(file.exists() for file in more.values())
    )
    Identification.check(arguments.out, overwrite=overwrite, more=more, inputs=inputs)
    if arguments.gallery:
        check_gallery(robot, arguments.out, arguments.gallery, overwrite=overwrite)
    with progress_bar() as progress:
        found = identify(
            arguments.recordings,
            robot,
            hold_out=arguments.hold_out,
            known_payloads=arguments.known_payload,
            coupling=arguments.coupling,
            accept=arguments.accept,
            progress=progress,
            **{name: getattr(arguments, name) for name in _OF_RECORDINGS},
        )
    texts = {"--urdf-out": urdf_text, "--mjcf-out": mjcf_text, "--ur": friction_request}
    exports = {file: texts[option](found) for option, file in more.items()}
    found.save(arguments.out, overwrite=overwrite, more=exports)
    shared: tuple[Path, ...] = ()
    if arguments.gallery:
        command = shlex.join(["ids", *(x for x in arguments.command_line if x != "--overwrite")])
        shared = write_gallery(found, arguments.out, arguments.gallery, command)
    robot_file, series, model, uncertainty, figures, page = files
    names: list[Line] = [
        ("robot", f"{robot_file}: `ids evaluate RECORDING --robot {robot_file}`"),
        ("model", model),
        ("uncertainty", f"{uncertainty}: for `ids payload` and `contact`"),
        ("page", page),
        ("figures", figures),
        ("for Python", series),
        ("also", list(more.values())),
        ("gallery", shared),
    ]
    written = [*files, *more.values(), *shared]
    show(arguments, found.numbers(), written, [*found.lines(), *names])


def _robot(arguments: argparse.Namespace) -> Robot:
    """The run configuration to start from; of a description alone, one with its name."""
    from inverse_dynamics.evaluation.posture import LOCKED
    from inverse_dynamics.robots.robots import with_changes

    changes = given_overrides(arguments)
    for name in _OF_RECORDINGS:
        changes.pop(name)
    for name in changes["parameters"] or ():
        if not name.startswith(LOCKED):
            raise UserError(
                f"--parameter {name}: expected {LOCKED}JOINT, the only parameters that a fit uses; leave "
                "it out"
            )
    robot = chosen_robot(arguments)
    if arguments.robot is None:
        robot = replace(robot, effort="torque", friction=False)
    springs = (text.partition("=") for text in arguments.spring)
    robot = replace(
        robot,
        friction_at={**robot.friction_at, **dict(arguments.friction_at)},
        fit_springs={**robot.fit_springs, **{j: kind or "linear" for j, _, kind in springs}},
    )
    return with_changes(robot, **changes)

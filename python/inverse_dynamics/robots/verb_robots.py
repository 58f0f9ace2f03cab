# SPDX-License-Identifier: Apache-2.0
"""`ids robots`: which robots and solvers there are."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import UserError
from inverse_dynamics.terminal.options import CHAIN, TABLE, Options, given_overrides
from inverse_dynamics.terminal.values import file_name

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from inverse_dynamics.robots.arm import Arm
    from inverse_dynamics.robots.robots import Robot
    from inverse_dynamics.terminal.screen import Line

PLACE = ("look", 3)
SUMMARY = "list robots, show one"
DESCRIPTION = "List the run configurations of the sourced workspaces, or show one."
EPILOG = """\
examples:
  ids robots                     names and descriptions
  ids robots ur10_real           its run configuration
  ids robots my_robot.yaml       the run configuration in a file, which is checked
  ids robots --plugins           installed solvers

  ids robots --new my_robot.yaml --urdf my_arm.urdf --from log.csv
      a run configuration of your own, commented; what efforts mean is found from the recording

What each key means: docs/add_a_robot.md.
"""


def declare(options: Options) -> None:
    """Arguments and options."""
    shown = options.one_of()
    shown.argument("robot", nargs="?", metavar="NAME|FILE", help="show this robot")
    shown.add("--plugins", "list installed solvers instead")
    shown.add("--new FILE", "write a run configuration of the robot that the options state", Path)
    options.shared("--json")
    options.add("--overwrite", "with --new: replace an older file")
    options.add(
        "--from RECORDING",
        "with --new: a recording that it must fit, from which it is found what efforts mean",
        file_name,
        dest="recording",
    )
    options.overrides(*CHAIN, "--plugin", "--no-friction", "--topic", "--drive-gains", *TABLE)


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    from inverse_dynamics import _core
    from inverse_dynamics.robots.robots import load_robot, robot_names
    from inverse_dynamics.terminal.screen import show

    found: dict[str, Any]
    rows: Sequence[Line]
    if arguments.new:
        arm = _new(arguments)
        robot = load_robot(arguments.new)
        found, rows = {"robot": robot}, [("written", f"{arguments.new}"), *_rows(robot, arm, [])]
    elif arguments.plugins:
        plugins = _core.available_solvers()
        found, rows = {"plugins": plugins}, plugins
    elif arguments.robot:
        robot = load_robot(arguments.robot)
        arm, notes = _checked(robot)
        found = {"robot": robot, "chain": arm.joint_names, "units": arm.units, "notes": notes}
        rows = _rows(robot, arm, notes)
    else:
        robots = [load_robot(name) for name in robot_names()]
        found, rows = {"robots": robots}, [(robot.name, robot.description) for robot in robots]
    show(arguments, found, [arguments.new], rows)


def _new(arguments: argparse.Namespace) -> Arm:
    """Write the file of a new robot; gives its arm. Raises UserError."""
    from dataclasses import replace

    from inverse_dynamics.evaluation.evaluation import evaluate_run, open_run
    from inverse_dynamics.robots.arm import Arm
    from inverse_dynamics.robots.robot_files import write_robot
    from inverse_dynamics.robots.robots import robot_of_description, with_changes

    if arguments.urdf is None:
        raise UserError("--new: expected --urdf FILE, got none; give the robot's description")
    if arguments.xacro:
        raise UserError("--new: expected no --xacro; give the URDF that xacro makes")
    robot = with_changes(robot_of_description(arguments.urdf), **given_overrides(arguments))
    arm = Arm(robot)
    description = f"{arguments.urdf.name}, {len(arm.joint_names)} joints"
    robot = replace(robot, name=arguments.new.stem, description=description)
    if arguments.recording is not None:
        evaluated = evaluate_run(open_run(arguments.recording, robot))
        robot = replace(evaluated.robot, effort=evaluated.effort.meaning)
    write_robot(robot, arguments.new, overwrite=arguments.overwrite)
    return arm


def _rows(robot: Robot, arm: Arm, notes: list[str]) -> list[tuple[str, str]]:
    """Keys of the run configuration that say something, in words."""
    from inverse_dynamics.robots.choices import EFFORT_CHOICES, METHODS

    gravity = robot.gravity
    cutoff = "" if robot.cutoff is None else f", cut-off {robot.cutoff:g} Hz"
    rows = {
        "name": robot.name,
        "description": robot.description,
        "plugin": robot.plugin,
        "urdf": str(robot.urdf or ""),
        "model": str(robot.model or ""),
        "root, tip": f"{robot.root or '(the first link)'}, {robot.tip or '(the last link)'}",
        "chain": ", ".join(arm.joint_names),
        "gravity": "(the solver's default)" if gravity is None else f"{list(gravity)} m/s²",
        "friction": _friction(robot, arm),
        "topic": robot.topic,
        "joints": ", ".join(robot.joints) or "(named as in the chain)",
        "effort": f"{robot.effort}: {EFFORT_CHOICES[robot.effort]}",
        "drive gains": f"{list(robot.drive_gains)} N m/A" if robot.drive_gains else "",
        "parameters": ", ".join(f"{name}: {value}" for name, value in robot.parameters.items()),
        "accelerations": f"{robot.accelerations}{cutoff}: {METHODS[robot.accelerations]}",
        "source": robot.source,
        "file": str(robot.file),
    }
    return [(k, text) for k, text in rows.items() if text] + [("note", note) for note in notes]


def _friction(robot: Robot, arm: Arm) -> str:
    """Whether it counts, and whether the model states any."""
    ones = [1.0] * len(arm.joint_names)
    rubs = arm.solver.friction_vector(ones, q=ones).any()
    return ("yes" if rubs else "yes, but the model states none") if robot.friction else "left out"


def _checked(robot: Robot) -> tuple[Arm, list[str]]:
    """The arm, checked as far as possible without a recording, and warnings. Raises UserError."""
    from inverse_dynamics.robots.arm import Arm
    from inverse_dynamics.simulation.configuration import StatedSimulation
    from inverse_dynamics.wording import did_you_mean

    arm = Arm(robot)
    notes = list(arm.solver.warnings)
    if set(robot.joints) & set(arm.joint_names):  # else they have names of their own
        for name in sorted(set(robot.joints) - set(arm.joint_names)):
            hint = did_you_mean(name, set(arm.joint_names) - set(robot.joints))
            notes.append(
                f"{name} is not a joint of the chain: recordings must use this name"
                + (hint and f"; {hint}")
            )
    if robot.urdf is not None:
        arm.limit("effort", math.inf)  # refuses what isn't a number
        StatedSimulation.of(robot, arm.joint_names)
    return arm, notes

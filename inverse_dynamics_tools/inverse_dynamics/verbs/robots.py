# SPDX-License-Identifier: Apache-2.0
"""`ids robots`: which robots and solvers there are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.verbs.json_output import print_json
from inverse_dynamics.verbs.options import add_verb

if TYPE_CHECKING:
    import argparse

    from inverse_dynamics.evaluation.evaluation import Arm
    from inverse_dynamics.robot.robots import Robot

_EPILOG = """\
examples:
  ids robots                     names and descriptions
  ids robots ur10_real           its run configuration
  ids robots my_robot.yaml       the run configuration in a file, which is checked
  ids robots --plugins           installed solvers

To add a robot, write one more file: docs/add_a_robot.md.
"""


def add_parser(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
) -> argparse.ArgumentParser:
    """Declare the verb."""
    parser = add_verb(
        subparsers,
        "robots",
        summary="list robots, show one",
        description="List the run configurations of the sourced workspaces, or show one.",
        epilog=_EPILOG,
        json=True,
    )
    shown = parser.add_mutually_exclusive_group()
    shown.add_argument("robot", nargs="?", metavar="NAME|FILE", help="show this robot")
    shown.add_argument("--plugins", action="store_true", help="list installed solvers instead")
    return parser


def run(arguments: argparse.Namespace) -> None:
    """Do it."""
    if arguments.plugins:
        _list_solvers(json=arguments.json)
    elif arguments.robot:
        _show(arguments.robot, json=arguments.json)
    else:
        _list(json=arguments.json)


def _list_solvers(*, json: bool) -> None:
    from inverse_dynamics import _core
    from inverse_dynamics.verbs.screen import Screen

    plugins = _core.available_solvers()
    if json:
        print_json("robots", {"plugins": plugins})
    else:
        Screen().print("\n".join(plugins))


def _list(*, json: bool) -> None:
    from inverse_dynamics.robot.robots import load_robot, robot_names

    robots = [load_robot(name) for name in robot_names()]
    if json:
        print_json("robots", {"robots": robots})
    else:
        _print_rows({robot.name: robot.description for robot in robots})


def _print_rows(rows: dict[str, str]) -> None:
    """One key and text per line; lines stay whole, so that paths can be copied. No text: no line."""
    from rich.text import Text

    from inverse_dynamics.verbs.screen import Screen

    console = Screen()
    width = max(map(len, rows), default=0) + 2
    for key, text in rows.items():
        if text:
            console.print(Text(f"{key:<{width}}", "bold") + Text(text, "not bold"))


def _show(robot: str, *, json: bool) -> None:
    from inverse_dynamics.robot.choices import EFFORT_CHOICES, METHODS
    from inverse_dynamics.robot.robots import load_robot

    shown = load_robot(robot)
    arm, notes = _checked(shown)
    if json:
        found = {"robot": shown, "chain": arm.joint_names, "units": arm.units, "notes": notes}
        print_json("robots", found)
        return
    gravity = shown.gravity
    cutoff = "" if shown.cutoff is None else f", cut-off {shown.cutoff:g} Hz"
    rows = {
        "name": shown.name,
        "description": shown.description,
        "plugin": shown.plugin,
        "urdf": str(shown.urdf or ""),
        "model": str(shown.model or ""),
        "root, tip": f"{shown.root or '(the first link)'}, {shown.tip or '(the last link)'}",
        "chain": ", ".join(arm.joint_names),
        "gravity": "(the solver's default)" if gravity is None else f"{list(gravity)} m/s²",
        "friction": "yes" if shown.friction else "no",
        "topic": shown.topic,
        "joints": ", ".join(shown.joints) or "(named as in the chain)",
        "effort": f"{shown.effort}: {EFFORT_CHOICES[shown.effort]}",
        "drive gains": f"{list(shown.drive_gains)} N m/A" if shown.drive_gains else "",
        "parameters": ", ".join(f"{name}: {value}" for name, value in shown.parameters.items()),
        "accelerations": f"{shown.accelerations}{cutoff}: {METHODS[shown.accelerations]}",
        "source": shown.source,
        "file": str(shown.file),
    }
    _print_rows(rows | {f"note{'' if i == 0 else f' {i + 1}'}": n for i, n in enumerate(notes)})


def _checked(robot: Robot) -> tuple[Arm, list[str]]:
    """The arm, checked as far as possible without a recording, and warnings. Raises UserError."""
    from inverse_dynamics.base.wording import did_you_mean
    from inverse_dynamics.evaluation.evaluation import Arm
    from inverse_dynamics.robot.descriptions import effort_limits, read_description
    from inverse_dynamics.simulation.configuration import StatedSimulation, states_simulation

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
        description = read_description(robot.urdf)
        effort_limits(robot.urdf, description, arm.joint_names)
        if states_simulation(robot):
            from inverse_dynamics.simulation.urdf import chain_from_urdf

            StatedSimulation.of(robot, chain_from_urdf(description, robot.root, robot.tip))
    return arm, notes

# SPDX-License-Identifier: Apache-2.0
"""Verbs and options that several verbs have."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.base.extras import is_installed
from inverse_dynamics.base.help_text import HelpFormatter
from inverse_dynamics.errors import UserError
from inverse_dynamics.robot.choices import EFFORT_CHOICES
from inverse_dynamics.verbs.common import figure_formats, names, parameter, three_numbers
from inverse_dynamics.verbs.payload_option import payload

if TYPE_CHECKING:
    from inverse_dynamics.robot.robots import Robot

# Options of add_robot_changes(), by the names that with_changes() has for them.
_CHANGES = ("plugin", "friction", "urdf", "root", "tip", "gravity", "joints", "parameters")


def add_verb(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
    name: str,
    *,
    summary: str,
    description: str = "",
    epilog: str,
    json: bool = False,
) -> argparse.ArgumentParser:
    """A verb. summary: in the list of verbs; description: of its own help, else the summary.

    json: whether it has the option --json, see json_output.py.
    """
    parser = subparsers.add_parser(
        name,
        help=summary,
        description=description or f"{summary[0].upper()}{summary[1:]}.",
        epilog=epilog,
        formatter_class=HelpFormatter,
    )
    if json:
        parser.add_argument(
            "--json",
            action="store_true",
            help="print one JSON object instead of tables (docs/command_line.md)",
        )
    return parser


def add_runs(parser: argparse.ArgumentParser, more: str = "") -> None:
    """RUN..., read by read_evaluation()."""
    parser.add_argument(
        "runs", metavar="RUN", type=Path, nargs="+", help=f"results of `ids evaluate`{more}"
    )


def add_robot(parser: argparse.ArgumentParser, *, required: bool = False) -> None:
    """--robot, read by load_robot(); where it isn't required, by chosen_robot()."""
    robot = parser.add_argument(
        "--robot",
        metavar="NAME|FILE",
        required=required,
        help="run configuration: a name that `ids robots` lists, or a YAML file"
        + ("" if required else "; may be left out where --urdf is given"),
    )
    robot.completer = robots_and_files  # type: ignore[attr-defined]


def robots_and_files(prefix: str, **_: object) -> list[str]:
    """What may stand for NAME|FILE, as argcomplete asks for it."""
    from argcomplete.completers import FilesCompleter

    from inverse_dynamics.robot.robots import robot_names

    return [*robot_names(), *FilesCompleter()(prefix)]


def chosen_robot(arguments: argparse.Namespace) -> Robot:
    """The run configuration of --robot; without one, the robot that --urdf describes."""
    from inverse_dynamics.robot.robots import load_robot, robot_of_description

    if arguments.robot is not None:
        if arguments.robot.endswith((".urdf", ".xacro")):
            raise UserError(
                f"--robot {arguments.robot}: expected a run configuration, got a description; give it "
                f"as --urdf {arguments.robot}"
            )
        return load_robot(arguments.robot)
    if arguments.urdf is None:
        raise UserError(
            "expected --robot NAME or --urdf FILE, got neither; `ids robots` lists the names"
        )
    return robot_of_description(arguments.urdf)


def add_figures(parser: argparse.ArgumentParser) -> None:
    """--figures, --no-figures."""
    figures = parser.add_mutually_exclusive_group()
    figures.add_argument(
        "--figures",
        metavar="FORMATS",
        type=figure_formats,
        default=("png",) if is_installed("matplotlib") else (),
        help="formats of the figure: some of png,svg,pdf, or none (default: png; without matplotlib: none)",
    )
    figures.add_argument(
        "--no-figures",
        dest="figures",
        action="store_const",
        const=(),
        help="no figure, which is faster: short for --figures none",
    )


def add_gravity(group: argparse._ActionsContainer) -> None:
    """--gravity."""
    group.add_argument(
        "--gravity",
        metavar="X,Y,Z",
        type=three_numbers,
        help="gravitational acceleration [m/s^2] in the frame of the root link (usually 0,0,-9.81)",
    )


def add_effort_is(group: argparse._ActionsContainer) -> None:
    """--effort-is."""
    group.add_argument(
        "--effort-is",
        metavar="MEANING",
        choices=tuple(EFFORT_CHOICES),
        help="meaning of the recorded efforts. "
        + "; ".join(f"{name}: {text}" for name, text in EFFORT_CHOICES.items()),
    )


def add_robot_changes(parser: argparse.ArgumentParser, what: str) -> argparse._ArgumentGroup:
    """Options that override the run configuration. what: what names the joints."""
    group = parser.add_argument_group("overrides of the run configuration")
    group.add_argument("--plugin", metavar="PACKAGE/CLASS", help="solver (`ids robots --plugins`)")
    group.add_argument(
        "--no-friction",
        dest="friction",
        action="store_false",
        default=None,
        help="leave out the solver's friction: for a robot whose controller compensates it",
    )
    add_chain(group, what)
    group.add_argument(
        "--payload",
        metavar="BODY",
        type=payload,
        help="a rigid body at the tip: MASS[,x,y,z[,Ixx,Ixy,Ixz,Iyy,Iyz,Izz]]: mass [kg], "
        "center of mass in the tip frame [m], moments of inertia "
        "about it [kg m^2]; or a YAML file with mass, center_of_mass, inertia and frame "
        "(docs/add_a_robot.md)",
    )
    return group


def add_chain(group: argparse._ActionsContainer, what: str) -> None:
    """--urdf and the options that say what of it moves. what: what names the joints."""
    group.add_argument(
        "--urdf",
        metavar="FILE",
        type=Path,
        help="robot description, with or without --robot; a .xacro file needs xacro",
    )
    group.add_argument("--root", metavar="LINK", help="first link of the chain")
    group.add_argument("--tip", metavar="LINK", help="last link of the chain")
    add_gravity(group)
    group.add_argument(
        "--joints",
        metavar="A,B,...",
        type=names,
        help=f"names of the joints in the {what}, in the order of the chain",
    )
    group.add_argument(
        "--parameter",
        dest="parameters",
        metavar="NAME=VALUE",
        type=parameter,
        action="append",
        help="a parameter of the solver, as under `parameters:` (docs/add_a_robot.md): "
        "locked_joints.finger=0.02; may be given several times",
    )


def robot_changes(arguments: argparse.Namespace) -> dict[str, Any]:
    """Values of the options of add_robot_changes(), or of add_chain(); None: not given."""
    changes = {name: getattr(arguments, name, None) for name in _CHANGES}
    parameters = dict(changes["parameters"] or {})
    for name, value in (getattr(arguments, "payload", None) or {}).items():
        if name in parameters:
            raise UserError(
                f"--payload and --parameter {name}: expected one of them; leave out one"
            )
        parameters[name] = value
    changes["parameters"] = parameters or None
    return changes

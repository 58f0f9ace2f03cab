# SPDX-License-Identifier: Apache-2.0
"""Options: how a verb declares them, and those that several verbs have.

def declare(options: Options) -> None:
options.recording()
options.robot()
options.add("--gain PER_SECOND", "1 / time constant", positive_number)
options.overrides(*SOLVER, *RECORDING)  # evaluate(..., **given_overrides(arguments))
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import UserError
from inverse_dynamics.installation.extras import is_installed
from inverse_dynamics.recordings.joint_log import CLOCKS
from inverse_dynamics.robots.choices import EFFORT_CHOICES, METHODS, RULES
from inverse_dynamics.terminal.values import (
    figure_formats,
    file_name,
    names,
    number,
    numbers,
    parameter,
    payload,
    positive_number,
    three_numbers,
    xacro_argument,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.robots.robots import Robot

# Overrides of the run configuration, by name.
CHAIN = ("--urdf", "--xacro", "--root", "--tip", "--gravity", "--joints", "--parameter")
SOLVER = (*CHAIN, "--plugin", "--no-friction", "--payload")
TABLE = ("--columns", "--scale", "--sign", "--rate", "--gears")
RECORDING = ("--topic", "--effort-is", "--drive-gains", *TABLE, "--cutoff", "--from", "--to")
FILTER = ("--accelerations", "--clock", "--without-rule")


class Options:
    """Declares the arguments of a verb: in its parser, or in a group of options."""

    def __init__(self, place: argparse._ActionsContainer) -> None:
        self._place = place

    def add(self, usage: str, help: str, type: Any = None, **more: Any) -> argparse.Action:
        """An option. usage: its names and, unless it is a switch, its value: `--urdf|--dh FILE`."""
        names, _, metavar = usage.partition(" ")
        more |= {"metavar": metavar} if metavar else {}
        more |= {"type": type} if type else {}
        if not more.keys() & {"metavar", "type", "choices", "action"}:
            more["action"] = "store_true"
        return self._place.add_argument(*names.split("|"), help=help, **more)

    def argument(self, name: str, **more: Any) -> None:
        """An argument without a name on the command line."""
        self._place.add_argument(name, **more)

    def group(self, title: str) -> Options:
        """Options under a title."""
        return Options(self._place.add_argument_group(title))

    def one_of(self, *, required: bool = False) -> Options:
        """Options of which one may be given, or must be."""
        return Options(self._place.add_mutually_exclusive_group(required=required))

    def shared(self, *wanted: str) -> list[str]:
        """Options of the table below; gives the names of their values."""
        options = map(_SHARED.__getitem__, wanted)
        return [self.add(usage, help, type, **more).dest for usage, help, type, more in options]

    def overrides(self, *wanted: str) -> None:
        """Overrides of the run configuration; given_overrides() reads them."""
        group = self.group("overrides of the run configuration")
        self._place.set_defaults(overrides=group.shared(*wanted))

    def figures(self) -> None:
        """--figures and --no-figures."""
        figures = self.one_of()
        figures.add(
            "--figures FORMATS",
            "formats of the figure: some of png,svg,pdf, or none, which is faster (default: png; "
            "without matplotlib: none)",
            figure_formats,
            default=("png",) if is_installed("matplotlib") else (),
        )
        figures.add(
            "--no-figures",
            "short for --figures none",
            dest="figures",
            action="store_const",
            const=(),
        )

    def output(self, usage: str, help: str, *, replaces: bool = False, **more: Any) -> None:
        """--out and --overwrite. replaces: an older result of the verb is replaced without it."""
        self.add(f"--out {usage}", help, Path, **more)
        text = "replace an older result, unless it holds other files too"
        self.add("--overwrite", argparse.SUPPRESS if replaces else text, default=replaces)

    def recording(
        self, name: str = "bag", help: str = "recording, as for `ids evaluate`", **more: Any
    ) -> None:
        """RECORDING; by default one, of which all files may be given."""
        more = more or {"nargs": "+", "action": _OneRecording}
        self.argument(name, metavar="RECORDING", type=file_name, help=help, **more)

    def runs(self, help: str = "results of `ids evaluate`") -> None:
        """RUN..., read by read_evaluation()."""
        self.argument("runs", metavar="RUN", type=Path, nargs="+", help=help)

    def robot(self, **more: Any) -> None:
        """--robot, read by chosen_robot()."""
        help = "run configuration: a name that `ids robots` lists, or a YAML file; or a URDF"
        if not more.get("required"):
            help += "; may be left out where --urdf is given"
        self.add("--robot NAME|FILE", help, **more).completer = _robots  # type: ignore[attr-defined]


class _OneRecording(argparse.Action):
    """The files of one recording, joined. Raises UserError."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, given: Any, *_: Any
    ) -> None:
        if len(given) > 1:
            from inverse_dynamics.recordings.tables import parts_joined

            given = parts_joined(given)
        if len(given) > 1:
            parser.error(
                f"expected one recording, got {given[0]} and {given[1]}; several files may be given only of one "
                "recording: of tables that together have positions and efforts"
            )
        setattr(namespace, self.dest, given[0])


def _robots(prefix: str, **_: object) -> list[str]:
    """Completions of NAME|FILE, for argcomplete."""
    from argcomplete.completers import FilesCompleter

    from inverse_dynamics.robots.robots import robot_names

    return [*robot_names(), *FilesCompleter()(prefix)]


def chosen_robot(arguments: argparse.Namespace) -> Robot:
    """The run configuration of --robot; without one, the robot that --urdf describes."""
    from inverse_dynamics.robots.robots import load_robot, robot_of_description

    if arguments.robot is not None:
        if arguments.robot.endswith(".xacro"):
            raise UserError(
                f"--robot {arguments.robot}: expected a run configuration or a URDF, got a .xacro file; "
                "give it as --urdf"
            )
        return load_robot(arguments.robot)
    described = _described(arguments)
    if described is None:
        raise UserError(
            "expected --robot NAME or --urdf FILE, got neither; `ids robots` lists the names"
        )
    return robot_of_description(described)


def replaces(arguments: argparse.Namespace, files: Sequence[Path]) -> bool:
    """Whether files are replaced: as asked for, or as all of them are there, so an earlier run wrote them."""
    if arguments.overwrite or not all(file.exists() for file in files):
        return bool(arguments.overwrite)
    from inverse_dynamics.terminal.screen import announce

    announce(f"replacing the earlier result in {files[0]}")
    return True


def _described(arguments: argparse.Namespace) -> Path | None:
    """The description, with the arguments of --xacro behind its name, as read_description() takes them."""
    urdf: Path | None = getattr(arguments, "urdf", None)
    xacro = getattr(arguments, "xacro", None)
    if not xacro:
        return urdf
    if urdf is None or urdf.suffix != ".xacro":
        raise UserError(
            f"--xacro {xacro[0]}: expected a .xacro file with it, got {urdf or 'none'}; give it as --urdf"
        )
    return Path(" ".join((f"{urdf}", *xacro)))


def given_overrides(arguments: argparse.Namespace) -> dict[str, Any]:
    """Arguments of evaluate(), or of with_changes(), that overrides() declared."""
    given = {name: getattr(arguments, name) for name in arguments.overrides}
    if given.pop("xacro", None):
        given["urdf"] = _described(arguments)
    parameters = dict(given.pop("parameters", None) or {})
    body = given.pop("payload", None) or {}
    if twice := parameters.keys() & body.keys():
        raise UserError(
            f"--payload and --parameter {min(twice)}: expected one of them; leave out one"
        )
    return {**given, "parameters": {**parameters, **body} or None}


def changed_robot(arguments: argparse.Namespace) -> Robot:
    """The run configuration of --robot with the overrides that were given."""
    from inverse_dynamics.robots.robots import with_changes

    return with_changes(chosen_robot(arguments), **given_overrides(arguments))


def stated(arguments: argparse.Namespace, *names: str) -> dict[str, Any]:
    """Options that were given, by name; the others have the defaults of what takes them."""
    values = {name: getattr(arguments, name) for name in names}
    return {name: value for name, value in values.items() if value is not None}


def _meanings(choices: dict[str, str]) -> str:
    return "; ".join(f"{name}: {text}" for name, text in choices.items())


def _entry(usage: str, help: str, type: Any = None, **more: Any) -> tuple[str, tuple[Any, ...]]:
    return re.split(r"[ |]", usage)[0], (usage, help, type, more)


# What Options.add() takes, by name; the name of the value is evaluate()'s argument.
_SHARED = dict(
    [
        _entry("--json", "print one JSON object instead of tables (docs/command_line.md)"),
        _entry(
            "--urdf|--dh FILE",
            "robot description, with or without --robot: .urdf; .xacro, which needs xacro; or .yaml, "
            "Denavit-Hartenberg parameters for `ids identify` (docs/identification.md#without-a-urdf)",
            Path,
        ),
        _entry(
            "--xacro NAME:=VALUE",
            "an argument of the .xacro file, prefix:=left_; may be given several times",
            xacro_argument,
            action="append",
        ),
        _entry("--root LINK", "first link of the chain"),
        _entry("--tip LINK[,LINK...]", "last link of the chain; several, or '*': those of a tree"),
        _entry(
            "--gravity X,Y,Z",
            "gravitational acceleration [m/s^2] in the frame of the root link (usually 0,0,-9.81)",
            three_numbers,
        ),
        _entry(
            "--joints A,B,...",
            "names of the joints in the recording, in the order of the chain",
            names,
        ),
        _entry(
            "--parameter NAME=VALUE",
            "a parameter of the solver, as under `parameters:` (docs/add_a_robot.md): "
            "locked_joints.finger=0.02; may be given several times",
            parameter,
            dest="parameters",
            action="append",
        ),
        _entry("--plugin PACKAGE/CLASS", "solver (`ids robots --plugins`)"),
        _entry(
            "--no-friction",
            "leave out the solver's friction: for a robot whose controller compensates it",
            dest="friction",
            action="store_false",
            default=None,
        ),
        _entry(
            "--payload BODY",
            "a rigid body at the tip: MASS[,x,y,z[,Ixx,Ixy,Ixz,Iyy,Iyz,Izz]]: mass [kg], center of "
            "mass in the tip frame [m], moments of inertia about it [kg m^2]; or a YAML file with "
            "mass, center_of_mass, inertia and frame (docs/add_a_robot.md)",
            payload,
        ),
        _entry(
            "--topic NAME",
            "topic of the joint states, or of the trajectory; several of joint states, joined by +, "
            "are merged by time",
        ),
        _entry(
            "--effort-is MEANING",
            f"meaning of the recorded efforts. {_meanings(EFFORT_CHOICES)}",
            choices=tuple(EFFORT_CHOICES),
        ),
        _entry(
            "--drive-gains A,B,...",
            "torque per motor current of each joint [N m/A], for efforts that are currents",
            numbers,
        ),
        _entry(
            "--columns KEY=PATTERN,...",
            "of a table: which column is what: time=t, q=q*, qd=dq*, effort=tau* (or current=i*); * is "
            "the joint's name or number; or numbers of columns: time=1, q=2-7 (docs/tables.md)",
        ),
        _entry(
            "--scale KEY=FACTOR",
            "of a table: what a quantity's numbers are multiplied by, a number or a unit, or one for "
            "each joint: effort=1e-3, q=deg, time=ms; may be given several times",
            action="append",
        ),
        _entry(
            "--sign S,S,...",
            "of a table: 1 or -1 for each joint; -1 turns its positions, velocities and efforts around",
            numbers,
        ),
        _entry(
            "--gears G,G,...",
            "positions, velocities and efforts are those of motors: a gear ratio of each joint, or the rows of the "
            "matrix G of q_motor = G q, one after the other",
            numbers,
        ),
        _entry("--rate HZ", "of a table without time: samples per second", positive_number),
        _entry("--accelerations METHOD", _meanings(METHODS), choices=tuple(METHODS)),
        _entry("--cutoff HZ", "cut-off frequency of the low-pass filter", positive_number),
        _entry(
            "--from SECONDS",
            "leave out samples before this time, counted from the first sample of each recording",
            number,
            dest="start",
        ),
        _entry("--to SECONDS", "leave out samples after this time", number, dest="end"),
        _entry(
            "--clock",
            "time stamps that are used: the header's, those of reception, or the header's if there "
            "are any (auto)",
            choices=CLOCKS,
            default="auto",
        ),
        _entry(
            "--without-rule RULE",
            "report what this rule finds, but do not act on it; may be given several times. "
            + _meanings(RULES),
            dest="without_rules",
            choices=tuple(RULES),
            action="append",
            default=[],
        ),
    ]
)

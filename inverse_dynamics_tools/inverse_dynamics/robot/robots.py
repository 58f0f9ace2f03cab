# SPDX-License-Identifier: Apache-2.0
"""Run configurations: what a robot is, in one YAML file.

    robot = load_robot("ur10_real")        # one of the project's
    robot = load_robot("my_robot.yaml")    # one's own

Which solver, from which description or model, between which links, and what its recordings look
like. Strict: unknown or missing keys and wrong types are errors with file, line and key.
"""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.base.ament import DATA_PACKAGE, PackageNotFoundError, package_share, resolve
from inverse_dynamics.base.files import is_plain_name
from inverse_dynamics.base.located_yaml import read_mapping
from inverse_dynamics.base.wording import did_you_mean, shown
from inverse_dynamics.errors import RobotError
from inverse_dynamics.robot.choices import EFFORT_CHOICES, METHODS
from inverse_dynamics.robot.solver_parameters import solver_parameters

if TYPE_CHECKING:
    from collections.abc import Collection

    from inverse_dynamics._core import Parameter
    from inverse_dynamics.base.located_yaml import Mapping, Value

SCHEMA = 1
DEFAULT_TOPIC = "/joint_states"


@dataclass(frozen=True)
class Robot:
    """One run configuration. Empty text or None: not stated, so the solver's own default."""

    name: str
    description: str
    file: Path
    plugin: str  # package/Class
    urdf: Path | None = None
    model: Path | None = None
    root: str = ""
    tip: str = ""
    gravity: tuple[float, float, float] | None = None  # m/s^2, in the frame of the root link
    friction: bool = True
    topic: str = DEFAULT_TOPIC
    joints: tuple[str, ...] = ()  # names in recordings, in the order of the chain
    effort: str = "torque"  # what the field `effort` of a joint state means, of EFFORT_CHOICES
    drive_gains: tuple[float, ...] = ()  # N m/A (prismatic N/A); empty: the solver's, if it has any
    accelerations: str = "auto"
    cutoff: float | None = None  # Hz
    # Of the solver, beyond the fields above: dotted name to value.
    parameters: dict[str, Parameter] = field(default_factory=dict)
    source: str = ""  # where description and figures come from
    # What only the simulator reads: not looked into here.
    simulation: Mapping | None = field(default=None, repr=False, compare=False)

    @property
    def files(self) -> tuple[Path | None, ...]:
        """What is read for this robot."""
        return (self.file, self.urdf, self.model)


def robot_names() -> list[str]:
    """Names of the robots that the sourced workspaces bring."""
    return sorted(file.stem for file in _directory().glob("*.yaml"))


def load_robot(name_or_file: str | Path) -> Robot:
    """Run configuration by the name of one of robot_names(), or from a file.

    What ends in .yaml or .yml, or has a directory, is a file. Raises RobotError.
    """
    text = str(name_or_file)
    file = Path(text)
    with suppress(ValueError):  # of a NUL, or half of a surrogate pair: no file has such a name
        file = Path(os.path.expanduser(text))  # Path's raises for unknown users
    if file.suffix in {".yaml", ".yml"} or file.name != text:
        if not os.path.isfile(file):  # Path.is_file() raises where the path is too long
            raise RobotError(
                f"{text}: no such file; expected a run configuration, or one of the names "
                f"{', '.join(_names_if_any())}"
            )
        return _read(file)
    file = _directory() / f"{text}.yaml"
    if not os.path.isfile(file):
        names = robot_names()
        hint = did_you_mean(text, names)
        raise RobotError(
            f"robot {shown(text)}: expected one of {', '.join(names)}, or a file ending in .yaml"
            + (hint and f"; {hint}")
        )
    return _read(file)


def with_changes(robot: Robot, **changes: Any) -> Robot:
    """The run configuration with all fields replaced for which something is given, not None.

    A description that is given stands instead of a model file too; parameters are given one by one.
    """
    given = {name: value for name, value in changes.items() if value is not None}
    if "urdf" in given:
        given["model"] = None
    if "parameters" in given:
        given["parameters"] = {**robot.parameters, **given["parameters"]}
    return replace(robot, **given)


def _directory() -> Path:
    return package_share(DATA_PACKAGE) / "robots"


def _names_if_any() -> list[str]:
    try:
        return robot_names()
    except PackageNotFoundError:
        return ["(no workspace is sourced)"]


def _read(file: Path) -> Robot:
    top = read_mapping(file, RobotError)
    schema = top.required("schema")
    if schema.integer() != SCHEMA:
        schema.fail(f"{SCHEMA}", "it was written for another version of this command")
    name = top.required("name")
    if not is_plain_name(name.text()):
        name.fail("a plain name: results are called after it", "leave out / and control characters")
    description = top.required("description").text()
    plugin = top.required("plugin")
    if plugin.text().count("/") != 1:
        plugin.fail("package/Class", "`ids robots --plugins` lists what is installed")
    method, cutoff = _accelerations(top.optional("accelerations"))
    simulation, parameters = top.optional("simulation"), top.optional("parameters")
    robot = Robot(
        name=name.text(),
        description=description.strip(),
        file=file,
        plugin=plugin.text(),
        urdf=_existing_file(top.optional("urdf")),
        model=_existing_file(top.optional("model")),
        root=_text(top.optional("root")),
        tip=_text(top.optional("tip")),
        gravity=_gravity(top.optional("gravity")),
        friction=_truth(top.optional("friction"), default=True),
        topic=_text(top.optional("topic"), DEFAULT_TOPIC),
        joints=_names(top.optional("joints")),
        effort=_text(top.optional("effort"), "torque", EFFORT_CHOICES),
        drive_gains=_drive_gains(top.optional("drive_gains")),
        accelerations=method,
        cutoff=cutoff,
        parameters=solver_parameters(parameters.mapping()) if parameters else {},
        source=_text(top.optional("source")).strip(),
        simulation=simulation.mapping() if simulation else None,
    )
    top.reject_others()
    return robot


def _text(value: Value | None, default: str = "", one_of: Collection[str] = ()) -> str:
    return default if value is None else value.text(one_of)


def _truth(value: Value | None, *, default: bool) -> bool:
    return default if value is None else value.truth()


def _existing_file(value: Value | None) -> Path | None:
    if value is None:
        return None
    try:
        path = resolve(value.text(), value.file.parent)
        there = path.is_file()
    except (PackageNotFoundError, OSError, RuntimeError) as error:  # no home, or a name too long
        value.fail("a file", str(error))
    if not there:
        value.fail("a file", f"{path} isn't there")
    return path


def _gravity(value: Value | None) -> tuple[float, float, float] | None:
    if value is None:
        return None
    x, y, z = (entry.number() for entry in value.entries(3))
    return (x, y, z)


def _drive_gains(value: Value | None) -> tuple[float, ...]:
    if value is None:
        return ()
    entries = value.entries()
    if not entries:
        value.fail("a figure per joint")
    for entry in entries:
        if entry.number() <= 0:
            entry.fail("a drive gain above zero, in N m/A", "turn the sign of the efforts instead")
    return tuple(entry.number() for entry in entries)


def _names(value: Value | None) -> tuple[str, ...]:
    if value is None:
        return ()
    names = tuple(entry.text() for entry in value.entries())
    if len(set(names)) != len(names):
        raise RobotError(f"{value.where}: expected each name once, got {', '.join(names)}")
    return names


def _accelerations(value: Value | None) -> tuple[str, float | None]:
    if value is None:
        return "auto", None
    mapping = value.mapping()
    method = _text(mapping.optional("method"), "auto", METHODS)
    cutoff_value = mapping.optional("cutoff")
    cutoff = None if cutoff_value is None else cutoff_value.number()
    if cutoff_value is not None and cutoff is not None and cutoff <= 0:
        cutoff_value.fail("a frequency in Hz above zero")
    mapping.reject_others()
    return method, cutoff

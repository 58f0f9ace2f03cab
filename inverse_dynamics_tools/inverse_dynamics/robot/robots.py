# SPDX-License-Identifier: Apache-2.0
"""Run configurations: what a robot is, in one YAML file.

    robot = load_robot("ur10_real")        # one of the project's
    robot = load_robot("my_robot.yaml")    # one's own

Which solver, from which description or model, between which links, and what its recordings look
like. Read in C++ (inverse_dynamics_evaluation/run_configuration.hpp), strictly: unknown or missing
keys and wrong types are errors with file, line and key.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics import _core

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Parameter

DEFAULT_TOPIC = "/joint_states"
RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"


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

    @property
    def files(self) -> tuple[Path | None, ...]:
        """What is read for this robot."""
        return (self.file, self.urdf, self.model)


def robot_names() -> list[str]:
    """Names of the robots that the sourced workspaces bring."""
    return _core.robot_names()


def load_robot(name_or_file: str | Path) -> Robot:
    """Run configuration by the name of one of robot_names(), or from a file.

    What ends in .yaml or .yml, or has a directory, is a file. Raises RobotError.
    """
    return Robot(**_core.read_robot(name_or_file))


def robot_of_description(urdf: Path | str) -> Robot:
    """A robot of which only the description is known: rigid bodies without friction.

    Its name is the file's; what recorded efforts mean is found from the data.
    """
    urdf = Path(urdf)
    name = urdf.name.partition(".")[0]
    return Robot(name, "", urdf, RIGID_BODY, urdf=urdf, effort="auto")


def with_changes(robot: Robot, **changes: Any) -> Robot:
    """The run configuration with all fields replaced for which something is given, not None.

    A description that is given stands instead of a model file too, a method of accelerations
    without the cut-off of the configuration's own; parameters are given one by one.
    """
    given = {name: value for name, value in changes.items() if value is not None}
    return Robot(**_core.change_robot(robot, given))

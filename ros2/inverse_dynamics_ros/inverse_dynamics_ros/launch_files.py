# SPDX-License-Identifier: Apache-2.0
"""Arguments and nodes of the launch files.

Names of arguments that the reference implementation has are kept: input_bag, output_bag, topic,
plugin_name, robot_description, root, tip, gravity.
"""

from __future__ import annotations

import sys
from ast import literal_eval
from difflib import get_close_matches
from pathlib import Path
from signal import SIGINT, SIGKILL, SIGTERM
from typing import TYPE_CHECKING, Any

import yaml
from launch import LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    IncludeLaunchDescription,
    OpaqueFunction,
    RegisterEventHandler,
)
from launch.event_handlers import OnProcessExit
from launch.launch_description_sources import (
    PythonLaunchDescriptionSource,
    get_launch_description_from_python_launch_file,
)
from launch.substitutions import LaunchConfiguration
from launch_ros.parameter_descriptions import ParameterValue

if TYPE_CHECKING:
    from launch import LaunchContext
    from launch.event_handlers import ProcessExited

_ACCELERATIONS = {
    "auto": "those of the recording if it has any, else low-pass",
    "low-pass": "zero-phase, of the velocities, then their derivative",
    "given": "those of the recording",
    "backward-difference": "no filter: the method of the reference implementation",
}
_EFFORTS = {
    "torque": "N m",
    "current": "A, times the drive gains of the solver",
    "torque_without_gravity": "N m, as newer UR drivers send",
}
_EFFORTS_OF_RECORDINGS = {**_EFFORTS, "auto": "what clearly fits the data"}


def argument(name: str, description: str, default: str = "", **more: Any) -> DeclareLaunchArgument:
    """An argument with a default."""
    return DeclareLaunchArgument(name, default_value=default, description=description, **more)


def choice(name: str, what: str, choices: dict[str, str], default: str) -> DeclareLaunchArgument:
    """An argument with a few values, each explained."""
    lines = [f"{what}:", *(f"  {value}: {text}" for value, text in choices.items())]
    return argument(name, "\n        ".join(lines), default, choices=list(choices))


def bag_arguments() -> list[DeclareLaunchArgument]:
    """Arguments of every launch file that evaluates a recording."""
    return [
        DeclareLaunchArgument(
            "input_bag",
            description="Recording to evaluate: a directory with metadata.yaml, or a .db3 or .mcap "
            "file, with sensor_msgs/JointState or trajectory_msgs/JointTrajectory",
        ),
        DeclareLaunchArgument(
            "output_bag", description="Recording to write; it must not exist yet"
        ),
        argument(
            "topic",
            "Topic of the computed torques in output_bag; the measured ones are on this name with "
            "_gt behind it",
            "/torques",
        ),
        argument(
            "storage",
            "Storage of output_bag; empty: that of input_bag",
            choices=["", "sqlite3", "mcap"],
        ),
    ]


def sample_arguments() -> list[DeclareLaunchArgument]:
    """Arguments about what the samples mean."""
    return [
        argument(
            "input_topic",
            "Topic of the motion in input_bag; empty: the run configuration's, else the only one of "
            "joint states, else that of trajectories",
        ),
        choice(
            "accelerations",
            "How they come from the velocities",
            {"": "what the run configuration says, else auto", **_ACCELERATIONS},
            "",
        ),
        argument(
            "cutoff",
            "Cut-off of the low-pass [Hz]; 0.0: chosen from the data; empty: what the run "
            "configuration says, else chosen",
        ),
        *effort_arguments(_EFFORTS_OF_RECORDINGS),
    ]


def effort_arguments(efforts: dict[str, str] = _EFFORTS) -> list[DeclareLaunchArgument]:
    """Arguments about what measured efforts mean; `auto` is for recordings alone."""
    return [
        choice(
            "effort",
            "What measured efforts mean",
            {"": "what the run configuration says, else torque", **efforts},
            "",
        ),
        argument(
            "drive_gains",
            "Torque per current of each joint [N m/A], comma-separated, for currents; empty: the "
            "run configuration's, else the solver's, if it has any",
        ),
    ]


def effort_parameters(context: LaunchContext) -> dict[str, Any]:
    """Node parameters of the arguments of effort_arguments(). Raises ValueError."""
    parameters = given_strings(context, "effort")
    if gains := numbers(context, "drive_gains"):
        parameters["drive_gains"] = gains
    return parameters


def solver_arguments() -> list[DeclareLaunchArgument]:
    """Arguments of a robot and its solver: a run configuration, and what replaces parts of it."""
    return [
        argument(
            "robot",
            "Run configuration: ur10_real, or a YAML file; empty: the other arguments say all",
        ),
        argument(
            "plugin_name",
            "Solver, package/Class of a plugin: "
            "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL; needed without robot",
        ),
        argument(
            "robot_description",
            "Text of a URDF, for a solver that doesn't bring its own model: "
            'robot_description:="$(xacro robot.urdf.xacro)"; empty: that of robot, if it has one',
        ),
        argument("root", "First link of the chain; empty: that of robot, else the URDF's root"),
        argument("tip", "Last link of the chain; empty: that of robot, else the URDF's leaf"),
        argument(
            "gravity",
            "Where things fall, in the frame of the root link [m/s^2]: [0, 0, -9.81]; empty: "
            "what robot says, else that",
        ),
        argument(
            "friction",
            "Whether the solver's friction model counts; false where the robot's controller "
            "compensates friction; empty: what robot says, else true",
            choices=["", "true", "false"],
        ),
        argument(
            "joints",
            "Names of the joints in the messages, comma-separated, in the order of the chain; "
            "empty: those of robot, else the solver's names",
        ),
    ]


def solver_parameters(context: LaunchContext) -> dict[str, Any]:
    """Node parameters of the arguments of solver_arguments(). Raises ValueError."""
    parameters = given_strings(context, "robot", "plugin_name")
    if description := _plain(text(context, "robot_description")):
        parameters["robot_description"] = string(description)
    for name in ("root", "tip"):
        if value := text(context, name):
            parameters[f"ids.{name}"] = string(value)
    if gravity := text(context, "gravity"):
        parameters["ids.gravity"] = _three_numbers(gravity)
    if friction := text(context, "friction"):
        parameters["ids.friction"] = friction == "true"
    if joints := text(context, "joints"):
        parameters["joints"] = [name.strip() for name in joints.split(",")]
    return parameters


def given_strings(context: LaunchContext, *names: str) -> dict[str, Any]:
    """Node parameters of those arguments that aren't empty: others would replace what `robot` says."""
    return {name: string(value) for name in names if (value := text(context, name))}


def string(value: str) -> ParameterValue:
    """A parameter that stays a string, whatever it looks like."""
    return ParameterValue(value, value_type=str)


def text(context: LaunchContext, argument: str) -> str:
    """The value of a launch argument."""
    return str(LaunchConfiguration(argument).perform(context))


def number(context: LaunchContext, argument: str) -> float:
    """The value of a launch argument as a number. Raises ValueError."""
    value = text(context, argument)
    try:
        return float(value)
    except ValueError:
        raise ValueError(f"argument {argument}: expected a number, got '{value}'") from None


def numbers(context: LaunchContext, argument: str) -> list[float]:
    """The value of a launch argument as comma-separated numbers; none if empty. Raises ValueError."""
    value = text(context, argument)
    try:
        return [float(part) for part in value.split(",")] if value else []
    except ValueError:
        raise ValueError(
            f"argument {argument}: expected numbers (12.5,12.5), got '{value}'"
        ) from None


def refusing_others(*actions: Any) -> LaunchDescription:
    """Launch description that refuses arguments it doesn't declare; `ros2 launch` ignores them."""
    declared = [action.name for action in actions if isinstance(action, DeclareLaunchArgument)]
    return LaunchDescription([OpaqueFunction(function=_refuse_others, args=[declared]), *actions])


def _refuse_others(context: LaunchContext, declared: list[str]) -> None:
    here = Path(context.locals.current_launch_file_path).name
    if here not in [Path(word).name for word in sys.argv]:
        return  # arguments are those of the file that includes this one
    for word in context.argv:
        name = word.partition(":=")[0]
        if name in declared or name.startswith("launch-prefix"):
            continue
        near = get_close_matches(name, declared, n=1)
        remedy = f"did you mean {near[0]}?" if near else f"expected one of {', '.join(declared)}"
        raise ValueError(f"argument {name}: {here} doesn't have it; {remedy}")


def failing_with_its_node() -> RegisterEventHandler:
    """Have `ros2 launch` end with an error where a process of it did."""

    def check(event: ProcessExited, _context: LaunchContext) -> None:
        if event.returncode not in (0, *(-end for end in (SIGINT, SIGTERM, SIGKILL))):
            raise RuntimeError(f"{event.process_name} ended with exit code {event.returncode}")

    return RegisterEventHandler(OnProcessExit(on_exit=check))


def evaluate_robot(name: str) -> LaunchDescription:
    """Launch description that evaluates a recording of a robot with a run configuration."""
    own = [*bag_arguments(), *sample_arguments()]
    given = {argument.name: LaunchConfiguration(argument.name) for argument in own}
    evaluation = PythonLaunchDescriptionSource(launch_file("evaluate_solver.launch.py"))
    arguments = {**given, "robot": name}.items()
    return refusing_others(*own, IncludeLaunchDescription(evaluation, launch_arguments=arguments))


def forward(name: str) -> LaunchDescription:
    """Launch description of a launch file of this package, with its arguments, under another name.

    Not included: that asks for required arguments even where the command line gives them.
    """
    return get_launch_description_from_python_launch_file(launch_file(name))


def launch_file(name: str) -> str:
    """Path of a launch file of this package."""
    from ament_index_python.packages import get_package_share_directory

    return str(Path(get_package_share_directory("inverse_dynamics_ros")) / "launch" / name)


def _plain(description: str) -> str:
    """A robot description that may have been quoted as YAML, as the reference implementation does."""
    if description.lstrip().startswith("<") or not description:
        return description
    plain = yaml.safe_load(description)
    return plain if isinstance(plain, str) else description


def _three_numbers(value: str) -> list[float]:
    try:
        x, y, z = (float(part) for part in literal_eval(value))
    except (ValueError, TypeError, SyntaxError):
        raise ValueError(
            f"argument gravity: expected three numbers, [0, 0, -9.81] for one, got '{value}'"
        ) from None
    return [x, y, z]

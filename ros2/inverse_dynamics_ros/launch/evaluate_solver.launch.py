# SPDX-License-Identifier: Apache-2.0
"""Torques of a recorded motion by any solver, as a recording and as a table of errors.

ros2 launch inverse_dynamics_ros evaluate_solver.launch.py robot:=ur10_real input_bag:=recording output_bag:=result
ros2 launch inverse_dynamics_ros evaluate_solver.launch.py --show-args
"""

from inverse_dynamics_ros.launch_files import (
    argument,
    bag_arguments,
    choice,
    effort_parameters,
    failing_with_its_node,
    given_strings,
    number,
    refusing_others,
    sample_arguments,
    solver_arguments,
    solver_parameters,
    string,
    text,
)
from launch.actions import OpaqueFunction
from launch_ros.actions import Node

CLOCKS = {
    "auto": "the header's, if there are any",
    "header": "as the publisher wrote them",
    "receive": "as the recorder wrote them",
}


def nodes(context):
    """The program, with the parameters of the arguments."""
    parameters = solver_parameters(context) | {
        name: string(text(context, name))
        for name in ("input_bag", "output_bag", "topic", "storage", "input_topic", "clock")
    }
    parameters |= given_strings(context, "accelerations") | effort_parameters(context)
    if text(context, "cutoff"):
        parameters["cutoff"] = number(context, "cutoff")
    if rules := text(context, "without_rules"):
        parameters["without_rules"] = [rule.strip() for rule in rules.split(",")]
    return [
        Node(
            package="inverse_dynamics_ros",
            executable="evaluate_solver",
            output="screen",
            parameters=[parameters],
        )
    ]


def generate_launch_description():
    """What `ros2 launch` asks for."""
    return refusing_others(
        *bag_arguments(),
        *solver_arguments(),
        *sample_arguments(),
        choice("clock", "Stamps that are the time", CLOCKS, "auto"),
        argument(
            "without_rules",
            "What is found in the samples but not acted upon, comma-separated: repeated, "
            "non-increasing, time-base, start-transient",
        ),
        OpaqueFunction(function=nodes),
        failing_with_its_node(),
    )

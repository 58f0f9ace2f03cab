# SPDX-License-Identifier: Apache-2.0
"""Computed torques of a robot that is running, and how far the measured ones are from them.

ros2 launch inverse_dynamics_ros live.launch.py robot:=ur10_real
ros2 launch inverse_dynamics_ros live.launch.py plugin_name:=package/Class tip:=tool0
ros2 launch inverse_dynamics_ros live.launch.py --show-args
"""

from inverse_dynamics_ros.launch_files import (
    choice,
    effort_arguments,
    effort_parameters,
    failing_with_its_node,
    number,
    numbers,
    solver_arguments,
    solver_parameters,
    string,
    text,
)
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch_ros.actions import LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode

RELIABILITIES = {
    "best_effort": "takes from every publisher; what is lost is lost",
    "reliable": "nothing is lost; only from publishers that are reliable, too",
}


def nodes(context):
    """The node by itself, or as a component of a container."""
    topic = text(context, "joint_states")
    parameters = solver_parameters(context) | effort_parameters(context)
    parameters |= {
        "cutoff": number(context, "cutoff"),
        "external_torques.enabled": text(context, "external_torques") == "true",
        "use_sim_time": text(context, "use_sim_time") == "true",
        f"qos_overrides.{topic}.subscription.reliability": string(text(context, "reliability")),
    }
    if contacts_file := text(context, "contacts_file"):
        parameters["external_torques.contacts_file"] = string(contacts_file)
    if noise := numbers(context, "payload_noise"):
        parameters["estimate_payload.noise"] = noise
    common = {
        "package": "inverse_dynamics_ros",
        "name": "live",
        "parameters": [parameters],
        "remappings": [("joint_states", topic)],
    }
    container = text(context, "container")
    if not container:
        return [Node(executable="live", output="screen", **common)]
    component = ComposableNode(plugin="inverse_dynamics_ros::LiveNode", **common)
    return [
        LoadComposableNodes(target_container=container, composable_node_descriptions=[component])
    ]


def generate_launch_description():
    """What `ros2 launch` asks for."""
    return LaunchDescription(
        [
            *solver_arguments(),
            *effort_arguments(),
            DeclareLaunchArgument(
                "cutoff",
                default_value="5.0",
                description="Cut-off of the causal filter that accelerations come from [Hz]; they "
                "come late by 1 / (pi cutoff) s",
            ),
            DeclareLaunchArgument(
                "external_torques",
                default_value="false",
                choices=["true", "false"],
                description="Whether external torques are estimated and published",
            ),
            DeclareLaunchArgument(
                "contacts_file",
                default_value="",
                description="contacts.json of `ids contact`: with it, contacts and the wrench at the "
                "tip are published, too",
            ),
            DeclareLaunchArgument(
                "payload_noise",
                default_value="",
                description="Standard deviation of measured - computed torques without a load [N m], "
                "comma-separated, of each joint or one for all; needed to estimate what the tip carries",
            ),
            DeclareLaunchArgument(
                "joint_states",
                default_value="/joint_states",
                description="Topic of the joint states, in full",
            ),
            choice(
                "reliability", "Quality of service of joint_states", RELIABILITIES, "best_effort"
            ),
            DeclareLaunchArgument(
                "use_sim_time",
                default_value="false",
                choices=["true", "false"],
                description="Whether time is that of the topic /clock",
            ),
            DeclareLaunchArgument(
                "container",
                default_value="",
                description="Name of a running component container to load the node into; empty: a "
                "process of its own",
            ),
            OpaqueFunction(function=nodes),
            failing_with_its_node(),
        ]
    )

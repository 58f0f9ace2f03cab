# SPDX-License-Identifier: Apache-2.0
"""Computed torques of a robot that is running, and how far the measured ones are from them.

ros2 launch inverse_dynamics_ros live.launch.py robot:=ur10_real
ros2 launch inverse_dynamics_ros live.launch.py plugin_name:=package/Class tip:=tool0
ros2 launch inverse_dynamics_ros live.launch.py robot:=ur10_real namespace:=left
ros2 launch inverse_dynamics_ros live.launch.py --show-args
"""

from inverse_dynamics_ros.launch_files import (
    argument,
    choice,
    effort_arguments,
    effort_parameters,
    failing_with_its_node,
    number,
    numbers,
    refusing_others,
    solver_arguments,
    solver_parameters,
    string,
    text,
)
from launch.actions import OpaqueFunction
from launch_ros.actions import LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode

RELIABILITIES = {
    "best_effort": "takes from every publisher; what is lost is lost",
    "reliable": "nothing is lost; only from publishers that are reliable, too",
}


def nodes(context):
    """The node by itself, or as a component of a container."""
    namespace, topic = text(context, "namespace").strip("/"), text(context, "joint_states")
    if not topic.startswith("/"):
        topic = "/".join(["", *filter(None, [namespace]), topic])
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
        "name": text(context, "name"),
        "namespace": namespace,
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
    return refusing_others(
        *solver_arguments(),
        *effort_arguments(),
        argument(
            "cutoff",
            "Cut-off of the causal filter that accelerations come from [Hz]; they come late by "
            "1 / (pi cutoff) s",
            "5.0",
        ),
        argument(
            "external_torques",
            "Whether external torques are estimated and published",
            "false",
            choices=["true", "false"],
        ),
        argument(
            "contacts_file",
            "contacts.json of `ids contact`: with it, contacts and the wrench at the tip are "
            "published, too",
        ),
        argument(
            "payload_noise",
            "Standard deviation of measured - computed torques without a load [N m], "
            "comma-separated, of each joint or one for all; needed to estimate what the tip carries",
        ),
        argument("name", "Name of the node", "live"),
        argument("namespace", "Namespace of the node and of its topics, one per robot: left"),
        argument("joint_states", "Topic of the joint states", "joint_states"),
        choice("reliability", "Quality of service of joint_states", RELIABILITIES, "best_effort"),
        argument(
            "use_sim_time",
            "Whether time is that of the topic /clock",
            "false",
            choices=["true", "false"],
        ),
        argument(
            "container",
            "Name of a running component container to load the node into; empty: a process of "
            "its own",
        ),
        OpaqueFunction(function=nodes),
        failing_with_its_node(),
    )

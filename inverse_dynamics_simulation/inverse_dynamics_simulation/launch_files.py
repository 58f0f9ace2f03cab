# SPDX-License-Identifier: Apache-2.0
"""Arguments, robots and descriptions of the launch files that simulate an arm."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from ament_index_python.packages import get_package_share_directory
from inverse_dynamics_ros.launch_files import text
from launch.actions import DeclareLaunchArgument
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

if TYPE_CHECKING:
    from launch import LaunchContext

INITIAL = {
    "ur10": {
        "shoulder_pan_joint": 0.0,
        "shoulder_lift_joint": -1.6,
        "elbow_joint": 1.2,
        "wrist_1_joint": -1.0,
        "wrist_2_joint": -1.5,
        "wrist_3_joint": 0.3,
    },
    "panda": {
        "fer_joint1": 0.0,
        "fer_joint2": -0.5,
        "fer_joint3": 0.0,
        "fer_joint4": -2.0,
        "fer_joint5": 0.0,
        "fer_joint6": 1.6,
        "fer_joint7": 0.8,
    },
}
"""Where the joints of each robot are at first [rad]."""

LINKS = {"ur10": ("base_link", "tool0"), "panda": ("fer_link0", "fer_link8")}
"""What stands on the floor, and what carries a payload."""

CONTROLLERS = {
    "inverse_dynamics": ["inverse_dynamics_controller", "trajectory_to_inverse_dynamics"],
    "feed_forward": ["feed_forward_controller", "trajectory_to_feed_forward"],
    "gravity_compensation": ["gravity_compensation_controller"],
    "pd_gravity_compensation": [
        "pd_gravity_compensation_controller",
        "trajectory_to_pd_gravity_compensation",
    ],
}
"""What is spawned for each choice, in this order."""

BROADCASTERS = ["joint_state_broadcaster", "external_wrench_broadcaster"]
"""What is spawned for all of them."""


def arguments() -> list[DeclareLaunchArgument]:
    """Which robot, which controller, which parameters."""
    return [
        DeclareLaunchArgument(
            "robot", default_value="ur10", choices=list(INITIAL), description="Which arm"
        ),
        DeclareLaunchArgument(
            "controller",
            default_value="inverse_dynamics",
            choices=list(CONTROLLERS),
            description="inverse_dynamics: computed torque after a joint_trajectory_controller; "
            "feed_forward: PD and the model's torque after one; gravity_compensation: hand guiding; "
            "pd_gravity_compensation: PD and gravity after one",
        ),
        DeclareLaunchArgument(
            "config",
            default_value="",
            description="Parameter file; empty: this package's for the robot",
        ),
    ]


def parameter_file(context: LaunchContext) -> str:
    """Path of the argument `config`. Raises ValueError: no such file."""
    given = text(context, "config")
    if given and not Path(given).is_file():
        raise ValueError(f"argument config: expected a parameter file, got '{given}': no such file")
    share = Path(get_package_share_directory("inverse_dynamics_simulation"))
    return given or str(share / "config" / f"{text(context, 'robot')}.yaml")


def spawner(context: LaunchContext) -> Node:
    """Starts the controllers of the argument `controller`."""
    spawned = [*BROADCASTERS, *CONTROLLERS[text(context, "controller")]]
    return Node(
        package="controller_manager",
        executable="spawner",
        arguments=[
            *spawned,
            "--param-file",
            parameter_file(context),
            "--controller-manager-timeout",
            "60",
        ],
    )


def state_publisher(description: str) -> Node:
    """Publishes the robot description, on time of the simulation."""
    value = ParameterValue(description, value_type=str)
    return Node(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        parameters=[{"robot_description": value, "use_sim_time": True}],
    )


def description_of(robot: str) -> ElementTree.Element:
    """The robot's URDF."""
    share = Path(get_package_share_directory("inverse_dynamics_robots"))
    return ElementTree.parse(share / "urdf" / f"{robot}.urdf").getroot()


def add_hardware(
    root: ElementTree.Element, robot: str, plugin: str, parameters: dict[str, str] | None = None
) -> None:
    """Adds a ros2_control component of effort-controlled joints to a URDF."""
    system = ElementTree.SubElement(root, "ros2_control", name=robot, type="system")
    hardware = ElementTree.SubElement(system, "hardware")
    ElementTree.SubElement(hardware, "plugin").text = plugin
    for name, value in (parameters or {}).items():
        ElementTree.SubElement(hardware, "param", name=name).text = value
    for name, position in INITIAL[robot].items():
        joint = ElementTree.SubElement(system, "joint", name=name)
        ElementTree.SubElement(joint, "command_interface", name="effort")
        state = ElementTree.SubElement(joint, "state_interface", name="position")
        ElementTree.SubElement(state, "param", name="initial_value").text = str(position)
        for interface in ("velocity", "effort"):
            ElementTree.SubElement(joint, "state_interface", name=interface)

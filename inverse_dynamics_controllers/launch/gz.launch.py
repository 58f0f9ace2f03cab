# SPDX-License-Identifier: Apache-2.0
"""A UR10 or a Panda in Gazebo under gz_ros2_control, with a controller of this package.

Not run by this project's tests, which have no Gazebo: written after gz_ros2_control's manual. It needs
ros_gz_sim, ros_gz_bridge and gz_ros2_control. Gazebo refuses links whose inertia breaks the triangle
inequality: the Panda's description has one (fer_link4).

ros2 launch inverse_dynamics_controllers gz.launch.py robot:=ur10
"""

from pathlib import Path
from xml.etree import ElementTree

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ROOT_LINKS = {"ur10": "base_link", "panda": "fer_link0"}
"""What stands on the floor."""

CONTROLLERS = {
    "inverse_dynamics": ["inverse_dynamics_controller", "trajectory_to_inverse_dynamics"],
    "feed_forward": ["feed_forward_controller", "trajectory_to_feed_forward"],
    "gravity_compensation": ["gravity_compensation_controller"],
}
"""What is spawned for each choice, in this order."""


def generate_launch_description():
    """What `ros2 launch` asks for."""
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "robot", default_value="ur10", choices=list(ROOT_LINKS), description="Which arm"
            ),
            DeclareLaunchArgument(
                "controller",
                default_value="inverse_dynamics",
                choices=list(CONTROLLERS),
                description="As of simulated.launch.py",
            ),
            OpaqueFunction(function=_processes),
        ]
    )


def _processes(context):
    robot = LaunchConfiguration("robot").perform(context)
    spawned = CONTROLLERS[LaunchConfiguration("controller").perform(context)]
    share = Path(get_package_share_directory("inverse_dynamics_controllers"))
    config = str(share / "config" / f"{robot}.yaml")
    description = {"robot_description": ParameterValue(in_gazebo(robot, config), value_type=str)}
    gazebo = Path(get_package_share_directory("ros_gz_sim")) / "launch" / "gz_sim.launch.py"
    return [
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(str(gazebo)),
            launch_arguments={"gz_args": "-r empty.sdf"}.items(),
        ),
        Node(
            package="robot_state_publisher",
            executable="robot_state_publisher",
            parameters=[description, {"use_sim_time": True}],
        ),
        Node(
            package="ros_gz_sim",
            executable="create",
            arguments=["-topic", "robot_description", "-name", robot],
        ),
        Node(
            package="ros_gz_bridge",
            executable="parameter_bridge",
            arguments=["/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"],
        ),
        Node(
            package="controller_manager",
            executable="spawner",
            arguments=["joint_state_broadcaster", *spawned, "--param-file", config],
        ),
    ]


def in_gazebo(robot, config):
    """The robot's description, standing in the world, with gz_ros2_control's hardware component."""
    robots = Path(get_package_share_directory("inverse_dynamics_robots"))
    root = ElementTree.parse(robots / "urdf" / f"{robot}.urdf").getroot()
    movable = [joint.get("name") for joint in root.iter("joint") if joint.get("type") != "fixed"]

    ElementTree.SubElement(root, "link", name="world")
    floor = ElementTree.SubElement(root, "joint", name="floor", type="fixed")
    ElementTree.SubElement(floor, "parent", link="world")
    ElementTree.SubElement(floor, "child", link=ROOT_LINKS[robot])

    system = ElementTree.SubElement(root, "ros2_control", name=robot, type="system")
    hardware = ElementTree.SubElement(system, "hardware")
    ElementTree.SubElement(hardware, "plugin").text = "gz_ros2_control/GazeboSimSystem"
    for name in movable:
        joint = ElementTree.SubElement(system, "joint", name=name)
        ElementTree.SubElement(joint, "command_interface", name="effort")
        for interface in ("position", "velocity", "effort"):
            ElementTree.SubElement(joint, "state_interface", name=interface)

    gazebo = ElementTree.SubElement(root, "gazebo")
    plugin = ElementTree.SubElement(
        gazebo,
        "plugin",
        filename="gz_ros2_control-system",
        name="gz_ros2_control::GazeboSimROS2ControlPlugin",
    )
    ElementTree.SubElement(plugin, "parameters").text = config
    return ElementTree.tostring(root, encoding="unicode")

# SPDX-License-Identifier: Apache-2.0
"""A UR10 or a Panda in Gazebo under gz_ros2_control, with a controller of this package.

Not run by this project's tests, which have no Gazebo: written after gz_ros2_control's manual. It needs
ros_gz_sim, ros_gz_bridge and gz_ros2_control. Gazebo refuses links whose inertia breaks the triangle
inequality: the Panda's description has one (fer_link4).

ros2 launch inverse_dynamics_simulation gz.launch.py robot:=ur10
"""

from pathlib import Path
from xml.etree import ElementTree

from ament_index_python.packages import get_package_share_directory
from inverse_dynamics_ros.launch_files import failing_with_its_node, text
from inverse_dynamics_simulation.launch_files import (
    LINKS,
    add_hardware,
    arguments,
    description_of,
    parameter_file,
    spawner,
    state_publisher,
)
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description():
    """What `ros2 launch` asks for."""
    return LaunchDescription(
        [*arguments(), OpaqueFunction(function=_processes), failing_with_its_node()]
    )


def _processes(context):
    robot = text(context, "robot")
    gazebo = Path(get_package_share_directory("ros_gz_sim")) / "launch" / "gz_sim.launch.py"
    return [
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(str(gazebo)),
            launch_arguments={"gz_args": "-r empty.sdf"}.items(),
        ),
        state_publisher(in_gazebo(robot, parameter_file(context))),
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
        spawner(context),
    ]


def in_gazebo(robot, config):
    """The robot's description, standing in the world, with gz_ros2_control's hardware component."""
    root = description_of(robot)
    base, _ = LINKS[robot]
    ElementTree.SubElement(root, "link", name="world")
    floor = ElementTree.SubElement(root, "joint", name="floor", type="fixed")
    ElementTree.SubElement(floor, "parent", link="world")
    ElementTree.SubElement(floor, "child", link=base)
    add_hardware(root, robot, "gz_ros2_control/GazeboSimSystem")
    plugin = ElementTree.SubElement(
        ElementTree.SubElement(root, "gazebo"),
        "plugin",
        filename="gz_ros2_control-system",
        name="gz_ros2_control::GazeboSimROS2ControlPlugin",
    )
    ElementTree.SubElement(plugin, "parameters").text = config
    return ElementTree.tostring(root, encoding="unicode")

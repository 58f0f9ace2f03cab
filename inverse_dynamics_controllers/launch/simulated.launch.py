# SPDX-License-Identifier: Apache-2.0
"""A UR10 or a Panda in MuJoCo under ros2_control, with a controller of this package.

ros2 launch inverse_dynamics_controllers simulated.launch.py robot:=ur10
ros2 run inverse_dynamics_controllers send_motion trajectory_to_inverse_dynamics \
    --joints shoulder_pan_joint shoulder_lift_joint elbow_joint \
    wrist_1_joint wrist_2_joint wrist_3_joint --amplitudes 0.5 -0.4 0.6 0.5 -0.5 0.8
"""

from pathlib import Path
from xml.etree import ElementTree

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    ExecuteProcess,
    OpaqueFunction,
    RegisterEventHandler,
)
from launch.event_handlers import OnProcessExit
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

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
                "robot", default_value="ur10", choices=list(INITIAL), description="Which arm"
            ),
            DeclareLaunchArgument(
                "controller",
                default_value="inverse_dynamics",
                choices=list(CONTROLLERS),
                description="inverse_dynamics: computed torque after a joint_trajectory_controller; "
                "feed_forward: PD and the model's torque after one; gravity_compensation",
            ),
            DeclareLaunchArgument(
                "config",
                default_value="",
                description="Parameter file; empty: this package's for the robot",
            ),
            DeclareLaunchArgument(
                "bag",
                default_value="",
                description="Directory to record /joint_states into, once the controllers are active; "
                "it must not exist yet. Empty: no recording",
            ),
            OpaqueFunction(function=_processes),
        ]
    )


def _processes(context):
    def text(argument):
        return LaunchConfiguration(argument).perform(context)

    robot, bag = text("robot"), text("bag")
    share = Path(get_package_share_directory("inverse_dynamics_controllers"))
    config = text("config") or str(share / "config" / f"{robot}.yaml")
    description = {"robot_description": ParameterValue(simulated(robot), value_type=str)}
    sim_time = {"use_sim_time": True}
    spawned = ["joint_state_broadcaster", *CONTROLLERS[text("controller")]]
    spawner = Node(
        package="controller_manager",
        executable="spawner",
        arguments=[*spawned, "--param-file", config, "--controller-manager-timeout", "60"],
    )
    actions = [
        Node(
            package="robot_state_publisher",
            executable="robot_state_publisher",
            parameters=[description, sim_time],
        ),
        Node(
            package="inverse_dynamics_controllers",
            executable="simulated_controller_manager",
            parameters=[config, sim_time],
            remappings=[("~/robot_description", "/robot_description")],
            output="both",
        ),
        spawner,
    ]
    if bag:
        # From when the controllers carry the arm: what its brakes give isn't measured.
        record = ["ros2", "bag", "record", "--use-sim-time", "-o", bag, "/joint_states"]
        recording = ExecuteProcess(cmd=record, output="screen")
        start = OnProcessExit(target_action=spawner, on_exit=[recording])
        actions.append(RegisterEventHandler(start))
    return actions


def simulated(robot):
    """The robot's description with a simulated hardware component."""
    robots = Path(get_package_share_directory("inverse_dynamics_robots"))
    root = ElementTree.parse(robots / "urdf" / f"{robot}.urdf").getroot()
    system = ElementTree.SubElement(root, "ros2_control", name=robot, type="system")
    hardware = ElementTree.SubElement(system, "hardware")
    plugin = ElementTree.SubElement(hardware, "plugin")
    plugin.text = "inverse_dynamics_controllers/SimulatedArm"
    for name, position in INITIAL[robot].items():
        joint = ElementTree.SubElement(system, "joint", name=name)
        ElementTree.SubElement(joint, "command_interface", name="effort")
        state = ElementTree.SubElement(joint, "state_interface", name="position")
        ElementTree.SubElement(state, "param", name="initial_value").text = str(position)
        for interface in ("velocity", "acceleration", "effort"):
            ElementTree.SubElement(joint, "state_interface", name=interface)
    return ElementTree.tostring(root, encoding="unicode")

# SPDX-License-Identifier: Apache-2.0
"""A UR10 or a Panda in MuJoCo under ros2_control, with a controller of this package.

ros2 launch inverse_dynamics_simulation simulated.launch.py robot:=ur10
ros2 run inverse_dynamics_simulation send_motion trajectory_to_inverse_dynamics \
    --joints shoulder_pan_joint shoulder_lift_joint elbow_joint \
    wrist_1_joint wrist_2_joint wrist_3_joint --amplitudes 0.5 -0.4 0.6 0.5 -0.5 0.8
"""

from xml.etree import ElementTree

from inverse_dynamics_ros.launch_files import failing_with_its_node, number, text
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
from launch.actions import (
    DeclareLaunchArgument,
    ExecuteProcess,
    OpaqueFunction,
    RegisterEventHandler,
)
from launch.event_handlers import OnProcessExit
from launch_ros.actions import Node


def generate_launch_description():
    """What `ros2 launch` asks for."""
    return LaunchDescription(
        [
            *arguments(),
            DeclareLaunchArgument(
                "payload",
                default_value="0.0",
                description="Mass at the tip, of which the solver knows nothing [kg]",
            ),
            DeclareLaunchArgument(
                "bag",
                default_value="",
                description="Directory to record /joint_states into, once the controllers are active; "
                "it must not exist yet. Empty: no recording",
            ),
            OpaqueFunction(function=_processes),
            failing_with_its_node(),
        ]
    )


def _processes(context):
    robot, bag = text(context, "robot"), text(context, "bag")
    spawning = spawner(context)
    actions = [
        state_publisher(simulated(robot, number(context, "payload"))),
        Node(
            package="inverse_dynamics_simulation",
            executable="simulated_controller_manager",
            parameters=[parameter_file(context), {"use_sim_time": True}],
            remappings=[("~/robot_description", "/robot_description")],
            output="both",
        ),
        spawning,
    ]
    if bag:
        # From when the controllers carry the arm: what its brakes give isn't measured.
        record = ["ros2", "bag", "record", "--use-sim-time", "-o", bag, "/joint_states"]
        recording = ExecuteProcess(cmd=record, output="screen")
        start = OnProcessExit(target_action=spawning, on_exit=[recording])
        actions.append(RegisterEventHandler(start))
    return actions


def simulated(robot, payload):
    """The robot's description with a simulated hardware component."""
    root = description_of(robot)
    _, tip = LINKS[robot]
    plugin = "inverse_dynamics_simulation/SimulatedArm"
    add_hardware(root, robot, plugin, {"payload": str(payload), "payload_link": tip})
    return ElementTree.tostring(root, encoding="unicode")

# SPDX-License-Identifier: Apache-2.0
"""A UR10 or a Panda in MuJoCo under ros2_control, with a controller of this package.

ros2 launch inverse_dynamics_simulation simulated.launch.py robot:=ur10
ros2 run inverse_dynamics_simulation send_motion trajectory_to_inverse_dynamics \
    --joints shoulder_pan_joint shoulder_lift_joint elbow_joint \
    wrist_1_joint wrist_2_joint wrist_3_joint --amplitudes 0.5 -0.4 0.6 0.5 -0.5 0.8
"""

from pathlib import Path
from xml.etree import ElementTree

import yaml
from ament_index_python.packages import get_package_share_directory
from inverse_dynamics_ros.launch_files import (
    argument,
    failing_with_its_node,
    number,
    refusing_others,
    text,
)
from launch.actions import ExecuteProcess, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

# Controllers to spawn for each choice, in this order.
CONTROLLERS = {
    "inverse_dynamics": ["inverse_dynamics_controller", "trajectory_to_inverse_dynamics"],
    "feed_forward": ["feed_forward_controller", "trajectory_to_feed_forward"],
    "gravity_compensation": ["gravity_compensation_controller"],
    "pd_gravity_compensation": [
        "pd_gravity_compensation_controller",
        "trajectory_to_pd_gravity_compensation",
    ],
}

# Spawned before each of them.
BROADCASTERS = ["joint_state_broadcaster", "external_wrench_broadcaster"]

# Takes over from the others: they are activated only once it is configured.
FALLBACK = "gravity_compensation_controller"


def generate_launch_description():
    """Arguments and processes, as `ros2 launch` asks for them."""
    return refusing_others(
        argument("robot", "Which arm", "ur10", choices=["ur10", "panda"]),
        argument(
            "controller",
            "inverse_dynamics: computed torque after a joint_trajectory_controller; "
            "feed_forward: PD and the model's torque after one; gravity_compensation: hand "
            "guiding; pd_gravity_compensation: PD and gravity after one",
            "inverse_dynamics",
            choices=list(CONTROLLERS),
        ),
        argument("config", "Parameter file; empty: this package's for the robot"),
        argument("payload", "Mass at the tip, unknown to the solver [kg]", "0.0"),
        argument(
            "bag",
            "Directory to record /joint_states into, once the controllers are active; it must "
            "not exist yet. Empty: no recording",
        ),
        OpaqueFunction(function=_processes),
        failing_with_its_node(),
    )


def _processes(context):
    robot, bag = text(context, "robot"), text(context, "bag")
    share = Path(get_package_share_directory("inverse_dynamics_simulation"))
    own = share / "config" / f"{robot}.yaml"
    config = text(context, "config") or str(own)
    if not Path(config).is_file():
        raise ValueError(
            f"argument config: expected a parameter file, got '{config}': no such file"
        )
    description = _simulated(robot, own, number(context, "payload"))
    controllers = CONTROLLERS[text(context, "controller")]
    spawner = _spawner(config, *BROADCASTERS, *controllers)
    first = spawner if FALLBACK in controllers else _spawner(config, "--inactive", FALLBACK)
    actions = [
        Node(
            package="robot_state_publisher",
            executable="robot_state_publisher",
            parameters=[
                {
                    "robot_description": ParameterValue(description, value_type=str),
                    "use_sim_time": True,
                }
            ],
        ),
        Node(
            package="inverse_dynamics_simulation",
            executable="simulated_controller_manager",
            parameters=[config, {"use_sim_time": True}],
            remappings=[("~/robot_description", "/robot_description")],
            output="both",
        ),
        first,
    ]
    if first is not spawner:
        start = OnProcessExit(target_action=first, on_exit=[spawner])
        actions.append(RegisterEventHandler(start))
    if bag:
        # From when the controllers carry the arm: what its brakes give isn't measured.
        record = ["ros2", "bag", "record", "--use-sim-time", "-o", bag, "/joint_states"]
        recording = ExecuteProcess(cmd=record, output="screen")
        start = OnProcessExit(target_action=spawner, on_exit=[recording])
        actions.append(RegisterEventHandler(start))
    return actions


def _spawner(config, *arguments):
    return Node(
        package="controller_manager",
        executable="spawner",
        arguments=[*arguments, "--param-file", config, "--controller-manager-timeout", "60"],
    )


def _simulated(robot, config, payload):
    """The robot's URDF with a simulated hardware component of effort-controlled joints.

    config: the parameter file, which says where the arm starts.
    """
    parameters = yaml.safe_load(config.read_text())
    law = parameters["feed_forward_controller"]["ros__parameters"]
    joints = parameters["trajectory_to_feed_forward"]["ros__parameters"]["joints"]
    share = Path(get_package_share_directory("inverse_dynamics_robots"))
    root = ElementTree.parse(share / "urdf" / f"{robot}.urdf").getroot()
    system = ElementTree.SubElement(root, "ros2_control", name=robot, type="system")
    hardware = ElementTree.SubElement(system, "hardware")
    plugin = "inverse_dynamics_simulation/SimulatedArm"
    ElementTree.SubElement(hardware, "plugin").text = plugin
    for name, value in {"payload": str(payload), "payload_link": law["ids"]["tip"]}.items():
        ElementTree.SubElement(hardware, "param", name=name).text = value
    start = parameters["simulated_arm"]["ros__parameters"]["start"]
    for name, position in zip(joints, start, strict=True):
        joint = ElementTree.SubElement(system, "joint", name=name)
        ElementTree.SubElement(joint, "command_interface", name="effort")
        state = ElementTree.SubElement(joint, "state_interface", name="position")
        ElementTree.SubElement(state, "param", name="initial_value").text = str(position)
        for interface in ("velocity", "effort"):
            ElementTree.SubElement(joint, "state_interface", name=interface)
    return ElementTree.tostring(root, encoding="unicode")

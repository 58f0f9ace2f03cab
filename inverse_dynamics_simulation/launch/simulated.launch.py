# SPDX-License-Identifier: Apache-2.0
"""A UR10 or a Panda in MuJoCo under ros2_control, with a controller of this package.

ros2 launch inverse_dynamics_simulation simulated.launch.py robot:=ur10
ros2 run inverse_dynamics_simulation send_motion trajectory_to_inverse_dynamics \
    --joints shoulder_pan_joint shoulder_lift_joint elbow_joint \
    wrist_1_joint wrist_2_joint wrist_3_joint --amplitudes 0.5 -0.4 0.6 0.5 -0.5 0.8
"""

from pathlib import Path
from xml.etree import ElementTree

from ament_index_python.packages import get_package_share_directory
from inverse_dynamics_ros.launch_files import argument, failing_with_its_node, number, text
from launch import LaunchDescription
from launch.actions import ExecuteProcess, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

# Positions of the joints at the start [rad].
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

# The link that carries the payload.
TIPS = {"ur10": "tool0", "panda": "fer_link8"}

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


def generate_launch_description():
    """Arguments and processes, as `ros2 launch` asks for them."""
    return LaunchDescription(
        [
            argument("robot", "Which arm", "ur10", choices=list(INITIAL)),
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
        ]
    )


def _processes(context):
    robot, bag, config = text(context, "robot"), text(context, "bag"), _parameter_file(context)
    description = _simulated(robot, number(context, "payload"))
    spawner = Node(
        package="controller_manager",
        executable="spawner",
        arguments=[
            *BROADCASTERS,
            *CONTROLLERS[text(context, "controller")],
            "--param-file",
            config,
            "--controller-manager-timeout",
            "60",
        ],
    )
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
        spawner,
    ]
    if bag:
        # From when the controllers carry the arm: what its brakes give isn't measured.
        record = ["ros2", "bag", "record", "--use-sim-time", "-o", bag, "/joint_states"]
        recording = ExecuteProcess(cmd=record, output="screen")
        start = OnProcessExit(target_action=spawner, on_exit=[recording])
        actions.append(RegisterEventHandler(start))
    return actions


def _parameter_file(context):
    """Path of the argument `config`. Raises ValueError: no such file."""
    given = text(context, "config")
    if given and not Path(given).is_file():
        raise ValueError(f"argument config: expected a parameter file, got '{given}': no such file")
    share = Path(get_package_share_directory("inverse_dynamics_simulation"))
    return given or str(share / "config" / f"{text(context, 'robot')}.yaml")


def _simulated(robot, payload):
    """The robot's URDF with a simulated hardware component of effort-controlled joints."""
    share = Path(get_package_share_directory("inverse_dynamics_robots"))
    root = ElementTree.parse(share / "urdf" / f"{robot}.urdf").getroot()
    system = ElementTree.SubElement(root, "ros2_control", name=robot, type="system")
    hardware = ElementTree.SubElement(system, "hardware")
    plugin = "inverse_dynamics_simulation/SimulatedArm"
    ElementTree.SubElement(hardware, "plugin").text = plugin
    for name, value in {"payload": str(payload), "payload_link": TIPS[robot]}.items():
        ElementTree.SubElement(hardware, "param", name=name).text = value
    for name, position in INITIAL[robot].items():
        joint = ElementTree.SubElement(system, "joint", name=name)
        ElementTree.SubElement(joint, "command_interface", name="effort")
        state = ElementTree.SubElement(joint, "state_interface", name="position")
        ElementTree.SubElement(state, "param", name="initial_value").text = str(position)
        for interface in ("velocity", "effort"):
            ElementTree.SubElement(joint, "state_interface", name=interface)
    return ElementTree.tostring(root, encoding="unicode")

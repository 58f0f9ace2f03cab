# SPDX-License-Identifier: Apache-2.0
"""Trajectories of a joint_trajectory_controller, followed in MuJoCo under a controller manager."""

from __future__ import annotations

import subprocess
import time
import unittest
from pathlib import Path

import launch
import launch_testing
import launch_testing.actions
import pytest
import rclpy
from ament_index_python.packages import get_package_share_directory
from control_msgs.msg import JointTrajectoryControllerState
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from sensor_msgs.msg import JointState

AMPLITUDES = {
    "ur10": {
        "shoulder_pan_joint": 0.5,
        "shoulder_lift_joint": -0.4,
        "elbow_joint": 0.6,
        "wrist_1_joint": 0.5,
        "wrist_2_joint": -0.5,
        "wrist_3_joint": 0.8,
    },
    "panda": {
        "fer_joint1": 0.5,
        "fer_joint2": 0.4,
        "fer_joint3": -0.5,
        "fer_joint4": 0.4,
        "fer_joint5": 0.6,
        "fer_joint6": 0.5,
        "fer_joint7": -0.8,
    },
}
"""How far each joint goes and comes back within DURATION [rad]."""

DURATION = 2.4
"""s"""

TOLERANCE = 2e-3
"""Greatest error that is allowed [rad]: the motions are up to 0.8 rad, at up to 1 rad/s."""

PATIENCE = 60.0
"""For each step [s], on a busy computer."""


@pytest.mark.launch_test
@launch_testing.parametrize(
    "robot, controller",
    [("ur10", "inverse_dynamics"), ("panda", "inverse_dynamics"), ("ur10", "feed_forward")],
)
def generate_test_description(robot, controller):
    share = Path(get_package_share_directory("inverse_dynamics_controllers"))
    source = PythonLaunchDescriptionSource(str(share / "launch" / "simulated.launch.py"))
    arguments = {"robot": robot, "controller": controller}
    return launch.LaunchDescription(
        [
            IncludeLaunchDescription(source, launch_arguments=arguments.items()),
            launch_testing.actions.ReadyToTest(),
        ]
    )


class TestFollowing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rclpy.init()
        cls.node = rclpy.create_node("closed_loop_test")

    @classmethod
    def tearDownClass(cls):
        cls.node.destroy_node()
        rclpy.shutdown()

    def spin_until(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition() and time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.1)
        return condition()

    def test_errors_stay_small(self, proc_output, robot, controller):
        trajectory = f"trajectory_to_{controller}"
        states, joint_states = [], []
        self.node.create_subscription(
            JointTrajectoryControllerState, f"/{trajectory}/controller_state", states.append, 100
        )
        self.node.create_subscription(JointState, "/joint_states", joint_states.append, 100)
        assert self.spin_until(lambda: states), "the trajectory controller says nothing"

        amplitudes = AMPLITUDES[robot]
        sending = subprocess.Popen(
            [
                *("ros2", "run", "inverse_dynamics_controllers", "send_motion", trajectory),
                *("--joints", *amplitudes, "--amplitudes", *map(str, amplitudes.values())),
                *("--duration", str(DURATION)),
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert self.spin_until(lambda: sending.poll() is not None), "the motion doesn't end"
        said, _ = sending.communicate()
        assert sending.returncode == 0, said

        # It moved, it followed, and nothing was cut.
        first = joint_states[0].name.index("elbow_joint" if robot == "ur10" else "fer_joint4")
        positions = [state.position[first] for state in joint_states]
        wished = abs(amplitudes[joint_states[0].name[first]])
        assert max(positions) - min(positions) > 0.99 * wished
        error = max(abs(e) for state in states for e in state.error.positions)
        print(f"{robot}, {controller}: greatest error {error:.2e} rad")
        assert error < TOLERANCE
        output = "".join(process.text.decode() for process in proc_output)
        assert "effort cut to its limit" not in output
        assert "[ERROR]" not in output

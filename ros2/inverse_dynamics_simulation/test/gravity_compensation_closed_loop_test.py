# SPDX-License-Identifier: Apache-2.0
"""Under gravity compensation an arm in MuJoCo stays where it was put."""

from __future__ import annotations

import time
import unittest
from pathlib import Path

import launch
import launch_testing
import launch_testing.actions
import pytest
import rclpy
from ament_index_python.packages import get_package_share_directory
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from sensor_msgs.msg import JointState

PATIENCE = 60.0
"""s, on a busy computer."""

TIME = 3.0
"""How long the arm is left alone [s, of the simulation]: it would have fallen within a second."""

TOLERANCE = 1e-3
"""rad"""


@pytest.mark.launch_test
@launch_testing.parametrize("robot", ["ur10", "panda"])
def generate_test_description(robot):
    share = Path(get_package_share_directory("inverse_dynamics_simulation"))
    source = PythonLaunchDescriptionSource(str(share / "launch" / "simulated.launch.py"))
    arguments = {"robot": robot, "controller": "gravity_compensation"}
    return launch.LaunchDescription(
        [
            IncludeLaunchDescription(source, launch_arguments=arguments.items()),
            launch_testing.actions.ReadyToTest(),
        ]
    )


def seconds(state):
    return state.header.stamp.sec + 1e-9 * state.header.stamp.nanosec


class TestGravityCompensation(unittest.TestCase):
    def test_the_arm_stays(self):
        rclpy.init()
        node = rclpy.create_node("gravity_compensation_closed_loop_test")
        carried = []  # states under the controller: brakes need no effort

        def receive(state):
            if any(state.effort):
                carried.append(state)

        node.create_subscription(JointState, "/joint_states", receive, 100)
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.1)
            if carried and seconds(carried[-1]) - seconds(carried[0]) > TIME:
                break
        node.destroy_node()
        rclpy.shutdown()

        assert carried, "no effort was commanded"
        first, last = carried[0], carried[-1]
        assert seconds(last) - seconds(first) > TIME
        pairs = zip(first.position, last.position, strict=True)
        drift = max(abs(b - a) for a, b in pairs)
        print(f"greatest drift {drift:.2e} rad")
        assert drift < TOLERANCE

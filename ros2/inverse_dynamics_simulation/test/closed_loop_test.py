# SPDX-License-Identifier: Apache-2.0
"""Trajectories of a joint_trajectory_controller, followed in MuJoCo under a controller manager."""

from __future__ import annotations

import itertools
import math
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import launch
import launch_testing
import launch_testing.actions
import pytest
import rclpy
import yaml
from ament_index_python.packages import get_package_share_directory
from control_msgs.msg import JointTrajectoryControllerState
from geometry_msgs.msg import WrenchStamped
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from rclpy.parameter_client import AsyncParameterClient
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

PD_TOLERANCE = 0.05
"""The same of the PD law [rad]: without the model's inertia a moving reference is followed late."""

LOADED_TOLERANCE = 0.1
"""The same with PAYLOAD [rad]: the model lacks it, and the feedback has no integral."""

PAYLOAD = 2.0
"""At the tip, unknown to the model [kg]."""

GRAVITY = 9.81
"""m/s^2"""

FORCE_TOLERANCE = 0.2
"""Of the force at the tip that the broadcaster senses, the arm at rest [N]."""

STIFF = {"natural_frequency": [60.0], "damping_ratio": [1.5]}
"""Gains to carry it with [rad/s]."""

SETTLING = 1.5
"""How long the arm is watched after the motion [s, of the simulation]."""

REST = 1e-3
"""Speed below which a joint stands [rad/s]."""

PATIENCE = 60.0
"""For each step [s], on a busy computer."""


CASES = [
    ("ur10", "inverse_dynamics", 0.0),
    ("panda", "inverse_dynamics", 0.0),
    ("ur10", "feed_forward", 0.0),
    ("panda", "feed_forward", 0.0),
    ("ur10", "pd_gravity_compensation", 0.0),
    ("panda", "pd_gravity_compensation", 0.0),
    ("ur10", "inverse_dynamics", PAYLOAD),
    ("panda", "inverse_dynamics", PAYLOAD),
]


def tolerance(controller, payload):
    if payload:
        return LOADED_TOLERANCE
    return PD_TOLERANCE if controller == "pd_gravity_compensation" else TOLERANCE


def parameter_file(robot, controller, payload):
    """This package's, with states of all cycles, and for a payload with the gains STIFF."""
    share = Path(get_package_share_directory("inverse_dynamics_simulation"))
    parameters = yaml.safe_load((share / "config" / f"{robot}.yaml").read_text())
    of_controller = parameters[f"{controller}_controller"]["ros__parameters"]
    of_controller["state_publish_rate"] = 1000.0
    if payload:
        of_controller["gains"] = STIFF
    with tempfile.NamedTemporaryFile("w", suffix=".yaml", delete=False) as file:
        yaml.safe_dump(parameters, file)
    return file.name


@pytest.mark.launch_test
@launch_testing.parametrize("robot, controller, payload", CASES)
def generate_test_description(robot, controller, payload):
    share = Path(get_package_share_directory("inverse_dynamics_simulation"))
    source = PythonLaunchDescriptionSource(str(share / "launch" / "simulated.launch.py"))
    arguments = {
        "robot": robot,
        "controller": controller,
        "payload": str(payload),
        "config": parameter_file(robot, controller, payload),
    }
    return launch.LaunchDescription(
        [
            IncludeLaunchDescription(source, launch_arguments=arguments.items()),
            launch_testing.actions.ReadyToTest(),
        ]
    )


def assert_times_increase(states):
    """The clock of the simulation has gone on between all states."""
    repeated = sum(seconds(a) >= seconds(b) for a, b in itertools.pairwise(states))
    assert repeated == 0, f"{repeated} of {len(states)} states have the time of the one before"


def seconds(state):
    return state.header.stamp.sec + 1e-9 * state.header.stamp.nanosec


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

    def move(self, trajectory, amplitudes):
        """Sends the arm there and back; the time of the simulation when it has come back."""
        sending = subprocess.Popen(
            [
                *("ros2", "run", "inverse_dynamics_simulation", "send_motion", trajectory),
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
        return seconds(self.joint_states[-1])

    def assert_settles(self, since):
        """With at most one overshoot each joint comes to rest."""
        assert self.spin_until(lambda: seconds(self.joint_states[-1]) > since + SETTLING)
        settling = [state for state in self.joint_states if seconds(state) > since]
        for speeds in zip(*(state.velocity for state in settling), strict=True):
            directions = [speed > 0 for speed in speeds if abs(speed) > REST]
            assert sum(a != b for a, b in itertools.pairwise(directions)) <= 1
        assert max(map(abs, self.joint_states[-1].velocity)) < REST

    def assert_has_fallback(self, controller):
        """The manager knows it from the controller's section of the parameter file."""
        client = AsyncParameterClient(self.node, "controller_manager")
        asked = client.get_parameters([f"{controller}.fallback_controllers"])
        assert self.spin_until(asked.done)
        (value,) = asked.result().values
        assert value.string_array_value == ["gravity_compensation_controller"]

    def test_errors_stay_small(self, proc_output, robot, controller, payload):
        # Of the controller itself: a joint_trajectory_controller's are of other moments.
        states, wrenches, self.joint_states = [], [], []
        topic = f"/{controller}_controller/controller_state"
        self.node.create_subscription(JointTrajectoryControllerState, topic, states.append, 100)
        topic = "/external_wrench_broadcaster/wrench"
        self.node.create_subscription(WrenchStamped, topic, wrenches.append, 100)
        self.node.create_subscription(JointState, "/joint_states", self.joint_states.append, 100)
        assert self.spin_until(lambda: states), "the controller publishes no state"
        self.assert_has_fallback(f"{controller}_controller")

        # It moved, it followed, it came to rest, and nothing was cut.
        amplitudes = AMPLITUDES[robot]
        since = self.move(f"trajectory_to_{controller}", amplitudes)
        self.assert_settles(since)
        first = self.joint_states[0].name.index("elbow_joint" if robot == "ur10" else "fer_joint4")
        positions = [state.position[first] for state in self.joint_states]
        desired = abs(amplitudes[self.joint_states[0].name[first]])
        assert max(positions) - min(positions) > 0.9 * desired
        error = max(abs(e) for state in states for e in state.error.positions)
        assert_times_increase(self.joint_states)
        print(f"{robot}, {controller}, payload {payload:g} kg: greatest error {error:.2e} rad")
        assert error < tolerance(controller, payload)
        if payload:
            assert error > TOLERANCE, "the payload isn't there"
        force = wrenches[-1].wrench.force
        weight = math.hypot(force.x, force.y, force.z)
        print(f"{robot}, {controller}, payload {payload:g} kg: {weight:.3f} N at the tip")
        assert abs(weight - payload * GRAVITY) < FORCE_TOLERANCE
        output = "".join(process.text.decode() for process in proc_output)
        assert "effort cut to its limit" not in output
        assert "[ERROR]" not in output

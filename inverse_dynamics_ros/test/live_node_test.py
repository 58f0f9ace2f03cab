# SPDX-License-Identifier: Apache-2.0
"""The live node: torques, residuals, diagnostics, and what it says of bad input."""

import math
import sys
import time
import unittest
from pathlib import Path

import launch_testing
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from launch import LaunchDescription
from launch_ros.actions import ComposableNodeContainer, LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode
from launch_testing.actions import ReadyToTest
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data

sys.path.insert(0, str(Path(__file__).parent))
from recordings import PENDULUM, SOLVER, JointState, String, joint_state, motion, stamp, torque

UR10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"
CUTOFF = 20.0  # Hz: settled after 53 ms, late by 16 ms
LEVELS = {DiagnosticStatus.OK: "ok", DiagnosticStatus.WARN: "warn", DiagnosticStatus.ERROR: "error"}


def live(name, **parameters):
    """A node of its own topics and name."""
    return Node(
        package="inverse_dynamics_ros",
        executable="live",
        name=name,
        namespace=name,
        output="screen",
        parameters=[
            {"max_age": 0.5, "diagnostic_updater.period": 0.2, "cutoff": CUTOFF} | parameters
        ],
    )


def generate_test_description():
    nodes = {
        "arm": live("arm", plugin_name=SOLVER),
        "unfed": live("unfed", plugin_name=UR10),
        "undescribed": live("undescribed", plugin_name=SOLVER),
        "unknown_plugin": live("unknown_plugin", plugin_name="no/Solver"),
        "no_plugin": live("no_plugin"),
        "mistyped": live("mistyped", plugin_name=SOLVER, min_rate="fast"),
        "bad_cutoff": live("bad_cutoff", plugin_name=SOLVER, cutoff=-1.0),
        "bad_tip": live(
            "bad_tip", plugin_name=SOLVER, robot_description=PENDULUM, **{"ids.tip": "tool0"}
        ),
        "misspelt": live(
            "misspelt", plugin_name=SOLVER, robot_description=PENDULUM, **{"ids.gravty": [0.0]}
        ),
    }
    container = ComposableNodeContainer(
        name="container",
        namespace="",
        package="rclcpp_components",
        executable="component_container",
        output="screen",
    )
    component = ComposableNode(
        package="inverse_dynamics_ros",
        plugin="inverse_dynamics_ros::LiveNode",
        name="component",
        parameters=[{"plugin_name": UR10}],
    )
    load = LoadComposableNodes(target_container=container, composable_node_descriptions=[component])
    return LaunchDescription([*nodes.values(), container, load, ReadyToTest()]), {
        "nodes": nodes,
        "container": container,
    }


class TestLiveNode(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rclpy.init()
        cls.node = rclpy.create_node("tester")
        cls.states = cls.node.create_publisher(JointState, "/arm/joint_states", 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        cls.description = cls.node.create_publisher(String, "/arm/robot_description", latched)
        cls.torques, cls.residuals, cls.diagnostics, cls.rates = [], [], {}, [0.0]
        cls.node.create_subscription(
            JointState, "/arm/arm/torques", cls.torques.append, qos_profile_sensor_data
        )
        cls.node.create_subscription(
            JointState, "/arm/arm/residual", cls.residuals.append, qos_profile_sensor_data
        )
        cls.node.create_subscription(DiagnosticArray, "/diagnostics", cls.diagnose, 10)

    @classmethod
    def tearDownClass(cls):
        cls.node.destroy_node()
        rclpy.shutdown()

    @classmethod
    def diagnose(cls, array):
        for status in array.status:
            if "arm" in status.name.split(":")[0]:
                values = {value.key: value.value for value in status.values}
                cls.diagnostics[status.name.split(": ")[1]] = (status, values)
                cls.rates.append(float(values.get("rate [Hz]", 0.0)))

    def until(self, condition, what, timeout=30.0):
        """Wait for something."""
        end = time.monotonic() + timeout
        while not condition():
            self.assertLess(time.monotonic(), end, f"{what}; {self.diagnostics}")
            rclpy.spin_once(self.node, timeout_sec=0.02)

    def until_diagnosed(self, task, level, text):
        def is_so():
            status, _ = self.diagnostics.get(task, (None, None))
            return status is not None and status.level == level and text in status.message

        self.until(is_so, f"{task}: expected {LEVELS[level]}, {text}")

    def spin(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.002)

    def play(self, begin, seconds, change=lambda message: message, more_effort=0.5):
        """Joint states at 100 Hz, in real time, from a stamp on."""
        self.spin(0.3)  # what is still under way belongs to what was played before
        self.torques.clear()
        self.residuals.clear()
        for k in range(round(100 * seconds)):
            self.states.publish(change(joint_state(begin + 0.01 * k, more_effort)))
            self.spin(0.01)
        self.spin(0.3)

    def test_1_waits_for_the_description(self, proc_output):
        proc_output.assertWaitFor(
            "waiting for a robot description on /arm/robot_description", timeout=30
        )
        self.until_diagnosed("solver", DiagnosticStatus.WARN, "waiting for a robot description")

    def test_2_says_what_is_wrong_with_a_description(self, proc_output):
        self.until(lambda: self.description.get_subscription_count() > 0, "no subscription")
        self.description.publish(String(data="<robot"))
        proc_output.assertWaitFor(
            "the robot description on /arm/robot_description can't be used", timeout=30
        )
        self.until_diagnosed("solver", DiagnosticStatus.WARN, "unusable robot description")

    def test_3_computes_torques_and_residuals(self, proc_output):
        self.description.publish(String(data=PENDULUM))
        proc_output.assertWaitFor("1 joints: swing; accelerations late by 16 ms", timeout=30)
        self.until_diagnosed("solver", DiagnosticStatus.OK, SOLVER)
        self.until(lambda: self.states.get_subscription_count() > 0, "no subscription")
        self.play(100.0, 1.5)
        self.assertGreater(len(self.torques), 30)
        for message in self.torques:
            t = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            q, qd, _ = motion(t)
            _, _, late_qdd = motion(t - 1 / (math.pi * CUTOFF))
            self.assertEqual(message.name, ["swing"])
            self.assertEqual(message.header.frame_id, "base")
            self.assertAlmostEqual(message.position[0], q, delta=1e-12)
            self.assertAlmostEqual(message.velocity[0], qd, delta=1e-12)
            # what is left of the filter's start is 1 % of the acceleration at most
            self.assertAlmostEqual(message.effort[0], torque(q, late_qdd), delta=0.02)
        self.assertEqual(len(self.residuals), len(self.torques))
        for message, computed in zip(self.residuals, self.torques, strict=True):
            self.assertEqual(message.header, computed.header)
            t = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            q, _, qdd = motion(t)
            self.assertAlmostEqual(
                message.effort[0], torque(q, qdd) + 0.5 - computed.effort[0], delta=1e-9
            )
        self.until_diagnosed("joint states", DiagnosticStatus.OK, "joint states arrive")
        self.assertGreater(max(self.rates), 10)
        self.assertEqual(self.diagnostics["joint states"][1]["missing joints"], "none")

    def test_4_starts_anew_when_the_clock_jumps_back(self, proc_output):
        self.play(50.0, 0.5)
        proc_output.assertWaitFor("the clock jumped back", timeout=30)
        self.assertGreater(len(self.torques), 5)
        for message in self.torques:  # none from before the filter had settled
            self.assertGreater(
                message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec, 50.05
            )
        self.assertEqual(self.diagnostics["joint states"][1]["clock jumps back"], "1")

    def test_5_says_which_joints_are_missing(self, proc_output):
        def without(message):
            message.name = ["swing", "swing"]
            return message

        self.play(60.0, 0.3, without)
        proc_output.assertWaitFor("joint states lack (or repeat) joints: swing", timeout=30)
        self.until_diagnosed("joint states", DiagnosticStatus.ERROR, "missing joints: swing")
        self.assertEqual(self.torques, [])

    def test_6_leaves_out_what_is_not_finite(self, proc_output):
        def with_nan(message):
            if message.header.stamp.nanosec // 10**7 % 10 == 0:
                message.velocity[1] = math.nan
            return message

        self.play(70.0, 1.0, with_nan)
        proc_output.assertWaitFor("a position or velocity that isn't finite", timeout=30)
        self.assertTrue(all(math.isfinite(m.effort[0]) for m in self.torques))
        self.assertGreater(len(self.torques), 20)

    def test_7_publishes_no_residual_without_efforts(self):
        def without_effort(message):
            message.effort = []
            return message

        self.play(80.0, 0.5, without_effort)
        self.assertGreater(len(self.torques), 5)
        self.assertEqual(self.residuals, [])

    def test_8_says_when_joint_states_cease(self):
        self.until_diagnosed(
            "joint states", DiagnosticStatus.ERROR, "no joint states any more on /arm/joint_states"
        )
        other = JointState(name=["finger"], position=[0.0], velocity=[0.0], effort=[0.0])
        other.header.stamp = stamp(1.0)
        self.states.publish(other)
        self.until(
            lambda: self.diagnostics["joint states"][1]["messages of other joints"] == "1",
            "other joints aren't counted",
        )

    def test_9_runs_as_a_component(self, proc_output, container):
        proc_output.assertWaitFor(f"solver: {UR10}, 6 joints", process=container, timeout=60)

    def test_says_again_and_again_what_does_not_come(self, proc_output, nodes):
        expected = {
            "unfed": "no joint states on /unfed/joint_states: 0 publisher(s)",
            "undescribed": "still waiting for a robot description on "
            "/undescribed/robot_description: 0 publisher(s)",
        }
        for name, text in expected.items():
            proc_output.assertWaitFor(text, process=nodes[name], timeout=60)
            said = "".join(o.text.decode() for o in proc_output[nodes[name]])
            line = next(line for line in said.splitlines() if text in line)
            self.assertIn("[WARN]", line)

    def test_ends_with_an_error_that_says_why(self, proc_info, proc_output, nodes):
        expected = {
            "unknown_plugin": "solver plugin 'no/Solver': not found",
            "no_plugin": "parameter 'plugin_name': expected a solver, package/Class, got nothing",
            "mistyped": "parameter 'min_rate' has invalid type",
            "bad_cutoff": "cutoff",
            "bad_tip": "tool0",
            "misspelt": "parameter 'ids.gravty': the solver doesn't know it: expected one of",
        }
        for name, text in expected.items():
            with self.subTest(name):
                proc_info.assertWaitForShutdown(process=nodes[name], timeout=60)
                self.assertEqual(proc_info[nodes[name]].returncode, 2)
                said = "".join(o.text.decode() for o in proc_output[nodes[name]])
                self.assertIn(text, said)
                self.assertIn("[FATAL]", said)


@launch_testing.post_shutdown_test()
class TestShutdown(unittest.TestCase):
    def test_is_clean(self, proc_info, nodes):
        self.assertIn(proc_info[nodes["arm"]].returncode, (0, -2))  # -2: SIGINT

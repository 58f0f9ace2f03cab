# SPDX-License-Identifier: Apache-2.0
"""The live node: torques, residuals, diagnostics, and what it says of bad input."""

import math
import sys
import time
import unittest
from pathlib import Path

import launch_testing
import rclpy
from action_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import InertiaStamped, Vector3Stamped, WrenchStamped
from inverse_dynamics_msgs.action import EstimatePayload
from inverse_dynamics_msgs.msg import Contact
from launch import LaunchDescription
from launch_ros.actions import ComposableNodeContainer, LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode
from launch_testing.actions import ReadyToTest
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu

sys.path.insert(0, str(Path(__file__).parent))
import itertools

from recordings import (
    GRAVITY,
    LENGTH,
    MASS,
    PENDULUM,
    SOLVER,
    JointState,
    String,
    joint_state,
    motion,
    stamp,
    torque,
)

UR10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"
CUTOFF = 20.0  # Hz: settled after 53 ms, late by 16 ms
# What the nodes publish with, and room for what comes while a test doesn't look.
SENSOR_DATA = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
LEVELS = {DiagnosticStatus.OK: "ok", DiagnosticStatus.WARN: "warn", DiagnosticStatus.ERROR: "error"}


def live(name, remappings=(), **parameters):
    """A node of its own topics and name."""
    return Node(
        remappings=remappings,
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
        "touched": live(
            "touched",
            plugin_name=SOLVER,
            robot_description=PENDULUM,
            **{
                "external_torques.enabled": True,
                "external_torques.gain": 30.0,
                "external_torques.tracking": 100.0,
                "external_torques.thresholds": [1.0],
                "external_torques.noise": [0.01],
                "payload.ramp_time": 0.1,
                "gravity_from_imu.use": "orientation",
                "gravity_from_imu.time_constant": 0.05,
            },
        ),
        "carrier": live(
            "carrier",
            robot="ur10_simulated",
            **{"payload.mass": 3.0, "payload.center_of_mass": [0.02, -0.03, 0.12]},
        ),
        "weigher": live(
            "weigher",
            remappings=[("joint_states", "/carrier/carrier/torques")],
            robot="ur10_simulated",
            **{"estimate_payload.noise": [0.5]},
        ),
        "unfed": live("unfed", plugin_name=UR10),
        "undescribed": live("undescribed", plugin_name=SOLVER),
        "unknown_plugin": live("unknown_plugin", plugin_name="no/Solver"),
        "no_plugin": live("no_plugin"),
        "mistyped": live("mistyped", plugin_name=SOLVER, min_rate="fast"),
        "bad_cutoff": live("bad_cutoff", plugin_name=SOLVER, cutoff=-1.0),
        "bad_tip": live(
            "bad_tip", plugin_name=SOLVER, robot_description=PENDULUM, **{"ids.tip": "tool0"}
        ),
        "unknown_contacts": live(
            "unknown_contacts",
            plugin_name=UR10,
            **{"external_torques.enabled": True, "external_torques.contacts_file": "none.json"},
        ),
        "nameless_tip": live(
            "nameless_tip",
            plugin_name=UR10,
            **{"external_torques.enabled": True, "external_torques.noise": [1.0]},
        ),
        "bad_payload": live(
            "bad_payload", plugin_name=UR10, **{"payload.inertia": [1.0, 0.0, 0.0, 1.0, 0.0, 3.0]}
        ),
        "misspelt_cutoff": live("misspelt_cutoff", plugin_name=UR10, cutof=9.0),
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
            JointState, "/arm/arm/torques", cls.torques.append, SENSOR_DATA
        )
        cls.node.create_subscription(
            JointState, "/arm/arm/residual", cls.residuals.append, SENSOR_DATA
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
        status, _ = self.diagnostics["solver"]
        self.assertEqual(status.name, "/arm/arm: solver")
        self.assertEqual(status.hardware_id, "/arm/pendulum")
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
        self.until(lambda: len(self.residuals) == len(self.torques), "residuals missing")
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
            "unknown_contacts": "none.json",
            "nameless_tip": "parameter 'ids.tip': expected the name of the link",
            "bad_payload": "parameter payload.inertia: no possible body",
            "misspelt_cutoff": "parameter 'cutof': the node doesn't declare it; "
            "did you mean 'cutoff'?",
            "misspelt": "parameter 'ids.gravty': the solver doesn't know it: expected one of",
        }
        for name, text in expected.items():
            with self.subTest(name):
                proc_info.assertWaitForShutdown(process=nodes[name], timeout=60)
                self.assertEqual(proc_info[nodes[name]].returncode, 2)
                said = "".join(o.text.decode() for o in proc_output[nodes[name]])
                self.assertIn(text, said)
                self.assertIn("[FATAL]", said)


class TestExternalTorques(unittest.TestCase):
    """Of the node `touched`: what the pendulum touches, carries, and where it hangs."""

    @classmethod
    def setUpClass(cls):
        rclpy.init()
        cls.node = rclpy.create_node("toucher")
        cls.states = cls.node.create_publisher(JointState, "/touched/joint_states", 10)
        cls.payload = cls.node.create_publisher(InertiaStamped, "/touched/touched/payload", 10)
        cls.gravity = cls.node.create_publisher(Vector3Stamped, "/touched/touched/gravity", 10)
        cls.imu = cls.node.create_publisher(Imu, "/touched/imu", 10)
        cls.parameters = cls.node.create_client(SetParameters, "/touched/touched/set_parameters")
        cls.torques, cls.wrenches, cls.flags, cls.diagnostics = [], [], [], {}
        for kind, topic, received in (
            (JointState, "external_torques", cls.torques),
            (WrenchStamped, "wrench", cls.wrenches),
            (Contact, "contact", cls.flags),
        ):
            cls.node.create_subscription(
                kind, f"/touched/touched/{topic}", received.append, SENSOR_DATA
            )
        cls.node.create_subscription(DiagnosticArray, "/diagnostics", cls.diagnose, 10)
        cls.now = 100.0

    @classmethod
    def tearDownClass(cls):
        cls.node.destroy_node()
        rclpy.shutdown()

    @classmethod
    def diagnose(cls, array):
        for status in array.status:
            if "touched" in status.name.split(":")[0]:
                values = {value.key: value.value for value in status.values}
                cls.diagnostics[status.name.split(": ")[1]] = (status, values)

    def until(self, condition, what, timeout=30.0):
        """Wait for something."""
        end = time.monotonic() + timeout
        while not condition():
            self.assertLess(time.monotonic(), end, f"{what}; {self.diagnostics}")
            rclpy.spin_once(self.node, timeout_sec=0.02)

    def play(self, seconds, more_effort=0.0, change=lambda message: message, step=0.005):
        """Joint states at 200 Hz: each stamp is one step later than the last."""
        self.until(lambda: self.states.get_subscription_count() > 0, "no subscription")
        for _ in range(round(seconds / step)):
            type(self).now += step
            self.states.publish(change(joint_state(self.now, more_effort)))
            end = time.monotonic() + step
            while time.monotonic() < end:
                rclpy.spin_once(self.node, timeout_sec=0.001)
        end = time.monotonic() + 0.3
        while time.monotonic() < end:  # what is still under way, until nothing comes any more
            before = self.message_count()
            rclpy.spin_once(self.node, timeout_sec=0.01)
            if self.message_count() > before:
                end = time.monotonic() + 0.3

    def play_to_the_turning_point(self, seconds=0.5):
        """Joint states of the next swing until the pendulum is at its highest, at rest."""
        type(self).now = 4 * math.ceil(self.now / 4) + 5 - seconds
        self.play(seconds)

    def message_count(self):
        return len(self.torques) + len(self.wrenches) + len(self.flags)

    def clear(self):
        for received in (self.torques, self.wrenches, self.flags):
            received.clear()

    def last(self):
        return self.torques[-1].effort[0]

    def set_parameter(self, name, value):
        self.assertTrue(self.parameters.wait_for_service(timeout_sec=30))
        future = self.parameters.call_async(
            SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
        )
        self.until(future.done, "no answer")
        return future.result().results[0]

    def test_1_are_what_efforts_have_beyond_the_model(self):
        # The first ones may be lost: topics may not be connected yet.
        self.until(lambda: self.play(0.5) or len(self.torques) > 50, "few torques")
        self.assertLess(max(abs(m.effort[0]) for m in self.torques), 0.1)
        self.assertFalse(any(m.contact for m in self.flags))
        self.clear()
        self.play(0.5, more_effort=3.0)
        self.assertAlmostEqual(self.last(), 3.0, delta=0.05)
        self.assertEqual(self.torques[-1].name, ["swing"])
        self.assertEqual(self.torques[-1].header, joint_state(self.now).header)
        self.assertTrue(self.flags[-1].contact)
        self.assertEqual(self.flags[-1].joint, "swing")
        self.assertAlmostEqual(self.flags[-1].excess, 3.0, delta=0.05)
        self.assertEqual(self.flags[-1].header, self.torques[-1].header)
        wrench = self.wrenches[-1]  # as a sensor's: what the surroundings exert
        self.assertEqual(wrench.header.frame_id, "rod")
        self.assertEqual(wrench.header.stamp, stamp(self.now))
        self.assertAlmostEqual(wrench.wrench.torque.y, -3.0, delta=0.05)
        self.assertLess(abs(wrench.wrench.force.x), 1e-9)
        self.assertEqual(len(self.torques), len(self.flags))
        self.assertEqual(len(self.torques), len(self.wrenches))

        self.clear()
        self.play(0.5)
        self.assertAlmostEqual(self.last(), 0.0, delta=0.05)
        self.assertFalse(self.flags[-1].contact)
        self.assertEqual(self.flags[-1].joint, "")

    def test_2_start_softly_after_what_cannot_be_used(self):
        def spoiled(message):
            message.effort[1] = math.nan
            return message

        self.play(0.5, more_effort=3.0)
        self.clear()
        self.play(0.05, more_effort=3.0, change=spoiled)
        self.assertEqual(self.torques, [])
        self.assertEqual(self.flags, [])
        self.play(0.5, more_effort=3.0)
        efforts = [m.effort[0] for m in self.torques]
        self.assertLess(abs(efforts[0]), 1.0)
        steps = [abs(b - a) for a, b in itertools.pairwise(efforts)]
        self.assertLess(max(steps), 0.6)  # 3 N m times gain and period
        self.assertAlmostEqual(self.last(), 3.0, delta=0.05)
        self.until(
            lambda: "efforts not finite" in self.diagnostics["external torques"][1],
            "no diagnostics",
        )
        _, values = self.diagnostics["external torques"]
        self.assertEqual(values["estimator"], "momentum observer")
        self.assertEqual(values["efforts not finite"], "10")

    def test_3_leave_out_messages_without_some_joint(self):
        def without(message):
            if round(message.header.stamp.nanosec / 5e6) % 4 == 0:
                message.name = ["gripper", "other"]
            return message

        self.play(0.3, more_effort=3.0)
        self.clear()
        self.play(0.5, more_effort=3.0, change=without)
        self.assertGreater(len(self.torques), 50)
        for message in self.torques:
            self.assertAlmostEqual(message.effort[0], 3.0, delta=0.05)

    def test_4_count_a_payload_of_the_topic(self, proc_output):
        self.until(lambda: self.payload.get_subscription_count() > 0, "no subscription")
        self.play(0.3)
        message = InertiaStamped()
        message.header.frame_id = "rod"
        message.inertia.m = 1.0
        message.inertia.com.z = -LENGTH
        self.payload.publish(message)
        self.play_to_the_turning_point()
        q, _, qdd = motion(self.now)
        carried = torque(q, qdd) / MASS
        self.assertGreater(carried, 3.0)
        self.assertAlmostEqual(self.last(), -carried, delta=0.05)
        self.payload.publish(InertiaStamped())
        self.play(0.5)
        self.assertAlmostEqual(self.last(), 0.0, delta=0.05)
        message.inertia.m = -1.0
        self.payload.publish(message)
        proc_output.assertWaitFor("~/payload: ignored: inertia.mass: no possible body", timeout=30)

    def test_5_count_a_payload_of_parameters(self):
        self.assertFalse(self.set_parameter("payload.mass", -1.0).successful)
        self.assertTrue(
            self.set_parameter("payload.center_of_mass", [0.0, 0.0, -LENGTH]).successful
        )
        self.assertTrue(self.set_parameter("payload.mass", 2.0).successful)
        refused = self.set_parameter("payload.inertia", [1.0, 0.0, 0.0, 1.0, 0.0, 3.0])
        self.assertFalse(refused.successful)
        self.assertIn("parameter payload.inertia: no possible body", refused.reason)
        self.play_to_the_turning_point()
        q, _, qdd = motion(self.now)
        self.assertAlmostEqual(self.last(), -2.0 * torque(q, qdd) / MASS, delta=0.1)
        self.assertTrue(self.set_parameter("payload.mass", 0.0).successful)
        self.play(0.5)
        self.assertAlmostEqual(self.last(), 0.0, delta=0.05)

    def test_6_count_gravity_of_an_imu(self, proc_output):
        self.until(lambda: self.imu.get_subscription_count() > 0, "no subscription")
        # The base hangs from the ceiling: half a turn about x.
        half_a_turn = Imu()
        half_a_turn.orientation.w = 0.0
        half_a_turn.orientation.x = 1.0
        for k in range(200):
            half_a_turn.header.stamp = stamp(10 + 0.01 * k)
            self.imu.publish(half_a_turn)
            rclpy.spin_once(self.node, timeout_sec=0.005)
        self.play_to_the_turning_point()
        q, _, _ = motion(self.now)
        gravity = MASS * GRAVITY * LENGTH * math.sin(q)
        self.assertAlmostEqual(self.last(), 2 * gravity, delta=0.1)
        self.gravity.publish(Vector3Stamped())
        proc_output.assertWaitFor("/touched/touched/gravity: ignored: gravity", timeout=30)


class TestPayloadEstimate(unittest.TestCase):
    """Of the node `weigher`, which gets the torques that the node `carrier` computes with a load."""

    @classmethod
    def setUpClass(cls):
        rclpy.init()
        cls.node = rclpy.create_node("mover")
        cls.states = cls.node.create_publisher(JointState, "/carrier/joint_states", 10)
        cls.found = []
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        cls.node.create_subscription(
            InertiaStamped, "/weigher/weigher/estimated_payload", cls.found.append, latched
        )

    @classmethod
    def tearDownClass(cls):
        cls.node.destroy_node()
        rclpy.shutdown()

    def send(self, node, duration=0.0):
        """Handle of a goal."""
        client = ActionClient(self.node, EstimatePayload, f"/{node}/{node}/estimate_payload")
        self.assertTrue(client.wait_for_server(timeout_sec=30))
        self.feedback = []
        goal = EstimatePayload.Goal(duration=duration)
        return self.done(client.send_goal_async(goal, lambda m: self.feedback.append(m.feedback)))

    def until(self, condition, timeout=30.0):
        end = time.monotonic() + timeout
        while not condition():
            self.assertLess(time.monotonic(), end)
            rclpy.spin_once(self.node, timeout_sec=0.1)

    def done(self, future):
        rclpy.spin_until_future_complete(self.node, future, timeout_sec=30)
        return future.result()

    def canceled(self, goal):
        result = goal.get_result_async()
        self.done(goal.cancel_goal_async())
        return self.done(result)

    def move(self, seconds):
        names = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
        while self.states.get_subscription_count() == 0:
            rclpy.spin_once(self.node, timeout_sec=0.02)
        for k in range(round(100 * seconds)):
            t = 0.01 * k
            message = JointState(name=[f"{name}_joint" for name in names])
            message.header.stamp = stamp(20 + t)
            rates = [0.9 + 0.17 * j for j in range(6)]
            message.position = [0.7 * math.sin(w * t) + 0.4 * j - 1.0 for j, w in enumerate(rates)]
            message.velocity = [0.7 * w * math.cos(w * t) for w in rates]
            self.states.publish(message)
            rclpy.spin_once(self.node, timeout_sec=0.01)

    def test_1_is_refused_with_a_reason(self):
        refused = self.done(self.send("touched").get_result_async())
        self.assertEqual(refused.status, GoalStatus.STATUS_ABORTED)
        self.assertEqual(refused.result.error_code, EstimatePayload.Result.NOT_READY)
        self.assertIn("parameter 'estimate_payload.noise'", refused.result.message)
        first = self.send("weigher")
        second = self.done(self.send("weigher").get_result_async())
        self.assertIn("expected one goal at a time", second.result.message)
        ended = self.canceled(first)
        self.assertEqual(ended.status, GoalStatus.STATUS_CANCELED)
        self.assertEqual(ended.result.error_code, EstimatePayload.Result.TOO_SHORT)
        self.assertIn("no estimate: ", ended.result.message)

    def test_2_is_a_result_and_a_message_as_controllers_take_it(self):
        result = self.send("weigher", 8.0).get_result_async()
        self.move(8.5)
        ended = self.done(result)
        self.assertEqual(ended.status, GoalStatus.STATUS_SUCCEEDED, ended.result.message)
        found = ended.result
        self.assertEqual(found.error_code, EstimatePayload.Result.SUCCESSFUL)
        self.until(lambda: self.found)
        self.assertEqual(self.found[-1], found.payload)
        self.assertEqual(found.payload.header.frame_id, "tool0")
        self.assertAlmostEqual(found.payload.inertia.m, 3.0, delta=0.1)
        self.assertAlmostEqual(found.payload.inertia.com.x, 0.02, delta=0.02)
        self.assertAlmostEqual(found.payload.inertia.com.y, -0.03, delta=0.02)
        self.assertAlmostEqual(found.payload.inertia.com.z, 0.12, delta=0.02)
        self.assertAlmostEqual(found.duration, 8.0, delta=0.5)
        # half widths of 95 % intervals are about two standard deviations, or more
        w = found.center_of_mass_half_width
        for i, half_width in enumerate((found.mass_half_width, w.x, w.y, w.z)):
            deviation = math.sqrt(found.covariance[5 * i])
            self.assertGreater(half_width, 1.9 * deviation)
            self.assertLess(half_width, 5 * deviation)
        self.assertEqual(found.covariance[1], found.covariance[4])
        self.assertGreater(len(self.feedback), 5)
        self.assertAlmostEqual(self.feedback[-1].mass, 3.0, delta=0.2)
        self.assertGreater(self.feedback[-1].duration, self.feedback[0].duration)

    def test_3_ends_when_the_goal_is_canceled(self):
        self.found.clear()
        goal = self.send("weigher")
        self.move(8.0)
        ended = self.canceled(goal)
        self.assertEqual(ended.status, GoalStatus.STATUS_CANCELED)
        self.assertEqual(ended.result.error_code, EstimatePayload.Result.SUCCESSFUL)
        self.assertAlmostEqual(ended.result.payload.inertia.m, 3.0, delta=0.1)
        self.until(lambda: self.found)


@launch_testing.post_shutdown_test()
class TestShutdown(unittest.TestCase):
    def test_is_clean(self, proc_info, nodes):
        self.assertIn(proc_info[nodes["arm"]].returncode, (0, -2))  # -2: SIGINT

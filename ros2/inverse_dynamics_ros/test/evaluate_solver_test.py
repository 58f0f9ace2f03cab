# SPDX-License-Identifier: Apache-2.0
"""The program evaluate_solver: what it writes, says and ends with, also for bad input."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import launch_testing
from launch import LaunchDescription
from launch.actions import RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_testing.actions import ReadyToTest
from launch_testing.util import KeepAliveProc

sys.path.insert(0, str(Path(__file__).parent))
import recordings
from recordings import PENDULUM, SOLVER, JointTrajectory, String, bits, read_bag, write_bag

FOLDER = Path(tempfile.mkdtemp())
GOOD = FOLDER / "good"
ROBOT = FOLDER / "pendulum.yaml"
CONFIGURED = {"robot": str(ROBOT), "plugin_name": None, "robot_description": None}


@dataclass
class Case:
    """A run of the program."""

    parameters: dict
    code: int  # that it ends with
    says: list[str]
    level: str = "FATAL"
    node: object = field(default=None, repr=False)

    @property
    def written(self):
        """Whether it is to leave a recording."""
        return self.code == 0

    def make_node(self, name):
        """The process, with parameters of which None is left out."""
        parameters = {
            "input_bag": str(GOOD),
            "output_bag": str(FOLDER / f"out_{name}"),
            "plugin_name": SOLVER,
            "robot_description": PENDULUM,
        } | self.parameters
        self.node = Node(
            package="inverse_dynamics_ros",
            executable="evaluate_solver",
            output="screen",
            parameters=[
                {
                    key: ParameterValue(value, value_type=str) if isinstance(value, str) else value
                    for key, value in parameters.items()
                    if value is not None
                }
            ],
        )
        return self.node


def missing_joint():
    """A recording whose last message lacks the joint, but has another."""
    messages = recordings.joint_states(50)
    messages[-1][0].name = ["gripper", "other"]
    return messages


def shorter(messages, name):
    """Messages without the numbers of a field."""
    for message, _ in messages:
        setattr(message, name, [])
    return messages


def make_recordings():
    """Everything the cases read."""
    write_bag(GOOD, {"/joint_states": recordings.joint_states()})
    write_bag(FOLDER / "mcap", {"/joint_states": recordings.joint_states()}, "mcap")
    write_bag(FOLDER / "trajectory", {"/plan": [(recordings.trajectory(), 7)]})
    write_bag(FOLDER / "plan", {"/plan": [(recordings.trajectory(effort=False), 7)]})
    write_bag(FOLDER / "plans", {"/plan": [(recordings.trajectory(), 7)] * 2})
    write_bag(FOLDER / "text", {"/chatter": [(String(data="hello"), 1)]})
    write_bag(
        FOLDER / "no_velocity", {"/joint_states": shorter(recordings.joint_states(50), "velocity")}
    )
    write_bag(
        FOLDER / "no_effort", {"/joint_states": shorter(recordings.joint_states(50), "effort")}
    )
    write_bag(FOLDER / "one_missing", {"/joint_states": missing_joint()})
    (FOLDER / "pendulum.urdf").write_text(PENDULUM)
    ROBOT.write_text(
        f"schema: 1\nname: pendulum\ndescription: a pendulum\nplugin: {SOLVER}\n"
        "urdf: pendulum.urdf\njoints: [swing]\neffort: torque\n"
    )
    (FOLDER / "directory").mkdir()
    (FOLDER / "exists").mkdir()
    (FOLDER / "file.txt").write_text("no recording")
    (FOLDER / "damaged").mkdir()
    (FOLDER / "damaged" / "metadata.yaml").write_text("rosbag2_bagfile_information: [\n")


MADE = "written: "
CASES = {
    "fine": Case({}, 0, [MADE, "1000 samples", "swing"], "INFO"),
    "mcap": Case({"input_bag": str(FOLDER / "mcap")}, 0, [MADE], "INFO"),
    "to_mcap": Case({"storage": "mcap"}, 0, [MADE], "INFO"),
    "file": Case({"input_bag": str(GOOD / "good_0.db3")}, 0, [MADE, "1000 samples"], "INFO"),
    "raw": Case(
        {"accelerations": "backward-difference"}, 0, ["backward-difference, no filter"], "INFO"
    ),
    "low_pass": Case(
        {"accelerations": "low-pass", "cutoff": 4.0}, 0, ["cut-off 4 Hz (given)"], "INFO"
    ),
    "topic": Case({"topic": "/effort"}, 0, ["/effort (computed), /effort_gt (measured)"], "INFO"),
    "robot": Case(
        CONFIGURED, 0, ["robot: pendulum, a pendulum; robot description: /", MADE], "INFO"
    ),
    "robot_changed": Case(
        CONFIGURED | {"accelerations": "low-pass", "cutoff": 4.0},
        0,
        ["cut-off 4 Hz (given)", MADE],
        "INFO",
    ),
    "no_robot": Case(
        {"robot": "ur11_real", "plugin_name": None},
        2,
        ["robot 'ur11_real': expected one of ", "or a file ending in .yaml or .urdf"],
    ),
    "trajectory": Case(
        {"input_bag": str(FOLDER / "trajectory")}, 0, ["given by the recording", MADE], "INFO"
    ),
    "plan": Case({"input_bag": str(FOLDER / "plan")}, 0, ["no efforts are recorded", MADE], "INFO"),
    "no_input": Case(
        {"input_bag": None},
        2,
        ["parameter 'input_bag': expected the recording to evaluate, got nothing"],
    ),
    "no_output": Case(
        {"output_bag": None}, 2, ["parameter 'output_bag': expected the recording to write"]
    ),
    "no_plugin": Case(
        {"plugin_name": None},
        2,
        ["parameter 'plugin_name': expected a solver", "set it to one of", SOLVER],
    ),
    "unknown_plugin": Case(
        {"plugin_name": "kdl_inverse_dynamics_solver/InverseDynamicsSolverKLD"},
        2,
        ["not found", f"did you mean {SOLVER}?"],
    ),
    "no_description": Case({"robot_description": None}, 2, ["robot description: missing"]),
    "bad_description": Case({"robot_description": "<robot"}, 2, ["robot description"]),
    "unknown_tip": Case({"ids.tip": "tool9"}, 2, ["tool9"]),
    "mistyped": Case({"topic": 5}, 2, ["parameter 'topic' has invalid type"]),
    "mistyped_number": Case(
        {"cutoff": 5}, 2, ["cutoff", "A number with a decimal point (5.0) is a double"]
    ),
    "bad_choice": Case({"accelerations": "savgol"}, 2, ["accelerations", "savgol"]),
    "bad_gravity": Case(
        {"ids.gravity": [0.0, 9.81]}, 2, ["parameter 'ids.gravity'", "3 finite numbers"]
    ),
    "mistyped_gravity": Case({"ids.gravity": "down"}, 2, ["ids.gravity", "list of doubles"]),
    "misspelt": Case(
        {"ids.gravty": [0.0, 0.0, -9.81]},
        2,
        ["parameter 'ids.gravty': the solver doesn't know it: expected one of", "ids.gravity"],
    ),
    "misspelt_cutoff": Case(
        {"cutof": 4.0},
        2,
        ["parameter 'cutof': the node doesn't declare it; did you mean 'cutoff'?"],
    ),
    "currents": Case({"effort": "current"}, 2, ["parameter 'drive_gains'", "effort means current"]),
    # refused before the recording is read
    "currents_of_nothing": Case(
        {"effort": "current", "input_bag": str(FOLDER / "nowhere")}, 2, ["effort means current"]
    ),
    "automatic": Case({"effort": "auto"}, 0, ["effort means: torque, ", MADE], "INFO"),
    "names": Case(
        {"joints": ["a", "b"]}, 2, ["parameter 'joints': expected 1 names", "got 2 (a, b)"]
    ),
    "no_such_bag": Case({"input_bag": str(FOLDER / "nowhere")}, 2, ["no such file or directory"]),
    "no_bag": Case({"input_bag": str(FOLDER / "directory")}, 2, ["it has no metadata.yaml"]),
    "no_bag_file": Case({"input_bag": str(FOLDER / "file.txt")}, 2, ["got 'file.txt'"]),
    "damaged": Case(
        {"input_bag": str(FOLDER / "damaged")}, 2, ["can't be read as a rosbag2 recording"]
    ),
    "other_type": Case(
        {"input_bag": str(FOLDER / "text")},
        2,
        ["expected one topic of type", "/chatter  std_msgs/msg/String"],
    ),
    "other_type_named": Case(
        {"input_bag": str(FOLDER / "text"), "input_topic": "/chatter"},
        2,
        ["topic /chatter: expected type", "got std_msgs/msg/String"],
    ),
    "no_topic": Case(
        {"input_topic": "/arm/joint_states"},
        2,
        ["has no topic /arm/joint_states", "/joint_states  sensor_msgs/msg/JointState  1000"],
    ),
    "joint_missing": Case(
        {"joints": ["shoulder"]}, 2, ["expected the joints shoulder, got only gripper, swing"]
    ),
    "no_velocity": Case(
        {"input_bag": str(FOLDER / "no_velocity")}, 2, ["message 1: velocity: expected 2 numbers"]
    ),
    "no_effort": Case(
        {"input_bag": str(FOLDER / "no_effort")}, 2, ["message 1: effort: expected 2 numbers"]
    ),
    "left_out": Case(
        {"input_bag": str(FOLDER / "one_missing")}, 0, ["1 of 50 messages left out"], "WARN"
    ),
    "plans": Case(
        {"input_bag": str(FOLDER / "plans")}, 2, ["expected one trajectory", "got 2 messages"]
    ),
    "exists": Case(
        {"output_bag": str(FOLDER / "exists")}, 2, ["exists: expected a name that is free"]
    ),
    "unwritable": Case({"output_bag": str(FOLDER / "file.txt" / "out")}, 2, ["can be written"]),
}


def generate_test_description():
    make_recordings()
    nodes = [case.make_node(name) for name, case in CASES.items()]
    one_after_the_other = [
        RegisterEventHandler(OnProcessExit(target_action=before, on_exit=[node]))
        for before, node in pairwise(nodes)
    ]
    # The tests may end after the last program.
    return LaunchDescription([*one_after_the_other, nodes[0], KeepAliveProc(), ReadyToTest()])


class TestRuns(unittest.TestCase):
    def test_each_ends_as_it_should_and_says_why(self, proc_info, proc_output):
        for name, case in CASES.items():
            with self.subTest(name):
                proc_info.assertWaitForShutdown(process=case.node, timeout=120)
                self.assertEqual(proc_info[case.node].returncode, case.code)
                said = "".join(o.text.decode() for o in proc_output[case.node])
                for text in case.says:
                    self.assertIn(text, said)
                self.assertIn(f"[{case.level}]", said)
                if case.written:
                    self.assertNotIn("[FATAL]", said)


@launch_testing.post_shutdown_test()
class TestRecordings(unittest.TestCase):
    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(FOLDER)

    def test_are_there_whole_or_not_at_all(self):
        for name, case in CASES.items():
            with self.subTest(name):
                self.assertEqual((FOLDER / f"out_{name}" / "metadata.yaml").exists(), case.written)
        self.assertEqual(list((FOLDER / "exists").iterdir()), [])
        self.assertEqual([p for p in FOLDER.iterdir() if p.name.endswith(".part")], [])

    def test_keep_stamps_and_hold_computed_and_measured_torques(self):
        for name in ("fine", "mcap", "to_mcap", "file"):
            topics = read_bag(FOLDER / f"out_{name}")
            self.assertEqual(set(topics), {"/torques", "/torques_gt"})
            for topic in topics.values():
                self.assertEqual(len(topic), 1000)
            for (message, received), (original, original_received), (measured, _) in zip(
                topics["/torques"], recordings.joint_states(), topics["/torques_gt"], strict=True
            ):
                self.assertEqual(received, original_received)
                self.assertEqual(message.header, original.header)
                self.assertEqual(message.name, ["swing"])
                self.assertEqual(list(message.position), [original.position[1]])
                self.assertEqual(list(measured.effort), [original.effort[1]])
                self.assertAlmostEqual(message.effort[0], measured.effort[0], delta=0.05)
        self.assertTrue(list((FOLDER / "out_to_mcap").glob("*.mcap")))
        self.assertTrue(list((FOLDER / "out_mcap").glob("*.mcap")))
        self.assertTrue(list((FOLDER / "out_fine").glob("*.db3")))

    def test_fill_the_efforts_of_trajectories(self):
        for name in ("trajectory", "plan"):
            topics = read_bag(FOLDER / f"out_{name}", JointTrajectory)
            ((filled, received),) = topics["/torques"]
            original = recordings.trajectory()
            self.assertEqual(received, 7)
            self.assertEqual(filled.header, original.header)
            self.assertEqual("/torques_gt" in topics, name == "trajectory")
            for point, as_was in zip(filled.points, original.points, strict=True):
                self.assertEqual(point.time_from_start, as_was.time_from_start)
                self.assertEqual(point.accelerations, as_was.accelerations)
                self.assertAlmostEqual(point.effort[0], as_was.effort[0] - 0.25, delta=1e-6)

    def test_are_those_of_the_command_line_to_the_last_bit(self, proc_output):
        ids = os.environ.get("IDS_COMMAND") or shutil.which("ids")
        if ids is None:
            self.skipTest("the command ids is not installed")
        changes = ["--accelerations", "low-pass", "--cutoff", "4"]
        for name, options in {"fine": [], "robot": [], "robot_changed": changes}.items():
            out = FOLDER / f"ids_{name}"
            command = [ids, "evaluate", GOOD, "--robot", ROBOT, "--out", out, "--storage", "mcap"]
            run = subprocess.run([*command, *options], check=True, capture_output=True, text=True)
            ours = read_bag(FOLDER / f"out_{name}")
            theirs = read_bag(next((out / "bag").glob("*.mcap")), storage="mcap")
            for topic in ("/torques", "/torques_gt"):
                self.assertEqual(len(ours[topic]), 1000)
                self.assertEqual(bits(ours[topic]), bits(theirs[topic]))
            said = "".join(o.text.decode() for o in proc_output[CASES[name].node])
            table = [line.split() for line in said.splitlines()]
            for line in run.stdout.splitlines():
                if line.split()[:1] in (["joint"], ["swing"]):
                    self.assertIn(line.split(), table)

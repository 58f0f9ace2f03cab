# SPDX-License-Identifier: Apache-2.0
"""The launch files: as a user calls them, from arguments to recording."""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from launch import LaunchDescription
from launch_testing.actions import ReadyToTest
from launch_testing.util import KeepAliveProc

sys.path.insert(0, str(Path(__file__).parent))
import recordings
from recordings import PENDULUM, SOLVER, JointState, read_bag, stamp, write_bag

FOLDER = Path(tempfile.mkdtemp())
ROBOTS = {
    "ur10_simulated": "ur10",
    "ur10_real": "ur10",
    "panda_simulated": "panda",
    "panda_real": "panda",
}
JOINTS = {
    "ur10": [
        "shoulder_pan_joint",
        "shoulder_lift_joint",
        "elbow_joint",
        "wrist_1_joint",
        "wrist_2_joint",
        "wrist_3_joint",
    ],
    "panda": [f"fer_joint{i}" for i in range(1, 8)],
}


def generate_test_description():
    return LaunchDescription([KeepAliveProc(), ReadyToTest()])  # tests start what they test


def arm_states(joints):
    """All joints of an arm in motion, in another order than the chain's; efforts are anything."""
    messages = []
    for k in range(400):
        t = 1.0 + 0.01 * k
        q, qd, _ = recordings.motion(t)
        message = JointState(name=joints[::-1])
        message.header.stamp = stamp(t)
        message.position = [q * (j + 1) / 10 for j in range(len(joints))]
        message.velocity = [qd * (j + 1) / 10 for j in range(len(joints))]
        message.effort = [10.0 * q] * len(joints)
        messages.append((message, round(1e9 * t)))
    return messages


def launch(*arguments, package="inverse_dynamics_ros"):
    """`ros2 launch PACKAGE ...`, with what it says."""
    return subprocess.run(
        ["ros2", "launch", *filter(None, [package]), *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
        check=False,
    )


class TestLaunchFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        write_bag(FOLDER / "pendulum", {"/joint_states": recordings.joint_states(200)})
        for robot, joints in JOINTS.items():
            write_bag(FOLDER / robot, {"/joint_states": arm_states(joints)})

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(FOLDER)

    def evaluate(self, *arguments, name="out"):
        return launch(
            "evaluate_solver.launch.py",
            f"input_bag:={FOLDER / 'pendulum'}",
            f"output_bag:={FOLDER / name}",
            f"plugin_name:={SOLVER}",
            *arguments,
        )

    def test_evaluate_any_robot(self):
        run = self.evaluate(f"robot_description:={PENDULUM}", "gravity:=[0, 0, -1]", "tip:=rod")
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("swing", run.stdout)
        first, _ = read_bag(FOLDER / "out")["/torques"][50]
        q, _, qdd = recordings.motion(1.5)
        weight = recordings.MASS * recordings.LENGTH
        expected = weight * (recordings.LENGTH * qdd + 1.0 * recordings.math.sin(q))
        self.assertAlmostEqual(first.effort[0], expected, delta=0.02)

    def test_compare_currents_by_drive_gains(self):
        run = self.evaluate(
            f"robot_description:={PENDULUM}", "effort:=current", "drive_gains:=2", name="currents"
        )
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("says, with drive gains 2 N m/A", run.stdout)
        measured, _ = read_bag(FOLDER / "currents")["/torques_gt"][0]
        self.assertEqual(measured.effort[0], 2 * recordings.joint_state(1.0).effort[1])

    def test_take_a_run_configuration_and_what_replaces_parts_of_it(self):
        (FOLDER / "pendulum.urdf").write_text(PENDULUM)
        robot = FOLDER / "pendulum.yaml"
        robot.write_text(
            f"schema: 1\nname: pendulum\ndescription: a pendulum\nplugin: {SOLVER}\n"
            "urdf: pendulum.urdf\neffort: current\ndrive_gains: [2]\ngravity: [0, 0, -1]\n"
        )
        command = ["evaluate_solver.launch.py", f"input_bag:={FOLDER / 'pendulum'}"]
        run = launch(*command, f"output_bag:={FOLDER / 'robot'}", f"robot:={robot}")
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("as the run configuration says, with drive gains 2 N m/A", run.stdout)
        changed = ["effort:=torque", "gravity:=[0, 0, -2]", "friction:=false"]
        run = launch(*command, f"output_bag:={FOLDER / 'changed'}", f"robot:={robot}", *changed)
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("effort means: torque, ", run.stdout)
        weight = recordings.MASS * recordings.LENGTH
        for name, gravity in {"robot": 1.0, "changed": 2.0}.items():
            first, _ = read_bag(FOLDER / name)["/torques"][50]
            q, _, qdd = recordings.motion(1.5)
            expected = weight * (recordings.LENGTH * qdd + gravity * recordings.math.sin(q))
            self.assertAlmostEqual(first.effort[0], expected, delta=0.02)
        robot.write_text(robot.read_text().replace("gravity", "gravty"))
        run = launch(*command, f"output_bag:={FOLDER / 'not_written'}", f"robot:={robot}")
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn("pendulum.yaml:8: gravty: unknown key; did you mean gravity?", run.stdout)

    def test_have_the_data_tell_what_efforts_mean(self):
        run = self.evaluate(f"robot_description:={PENDULUM}", "effort:=auto", name="auto")
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("effort means: torque, ", run.stdout)
        run = launch("live.launch.py", f"plugin_name:={SOLVER}", "effort:=auto")
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn("effort", run.stdout)

    def test_end_with_an_error_where_the_program_does(self):
        run = self.evaluate(name="not_written")
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn("robot description: missing", run.stdout)
        self.assertIn("ended with exit code 2", run.stdout)
        run = self.evaluate(f"robot_description:={PENDULUM}", "gravity:=down", name="not_written")
        self.assertEqual(run.returncode, 1)
        self.assertIn("argument gravity: expected three numbers, [0, 0, -9.81]", run.stdout)
        run = self.evaluate("drive_gains:=2;3", name="not_written")
        self.assertIn("argument drive_gains: expected numbers", run.stdout)
        run = self.evaluate("effort:=volts", name="not_written")
        self.assertEqual(run.returncode, 1)
        self.assertIn("effort", run.stdout)
        self.assertFalse((FOLDER / "not_written").exists())

    def test_refuse_an_argument_that_they_do_not_have(self):
        (FOLDER / "outer.launch.py").write_text(
            "from inverse_dynamics_ros.launch_files import launch_file\n"
            "from launch import LaunchDescription\n"
            "from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription\n"
            "from launch.launch_description_sources import PythonLaunchDescriptionSource\n"
            "def generate_launch_description():\n"
            "    inner = PythonLaunchDescriptionSource(launch_file('evaluate_solver.launch.py'))\n"
            f"    bags = {{'input_bag': '{FOLDER / 'ur10'}', 'output_bag': '{FOLDER / 'included'}'}}\n"
            "    return LaunchDescription([DeclareLaunchArgument('cutof'),"
            " IncludeLaunchDescription(inner, launch_arguments=bags.items())])\n"
        )
        robot = [f"input_bag:={FOLDER / 'ur10'}", f"output_bag:={FOLDER / 'not_written'}"]
        for command in (
            ["live.launch.py", f"plugin_name:={SOLVER}"],
            ["evaluate_solver.launch.py", *robot],
        ):
            run = launch(*command, "cutof:=3")
            self.assertEqual(run.returncode, 1, run.stdout)
            self.assertIn("argument cutof: ", run.stdout)
            self.assertIn("did you mean cutoff?", run.stdout)
        run = launch("ur10_real.launch.py", *robot, "speed:=3")
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn("doesn't have it; expected one of input_bag, ", run.stdout)
        self.assertFalse((FOLDER / "not_written").exists())
        outer = [str(FOLDER / "outer.launch.py"), "robot:=ur10_simulated", "cutof:=3"]
        run = launch(*outer, package="")
        self.assertEqual(run.returncode, 0, run.stdout)

    def test_evaluate_each_of_the_four_robots(self):
        for name, arm in ROBOTS.items():
            with self.subTest(name):
                out = FOLDER / f"out_{name}"
                run = launch(
                    f"{name}.launch.py",
                    f"input_bag:={FOLDER / arm}",
                    f"output_bag:={out}",
                    "topic:=/tau",
                )
                self.assertEqual(run.returncode, 0, run.stdout)
                self.assertIn(f"inverse_dynamics_robots/urdf/{arm}.urdf", run.stdout)
                topics = read_bag(out)
                self.assertEqual(len(topics["/tau"]), 400)
                self.assertEqual(topics["/tau"][0][0].name, JOINTS[arm])
                self.assertEqual(set(topics), {"/tau", "/tau_gt"})

    def test_forward_the_names_of_the_reference_implementation(self):
        command = [f"input_bag:={FOLDER / 'ur10'}", f"output_bag:={FOLDER / 'forwarded'}"]
        run = launch(
            "evaluate_solver_ur10.launch.py", *command, package="ur10_inverse_dynamics_solver"
        )
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertEqual(len(read_bag(FOLDER / "forwarded")["/torques"]), 400)
        run = subprocess.run(
            ["ros2", "run", "inverse_dynamics_solver", "evaluate_solver"],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("input_bag", run.stdout + run.stderr)

    def test_say_which_argument_of_a_program_is_wrong(self):
        command = ["ros2", "run", "inverse_dynamics_ros", "live", "--ros-args", "-p"]
        for argument, text in {
            "joints:=": "'-p joints:='",
            "joints:=a": "parameter 'joints' has invalid type",
            "joints:=[a,b]": "parameter 'joints': expected 6 names",
        }.items():
            words = [*command, argument, "-p", "robot:=ur10_simulated"]
            run = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(text, run.stderr)

    def test_run_the_live_node(self):
        command = ["ros2", "launch", "inverse_dynamics_ros", "live.launch.py"]
        command += [
            f"plugin_name:={SOLVER}",
            f"robot_description:={PENDULUM}",
            "reliability:=reliable",
            "external_torques:=true",
            "name:=arm",
            "namespace:=left",
        ]
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        try:
            lines = []
            for line in process.stdout:
                lines.append(line)
                if "1 joints: swing" in line:
                    break
            self.assertIn("1 joints: swing", "".join(lines))
            self.assertIn("[left.arm]: ", "".join(lines))
            self.assertIn("external torques: momentum observer; wrench: none", "".join(lines))
        finally:
            process.send_signal(2)
            process.communicate(timeout=60)

# SPDX-License-Identifier: Apache-2.0
"""The launch files and send_motion as a user calls them: what they explain, and bad input."""

import subprocess
import unittest

from launch import LaunchDescription
from launch_testing.actions import ReadyToTest
from launch_testing.util import KeepAliveProc

PATIENCE = 120.0
"""For a program to end [s], on a busy computer."""


def generate_test_description():
    return LaunchDescription([KeepAliveProc(), ReadyToTest()])  # tests start what they test


def run(*command):
    """What a command says, and its exit code."""
    ended = subprocess.run(
        ["ros2", *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    return ended.stdout, ended.returncode


def simulated(*arguments):
    return run("launch", "inverse_dynamics_simulation", "simulated.launch.py", *arguments)


def send_motion(*arguments):
    return run("run", "inverse_dynamics_simulation", "send_motion", *arguments)


class TestAsAUser(unittest.TestCase):
    def test_the_launch_file_explains_its_arguments(self):
        said, code = simulated("--show-args")
        assert code == 0, said
        assert "no description given" not in said
        for argument in ("robot", "controller", "config", "payload", "bag"):
            assert f"'{argument}':" in said

    def test_an_argument_that_is_wrong_ends_the_launch(self):
        cases = {
            "robot:=ur5": "Valid options are: ['ur10', 'panda']",
            "config:=nowhere.yaml": "argument config: expected a parameter file, got "
            "'nowhere.yaml': no such file",
            "payload:=heavy": "argument payload: expected a number, got 'heavy'",
        }
        for argument, expected in cases.items():
            with self.subTest(argument):
                said, code = simulated(argument)
                assert code == 1, said
                assert expected in said

    def test_a_simulation_that_cannot_start_ends_the_launch(self):
        said, code = simulated("payload:=-1")
        assert code == 1, said
        assert "[FATAL]" in said
        assert "ur10: parameter payload: expected a mass [kg], got '-1.0'" in said
        assert "ended with exit code 1" in said

    def test_send_motion_says_what_does_not_come(self):
        said, code = send_motion("nobody", "--amplitudes", "1", "--timeout", "1")
        assert code == 1, said
        assert "send_motion: /joint_states didn't come within 1 s" in said

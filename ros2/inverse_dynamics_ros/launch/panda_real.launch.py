# SPDX-License-Identifier: Apache-2.0
"""Torques of a recording of a real Franka Emika Panda, by the model identified on one.

ros2 launch inverse_dynamics_ros panda_real.launch.py input_bag:=recording output_bag:=result
ros2 launch inverse_dynamics_ros panda_real.launch.py --show-args
"""

from inverse_dynamics_ros.launch_files import evaluate_robot


def generate_launch_description():
    """What `ros2 launch` asks for."""
    return evaluate_robot("panda_real")

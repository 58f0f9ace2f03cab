# SPDX-License-Identifier: Apache-2.0
"""The reference implementation's name of `ros2 launch inverse_dynamics_ros ur10_real.launch.py`."""

from inverse_dynamics_ros.launch_files import forward


def generate_launch_description():
    """What `ros2 launch` asks for."""
    return forward("ur10_real.launch.py")

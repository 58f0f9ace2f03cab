# SPDX-License-Identifier: Apache-2.0
"""A motion to record as files: for `ids simulate`, and as a message to send."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.simulation.trajectory import trajectory_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.excitation.excite import ExcitationResult
    from inverse_dynamics.simulation.trajectory import WaypointTrajectory

LEAD_IN = 3.0  # s from the start of the trajectory to send to its first point


def motion_text(result: ExcitationResult) -> str:
    """The motion for `ids simulate`."""
    source = f"Exciting motion of {result.robot.name} for "
    if result.options.payload:  # the rest of the arm rests
        source += "a payload, made by ids excite."
    else:
        condition = result.excitation.condition_number
        source += f"identification, made by ids excite: condition number of the base regressor {condition:.4g}."
    return trajectory_text(result.excitation.trajectory, source)


def message_text(
    trajectory: WaypointTrajectory, joint_names: Sequence[str], step: float | None = None
) -> str:
    """A trajectory_msgs/JointTrajectory as YAML, as `ros2 topic pub` takes it.

    The first point, where the arm is at rest, comes after LEAD_IN. Points at the waypoints are
    enough for a controller that joins points by polynomials of the fifth order.
    """
    time = trajectory.times
    if step is not None:
        time = np.linspace(0.0, trajectory.duration, 1 + int(np.ceil(trajectory.duration / step)))
    lines = ["header: {stamp: {sec: 0, nanosec: 0}, frame_id: ''}"]
    lines += [f"joint_names: [{', '.join(joint_names)}]", "points:"]
    for t, *state in zip(time, *trajectory.at(time), strict=True):
        stamp = round((LEAD_IN + t) * 1e9)
        lines += [
            f"{'-' if key == 'positions' else ' '} {key}: [{', '.join(f'{v:.9g}' for v in values)}]"
            for key, values in zip(("positions", "velocities", "accelerations"), state, strict=True)
        ]
        sec, nanosec = divmod(stamp, 10**9)
        lines.append(f"  time_from_start: {{sec: {sec}, nanosec: {nanosec}}}")
    return "\n".join(lines) + "\n"

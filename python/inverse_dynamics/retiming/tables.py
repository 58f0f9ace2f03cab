# SPDX-License-Identifier: Apache-2.0
"""The load of each joint as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.show.tables import ReportTable, of_joints

if TYPE_CHECKING:
    from inverse_dynamics.retiming.retiming import Retimed


def retime_table(result: Retimed) -> ReportTable:
    """Of each joint: its greatest torque and velocity, and how long it is at its torque limit."""
    columns = {
        "peak": np.abs(result.efforts).max(axis=0),
        "limit": result.limits.torque,
        "at limit [% of time]": 100 * result.at_limit,
        "velocity [rad/s, m/s]": np.abs(result.qd).max(axis=0),
    }
    return of_joints("Load of each joint", result.joint_names, result.units, columns)

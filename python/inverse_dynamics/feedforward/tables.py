# SPDX-License-Identifier: Apache-2.0
"""The torques of a trajectory as a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from inverse_dynamics.show.tables import ReportTable

if TYPE_CHECKING:
    from inverse_dynamics.feedforward.trajectory_torques import TrajectoryTorques


def load_table(result: TrajectoryTorques) -> ReportTable:
    """Greatest torque of each joint and, where it exceeds the limit, when it first does."""

    def moment(time: float, trajectory: int | None) -> str:
        return f"{time:.3f} s" + (f" of trajectory {trajectory}" if len(result.times) > 1 else "")

    rows = []
    for load in result.loads:
        limited = math.isfinite(load.limit)
        passed = "-" if limited else "not known"
        if load.passed_time is not None:
            passed = f"first at {moment(load.passed_time, load.passed_trajectory)}"
        limit = f"{load.limit:g} {load.unit}" if limited else "-"
        peak = f"{load.peak:.3f} {load.unit}"
        rows.append((load.joint, peak, moment(load.peak_time, load.peak_trajectory), limit, passed))
    return ReportTable("", ("joint", "peak", "at", "limit", "passes its limit"), rows)

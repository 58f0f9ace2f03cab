# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with a wish for a simulation."""

from __future__ import annotations

from inverse_dynamics.errors import UserError


class SimulationError(UserError):
    """A robot that can't be simulated, or an option that makes no sense."""


class TrajectoryError(UserError):
    """A trajectory that can't be read, or one that the robot can't follow."""

# SPDX-License-Identifier: Apache-2.0
"""Errors of simulations."""

from inverse_dynamics.errors import UserError


class SimulationError(UserError):
    """A robot that can't be simulated, or an option out of range."""


class TrajectoryError(UserError):
    """A trajectory that can't be read, or one that the robot can't follow."""

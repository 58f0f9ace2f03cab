# SPDX-License-Identifier: Apache-2.0
"""The meanings that recorded efforts can have, by name."""

from __future__ import annotations

# What each meaning has compared with the computed torques, as --help says it.
EFFORT_MEANINGS = {
    "torque": "torques, compared as they are",
    "current": "motor currents, compared times the drive gains",
    "torque_without_gravity": "torques as newer UR drivers send them, compared with computed "
    "torques minus gravity",
}
EFFORT_CHOICES = {**EFFORT_MEANINGS, "auto": "the one that clearly fits the data, if there is one"}

# SPDX-License-Identifier: Apache-2.0
"""Choices of a run configuration, by name: filters, and meanings of recorded efforts."""

from __future__ import annotations

# Help text of each meaning: what is compared with the computed torques.
EFFORT_MEANINGS = {
    "torque": "torques, compared as they are",
    "current": "motor currents, compared times the drive gains",
    "torque_without_gravity": "torques without gravity, as newer UR drivers send them, compared with computed "
    "torques minus gravity",
}
EFFORT_CHOICES = {
    **EFFORT_MEANINGS,
    "auto": "the meaning that clearly fits the data, if there is one",
}

# Help text of each method of estimating accelerations.
METHODS = {
    "auto": "accelerations of the recording if it has any, else low-pass with a cut-off chosen from the data",
    "low-pass": "zero-phase low-pass of the velocities, then their derivative",
    "given": "accelerations of the recording",
    "backward-difference": "(qd[k] - qd[k-1]) / (t[k] - t[k-1]), the first one zero; no filter",
}

RULES = {  # of samples: inverse_dynamics_evaluation/samples.hpp
    "repeated": "samples that repeat the previous one are left out of the differentiation",
    "non-increasing": "samples whose stamp isn't later than all previous ones are left out of it too",
    "time-base": "stamps that contradict positions and velocities are replaced by equidistant ones",
    "start-transient": "efforts that jump at the very start are left out of the second metrics",
}

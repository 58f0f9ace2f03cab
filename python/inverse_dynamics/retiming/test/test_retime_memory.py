# SPDX-License-Identifier: Apache-2.0
"""Torques of timed paths where friction remembers the motion before."""

import numpy as np
import pytest

from inverse_dynamics import MotionLimits, load_robot, retime
from inverse_dynamics._core import sample_times

ROBOT = "ur10_salerno_identified"
FAR = 20.0  # rad, over which friction forgets what was before
PLAY = 5e-5  # rad, of the memory
WAYPOINTS = np.array(
    [
        [0.0, -1.0, 1.0, 0.0, 0.0, 0.0],
        [0.5, -1.5, 1.5, 0.5, 0.3, 0.0],
        [1.5, -1.2, 0.8, 0.2, 1.3, 0.4],
        [2.0, -0.5, 0.5, 0.0, 1.0, 1.0],
    ]
)
TORQUE = 0.6 * np.array([330.0, 330.0, 150.0, 56.0, 56.0, 56.0])


@pytest.fixture(scope="module")
def solver():
    return load_robot(ROBOT).solver()


def came_from(solver, side):
    state = solver.friction_state()
    state.move(WAYPOINTS[0] + side * FAR)
    state.move(WAYPOINTS[0] - side * PLAY)  # and back to its middle
    return state


@pytest.mark.parametrize("given", [{}, {"deviation": 0.0}, {"duration": 6.0}, {"weight": 0.01}])
def test_use_is_that_of_the_worst_motion_before_and_within_limits(solver, given):
    motion = retime(WAYPOINTS, ROBOT, MotionLimits(torque=TORQUE), rate=2000.0, **given)
    state = motion.q, motion.qd, motion.qdd
    use = [
        (solver.torques(*state) + came_from(solver, side).along(*state[:2])) / TORQUE
        for side in (-1.0, 1.0)
    ]
    worst = np.abs(use).max(axis=0)
    np.testing.assert_allclose(np.abs(motion.use), worst, atol=1e-9)
    assert worst.max() < 1.003


def test_efforts_have_what_friction_remembers(solver):
    motion = retime(WAYPOINTS, ROBOT, MotionLimits(torque=TORQUE), compare=False)
    state = motion.q, motion.qd, motion.qdd
    remembered = solver.friction_state().along(*state[:2])
    assert np.abs(remembered).max() > 1.0
    np.testing.assert_array_equal(motion.efforts, solver.torques(*state) + remembered)


def test_constant_acceleration_keeps_limits_whatever_the_motion_before_was(solver):
    other = retime(WAYPOINTS, ROBOT, MotionLimits(torque=TORQUE)).by_acceleration
    state = other.states(sample_times(other.duration, 2000.0))
    for side in (-1.0, 1.0):
        torques = solver.torques(*state) + came_from(solver, side).along(*state[:2])
        assert (np.abs(torques) / TORQUE).max() < 1.003

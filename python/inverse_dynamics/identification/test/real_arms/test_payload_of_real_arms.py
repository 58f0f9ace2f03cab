# SPDX-License-Identifier: Apache-2.0
"""How good estimates of payloads are: simulated loads on the real residuals of a real arm.

The arm's model is identified from what the recording has outside of the window of the load, with the
law, prior strength and delay that `ids identify` chooses, and its residuals stay in the torques.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[5] / "scripts" / "studies"))
from payload_truth import Arm, trials

TRIALS = 100

# Medians: relative error of the mass, distance of the center of mass [m]; half widths of mass and
# center by their errors.
# The model of the arm is taken for exact, or what it may be wrong by is estimated with the load.
MOST = {
    ("panda", 1.0, 4.0, "exact"): (0.015, 0.010, 4.0, 4.0),  # 30 Hz
    ("panda", 1.0, 8.0, "exact"): (0.015, 0.007, 4.0, 4.0),
    ("panda", 1.0, 8.0, "uncertain"): (0.010, 0.007, 4.0, 4.0),
    ("ur10", 5.0, 4.0, "exact"): (0.012, 0.010, 5.0, 4.0),
    ("ur10", 5.0, 8.0, "uncertain"): (0.012, 0.010, 4.0, 4.5),  # wrist 3 creeps
}


@pytest.fixture(scope="module")
def arm_of(identified, tmp_path_factory):
    """Arms by name and length of the windows [s], each made once."""
    return cache(
        lambda name, seconds: Arm.of(
            identified(name), tmp_path_factory.mktemp(name), seconds=seconds
        )
    )


@pytest.mark.parametrize(
    ("name", "mass", "seconds", "model"),
    [pytest.param(*case, marks=pytest.mark.nightly if case[0] == "ur10" else ()) for case in MOST],
)
def test_simulated_loads_on_real_residuals(arm_of, name, mass, seconds, model):
    arm = arm_of(name, seconds)
    if model == "exact":
        arm = arm.taken_for_exact()
    figures = trials(arm, mass, TRIALS)
    most_mass, most_center, most_ratio, most_ratio_of_center = MOST[name, mass, seconds, model]
    assert figures.mass <= most_mass, figures
    assert figures.center <= most_center, figures
    assert 0.90 <= figures.coverage <= 0.99, figures
    assert figures.ratio_of_mass <= most_ratio, figures
    assert figures.ratio_of_center <= most_ratio_of_center, figures

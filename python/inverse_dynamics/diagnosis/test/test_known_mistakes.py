# SPDX-License-Identifier: Apache-2.0
"""Which causes are named for recordings with a known mistake: a short form of `./scripts/study causes`."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from inverse_dynamics import evaluate

sys.path.insert(0, str(Path(__file__).resolve().parents[4] / "scripts" / "studies"))
from causes_study import outcomes_of, shares_of
from described_arms import OWN, arm_of
from known_mistakes import Recording, drafted, real_recordings
from known_mistakes import recordings as recordings_with_mistakes

MOST_WRONG, MOST_MISSED = 0.03, 0.05  # one of so few is 3 %; of the whole set 1 % are wrong


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    directory = tmp_path_factory.mktemp("set")
    made = recordings_with_mistakes(seed=12, wheels=directory, arms=OWN)
    return outcomes_of(made, directory)


def test_no_wrong_cause_is_named(outcomes):
    assert shares_of(outcomes)["wrong"] <= MOST_WRONG
    assert shares_of(outcomes)["missed"] <= MOST_MISSED


def test_an_arm_without_a_mistake_is_accused_of_none(outcomes):
    assert sum(not outcome.mistakes for outcome in outcomes) >= len(outcomes) / 5
    assert shares_of(outcomes)["false alarm"] == 0


def test_real_arms_are_accused_of_nothing_but_friction(recordings, tmp_path):
    made = [made for made in real_recordings(recordings, seed=1) if not made.mistakes]
    assert not [o.recording for o in outcomes_of(made, tmp_path) if o.verdict != "right"]


def test_torques_of_an_arm_worked_by_hand(tmp_path):
    """The slider of a SCARA points down: it carries 1.5 kg and what is beyond it, against gravity."""
    arm = arm_of("scara", tmp_path)
    q = np.array([[0.3, -0.5, 0.1, 0.2]])
    acceleration = np.array([[0.0, 0.0, 2.0, 0.0]])
    tau = arm.torques(q, 0 * q, acceleration)
    np.testing.assert_allclose(tau[0], [0.0, 0.0, 2.1 * (2.0 - 9.81), 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("name", "scales", "unit"),
    [("scara", [1000, 1000, 1, 1000], "N mm"), ("gantry", [0.67, 0.62, 0.42, 0.102, 0.102], "")],
)
def test_joints_that_slide_have_one_scale(tmp_path, name, scales, unit):
    """A free scale of each slider is no unit, though the hinge's is that of kgf m."""
    draft, _ = drafted(arm_of(name, tmp_path), np.random.default_rng(0), fast=True)
    draft.scale("effort", np.array(scales))
    recording = Recording(name, draft, mistakes=())
    text = " ".join(cause.reason for cause in evaluate(*recording.write(tmp_path)).diagnosis)
    assert re.findall("they are in (.*)", text) == [unit] * bool(unit), text

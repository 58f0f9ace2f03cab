# SPDX-License-Identifier: Apache-2.0
"""Part of the sweep over hostile input; scripts/sweep runs all of it."""

import subprocess
import sys
from pathlib import Path

import pytest

SWEEP = Path(__file__).parent / "sweep"
# One case of so many: a few seconds per group. Not a divisor of how often kinds of cases repeat.
EVERY = {"urdf": 13, "model": 59, "robot": 7, "parameter": 3}
EVERY_AT_NIGHT = {"model": 29, "robot": 3, "parameter": 1}


@pytest.mark.parametrize(
    ("group", "every"),
    [
        *EVERY.items(),
        *(pytest.param(*part, marks=pytest.mark.nightly) for part in EVERY_AT_NIGHT.items()),
    ],
)
def test_hostile_input_is_refused_or_warned_of(group: str, every: int) -> None:
    command = [sys.executable, str(SWEEP), group, "--wrong", "--every", str(every)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr

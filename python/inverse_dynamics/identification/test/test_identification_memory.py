# SPDX-License-Identifier: Apache-2.0
"""A fit takes no more memory for a longer recording: samples are gone through in batches."""

from __future__ import annotations

import subprocess
import sys

import pytest

SAMPLES = 400_000
MOST = 10  # MB; one number per joint and sample would be 22

PROGRAM = f"""
import resource, sys
import numpy as np
import inverse_dynamics as ids
from inverse_dynamics import _core
from inverse_dynamics.robots.descriptions import read_description

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

robot = ids.load_robot("panda_simulated")
fitter = _core.ArmFitter.from_urdf(read_description(robot.urdf), root=robot.root, tip=robot.tip)
n, random = len(fitter.joint_names), np.random.default_rng(1)

def block(samples):
    arrays = np.empty((4, samples, n))
    random.random(out=arrays)
    return tuple(arrays)

options = _core.ArmFitOptions("load", prior_strength=100.0, most_passes=1)
fitter.fit(fitter.data([block(1000)]), options)
long = block({SAMPLES})
before = peak()
data = fitter.data([long])
fitter.information(fitter.fit(data, options), data, options)
print(peak() - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="memory is in other units")
def test_a_fit_of_400_000_samples_takes_no_memory_besides_them():
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True
    )
    assert float(done.stdout) <= MOST

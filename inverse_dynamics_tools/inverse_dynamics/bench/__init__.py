# SPDX-License-Identifier: Apache-2.0
"""How fast this machine computes inverse dynamics, beside other libraries.

    from inverse_dynamics.bench import measure, page

    print(page(measure()))

The programs that measure are those of the package inverse_dynamics_benchmarks.
"""

from inverse_dynamics.bench.asked import Bound, bounds
from inverse_dynamics.bench.measurement import Measurement, read_measurement, write_measurement
from inverse_dynamics.bench.pages import page, updated
from inverse_dynamics.bench.running import BenchmarkError, measure

__all__ = [
    "BenchmarkError",
    "Bound",
    "Measurement",
    "bounds",
    "measure",
    "page",
    "read_measurement",
    "updated",
    "write_measurement",
]

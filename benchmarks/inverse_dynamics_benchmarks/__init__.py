# SPDX-License-Identifier: Apache-2.0
"""How fast this machine computes inverse dynamics, beside other libraries: `ids bench`.

    from inverse_dynamics_benchmarks import measure, page

    print(page(measure()))

The programs that measure are in the same package. Names are imported when they are first used, as
every start of `ids` looks for its verbs.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics_benchmarks.asked import Bound, bounds
    from inverse_dynamics_benchmarks.measurement import (
        Measurement,
        read_measurement,
        write_measurement,
    )
    from inverse_dynamics_benchmarks.pages import page, updated
    from inverse_dynamics_benchmarks.running import BenchmarkError, measure

_HOME = {
    "BenchmarkError": "running",
    "Bound": "asked",
    "Measurement": "measurement",
    "bounds": "asked",
    "measure": "running",
    "page": "pages",
    "read_measurement": "measurement",
    "updated": "pages",
    "write_measurement": "measurement",
}

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


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)

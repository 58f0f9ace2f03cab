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
    from inverse_dynamics_benchmarks.measurement import (
        Measurement,
        read_measurement,
        write_measurement,
    )
    from inverse_dynamics_benchmarks.running import BenchmarkError, measure
    from inverse_dynamics_benchmarks.tables import page

_HOME = {
    "BenchmarkError": "running",
    "Measurement": "measurement",
    "measure": "running",
    "page": "tables",
    "read_measurement": "measurement",
    "write_measurement": "measurement",
}

__all__ = [
    "BenchmarkError",
    "Measurement",
    "measure",
    "page",
    "read_measurement",
    "write_measurement",
]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)

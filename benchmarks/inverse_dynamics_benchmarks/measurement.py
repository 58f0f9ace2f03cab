# SPDX-License-Identifier: Apache-2.0
"""What a run of the benchmarks measured, and its file.

The file is Google Benchmark's JSON, with less in it: of each benchmark the least of its
repetitions, and what a reader needs to judge them. `latency` stands beside `benchmarks`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from statistics import median
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import OutputError
from inverse_dynamics.outputs.files import write_text_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

# Neither who measured nor when.
_CONTEXT = (
    "processor",
    "num_cpus",
    "mhz_per_cpu",
    "load_avg",
    "load_avg_after",
    "repetitions",
    "median_by_least",
    "compiler",
    "compiler_flags",
    "optimized",
    "kernels",
    "kdl",
    "pinocchio",
    "mujoco",
    "casadi",
)
_ENTRY = ("name", "run_name", "run_type", "aggregate_name", "real_time", "cpu_time", "time_unit")
_LATENCY = (
    "name",
    "calls",
    "p50",
    "p99",
    "p99.99",
    "max",
    "slowest_state",
    "interruptions_per_second",
    "context_switches",
    "page_faults",
)


@dataclass(frozen=True)
class Measurement:
    """times: by name, `ROBOT/QUANTITY/LIBRARY`, in ns per state, the least of the repetitions."""

    context: Mapping[str, Any]
    times: Mapping[str, float]
    latency: tuple[Mapping[str, Any], ...] = ()
    document: Mapping[str, Any] = field(repr=False, default_factory=dict)

    def time(self, robot: str, quantity: str, library: str) -> float | None:
        """Time of one state, the least of the repetitions [ns]; None: not measured."""
        return self.times.get(f"{robot}/{quantity}/{library}")


def measurement(document: Mapping[str, Any], where: str) -> Measurement:
    """What Google Benchmark's JSON says. `where` begins the text of an OutputError."""
    try:
        context = dict(document["context"])
        entries = document["benchmarks"]
        least = [_trimmed(e) for e in entries if e.get("aggregate_name") == "min"]
        times, medians = _times(least, "min"), _times(entries, "median")
        if times.keys() == medians.keys() and times:
            context["median_by_least"] = round(median(medians[n] / t for n, t in times.items()), 3)
        latency = tuple({key: row[key] for key in _LATENCY} for row in document.get("latency", ()))
        if not times and not latency:
            raise ValueError("no entry with the aggregate_name 'min', and no latency")
        kept: dict[str, Any] = {
            "context": {key: context[key] for key in _CONTEXT if key in context},
            "benchmarks": least,
            "latency": list(latency),
        }
        return Measurement(kept["context"], times, latency, kept)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        what = f"no {error}" if isinstance(error, KeyError) else str(error)
        raise OutputError(
            f"{where}: expected a result of `ids bench --json`, got something else ({what}); "
            "measure again"
        ) from error


def read_measurement(file: Path) -> Measurement:
    """Read what write_measurement() wrote. Raises OutputError."""
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise OutputError(f"{file}: can't be read ({error.strerror or error})") from error
    except ValueError as error:
        raise OutputError(f"{file}: expected JSON of `ids bench --json`: {error}") from error
    return measurement(document, str(file))


def write_measurement(result: Measurement, file: Path) -> None:
    """Write it, one benchmark per line. Raises OutputError."""
    document = result.document
    parts = [f' "context": {json.dumps(document["context"], indent=2)}']
    for key in ("benchmarks", "latency"):
        lines = ",\n".join(f"  {json.dumps(entry)}" for entry in document[key])
        parts.append(f' "{key}": [\n{lines}\n ]')
    write_text_whole(file, "{\n" + ",\n".join(parts) + "\n}\n")


def _trimmed(entry: Mapping[str, Any]) -> dict[str, Any]:
    kept = {key: entry[key] for key in _ENTRY}
    for key in ("real_time", "cpu_time"):
        kept[key] = float(f"{entry[key]:.5g}")
    if "states" in entry:
        kept["states"] = entry["states"]
    return kept


def _times(entries: Iterable[Mapping[str, Any]], statistic: str) -> dict[str, float]:
    return {
        "/".join(entry["run_name"].split("/")[:3]): _per_state(entry)
        for entry in entries
        if entry.get("aggregate_name") == statistic
    }


def _per_state(entry: Mapping[str, Any]) -> float:
    if entry["time_unit"] != "ns":
        raise ValueError(f"time_unit: expected ns, got {entry['time_unit']}")
    real = entry["run_name"].endswith("/real_time")
    return float(entry["real_time" if real else "cpu_time"]) / float(entry.get("states", 1))

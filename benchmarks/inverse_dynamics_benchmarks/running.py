# SPDX-License-Identifier: Apache-2.0
"""Runs the benchmark programs of the package inverse_dynamics_benchmarks."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from inverse_dynamics.errors import UserError
from inverse_dynamics.installation.ament import PackageNotFoundError, package_share
from inverse_dynamics.wording import how_to_build, not_built
from inverse_dynamics_benchmarks.measurement import Measurement, measurement

if TYPE_CHECKING:
    from collections.abc import Sequence

PACKAGE = "inverse_dynamics_benchmarks"
_NAMES = (
    "; names are ROBOT/QUANTITY/LIBRARY, such as ur10/torques/ours (those of `ids bench --json`)"
)


class BenchmarkError(UserError):
    """Benchmarks that aren't installed, or that fail."""


def measure(
    *, repetitions: int = 20, seconds: float = 0.003, only: str = "", latency_calls: int = 0
) -> Measurement:
    """Measure this machine.

    repetitions: of each benchmark, two or more, in random order among the others; seconds: of each
    repetition; only: regular expression that names, `ROBOT/QUANTITY/LIBRARY`, must match;
    latency_calls: how many single calls are timed, 0: none. Raises BenchmarkError.
    """
    document = _speed(repetitions, seconds, only)
    document["context"]["repetitions"] = repetitions
    if latency_calls:
        output = _run([_program("inverse_dynamics_latency"), str(latency_calls)])
        document["latency"] = _parsed(output)
    if hasattr(os, "getloadavg"):
        document["context"]["load_avg_after"] = [round(load, 2) for load in os.getloadavg()]
    return measurement(document, "inverse_dynamics_benchmark")


def _speed(repetitions: int, seconds: float, only: str) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "speed.json"
        _run(
            [
                _program("inverse_dynamics_benchmark"),
                f"--benchmark_repetitions={repetitions}",
                f"--benchmark_min_time={seconds:g}",
                f"--benchmark_filter={only or '.'}",
                "--benchmark_enable_random_interleaving=true",
                "--benchmark_report_aggregates_only=true",
                f"--benchmark_out={file}",
                "--benchmark_out_format=json",
            ],
            result=file,
        )
        document: dict[str, Any] = _parsed(file.read_text(encoding="utf-8"))
        return document


def _program(name: str) -> str:
    try:
        program = package_share(PACKAGE).parents[1] / "bin" / name
    except PackageNotFoundError as error:
        raise BenchmarkError(not_built(PACKAGE)) from error
    if not program.is_file():
        raise BenchmarkError(
            f"{program}: not there: {PACKAGE} was built without Google Benchmark; install it (Debian: "
            f"apt install libbenchmark-dev), then {how_to_build(PACKAGE)}"
        )
    return str(program)


def _run(command: Sequence[str], result: Path | None = None) -> str:
    """Standard output. result: a file that the command must have written."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise BenchmarkError(
            f"{command[0]}: can't be run ({error.strerror or error}); build {PACKAGE} again"
        ) from error
    written = result is None or (result.is_file() and result.stat().st_size > 0)
    if done.returncode != 0 or not written:
        lines = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
        remedy = _NAMES if lines[-1].startswith("Failed to match any benchmarks") else ""
        raise BenchmarkError(f"{Path(command[0]).name} failed: {lines[-1]}{remedy}")
    return done.stdout


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError as error:
        raise BenchmarkError(f"a benchmark wrote something else than JSON: {error}") from error

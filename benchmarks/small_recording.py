#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""CPU that commands of ids take whose own work is small, in a sourced workspace.

python3 benchmarks/small_recording.py                  what takes seconds
python3 benchmarks/small_recording.py --demo           the demonstration too

User and system time of a process and its children, the least of some runs. Recordings: those of
`ids data`. The bare script is what any figure costs: matplotlib imported, as many panels drawn and
saved.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from inverse_dynamics.demo.demo import find_recordings

BARE = """\
from matplotlib.figure import Figure
figure = Figure(figsize=(11.0, 9.2))
for axes in figure.subplots(6, 2).flat:
    axes.plot(range(3441))
figure.savefig("bare.png", dpi=160)
"""


def cpu(command: list[str], directory: Path, runs: int) -> float:
    """Least user and system time of a command [s]."""
    times = []
    for _ in range(runs):
        with subprocess.Popen(command, cwd=directory, stdout=subprocess.DEVNULL) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"{' '.join(command)}: exit status {process.returncode}")
        times.append(usage.ru_utime + usage.ru_stime)
    return min(times)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="CPU of small commands of ids")
    parser.add_argument("--runs", type=int, default=5, help="of each command (default: 5)")
    parser.add_argument("--demo", action="store_true", help="`ids demo` too, once")
    arguments = parser.parse_args()
    recordings = find_recordings()
    if recordings is None:
        sys.exit("no recordings: `ids data` fetches them")
    evaluate = ["ids", "evaluate", str(recordings / "ur10_exciting_trajectory")]
    evaluate += ["--robot", "ur10_real", "--out", "result", "--overwrite", "--figures"]
    commands = {
        "ids --help": (["ids", "--help"], 0.15),
        "ids robots": (["ids", "robots"], 0.3),
        "ids evaluate --figures none": ([*evaluate, "none"], 0.7),
        "a bare figure": ([sys.executable, "-c", BARE], None),
        "ids evaluate --figures png": ([*evaluate, "png"], None),
    }
    with tempfile.TemporaryDirectory() as directory:
        for name, (command, most) in commands.items():
            seconds = cpu(command, Path(directory), arguments.runs)
            print(f"{name:<28} {seconds:6.2f} s{f'   (at most {most} s)' if most else ''}")
        if arguments.demo:
            seconds = cpu(["ids", "demo", "--out", "demo"], Path(directory), 1)
            print(f"{'ids demo':<28} {seconds:6.2f} s   (at most 15 s)")


if __name__ == "__main__":
    main()

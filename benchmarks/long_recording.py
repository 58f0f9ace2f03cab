#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""CPU per message and memory of `ids evaluate` on long recordings, in a sourced workspace.

python3 benchmarks/long_recording.py                        1e6 messages, sqlite3 and MCAP
python3 benchmarks/long_recording.py --messages 10000000    needs 8 GB of disk, and as much for results

The recordings, of a Panda at 1 kHz with seven joints, are made here. CPU is user and system time of
the process less that on a recording of 27 s, per message; memory is the most anonymous memory, as
pages of the table's files can be given back to the disk.
Beside it, what `recordings_benchmark` measures: reading alone, writing two messages for each one,
and a plain copy of the bytes that were written.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from inverse_dynamics._core import JointStateWriter
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import load_robot

ROBOT = "panda_real"
RATE = 1000.0  # Hz
SHORT = 27_000  # messages
BLOCK = 20_000


def write_recording(path: Path, storage: str, messages: int) -> None:
    """Sums of sines, noise of position and velocity, torques of the model with noise."""
    robot = load_robot(ROBOT)
    arm = Arm(robot)
    names = arm.recorded_names
    random = np.random.default_rng(1)
    frequency = np.linspace(0.11, 0.43, len(names))
    writer = JointStateWriter(path, storage, [(robot.topic, list(names), "base")])
    for begin in range(0, messages, BLOCK):
        k = np.arange(begin, min(begin + BLOCK, messages))
        phase = 2 * np.pi * frequency * (k / RATE)[:, None]
        w = 2 * np.pi * frequency
        q, qd, qdd = 0.4 * np.sin(phase), 0.4 * w * np.cos(phase), -0.4 * w**2 * np.sin(phase)
        effort = arm.solver.torques(q, qd, qdd) + random.normal(0, 0.2, q.shape)
        q = q + random.normal(0, 1e-5, q.shape)
        qd = qd + random.normal(0, 1e-3, q.shape)
        stamps = 1_700_000_000_000_000_000 + k * int(1e9 / RATE)
        stamps = stamps + random.integers(0, 50_000, len(k))
        writer.write([(stamps, stamps + 100_000, q, qd, effort)])
    writer.finish()


def measure(recording: Path, figures: str, directory: Path) -> tuple[float, float]:
    """CPU [s] and most anonymous memory [MB] of an evaluation."""
    command = ["ids", "evaluate", str(recording), "--robot", ROBOT, "--figures", figures]
    command += ["--out", str(directory / "result"), "--overwrite"]
    memory = 0.0
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while not (ended := os.wait4(process.pid, os.WNOHANG))[0]:
            memory = max(memory, anonymous_memory(process.pid))
            time.sleep(0.02)
        _, status, usage = ended
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit status {process.returncode}")
    shutil.rmtree(directory / "result")
    return usage.ru_utime + usage.ru_stime, memory


def anonymous_memory(pid: int) -> float:
    """What a process holds now [MB]."""
    found = re.search(r"RssAnon:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
    return int(found[1]) / 1024 if found else 0.0


def of_files() -> dict[str, list[str]]:
    """Reading, writing two, copying [us a message] of each storage, by recordings_benchmark."""
    lines = subprocess.check_output(["recordings_benchmark"], text=True).splitlines()[2:]
    return {storage: times for storage, *times in map(str.split, lines)}


def row(storage: str, messages: int, of_files: list[str]) -> str:
    """The line of a storage in the table."""
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        for count in (SHORT, messages):
            write_recording(directory / f"{count}", storage, count)
        least, _ = measure(directory / f"{SHORT}", "none", directory)
        cells = []
        for figures in ("none", "png"):
            seconds, memory = measure(directory / f"{messages}", figures, directory)
            cells.append(f"{1e6 * (seconds - least) / (messages - SHORT):.2f} | {memory:.0f}")
    return f"| {storage} | {' | '.join([*cells, *of_files])} |\n"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="CPU and memory of ids on long recordings")
    parser.add_argument("--messages", type=int, default=1_000_000)
    arguments = parser.parse_args()
    table = (
        f"| {arguments.messages} messages | without figures [µs] | [MB] | with its PNG [µs] | [MB] "
        "| reading [µs] | writing two [µs] | copying what was written [µs] |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|\n"
    )
    for storage, times in of_files().items():
        table += row(storage, arguments.messages, times)
    print(table, end="")


if __name__ == "__main__":
    main()

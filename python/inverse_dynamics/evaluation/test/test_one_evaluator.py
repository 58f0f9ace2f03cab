# SPDX-License-Identifier: Apache-2.0
"""`ids evaluate`, Python, and the C++ libraries alone: the same bits from the same recording."""

from __future__ import annotations

import json
import os
import sqlite3
import subprocess
from pathlib import Path

import pytest
from example_recordings import recording

from inverse_dynamics import Solver, evaluate, load_robot

FIGURES = ("mae", "rmse", "nrmse", "bias", "r2", "max_abs")
PROGRAM = os.environ.get("EVALUATION_OF", "")


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """A recording of a model with a tool that the run configuration doesn't know, and its robot."""
    directory = tmp_path_factory.mktemp("run")
    simulated = load_robot("ur10_simulated")
    urdf = simulated.urdf.read_text()
    plugin = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"
    parts = {"root": simulated.root, "tip": simulated.tip}
    recording(directory / "bag", Solver(plugin, urdf, **parts, gravity=(0.5, 0.0, -9.0)))
    (directory / "arm.yaml").write_text(
        f"schema: 1\nname: arm\ndescription: an arm\nplugin: {plugin}\nurdf: {simulated.urdf}\n"
        f"root: {simulated.root}\ntip: {simulated.tip}\neffort: auto\n"
        "accelerations: {method: low-pass, cutoff: 20}\nparameters: {batch_threads: 2}\n"
    )
    return directory


def rows(bag: Path) -> list[tuple[str, int, bytes]]:
    """Topic, time of reception and payload of each message, in the order of the file."""
    (file,) = bag.glob("*.db3")
    query = (
        "SELECT topics.name, timestamp, data FROM messages "
        "JOIN topics ON topics.id = topic_id ORDER BY messages.id"
    )
    connection = sqlite3.connect(file)
    try:
        return connection.execute(query).fetchall()
    finally:
        connection.close()


def by_program(bag: Path, robot: Path | str, out: Path) -> list[list[float]]:
    """Metrics of the program, one row per joint."""
    done = subprocess.run([PROGRAM, bag, robot, out], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [[float(word) for word in line.split()] for line in done.stdout.splitlines()]


def test_ids_python_and_cpp_give_the_same_bits(ids, run):
    robot = run / "arm.yaml"
    found = by_program(run / "bag", robot, run / "cpp")
    code, _, err = ids(
        "evaluate", run / "bag", "--robot", robot, "--out", run / "ids", "--figures", "none"
    )
    assert code == 0, err
    metrics = json.loads((run / "ids" / "metrics.json").read_text())["joints"]
    assert [[joint[name] for name in FIGURES] for joint in metrics] == found
    errors = evaluate(run / "bag", robot).errors
    assert [[getattr(joint, name) for name in FIGURES] for joint in errors] == found
    assert max(joint["rmse"] for joint in metrics) > 0.1  # the model is wrong

    ours, theirs = rows(run / "ids" / "bag"), rows(run / "cpp")
    assert {topic for topic, _, _ in ours} == {"/torques", "/torques_gt"}
    assert len(ours) == 3000
    assert ours == theirs


def test_so_do_real_recordings(ids, recordings, tmp_path):
    bag = recordings / "ur10_exciting_trajectory"
    found = by_program(bag, "ur10_real", tmp_path / "cpp")
    arguments = ("evaluate", bag, "--robot", "ur10_real", "--out", tmp_path / "ids")
    assert ids(*arguments, "--figures", "none")[0] == 0
    metrics = json.loads((tmp_path / "ids" / "metrics.json").read_text())["joints"]
    assert [[joint[name] for name in FIGURES] for joint in metrics] == found
    assert rows(tmp_path / "ids" / "bag") == rows(tmp_path / "cpp")

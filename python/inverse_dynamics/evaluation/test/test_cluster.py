# SPDX-License-Identifier: Apache-2.0
"""Recordings evaluated on a Dask cluster: here one of processes on this machine."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from command_line import fails
from test_many_evaluations import QUICK, ROBOT, bags, fifo_held_open, fifo_is_open
from test_workers import square

from inverse_dynamics import evaluate_many
from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation import cluster as clusters
from inverse_dynamics.evaluation.cluster import on_cluster

_ = bags  # a fixture


def test_without_dask_the_error_says_what_to_install(ids, bags, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    fails(
        ids("evaluate", bags, *ROBOT, "--scheduler", "tcp://127.0.0.1:8786"),
        "--scheduler tcp://127.0.0.1:8786 needs distributed",
        "run ./scripts/setup in the workspace",
    )
    assert os.listdir(tmp_path) == []


@pytest.fixture(scope="module")
def distributed():
    return pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def cluster(distributed):
    import dask

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=2, processes=True, dashboard_address=None
        ) as local,
    ):
        yield local


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense", "foo://a:1"])
def test_an_address_where_no_scheduler_answers_is_an_error(
    distributed, ids, bags, tmp_path, monkeypatch, address
):
    monkeypatch.setattr(clusters, "_SECONDS", 0.5)
    fails(
        ids("evaluate", bags, *ROBOT, "--scheduler", address),
        f"--scheduler {address}: expected a Dask scheduler with workers",
    )
    assert os.listdir(tmp_path) == []


def test_a_scheduler_without_workers_is_an_error(distributed, monkeypatch):
    monkeypatch.setattr(clusters, "_SECONDS", 1.0)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=None) as empty,
        pytest.raises(UserError, match="expected a Dask scheduler with workers"),
    ):
        on_cluster(square, [1], empty.scheduler_address, paths=[], done=print)


def test_results_are_those_of_this_machine(cluster, ids, bags, tmp_path, monkeypatch):
    here = evaluate_many(bags, "ur10_simulated", tmp_path / "here", **QUICK)
    monkeypatch.chdir(bags)  # workers have another working directory
    there = evaluate_many(
        ["monday", "tuesday", "wednesday"],
        "ur10_simulated",
        os.path.relpath(tmp_path / "there"),
        scheduler=cluster.scheduler_address,
        **QUICK,
    )
    assert [s.errors for s in there.summaries] == [s.errors for s in here.summaries]
    for name in there.directories:
        series = [tmp_path / run / name / "series.npz" for run in ("here", "there")]
        assert series[0].read_bytes() == series[1].read_bytes()


def process_with_open(fifo):
    """A process that has a FIFO open, beside this one."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        for place in Path("/proc").glob("[0-9]*"):
            try:
                if int(place.name) != os.getpid() and fifo_is_open(place, fifo):
                    return int(place.name)
            except OSError:
                continue
        time.sleep(0.02)
    raise AssertionError("nobody reads the FIFO")


def test_a_worker_that_dies_is_a_failure_of_its_recording(cluster, bags, tmp_path):
    stuck = tmp_path / "stuck.csv"
    writer = fifo_held_open(stuck)
    result = []

    def work():
        given, scheduler = [stuck, bags / "monday"], cluster.scheduler_address
        out = tmp_path / "week"
        result.append(evaluate_many(given, "ur10_simulated", out, scheduler=scheduler, **QUICK))

    thread = threading.Thread(target=work)
    thread.start()
    os.kill(process_with_open(stuck), signal.SIGKILL)
    thread.join()
    os.close(writer)
    (failure,) = result[0].failures
    assert failure.name == "stuck"
    assert "on the cluster: " in failure.error
    assert [summary.name for summary in result[0].summaries] == ["monday"]


def test_workers_must_see_the_paths(cluster):
    paths = [Path("/"), Path("/nowhere/monday")]
    with pytest.raises(
        UserError,
        match=r"files and software, got .*tcp://\S+: 'no /nowhere/monday'",
    ):
        on_cluster(square, [1], cluster.scheduler_address, paths=paths, done=print)


def test_an_interruption_cancels_what_has_not_begun(cluster, bags, tmp_path):
    def interrupt(_, done, total):
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate_many(
            bags,
            "ur10_simulated",
            tmp_path / "week",
            scheduler=cluster.scheduler_address,
            progress=interrupt,
            **QUICK,
        )
    assert os.listdir(tmp_path) == []


def test_workers_must_have_the_software(distributed, tmp_path):
    with distributed.LocalCluster(n_workers=0, dashboard_address=None) as local:
        command = [sys.executable, "-P", "-m", "distributed.cli.dask_worker", "--no-nanny",
                   "--no-dashboard", local.scheduler_address]  # fmt: skip
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        with subprocess.Popen(command, cwd=tmp_path, env=environment, **quiet) as worker:
            try:
                with pytest.raises(
                    UserError,
                    match=r"files and software, got .*tcp://",
                ):
                    on_cluster(square, [1], local.scheduler_address, paths=[], done=print)
            finally:
                worker.kill()

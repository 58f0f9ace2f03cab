# SPDX-License-Identifier: Apache-2.0
import os
import sys
from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest
from example_evaluations import make_evaluation
from example_recordings import motion
from example_robots import JOINTS, UR10

from inverse_dynamics import Solver, cli, evaluate, write_evaluation
from inverse_dynamics._core import Effort
from inverse_dynamics.evaluation.exports import export_series, series_columns
from inverse_dynamics.recordings.bags import write_joint_logs
from inverse_dynamics.recordings.joint_log import JointLog


@pytest.fixture(scope="module")
def evaluation():
    return make_evaluation()


@pytest.fixture(scope="module")
def saved(tmp_path_factory, evaluation):
    directory = tmp_path_factory.mktemp("saved") / "run"
    write_evaluation(evaluation, directory)
    return directory


@pytest.fixture
def run(saved, tmp_path):
    """A result of one's own."""
    import shutil

    return shutil.copytree(saved, tmp_path / "run")


def expected(evaluation):
    """Name to values, from the evaluation itself."""
    log, samples = evaluation.log, evaluation.samples
    table = {"time": evaluation.time}
    for j, joint in enumerate(log.joint_names):
        table[f"position.{joint}"] = log.q[:, j]
        table[f"velocity.{joint}"] = log.qd[:, j]
        table[f"acceleration.{joint}"] = evaluation.qdd[:, j]
        table[f"effort.{joint}"] = log.effort[:, j]
        table[f"measured.{joint}"] = evaluation.measured[:, j]
        table[f"computed.{joint}"] = evaluation.computed[:, j]
        table[f"error.{joint}"] = evaluation.computed[:, j] - evaluation.measured[:, j]
    for mask in ("repeated", "non_increasing", "start_transient", "isolated", "kept"):
        table[mask] = getattr(samples, mask)
    return table


def test_a_csv_table_has_every_series_with_every_digit(run, evaluation, capsys):
    assert cli.main(["export", str(run)]) == 0
    assert capsys.readouterr().out.strip() == str(run / "series.csv")
    header, *rows = (run / "series.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]
    table = expected(evaluation)
    assert header.split(",") == list(table)
    for i, (name, values) in enumerate(table.items()):
        column = [row[i] for row in cells]
        if values.dtype == bool:
            assert column == ["true" if value else "false" for value in values], name
        else:
            np.testing.assert_array_equal(np.array(column, dtype=float), values, err_msg=name)


def test_a_parquet_table_has_every_series_and_its_unit(run, evaluation):
    assert cli.main(["export", str(run), "--format", "parquet"]) == 0
    table = pq.read_table(run / "series.parquet")
    for name, values in expected(evaluation).items():
        np.testing.assert_array_equal(table[name].to_numpy(), values, err_msg=name)
    units = {f.name: (f.metadata or {}).get(b"unit", b"").decode() for f in table.schema}
    assert units["time"] == "s"
    assert units["position.joint_1"] == "rad"
    assert units["acceleration.joint_3"] == "rad/s^2"
    assert units["effort.joint_1"] == units["error.joint_2"] == "N m"
    assert units["kept"] == ""
    assert table.schema.metadata[b"robot"] == b"arm"


def test_units_of_a_prismatic_joint_are_metres_and_newtons(evaluation):
    units = {c.name: c.unit for c in series_columns(replace(evaluation, units=("N m", "N", "N m")))}
    assert units["position.joint_2"] == "m"
    assert units["velocity.joint_2"] == "m/s"
    assert units["computed.joint_2"] == "N"
    assert units["position.joint_1"] == "rad"


def test_efforts_that_are_currents_stay_as_recorded_beside_the_torques_they_mean(evaluation):
    effort = Effort("current", drive_gains=(2.0, 3.0, 4.0))
    measured = effort.torques(evaluation.log.effort)
    currents = replace(evaluation, effort=effort, measured=measured)
    columns = {c.name: c for c in series_columns(currents)}
    assert columns["current.joint_2"].unit == "A"
    assert "effort.joint_2" not in columns
    assert columns["measured.joint_2"].unit == "N m"
    recorded = evaluation.log.effort[:, 1]
    np.testing.assert_array_equal(columns["current.joint_2"].values, recorded)
    np.testing.assert_array_equal(columns["measured.joint_2"].values, 3.0 * recorded)


@pytest.mark.parametrize("currents", [False, True])
def test_an_exported_table_evaluates_to_the_same_figures(tmp_path, currents):
    ur10 = Solver(UR10)
    q, qd, qdd, stamps = motion()
    efforts = 1.1 * ur10.torques(q, qd, qdd) / (ur10.drive_gains if currents else 1.0)
    log = JointLog(JOINTS, stamps, stamps, q, qd, efforts)
    write_joint_logs(tmp_path / "bag", {log.topic: log})
    first = evaluate(tmp_path / "bag", "ur10_real", effort_is="current" if currents else "torque")
    export_series(first, tmp_path / "series.csv")
    again = evaluate(tmp_path / "series.csv", "ur10_real")
    assert again.errors == first.errors
    assert again.effort.meaning == first.effort.meaning
    assert again.log.effort_is == ("current" if currents else "")
    assert first.errors[1].rmse > 1


def test_more_rows_than_a_block_stay_in_order(tmp_path):
    evaluation = make_evaluation(70_000, 1)
    heard = []
    file = tmp_path / "long.parquet"
    export_series(evaluation, file, progress=lambda *a: heard.append(a))
    np.testing.assert_array_equal(pq.read_table(file)["time"].to_numpy(), evaluation.time)
    assert heard[-1] == ("writing parquet", 70_000, 70_000)


def test_names_with_commas_are_quoted(tmp_path, evaluation):
    import csv

    names = ("a,b", 'c"d', "e")
    log = replace(evaluation.log, joint_names=names)
    export_series(replace(evaluation, log=log), tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="") as file:
        header = next(csv.reader(file))
    assert header[1] == "position.a,b"
    assert 'position.c"d' in header


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--out", "t.txt"], "t.txt: expected a name ending in .csv or .parquet"),
        (["--out", "t.csv", "--format", "parquet"], "--out: expected a name ending in .parquet"),
        (["RUN", "--out", "t.csv"], "--out: names the table of one RUN, got 2 RUNs"),
        (["--format", "xls"], "invalid choice: 'xls'"),
    ],
)
def test_bad_options_are_said(run, tmp_path, monkeypatch, capsys, arguments, text):
    monkeypatch.chdir(tmp_path)
    given = [str(run) if a == "RUN" else a for a in arguments]
    try:
        code = cli.main(["export", str(run), *given])
    except SystemExit as exit_:
        code = exit_.code
    assert code == 2
    assert text in capsys.readouterr().err
    assert os.listdir(tmp_path) == ["run"]


def test_without_pyarrow_the_remedy_is_said(run, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert cli.main(["export", str(run)]) == 2
    assert "./scripts/setup" in capsys.readouterr().err
    assert not (run / "series.csv").exists()

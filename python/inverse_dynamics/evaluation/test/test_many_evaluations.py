# SPDX-License-Identifier: Apache-2.0
import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import asdict, replace
from importlib.util import find_spec
from pathlib import Path

import pytest
from command_line import fails
from example_recordings import recording

from inverse_dynamics import evaluate, evaluate_many, write_joint_logs
from inverse_dynamics.errors import ArgumentError, BagError, OutputError, UserError
from inverse_dynamics.evaluation import exports, many_evaluations
from inverse_dynamics.evaluation.many_evaluations import COLUMNS
from inverse_dynamics.evaluation.workers import outcome_of

ROBOT = ("--robot", "ur10_simulated")
RAW = ("--accelerations", "backward-difference")
NO_FIGURE = ("--figures", "none")
QUICK = {"figures": (), "accelerations": "backward-difference"}


@pytest.fixture(scope="module")
def bags(tmp_path_factory, solver):
    """Three recordings: efforts are right, and 1 and 2 N m off."""
    directory = tmp_path_factory.mktemp("recordings") / "week"
    directory.mkdir()
    log = recording(directory / "monday", solver)
    for name, offset in (("tuesday", 1.0), ("wednesday", 2.0)):
        shifted = replace(log, effort=log.effort + offset)
        write_joint_logs(directory / name, {log.topic: shifted}, storage="mcap")
    return directory


@pytest.fixture(scope="module")
def week(bags, tmp_path_factory):
    """What evaluate_many() gives of all of them, with every table."""
    out = tmp_path_factory.mktemp("results") / "week"
    parquet = find_spec("pyarrow") is not None
    return evaluate_many(bags, "ur10_simulated", out, jobs=2, parquet=parquet, **QUICK)


def files(directory):
    return {
        str(f.relative_to(directory)): f.read_bytes() for f in directory.rglob("*") if f.is_file()
    }


# ---- results ---------------------------------------------------------------------------------------


def test_a_recording_among_others_has_the_result_that_it_has_alone(ids, bags, tmp_path):
    several = ("evaluate", bags / "monday", bags / "tuesday", *ROBOT, *NO_FIGURE)
    assert ids(*several, "--out", "week", "--jobs", "2")[0] == 0
    for name in ("monday", "tuesday"):
        assert ids("evaluate", bags / name, *ROBOT, *NO_FIGURE, "--out", name)[0] == 0
        assert files(tmp_path / "week" / name) == files(tmp_path / name)


def test_one_table_and_one_page_show_all_of_them(ids, bags, tmp_path):
    code, out, err = ids("evaluate", bags, *ROBOT, *RAW, "--out", "week", "--jobs", "2")
    assert (code, err) == (0, "")
    for name, mean in (("monday", "0"), ("tuesday", "1"), ("wednesday", "2")):
        assert re.search(rf"^{name}( +[-.e\d]+){{6}} +{mean}\.\d+$", out, re.M)
        assert (tmp_path / "week" / name / "torques.png").is_file()
    assert re.search(r"^page +week/report.html$", out, re.M)
    html = (tmp_path / "week/report.html").read_text()
    for name in ("monday", "tuesday", "wednesday"):
        assert f'<a href="{name}/report.html">{name}</a>' in html
        assert (tmp_path / "week" / name / "report.html").is_file()
    assert "Not evaluated" not in html
    assert {f.name for f in (tmp_path / "week").iterdir()} == {
        *("monday", "tuesday", "wednesday"),
        *("recordings.json", "report.html", "summary.csv"),
    }


def test_the_summary_has_a_row_per_recording_and_joint(bags, week):
    with (week.directories["monday"].parent / "summary.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(COLUMNS)
    assert len(rows) == len(week.rows) == 18
    for row, expected in zip(rows, week.rows, strict=True):
        for name in COLUMNS:
            value = expected[name]
            assert (type(value)(row[name]) if row[name] else None) == value
    one = evaluate(bags / "tuesday", "ur10_simulated", accelerations="backward-difference")
    tuesday = [row for row in week.rows if row["recording"] == "tuesday"]
    for row, error, kept in zip(tuesday, one.errors, one.errors_of_kept, strict=True):
        assert {name: row[name] for name in asdict(error)} == asdict(error)
        assert row["kept_rmse"] == kept.rmse
    assert (tuesday[0]["samples"], tuesday[0]["kept_samples"]) == (1500, 1500)
    assert (tuesday[0]["accelerations"], tuesday[0]["effort"]) == ("backward-difference", "torque")
    assert tuesday[0]["bag"] == str(bags / "tuesday")
    assert tuesday[0]["duration"] == pytest.approx(5.996)
    assert tuesday[0]["start"] == pytest.approx(0.004)


def test_parquet_files_are_one_table(week):
    dataset = pytest.importorskip("pyarrow.dataset")
    out = week.directories["monday"].parent
    series = dataset.dataset(sorted(map(str, out.glob("*/series.parquet")))).to_table()
    assert series.num_rows == 4500
    counts = series.group_by("recording").aggregate([("time", "count")]).to_pylist()
    assert {row["recording"]: row["time_count"] for row in counts} == {
        "monday": 1500,
        "tuesday": 1500,
        "wednesday": 1500,
    }


def test_a_long_recording_has_no_page_of_its_own(bags, tmp_path, monkeypatch):
    monkeypatch.setattr(many_evaluations, "in_processes", in_this_process)
    monkeypatch.setattr(many_evaluations.evaluations, "_MOST_ON_A_PAGE", 1499)
    evaluate_many(bags / "monday", "ur10_simulated", tmp_path / "out", figures=("png",))
    assert (tmp_path / "out/monday/torques.png").is_file()
    assert not (tmp_path / "out/monday/report.html").exists()
    assert '<a href="monday/">monday</a>' in (tmp_path / "out/report.html").read_text()


def in_this_process(function, arguments, *, jobs, done):
    for k, argument in enumerate(arguments):
        done(k, outcome_of(function, argument))


def test_an_older_result_is_replaced_unless_it_holds_other_files(ids, bags, tmp_path):
    command = ("evaluate", bags / "monday", *ROBOT, *RAW, *NO_FIGURE, "--out", "week", "--jobs=1")
    assert ids(*command)[0] == 0
    assert ids(*command)[::2] == (0, "ids: replaced the earlier result in week\n")
    (tmp_path / "week/monday/mine.txt").write_text("mine")
    fails(ids(*command), "holds 1 file that this command doesn't write (monday/mine")


def test_one_recording_goes_into_the_same_layout_where_processes_are_asked_for(ids, bags, tmp_path):
    command = ("evaluate", bags / "monday", *ROBOT, *RAW, *NO_FIGURE)
    assert ids(*command, "--jobs", "1")[0] == 0
    assert (tmp_path / "recordings_ur10_simulated/monday/metrics.json").is_file()


def test_a_part_of_each_recording(ids, bags, tmp_path):
    command = ("evaluate", bags, *ROBOT, *RAW, *NO_FIGURE, "--out", "week")
    assert ids(*command, "--from", "1", "--to", "2.5")[0] == 0
    with (tmp_path / "week/summary.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {(row["window_from"], row["window_to"], row["samples"]) for row in rows} == {
        ("1.0", "2.5", "376")
    }
    assert float(rows[0]["start"]) == pytest.approx(1.004)
    assert "<dd>from 1 s to 2.5 s</dd>" in (tmp_path / "week/report.html").read_text()


# ---- failures --------------------------------------------------------------------------------------


def test_a_recording_that_fails_is_named_and_the_others_are_finished(ids, bags, tmp_path):
    damaged = tmp_path / "tuesday"
    shutil.copytree(bags / "tuesday", damaged)
    (damaged / "tuesday.mcap").write_bytes(b"nothing")
    given = (bags / "monday", damaged, tmp_path / "nowhere", bags / "wednesday")
    code, out, err = ids("evaluate", *given, *ROBOT, *RAW, *NO_FIGURE, "--out", "week")
    assert code == 3
    assert re.search(r"^monday .*\nwednesday ", out, re.M)
    lines = err.splitlines()
    assert lines[0] == "ids: error: 2 of 4 recordings failed:"
    assert re.match(rf"  tuesday: {damaged}: can't be read as a rosbag2 recording", lines[1])
    assert re.match(rf"  nowhere: {tmp_path}/nowhere: no such file", lines[2])
    assert lines[3:] == ["  written before, whole: week"]
    recordings = json.loads((tmp_path / "week/recordings.json").read_text())["recordings"]
    assert [bool(r["error"]) for r in recordings] == [False, True, True, False]
    html = (tmp_path / "week/report.html").read_text()
    assert "Not evaluated" in html
    assert "can&#39;t be read as a rosbag2 recording" in html
    assert not (tmp_path / "week/tuesday").exists()


def test_where_everything_fails_nothing_is_written(ids, tmp_path):
    (tmp_path / "a.csv").write_text("time\n1\n")
    (tmp_path / "b.csv").write_text("time\n1\n")
    fails(
        ids("evaluate", "a.csv", "b.csv", *ROBOT, "--out", "week"),
        "error: none of the recordings could be evaluated:\n  a: a.csv: expected columns",
        "\n  b: b.csv: expected columns",
    )
    assert sorted(os.listdir(tmp_path)) == ["a.csv", "b.csv"]


def test_a_fault_of_the_robot_is_told_once(ids, bags, tmp_path):
    fails(
        ids("evaluate", bags, *ROBOT, "--plugin", "no/Plugin", "--out", "week"),
        "error: none of the recordings could be evaluated: ",
    )
    assert os.listdir(tmp_path) == []


def reader_of(fifo, process):
    """The worker of a process that waits for a FIFO, once it does."""
    while process.poll() is None:
        for place in Path("/proc").glob("[0-9]*"):
            try:
                status = (place / "status").read_text()
                command = (place / "cmdline").read_text()
                waits = "fifo" in (place / "wchan").read_text() or fifo_is_open(place, fifo)
            except OSError:
                continue
            if f"PPid:\t{process.pid}\n" in status and "workers import serve" in command and waits:
                return int(place.name)
        time.sleep(0.02)
    raise AssertionError("it ended before a worker read the FIFO")


def fifo_is_open(place, fifo):
    return any(os.path.realpath(f) == str(fifo) for f in (place / "fd").iterdir())


def fifo_held_open(path):
    """A table that a reader gets stuck in: a pipe whose writer says nothing."""
    os.mkfifo(path)
    return os.open(path, os.O_RDWR)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_all_workers_and_leaves_nothing(bags, tmp_path, number):
    stuck = tmp_path / "stuck.csv"
    writer = fifo_held_open(stuck)
    command = [sys.executable, "-c", "import sys; from inverse_dynamics.cli import main; "
               "sys.exit(main())", "evaluate", str(bags), str(stuck), *ROBOT, *NO_FIGURE,
               "--out", "week", "--jobs", "2"]  # fmt: skip
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        worker = reader_of(stuck, process)
        process.send_signal(number)
        _, err = process.communicate()  # forever, if it waits for a worker
    os.close(writer)
    assert process.returncode == 128 + number
    assert err.endswith("; nothing was written\n")
    assert not Path(f"/proc/{worker}").exists()
    assert os.listdir(tmp_path) == ["stuck.csv"]


# ---- errors before the work ------------------------------------------------------------------------


def test_what_no_recording_can_be_evaluated_with_is_an_error_at_once(bags, tmp_path):
    out = tmp_path / "week"
    with pytest.raises(
        ArgumentError, match="evaluate_many: argument cutof: unknown; did you mean cut"
    ):
        evaluate_many(bags, "ur10_simulated", out, cutof=3.0)
    with pytest.raises(ArgumentError, match="argument jobs: expected int"):
        evaluate_many(bags, "ur10_simulated", out, jobs="two")
    with pytest.raises(UserError, match="jobs: expected a number of processes above zero, got 0"):
        evaluate_many(bags, "ur10_simulated", out, jobs=0)
    with pytest.raises(UserError, match="recordings: expected one or more, got none"):
        evaluate_many([], "ur10_simulated", out)
    with pytest.raises(UserError, match="robot 'ur11': expected one of"):
        evaluate_many(bags, "ur11", out)
    for wrong in (5, None, [5], b"monday"):
        with pytest.raises(ArgumentError, match="argument recordings: expected Iterable"):
            evaluate_many(wrong, "ur10_simulated", out)
    with pytest.raises(ArgumentError, match="evaluate_many: argument series: unknown"):
        evaluate_many(bags, "ur10_simulated", out, series=None)
    with pytest.raises(BagError, match="expected each recording once"):
        evaluate_many([bags, bags / "monday"], "ur10_simulated", out)
    with pytest.raises(OutputError, match="lies in .*monday, which is read"):
        evaluate_many(bags, "ur10_simulated", bags / "monday/out")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"accelerations": "lowpass"}, "accelerations: expected one of .*, got 'lowpass'"),
        ({"effort_is": "volt"}, "effort, as given: expected one of .*, got 'volt'"),
        ({"clock": "sun"}, "clock: expected one of auto, header, receive, got 'sun'"),
        ({"storage": "tape"}, "storage: expected one of sqlite3, mcap, got 'tape'"),
        ({"figures": ("gif",)}, "gif"),
    ],
)
def test_a_wrong_value_is_told_before_any_process_starts(
    bags, tmp_path, monkeypatch, options, text
):
    monkeypatch.setattr(many_evaluations, "in_processes", lambda *_, **__: pytest.fail("started"))
    with pytest.raises(UserError, match=text):
        evaluate_many(bags, "ur10_simulated", tmp_path / "week", **options)
    assert os.listdir(tmp_path) == []


def test_a_recording_in_an_older_result_is_not_replaced(bags, tmp_path):
    evaluate_many(bags / "monday", "ur10_simulated", tmp_path / "week", **QUICK)
    before = files(tmp_path)
    with pytest.raises(
        OutputError, match="holds .*monday/bag, which is read and would be replaced"
    ):
        evaluate_many(
            [bags / "tuesday", tmp_path / "week/monday/bag"],
            "ur10_simulated",
            tmp_path / "week",
            overwrite=True,
            topic="/torques",
        )
    assert files(tmp_path) == before


@pytest.mark.parametrize("jobs", ["0", "-1", "two", "1.5"])
def test_a_number_of_jobs_is_a_whole_number_above_zero(ids, bags, jobs):
    fails(
        ids("evaluate", bags, *ROBOT, f"--jobs={jobs}"), "argument --jobs: expected a", f"'{jobs}'"
    )


@pytest.mark.parametrize("verb", ["report", "export"])
def test_a_result_of_several_recordings_is_not_taken_for_that_of_one(ids, tmp_path, verb):
    (tmp_path / "week").mkdir()
    (tmp_path / "week/recordings.json").touch()
    fails(
        ids(verb, "week"), "week: holds results of several recordings; name one of them, week/NAME"
    )


def test_one_recording_alone_has_its_parquet_too(ids, bags, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    command = ("evaluate", bags / "monday", *ROBOT, *RAW, *NO_FIGURE, "--out", "one", "--parquet")
    assert ids(*command)[0] == 0
    table = parquet.read_table(tmp_path / "one/series.parquet")
    assert table.column_names[:2] == ["recording", "time"]
    assert set(table["recording"].to_pylist()) == {"monday"}


def test_one_recording_and_its_parquet_are_written_whole_or_not_at_all(
    ids, bags, tmp_path, monkeypatch
):
    def full(*_, **__):
        raise OutputError("no space left")

    monkeypatch.setattr(exports, "export_series", full)
    command = ("evaluate", bags / "monday", *ROBOT, *RAW, *NO_FIGURE, "--out", "one", "--parquet")
    fails(ids(*command), "error: no space left")
    assert os.listdir(tmp_path) == []

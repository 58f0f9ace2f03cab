# SPDX-License-Identifier: Apache-2.0
"""What goes wrong while `ids` works: signals, full disks, closed pipes, poor terminals, odd names."""

import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest
from command_line import fails
from example_evaluations import make_evaluation
from example_robots import URDF

from inverse_dynamics import read_topics, write_evaluation
from inverse_dynamics.evaluation.evaluation import Evaluation
from inverse_dynamics.robots import verb_robots as robots

RAW = ("--accelerations", "backward-difference")
IDS = [sys.executable, "-c", "import sys; from inverse_dynamics.cli import main; sys.exit(main())"]


def evaluation_of_no_file():
    """An evaluation whose robot has no description to be read."""
    evaluation = make_evaluation()
    return replace(evaluation, robot=replace(evaluation.robot, urdf=None))


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    target = tmp_path_factory.mktemp("results") / "result"
    write_evaluation(evaluation_of_no_file(), target)
    return target


def run(*arguments, cwd, **options):
    return subprocess.run(
        [*IDS, *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        **options,
    )


# ---- what is read is not lost ----------------------------------------------------------------------------------------


def test_a_recording_inside_the_output_is_kept(ids, bag, result, tmp_path):
    command = ("--robot", "ur10_simulated", "--out", "result", "--overwrite")
    shutil.copytree(result, tmp_path / "result")
    fails(ids("evaluate", "result/bag", *command), "result: holds result/bag, which is read")
    shutil.copytree(bag, tmp_path / "result" / "recording")
    (tmp_path / "link").symlink_to("result/recording")
    for source in ("result/recording", "link"):
        fails(ids("evaluate", source, *command), "result: ", "name another directory with --out")
    assert (tmp_path / "result" / "recording" / "metadata.yaml").is_file()


def test_no_result_is_put_into_a_recording(ids, bag, tmp_path):
    shutil.copytree(bag, tmp_path / "motion")
    command = ("evaluate", "motion", "--robot", "ur10_simulated", "--out", "motion/result")
    fails(ids(*command), "motion/result: lies in motion, which is read; name another directory")


def test_robots_and_descriptions_inside_the_output_are_kept(ids, bag, result, tmp_path):
    shutil.copytree(result, tmp_path / "out")
    shutil.copy(URDF, tmp_path / "out" / "series.csv")  # by a name that a result may have
    arguments = ("--robot", "ur10_simulated", "--out", "out", "--overwrite")
    command = ("evaluate", bag, *arguments, "--urdf", "out/series.csv")
    fails(ids(*command), "out: holds out/series.csv, which is read and would be replaced")


def test_pages_and_tables_do_not_replace_what_they_are_made_of(ids, result, tmp_path):
    shutil.copytree(result, tmp_path / "run")
    for command in (
        ("report", "run", "--out", "run/evaluation.json"),
        ("report", "run", "--out", "run/bag/bag.db3"),
        ("export", "run", "--out", "run/metrics.json"),
    ):
        fails(ids(*command, "--overwrite"), "lies in run, which is read; name another file")
    assert ids("export", "run")[0] == 0
    assert (tmp_path / "run" / "series.csv").is_file()


def test_a_table_is_not_filled_in_over_itself(ids, tmp_path):
    (tmp_path / "plan.csv").write_text("time\n0\n")
    command = ("torques", "plan.csv", "--robot", "ur10_simulated", "--out", "./plan.csv")
    fails(
        ids(*command, "--overwrite"), "plan.csv: is plan.csv, which is read and would be replaced"
    )
    assert (tmp_path / "plan.csv").read_text() == "time\n0\n"


def test_devices_stay_devices(ids, result, tmp_path):
    os.mkfifo(tmp_path / "pipe.html")
    command = ("report", result, "--out", "pipe.html", "--overwrite")
    fails(ids(*command), "pipe.html: is a device, pipe or socket, not a file")
    fails(ids("report", result, "--out", "/dev/null", "--overwrite"), "/dev/null: is a device")
    assert os.listdir(tmp_path) == ["pipe.html"]


def test_a_name_of_a_robot_is_no_way_out_of_the_working_directory(ids, bag, tmp_path):
    work = tmp_path / "deep"
    work.mkdir()
    robot = work / "robot.yaml"
    source = (URDF.parents[1] / "robots" / "ur10_simulated.yaml").read_text()
    robot.write_text(re.sub(r"^name: .*$", "name: ../../escaped", source, flags=re.MULTILINE))
    os.chdir(work)
    fails(ids("evaluate", bag, "--robot", robot), "robot.yaml:", "name: expected a plain name")
    assert os.listdir(tmp_path) == ["deep"]


# ---- signals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("older", [False, True])
def test_a_signal_leaves_no_trace_and_tells_what_there_is(bag, result, tmp_path, number, older):
    if older:
        shutil.copytree(result, tmp_path / "out")
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--out", "out", "--overwrite", *RAW)
    with subprocess.Popen(
        [*IDS, *map(str, command)], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as child:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob(".out.*.part/new/out/bag")):
            assert time.monotonic() < deadline
            time.sleep(0.001)
        child.send_signal(number)
        out, err = child.communicate(timeout=60)
    assert (child.returncode, out) == (128 + number, b"")
    kept = "; as it was before: out" if older else ""
    what = "interrupted" if number == signal.SIGINT else f"ended by {number.name}"
    assert err.decode() == f"ids: {what}; nothing was written{kept}\n"
    assert os.listdir(tmp_path) == (["out"] if older else [])
    if older:
        assert Evaluation.contents.foreign(tmp_path / "out") == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_a_module_is_imported_is_no_fault(bag, tmp_path, number):
    numpy = tmp_path / "first" / "numpy"  # which the module in C++ imports
    numpy.mkdir(parents=True)
    (numpy / "__init__.py").write_text(f"import signal\nsignal.raise_signal({int(number)})\n")
    code = "import sys; from inverse_dynamics import cli; sys.exit(cli.main(sys.argv[1:]))"
    paths = [f"{numpy.parent}", os.environ.get("PYTHONPATH", "")]
    finished = subprocess.run(
        [sys.executable, "-c", code, "evaluate", bag, "--robot", "ur10_simulated"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        check=False,
    )
    what = "interrupted" if number == signal.SIGINT else f"ended by {number.name}"
    assert finished.stderr == f"ids: {what}; nothing was written\n"
    assert finished.returncode == 128 + number


# ---- full disks ------------------------------------------------------------------------------------------------------


def limit_files(size):
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def told_in_one_line(finished, *expected):
    assert finished.returncode == 2, finished
    assert "Traceback" not in finished.stderr
    assert finished.stderr.startswith("ids: error: ")
    assert finished.stderr.count("\n") == 1, finished.stderr
    for part in expected:
        assert part in finished.stderr


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
@pytest.mark.parametrize("size", [1, 30_000, 100_000])
def test_files_that_can_not_grow_are_told_in_one_line(bag, tmp_path, storage, size):
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--out", "out", "--storage", storage)
    finished = run(*command, *RAW, cwd=tmp_path, preexec_fn=lambda: limit_files(size))
    told_in_one_line(finished, "ids: error: out", "can't be written", "--out")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("verb", ["report", "export", "compare"])
def test_other_results_that_can_not_grow_are_told_in_one_line(result, tmp_path, verb):
    runs = [result, result, "--labels", "one,other"] if verb == "compare" else [result]
    out = {"report": "a.html", "export": "a.csv", "compare": "a"}[verb]
    finished = run(verb, *runs, "--out", out, cwd=tmp_path, preexec_fn=lambda: limit_files(4096))
    told_in_one_line(finished, f"ids: error: {out}: can't be written (File too large)")
    assert os.listdir(tmp_path) == []


@pytest.fixture
def small_disk(tmp_path):
    if os.geteuid() != 0:
        pytest.skip("only the super-user mounts file systems")
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("file systems can't be mounted here")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
@pytest.mark.parametrize("room", [0, 20, 60, 190])
def test_a_full_disk_is_told_in_one_line(bag, small_disk, storage, room):
    (small_disk / "others").write_bytes(bytes((196 - room) * 1024))
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--out", "out", "--storage", storage)
    finished = run(*command, *RAW, cwd=small_disk)
    told_in_one_line(finished, "out", "can't be written", "free some space, or name another")
    assert os.listdir(small_disk) == ["others"]


def test_a_read_only_place_is_told_before_the_work(ids, bag, result, small_disk):
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    for command in (
        ("evaluate", bag, "--robot", "ur10_simulated", "--out", small_disk / "out"),
        ("report", result, "--out", small_disk / "page.html"),
    ):
        fails(ids(*command), f"can't be written ({small_disk} may not be written to); name another")


def test_an_output_that_takes_nothing_is_told_with_what_was_written(result, tmp_path):
    with open("/dev/full", "w") as full:
        finished = subprocess.run(
            [*IDS, "export", result], cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True,
            check=False,
        )  # fmt: skip
    assert finished.returncode == 2
    assert "No space left on device" in finished.stderr
    assert f"written, whole: {result}/series.csv" in finished.stderr
    assert finished.stderr.count("\n") == 1
    (result / "series.csv").unlink()


# ---- terminals -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("arguments", [("robots",), ("export", "RESULT"), ("evaluate", "BAG")])
def test_a_reader_that_has_gone_is_no_error(bag, result, tmp_path, arguments):
    names = {"RESULT": str(result), "BAG": str(bag)}
    command = [*IDS, *(names.get(a, a) for a in arguments)]
    if "BAG" in arguments:
        command += ["--robot", "ur10_simulated", "--out", "out", *RAW]
    if "RESULT" in arguments:
        command += ["--out", "a.csv"]
    reader, writer = os.pipe()
    os.close(reader)
    finished = subprocess.run(
        command, cwd=tmp_path, stdout=writer, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(writer)
    assert (finished.returncode, finished.stderr) == (128 + signal.SIGPIPE, "")


@pytest.mark.parametrize(
    "poor",
    [{"LC_ALL": "C", "PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C", "PYTHONUTF8": "0",
      "PYTHONCOERCECLOCALE": "0"}],
)  # fmt: skip
def test_a_terminal_without_a_character_gets_its_escape(bag, tmp_path, poor):
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--out", "out", *RAW)
    finished = run(*command, cwd=tmp_path, env={**os.environ, **poor})
    assert (finished.returncode, finished.stderr) == (0, "")
    assert "elbow_joint" in finished.stdout
    assert (tmp_path / "out" / "metrics.json").is_file()
    assert run("robots", "ur10_real", cwd=tmp_path, env={**os.environ, **poor}).returncode == 0
    read = run("export", "out", cwd=tmp_path, env={**os.environ, **poor})
    assert (read.returncode, read.stderr) == (0, "")


def test_names_do_not_control_the_terminal_nor_the_page(ids, tmp_path):
    evil = "\x1b]0;owned\x07\x1b[2J$\\frac$"
    evaluation = make_evaluation()
    names = (evil, "two\nlines", "\u202ebidi")
    evaluation = replace(
        evaluation,
        log=replace(evaluation.log, joint_names=names),
        joint_names=names,
        errors=tuple(replace(e, joint=n) for e, n in zip(evaluation.errors, names, strict=True)),
        robot=replace(evaluation.robot, urdf=None, name=evil, description=evil),
    )
    for name in ("one", "other"):
        write_evaluation(evaluation, tmp_path / name)
    code, out, err = ids("compare", "one", "other", "--labels", "\x1b[31mred,blue")
    assert (code, err) == (0, "")
    code, _page, err = ids("report", "one", "--title", evil, "--out", "page.html")
    assert (code, err) == (0, "")
    html = (tmp_path / "page.html").read_text()
    for text in (out, html.partition("<script")[0]):
        assert not set(text) & {"\x1b", "\x07", "\u202e"}
        assert "\\x1b" in text
    assert "<title>\\x1b]0;owned\\x07\\x1b[2J$\\frac$</title>" in html


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("\x1b[2Jbag", "\\x1b[2Jbag: no such file"),
        ("bag\nids: all is well", "bag\n  ids: all is well: no such file"),
        ("b" * 3000, "bbb [... 3001 characters ...] bbb"),
        ("b" * 200 + "/c" * 3000, "characters ...]"),
        (os.fsdecode(b"caf\xe9"), "caf\\udce9: no such file"),
    ],
)
def test_paths_are_shown_as_the_terminal_can_bear(ids, name, shown):
    code, out, err = ids("evaluate", name, "--robot", "ur10_simulated", "--out", "out")
    assert (code, out) == (2, "")
    assert shown in err
    assert "\x1b" not in err
    assert len(err) < 3000


@pytest.mark.parametrize("name", [b"caf\xe9", b"b" * 250, b"what?%41#b", b"it's; [1]"])
@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_recordings_and_results_may_have_any_name(ids, tmp_path, name, storage):
    folder = tmp_path / os.fsdecode(name)
    folder.mkdir()
    evaluation = replace(evaluation_of_no_file(), bag=folder / os.fsdecode(name))
    write_evaluation(evaluation, folder / "result", storage=storage)
    assert os.listdir(tmp_path) == [os.fsdecode(name)]
    assert ids("report", folder / "result", "--out", folder / "page.html")[::2] == (0, "")
    assert ids("export", folder / "result", "--out", folder / "table.csv")[::2] == (0, "")
    assert sorted(os.listdir(folder)) == ["page.html", "result", "table.csv"]
    (_, topic) = read_topics(folder / "result" / "bag")
    assert topic == ("/torques_gt", "sensor_msgs/msg/JointState", 400)


# ---- unexpected errors -----------------------------------------------------------------------------------------------


def broken(_):
    raise RuntimeError("a fault\nin two lines \x1b[2J")


def without_rich(_):
    raise ModuleNotFoundError("No module named 'rich.text'", name="rich.text")


def test_a_python_package_that_is_missing_is_no_bug(ids, monkeypatch):
    monkeypatch.setattr(robots, "run", without_rich)
    fails(
        ids("robots"),
        "ids: error: ids needs rich: run ./scripts/setup in the workspace, or sudo apt install python3-rich, "
        "or pip install rich",
    )


def test_an_unexpected_error_is_one_line_with_a_report(ids, tmp_path, monkeypatch):
    monkeypatch.setattr(robots, "run", broken)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("A_SECRET", "hunter2")
    code, out, err = ids("robots", "my robot")
    assert (code, out) == (1, "")
    assert re.fullmatch(
        r"ids: error: unexpected RuntimeError: a fault; this is a bug in ids: please "
        r"report it with \S+ids-error-\w+\.txt; nothing was written\n",
        err,
    )
    (file,) = tmp_path.iterdir()
    report = file.read_text()
    for part in (
        "ids robots 'my robot'",
        "Traceback",
        "RuntimeError: a fault",
        "numpy ",
        "Python 3",
    ):
        assert part in report
    assert "hunter2" not in report


def test_a_report_that_can_not_be_written_does_not_matter(ids, monkeypatch):
    monkeypatch.setattr(robots, "run", broken)
    monkeypatch.setattr("tempfile.tempdir", "/proc/nowhere")
    code, _, err = ids("robots")
    assert code == 1
    assert re.fullmatch(
        r"ids: error: unexpected RuntimeError: a fault \(no report .*\)[^\n]*\n", err
    )


@pytest.mark.parametrize("error", [MemoryError(), RecursionError("too deep"), OSError("odd")])
def test_no_error_ends_in_a_traceback(ids, tmp_path, monkeypatch, error):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def fail(_):
        raise error

    monkeypatch.setattr(robots, "run", fail)
    code, _, err = ids("robots")
    assert code in (1, 2)
    assert "Traceback" not in err
    assert err.count("\n") == 1

# SPDX-License-Identifier: Apache-2.0
"""A signal before and after each step by which a result is written: the old or the new one is there.

A program of its own forks a run for each signal and step, so that SIGKILL is as real as Ctrl-C.
"""

import json
import os
import signal
import subprocess
import sys

import pytest

from inverse_dynamics.errors import OutputError
from inverse_dynamics.outputs import replacement

# For each signal and way to write: writes a result again and again, with the signal before (even) or after
# (odd) the k-th system call that changes the file system, until no step is left; a line of JSON for each.
PROGRAM = """
import json, os, shutil, signal, sys
from pathlib import Path
from inverse_dynamics import cli
from inverse_dynamics.outputs import files
from inverse_dynamics.outputs import replacement
from inverse_dynamics.robots import verb_robots as robots

RESULT = files.Contents("mark", ("mark", "data"))
target = Path("result")
step, signalled = 0, False

def injected(function, at):
    def call(*arguments, **options):
        global step, signalled
        for when in (0, 1):
            if when:
                result = function(*arguments, **options)
            if step == at:
                signalled = True
                os.kill(os.getpid(), number)
            step += 1
        return result
    return call

def write(text):
    if kind == "file":
        with files.file_written_whole(target) as file:
            file.write_text(text)
        return
    with files.written_whole(target, contents=RESULT, overwrite=True) as directory:
        (directory / "data").write_text(text)
        (directory / "mark").write_text(text)

def run(at):
    for name in ("mkdir", "rename", "replace", "rmdir", "unlink", "fsync", "open"):
        setattr(os, name, injected(getattr(os, name), at))
    if hasattr(replacement, "_exchange"):
        real = replacement._exchange
        replacement._exchange = injected(real if exchange == "exchange" else (lambda *_: False), at)
    code = cli.main(["robots"])
    os._exit(code if signalled else 99)

def found():
    if not target.exists():
        return None
    if kind == "file":
        return [target.read_text()]
    return sorted(file.read_text() for file in target.iterdir())

def interrupted_runs():
    for at in range(1000):
        write("old")
        read, written = os.pipe()
        child = os.fork()
        if child == 0:
            os.dup2(written, 2)
            run(at)
        os.close(written)
        text = os.fdopen(read).read()
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if code == 99:
            break
        state = {"at": at, "code": code, "text": text, "found": found(), "left": sorted(os.listdir("."))}
        replacement.restore_interrupted(target.absolute())
        state["next"], state["left_next"] = found(), sorted(os.listdir("."))
        yield state

robots.run = lambda _: write("new")
parser = cli.make_parser()  # imports its modules once
cli.make_parser = lambda: parser
above = os.getcwd()
for k, (number, exchange, kind) in enumerate(json.loads(sys.argv[1])):
    os.mkdir(f"{above}/{k}")
    os.chdir(f"{above}/{k}")
    print(json.dumps(list(interrupted_runs())), flush=True)  # children inherit what is buffered
"""

WAYS = [("exchange", "directory"), ("two renames", "directory"), ("exchange", "file")]


@pytest.fixture(scope="module")
def interrupted_runs(tmp_path_factory):
    """Lists of runs by signal and way."""
    given = [(number, *way) for number in (*replacement.STOPPING, signal.SIGKILL) for way in WAYS]
    result = subprocess.run(
        [sys.executable, "-c", PROGRAM, json.dumps(given)],
        cwd=tmp_path_factory.mktemp("interrupted"),
        capture_output=True,
        text=True,
        check=False,
        timeout=1200,
    )
    assert result.returncode == 0, result.stderr
    return dict(zip(given, map(json.loads, result.stdout.splitlines()), strict=True))


def is_whole(content, kind):
    return content in ([["old"], ["new"]] if kind == "file" else [["old"] * 2, ["new"] * 2])


@pytest.mark.parametrize(("exchange", "kind"), WAYS)
@pytest.mark.parametrize("number", replacement.STOPPING)
def test_a_signal_at_any_step_leaves_the_old_or_the_new_result(
    interrupted_runs, number, exchange, kind
):
    runs = interrupted_runs[number, exchange, kind]
    assert len(runs) >= 20
    for run in runs:
        assert is_whole(run["found"], kind), run
        assert run["code"] == 128 + number, run
        if "new" in run["found"]:
            assert run["text"].endswith("; written, whole: result\n"), run
        else:
            assert run["text"].endswith("; nothing was written; as it was before: result\n"), run
        assert run["left"] == ["result"], run
    assert {run["found"][0] for run in runs} == {"old", "new"}


@pytest.mark.parametrize(("exchange", "kind"), WAYS)
def test_a_run_killed_at_any_step_is_tidied_up_by_the_next(interrupted_runs, exchange, kind):
    runs = interrupted_runs[signal.SIGKILL, exchange, kind]
    assert len(runs) >= 20
    missing = [run for run in runs if not is_whole(run["found"], kind)]
    # Between two renames only, where directories can't be exchanged.
    assert bool(missing) == (exchange == "two renames")
    for run in runs:
        assert run["code"] == -signal.SIGKILL
        assert run["found"] is None or is_whole(run["found"], kind), run
        assert is_whole(run["next"], kind), run
        assert run["left_next"] == ["result"], run


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="renameat2 is Linux's")
def test_two_directories_are_exchanged_in_one_step(tmp_path):
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / name).touch()
    if not replacement._exchange(tmp_path / "one", tmp_path / "other"):
        pytest.skip("this file system can't")
    assert os.listdir(tmp_path / "one") == ["other"]
    assert os.listdir(tmp_path / "other") == ["one"]


def test_an_exchange_that_fails_is_an_error(tmp_path):
    (tmp_path / "one").mkdir()
    with pytest.raises(FileNotFoundError):
        replacement._exchange(tmp_path / "one", tmp_path / "missing")


def test_a_failure_between_two_renames_puts_the_old_result_back(tmp_path, monkeypatch):
    for name in ("new", "target"):
        (tmp_path / name).mkdir()
        (tmp_path / name / name).touch()
    rename = os.rename

    def fail_for_new(one, other):
        if str(one).endswith("new"):
            raise OSError(28 if calls else 39, "no")
        calls.append(1)
        rename(one, other)

    calls = []
    monkeypatch.setattr(replacement, "_exchange", lambda *_: False)
    monkeypatch.setattr(os, "rename", fail_for_new)
    with pytest.raises(OSError, match="no"):
        replacement.put_directory(
            tmp_path / "new", tmp_path / "target", tmp_path / "old", overwrite=True
        )
    assert os.listdir(tmp_path / "target") == ["target"]


def test_a_folder_that_can_not_be_completed_is_removed(tmp_path, monkeypatch):
    mkdir = os.mkdir

    def fail_for_new(path, *mode):
        if os.path.basename(path) == "new":
            raise OSError(28, "No space left on device")
        mkdir(path, *mode)

    with monkeypatch.context() as patches:
        patches.setattr(os, "mkdir", fail_for_new)
        with pytest.raises(OSError, match="No space left on device"):
            replacement.WorkFolder(tmp_path / "result")
    assert os.listdir(tmp_path) == []
    replacement.WorkFolder(tmp_path / "result").remove()  # it isn't locked


def killed_between_two_renames(directory):
    """The target; the older result is in its work folder."""
    for name in ("new", "old"):
        (directory / ".result.part" / name).mkdir(parents=True)
        (directory / ".result.part" / name / "data").write_text(name)
    return directory / "result"


def test_an_older_result_is_put_back_over_an_empty_directory(tmp_path):
    target = killed_between_two_renames(tmp_path)
    target.mkdir()
    replacement.restore_interrupted(target)
    assert os.listdir(tmp_path) == ["result"]
    assert (target / "data").read_text() == "old"


@pytest.mark.parametrize("kind", ["directory", "file"])
def test_an_older_result_stays_where_something_else_took_its_place(tmp_path, kind):
    target = killed_between_two_renames(tmp_path)
    if kind == "directory":
        target.mkdir()
        (target / "mine").touch()
    else:
        target.touch()
    old = tmp_path / ".result.part" / "old"
    for _ in range(2):
        with pytest.raises(OutputError, match=f"{target}: .*the older result is still {old}.*move"):
            replacement.restore_interrupted(target)
    assert (old / "data").read_text() == "old"
    assert os.listdir(target) == ["mine"] if kind == "directory" else target.is_file()


def test_an_older_result_that_can_not_be_put_back_is_kept(tmp_path, monkeypatch):
    work = replacement.WorkFolder(tmp_path / "result")
    (tmp_path / "result").mkdir()
    (tmp_path / "result" / "data").write_text("old")
    rename, calls = os.rename, []

    def fail_after_the_first(one, other):
        calls.append(one)
        if len(calls) != 2:
            raise OSError(39 if len(calls) == 1 else 5, "no")
        rename(one, other)

    with monkeypatch.context() as patches:
        patches.setattr(replacement, "_exchange", lambda *_: False)
        patches.setattr(os, "rename", fail_after_the_first)
        with pytest.raises(OSError, match="no"):
            replacement.put_directory(work.new, tmp_path / "result", work.old, overwrite=True)
        work.remove()
    replacement.restore_interrupted(tmp_path / "result")
    assert (tmp_path / "result" / "data").read_text() == "old"

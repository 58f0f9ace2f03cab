# SPDX-License-Identifier: Apache-2.0
import os
import signal
from pathlib import Path

import pytest

from inverse_dynamics import cli
from inverse_dynamics.errors import OutputError
from inverse_dynamics.outputs.files import (
    Contents,
    check_output_directory,
    check_output_file,
    files_written_whole,
    write_text_whole,
    written_whole,
)
from inverse_dynamics.robots import verb_robots

MARK = "result.json"
RESULT = Contents(MARK, (MARK, "of_old", "bag/{name}.db3", "plot.*"), added=("series.csv",))


def write(target, text="new", **options):
    with written_whole(target, contents=RESULT, **options) as directory:
        (directory / MARK).write_text(text)


def test_nothing_changes_after_an_error(tmp_path):
    def write_and_fail():
        options = {"contents": RESULT, "overwrite": True}
        with written_whole(tmp_path / "result", **options) as directory:
            (directory / MARK).write_text("new")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write_and_fail()
    assert os.listdir(tmp_path) == []
    (tmp_path / "result").mkdir()  # an empty directory is filled
    write(tmp_path / "result", "old")
    with pytest.raises(ZeroDivisionError):
        write_and_fail()
    assert (tmp_path / "result" / MARK).read_text() == "old"


def test_an_older_result_is_replaced_on_demand(tmp_path):
    write(tmp_path / "result", "old")
    (tmp_path / "result" / "of_old").touch()
    (tmp_path / "result").chmod(0o750)
    with pytest.raises(OutputError, match=r"result: exists already; name another .*overwrite=True"):
        write(tmp_path / "result")
    write(tmp_path / "result", overwrite=True)
    assert os.listdir(tmp_path / "result") == [MARK]
    assert (tmp_path / "result" / MARK).read_text() == "new"
    assert (tmp_path / "result").stat().st_mode & 0o777 == 0o750
    assert os.listdir(tmp_path) == ["result"]


def test_files_of_the_user_are_never_overwritten(tmp_path):
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter").touch()
    with pytest.raises(
        OutputError, match=r"thesis: won't be overwritten: it holds no result\.json"
    ):
        write(tmp_path / "thesis", overwrite=True)
    write(tmp_path / "result", "old")
    for name in ("bag/result.db3", "plot.png", "series.csv"):
        file = tmp_path / "result" / name
        file.parent.mkdir(exist_ok=True)
        file.touch()
    write(tmp_path / "result", "newer", overwrite=True)
    for k in range(7):
        (tmp_path / "result" / f"note_{k}").write_text("mine")
    (tmp_path / "result" / "link").symlink_to(tmp_path)
    expected = (
        r"it holds 8 files .*\(link, note_0, note_1, note_2, note_3 and 3 others\); move what"
    )
    with pytest.raises(OutputError, match=expected):
        write(tmp_path / "result", overwrite=True)
    assert (tmp_path / "result" / "note_3").read_text() == "mine"


@pytest.mark.parametrize(
    "name", ["bag/other.db3", "plots/plot.png", "bag/plot.png", "a/series.csv"]
)
def test_files_of_a_result_are_known_by_their_whole_path(tmp_path, name):
    write(tmp_path / "result")
    file = tmp_path / "result" / name
    file.parent.mkdir()
    file.touch()
    assert RESULT.foreign(tmp_path / "result") == [name]


def test_a_file_is_never_overwritten_by_a_directory(tmp_path):
    (tmp_path / "notes").write_text("mine")
    with pytest.raises(OutputError, match=r"notes: exists and isn't a directory"):
        check_output_directory(tmp_path / "notes", overwrite=True, contents=RESULT)


def test_the_working_directory_is_not_replaced(tmp_path, monkeypatch):
    write(tmp_path / "result")
    (tmp_path / "result" / "bag").mkdir()
    monkeypatch.chdir(tmp_path / "result" / "bag")
    for out in (".", "..", tmp_path / "result"):
        with pytest.raises(OutputError, match="is the working directory, or holds it"):
            check_output_directory(Path(out), overwrite=True, contents=RESULT)


@pytest.mark.skipif(os.geteuid() == 0, reason="the super-user may write everywhere")
def test_a_directory_without_permission_is_an_error(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match=r"can't be written \(.* may not be written to\)"):
        write(tmp_path / "result")


def test_what_appears_meanwhile_is_not_overwritten(tmp_path):
    def write_too_late():
        with written_whole(tmp_path / "result"):
            (tmp_path / "result").mkdir()
            (tmp_path / "result" / "of_another_process").touch()

    with pytest.raises(OutputError, match="exists already"):
        write_too_late()
    assert os.listdir(tmp_path / "result") == ["of_another_process"]


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="there is no /proc here")
def test_a_place_where_nothing_can_be_made_is_an_error():
    for write_it in (write, lambda target: write_text_whole(target, "")):
        with pytest.raises(
            OutputError, match=r"/proc/result: can't be written \(.+\); name another"
        ):
            write_it(Path("/proc/result"))


# ---- what is read and what is written --------------------------------------------------------------------------------


def places(tmp_path):
    """An older result with a recording in it, and other names for both."""
    write(tmp_path / "result")
    (tmp_path / "result" / "bag").mkdir()
    (tmp_path / "result" / "bag" / "result.db3").write_text("recorded once")
    (tmp_path / "link_to_bag").symlink_to("result/bag")
    (tmp_path / "link_to_all").symlink_to(".")


@pytest.mark.parametrize(
    ("source", "out", "relation"),
    [
        ("result/bag", "result", "holds"),
        ("result", "result", "is"),
        ("link_to_bag", "result", "holds"),
        ("result/bag", "link_to_all/result", "holds"),
        ("result/bag", "result/bag/deep/out", "lies in"),
        ("result/bag", "link_to_bag/out", "lies in"),
    ],
)
def test_a_directory_that_is_read_from_is_neither_replaced_nor_added_to(
    tmp_path, monkeypatch, source, out, relation
):
    places(tmp_path)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match=f"{out}: {relation} {source}, which is read.*out="):
        check_output_directory(Path(out), overwrite=True, contents=RESULT, inputs=[Path(source)])


def test_a_file_that_is_read_is_not_replaced(tmp_path):
    places(tmp_path)
    file = tmp_path / "result/bag/result.db3"
    os.link(file, tmp_path / "another_name")
    for out in (file, tmp_path / "link_to_bag/result.db3", tmp_path / "another_name"):
        with pytest.raises(OutputError, match=r"is .*result\.db3, which is read"):
            check_output_file(out, overwrite=True, inputs=[file])


def test_a_file_may_be_put_beside_those_of_a_result_but_not_over_them(tmp_path):
    places(tmp_path)
    options = {"overwrite": True, "inputs": [tmp_path / "result"], "results": RESULT}
    check_output_file(tmp_path / "result" / "report.html", **options)
    check_output_file(tmp_path / "result" / "series.csv", **options)
    for name in (MARK, "bag/result.db3"):
        with pytest.raises(OutputError, match=f"{name}: lies in .*result, which is read"):
            check_output_file(tmp_path / "result" / name, **options)


# ---- files -----------------------------------------------------------------------------------------------------------


def test_a_device_or_pipe_is_left_alone(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "link").symlink_to("/dev/full")
    for node in (tmp_path / "fifo", tmp_path / "link", Path("/dev/null")):
        before = node.lstat()
        expected = f"{node}: is a device, pipe or socket, not a file"
        with pytest.raises(OutputError, match=expected):
            check_output_file(node, overwrite=True)
        with pytest.raises(OutputError, match=expected):
            write_text_whole(node, "")
        assert node.lstat()[:3] == before[:3]


def test_a_link_stays_a_link_to_the_new_file(tmp_path):
    (tmp_path / "file").touch(mode=0o600)
    (tmp_path / "link").symlink_to("file")
    write_text_whole(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o600
    assert (tmp_path / "file").read_text() == "new"


def test_long_names_are_written(tmp_path):
    write_text_whole(tmp_path / ("n" * 255), "new")
    write(tmp_path / ("ä" * 127))
    assert sorted(map(len, os.listdir(tmp_path))) == [127, 255]


@pytest.mark.parametrize("path", ["n" * 256, "/".join(["n" * 200] * 25)])
def test_too_long_names_are_told(tmp_path, path):
    for check in (check_output_directory, check_output_file, write):
        with pytest.raises(OutputError, match=r"can't be written \(File name too long\)"):
            check(tmp_path / path)


@pytest.mark.parametrize("name", [b"caf\xe9", b"two\nlines", b"\x1b[31mred", b"/"])
def test_names_that_no_text_can_hold_are_refused(tmp_path, name):
    for check in (check_output_directory, check_output_file):
        with pytest.raises(
            OutputError, match="expected a name in UTF-8 without control characters"
        ):
            check(tmp_path / os.fsdecode(name))


# ---- signals and failures --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("names", [["result"], ["a", "b"]])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_at_any_step_leaves_the_old_or_the_new_result(
    tmp_path, monkeypatch, capsys, number, names
):
    def write_result(text):
        if names == ["result"]:
            write(Path("result"), text, overwrite=True)
        else:
            write_files(Path(), text, names)

    def signalled(function, at):
        """A system call with a signal before it (2 k = at, k: number of the call) or after it."""

        def call(*arguments, **options):
            for before in (True, False):
                result = None if before else function(*arguments, **options)
                steps.append(before)
                if len(steps) == at + 1:
                    signal.raise_signal(number)
            return result

        return call

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(verb_robots, "run", lambda _: write_result("new"))
    parser = cli.make_parser()  # imports its modules once
    monkeypatch.setattr(cli, "make_parser", lambda: parser)
    found = []
    while True:
        write_result("old")
        steps = []
        with monkeypatch.context() as patches:
            for name in ("mkdir", "rename", "replace", "rmdir", "unlink", "open"):
                patches.setattr(os, name, signalled(getattr(os, name), len(found)))
            code = cli.main(["robots"])
        if code == 0:
            break
        assert code == 128 + number
        (text,) = {file.read_text() for file in Path().rglob("*") if file.is_file()}
        kept = "nothing was written; as it was before: " if text == "old" else "written, whole: "
        assert capsys.readouterr().err.endswith(f"; {kept}{', '.join(names)}\n")
        assert sorted(os.listdir()) == names
        found.append(text)
    assert len(found) >= 10
    assert set(found) == {"old", "new"}


def test_an_older_result_is_put_back_when_the_new_one_can_not_be_renamed(tmp_path, monkeypatch):
    write(tmp_path / "result", "old")
    replace = os.replace

    def fail_for_new(source, target):
        if Path(source).parent.name == "new":
            raise OSError(28, "No space left on device", str(target))
        replace(source, target)

    monkeypatch.setattr(os, "replace", fail_for_new)
    with pytest.raises(OutputError, match="No space left.*what was there is kept; free some space"):
        write(tmp_path / "result", overwrite=True)
    assert (tmp_path / "result" / MARK).read_text() == "old"
    assert os.listdir(tmp_path) == ["result"]


def write_files(directory, text, names=("a.yaml", "b.json", "c.html")):
    with files_written_whole([directory / name for name in names]) as fresh:
        for file in fresh:
            file.write_text(text)


def test_several_files_appear_together(tmp_path):
    target = tmp_path / "deep"
    write_files(target, "old", ("a.yaml", "other/b.json"))
    write_files(target, "new", ("a.yaml", "other/b.json"))
    assert (target / "a.yaml").read_text() == (target / "other" / "b.json").read_text() == "new"
    assert sorted(os.listdir(target)) == ["a.yaml", "other"]
    assert os.listdir(target / "other") == ["b.json"]


def test_none_of_several_files_is_left_after_an_error(tmp_path):
    def write_one(error):
        with files_written_whole([tmp_path / "a", tmp_path / "b"]) as fresh:
            fresh[0].write_text("1")
            if error:
                raise error

    with pytest.raises(ZeroDivisionError):
        write_one(ZeroDivisionError())
    with pytest.raises(OutputError, match="can't be written"):
        write_one(None)  # b was forgotten
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("older", [(), ("a.yaml", "b.json", "c.html"), ("b.json",)])
def test_what_was_there_is_put_back_when_the_last_of_several_fails(tmp_path, monkeypatch, older):
    for name in older:
        (tmp_path / name).write_text("old")
    replaced = os.replace

    def fail_at_last(source, target):
        if Path(source).name == "c.html":
            raise OSError(28, "No space left on device", str(target))
        replaced(source, target)

    monkeypatch.setattr(os, "replace", fail_at_last)
    with pytest.raises(OutputError, match="No space left"):
        write_files(tmp_path, "new")
    assert {name: (tmp_path / name).read_text() for name in os.listdir(tmp_path)} == dict.fromkeys(
        older, "old"
    )

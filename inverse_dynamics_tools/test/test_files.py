# SPDX-License-Identifier: Apache-2.0
import os

import pytest

from inverse_dynamics.errors import OutputError
from inverse_dynamics.files import check_output_directory, written_whole

MARK = "result.json"


def write(target, text="new", **options):
    with written_whole(target, mark=MARK, **options) as directory:
        (directory / MARK).write_text(text)


def test_a_directory_is_there_with_all_files_at_the_end(tmp_path):
    target = tmp_path / "deep" / "result"
    with written_whole(target) as directory:
        (directory / "a").write_text("1")
        assert not target.exists()
    assert (target / "a").read_text() == "1"
    assert os.listdir(tmp_path / "deep") == ["result"]


def test_nothing_is_left_after_an_error(tmp_path):
    def write_and_fail():
        with written_whole(tmp_path / "result") as directory:
            (directory / "a").write_text("1")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write_and_fail()
    assert os.listdir(tmp_path) == []


def test_an_empty_directory_may_be_filled(tmp_path):
    (tmp_path / "result").mkdir()
    write(tmp_path / "result")
    assert (tmp_path / "result" / MARK).read_text() == "new"


def test_an_older_result_is_not_overwritten_silently(tmp_path):
    write(tmp_path / "result", "old")
    with pytest.raises(OutputError, match=r"result: exists already; name another .*--overwrite"):
        write(tmp_path / "result")
    assert (tmp_path / "result" / MARK).read_text() == "old"


def test_an_older_result_is_replaced_on_demand(tmp_path):
    write(tmp_path / "result", "old")
    (tmp_path / "result" / "of_old").touch()
    write(tmp_path / "result", overwrite=True)
    assert os.listdir(tmp_path / "result") == [MARK]
    assert (tmp_path / "result" / MARK).read_text() == "new"
    assert os.listdir(tmp_path) == ["result"]


def test_an_older_result_stays_when_writing_the_new_one_fails(tmp_path):
    write(tmp_path / "result", "old")
    with (
        pytest.raises(ZeroDivisionError),
        written_whole(tmp_path / "result", mark=MARK, overwrite=True),
    ):
        raise ZeroDivisionError
    assert (tmp_path / "result" / MARK).read_text() == "old"


def test_what_is_not_a_result_is_never_overwritten(tmp_path):
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter").write_text("years of work")
    with pytest.raises(
        OutputError, match=r"thesis: won't be overwritten: it holds no result\.json"
    ):
        write(tmp_path / "thesis", overwrite=True)
    assert (tmp_path / "thesis" / "chapter").read_text() == "years of work"


def test_a_file_is_never_overwritten(tmp_path):
    (tmp_path / "notes").write_text("mine")
    with pytest.raises(OutputError, match=r"notes: exists and isn't a directory"):
        check_output_directory(tmp_path / "notes", overwrite=True, mark=MARK)


def test_a_place_that_can_not_be_written_is_an_error(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match=r"result: can't be written \(.+\); name another"):
        write(tmp_path / "file" / "result")


@pytest.mark.skipif(os.geteuid() == 0, reason="the super-user may write everywhere")
def test_a_directory_without_permission_is_an_error(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match=r"can't be written \(Permission denied\)"):
        write(tmp_path / "result")


def test_what_appears_meanwhile_is_not_overwritten(tmp_path):
    def write_too_late():
        with written_whole(tmp_path / "result"):
            (tmp_path / "result").mkdir()
            (tmp_path / "result" / "of_another_process").touch()

    with pytest.raises(OutputError, match="exists already"):
        write_too_late()
    assert os.listdir(tmp_path / "result") == ["of_another_process"]

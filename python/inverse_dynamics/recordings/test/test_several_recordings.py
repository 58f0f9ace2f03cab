# SPDX-License-Identifier: Apache-2.0
import pytest

from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.several_recordings import named_recordings


def make(root, *recordings):
    """Directories with metadata.yaml, and files."""
    for name in recordings:
        path = root / name
        if path.suffix in (".mcap", ".db3", ".csv", ".txt"):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        else:
            path.mkdir(parents=True)
            (path / "metadata.yaml").touch()


def names(root, *paths, **options):
    found = named_recordings([root / path for path in paths], **options)
    return {name: str(path.relative_to(root)) for name, path in found.items()}


def test_recordings_are_named_after_their_stems_in_the_order_given(tmp_path):
    make(tmp_path, "b", "a.mcap", "c.csv")
    assert list(names(tmp_path, "c.csv", "b", "a.mcap").items()) == [
        ("c", "c.csv"),
        ("b", "b"),
        ("a", "a.mcap"),
    ]


def test_a_directory_stands_for_the_recordings_in_it(tmp_path):
    make(tmp_path, "week/tue", "week/mon", "other", "week/readme.txt")
    (tmp_path / "week/empty").mkdir()
    assert names(tmp_path, "week", "other") == {
        "mon": "week/mon",
        "tue": "week/tue",
        "other": "other",
    }


def test_a_result_or_what_holds_no_recording_is_left_to_the_reader(tmp_path):
    make(tmp_path, "result/bag")
    (tmp_path / "result/evaluation.json").touch()
    (tmp_path / "empty").mkdir()
    assert set(names(tmp_path, "result", "empty", "nowhere").values()) == {
        "result",
        "empty",
        "nowhere",
    }


@pytest.mark.parametrize("loose", ["c.mcap", "c_0.db3", "c.csv"])
def test_a_directory_with_other_files_that_could_be_recordings_is_ambiguous(tmp_path, loose):
    make(tmp_path, "week/mon", f"week/{loose}")
    with pytest.raises(BagError, match=rf"could be some \({loose}\); name the recordings one by"):
        names(tmp_path, "week")


def test_recordings_of_one_stem_are_told_apart_by_what_differs(tmp_path):
    make(tmp_path, "mon/run", "tue/run", "wed.1", "wed.2", "x.db3", "x.mcap", "one/a/b", "two/a/b")
    assert names(
        tmp_path, "mon/run", "tue/run", "wed.1", "wed.2", "x.db3", "x.mcap", "one/a/b", "two/a/b"
    ) == {
        "mon_run": "mon/run",
        "tue_run": "tue/run",
        "wed.1": "wed.1",
        "wed.2": "wed.2",
        "x.db3": "x.db3",
        "x.mcap": "x.mcap",
        "one_a_b": "one/a/b",
        "two_a_b": "two/a/b",
    }


def test_a_name_that_is_taken_is_told_apart_too(tmp_path):
    make(tmp_path, "here/summary.csv")
    taken = ("summary.csv", "summary")
    assert names(tmp_path, "here/summary.csv", taken=taken) == {
        "here_summary.csv": "here/summary.csv"
    }


def test_names_that_cannot_be_told_apart_are_an_error():
    with pytest.raises(
        BagError, match="/x_y/r, /x/y/r: their results would have the same name, 'x_y_r'"
    ):
        named_recordings(["/x_y/r", "/x/y/r", "/y/r"])


@pytest.mark.parametrize(
    ("paths", "text"),
    [
        (("a", "a"), "a: expected each recording once, got it twice; leave one"),
        (("a", "link"), "a, .*link: expected each recording once, but they are the same one"),
        (("a", "a/a_0.mcap"), "a, .*a_0.mcap: expected each recording once, but"),
        (("a/a_0.mcap", "a"), "a, .*a_0.mcap: expected each recording once, but"),
        ((".", "a"), "a: expected each recording once, got it twice"),
    ],
)
def test_the_same_recording_twice_is_an_error(tmp_path, paths, text):
    make(tmp_path, "a")
    (tmp_path / "a/a_0.mcap").touch()
    (tmp_path / "link").symlink_to("a") if "link" in paths else None
    with pytest.raises(BagError, match=text):
        names(tmp_path, *paths)


def test_a_name_with_control_characters_is_an_error(tmp_path):
    make(tmp_path, "a\x1bb")
    with pytest.raises(BagError, match="expected a name in UTF-8 without control characters"):
        names(tmp_path, "a\x1bb")


def test_a_name_is_that_of_the_directory_which_dots_stand_for(tmp_path, monkeypatch):
    make(tmp_path, "monday", "tuesday")
    (tmp_path / "monday/notes").mkdir()
    monkeypatch.chdir(tmp_path / "monday/notes")
    assert list(named_recordings(["..", "../../tuesday"])) == ["monday", "tuesday"]


def test_an_empty_path_is_not_the_working_directory(tmp_path, monkeypatch):
    make(tmp_path, "a")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BagError, match="expected the name of a file or directory, got ''"):
        named_recordings([""])


def test_the_root_directory_is_not_named_twice():
    with pytest.raises(BagError, match="/: expected a name"):
        named_recordings(["/"])

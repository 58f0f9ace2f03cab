# SPDX-License-Identifier: Apache-2.0
"""What all results have: files, written whole or not at all, and a text of ten lines."""

import copy
import json
import os
import pickle
from dataclasses import dataclass
from pathlib import Path

import pytest

from inverse_dynamics.errors import OutputError
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.show.result import (
    PAGE,
    Result,
    ResultDirectory,
    ResultFiles,
    files_of,
)
from inverse_dynamics.show.tables import ReportTable


@dataclass(frozen=True, repr=False)
class Sum(Result):
    values: tuple[float, ...] = (1.0, 2.0)
    notes: tuple[str, ...] = ()
    recording: Path | None = None

    def numbers(self):
        return {"schema": 1, "sum": sum(self.values), "recording": self.recording}

    def lines(self):
        table = ReportTable("Values", ("value",), [(value,) for value in self.values])
        return [("", "An arm"), ("sum", f"{sum(self.values)}"), ("note", self.notes), table]

    def inputs(self):
        return [self.recording]

    def page(self):
        return "<html>"

    def plot(self):
        from matplotlib.figure import Figure

        return Figure(figsize=(1, 1))


class SumDirectory(Sum, ResultDirectory):
    contents = files_of("sum.json", "sum", PAGE)


class SumFiles(Sum, ResultFiles):
    names = ("{stem}_more{suffix}", "{stem}.json", "{stem}.{figure}")
    reader = ", as --sum takes it"

    def texts(self, files):
        return f"more: {files[1].name}\n", "more\n", json_text(self.numbers())


def test_a_directory_holds_numbers_samples_page_and_figures(tmp_path):
    SumDirectory().save(tmp_path / "sum", figures=("png", "svg"))
    names = ["report.html", "series.npz", "sum.json", "sum.png", "sum.svg"]
    assert sorted(os.listdir(tmp_path / "sum")) == names
    assert json.loads((tmp_path / "sum/sum.json").read_text())["sum"] == 3.0
    assert SumDirectory.load(tmp_path / "sum") == SumDirectory()
    with pytest.raises(OutputError, match="exists already"):
        SumDirectory().save(tmp_path / "sum")
    SumDirectory((4.0,)).save(str(tmp_path / "sum"), overwrite=True, figures=())
    assert sorted(os.listdir(tmp_path / "sum")) == names[:3]
    assert (tmp_path / "sum/report.html").read_text() == "<html>"


def test_files_lie_beside_each_other(tmp_path):
    out = tmp_path / "a.yml"
    SumFiles().save(out, more={tmp_path / "b.txt": "b"})
    assert {file.name for file in SumFiles.files(out, ("png",))} | {"b.txt"} == {
        *os.listdir(tmp_path)
    }
    assert [f.name for f in SumFiles.files(out)] == ["a.yml", "a.npz", "a_more.yml", "a.json"]
    assert SumFiles.load(out) == SumFiles()
    assert out.read_text() == "more: a_more.yml\n"
    with pytest.raises(OutputError, match="exists already"):
        SumFiles().save(out)
    with pytest.raises(OutputError, match="in .yaml, as sum= takes it; name another file with"):
        SumFiles().save(tmp_path / "a.txt")
    with pytest.raises(
        OutputError, match="expected a file of its own for --b, got one of the other"
    ):
        SumFiles.check(tmp_path / "c.yaml", more={"--b": tmp_path / "c.json"})


@pytest.mark.parametrize("kind", [SumDirectory, SumFiles])
def test_nothing_is_written_over_an_input_or_if_a_file_fails(tmp_path, monkeypatch, kind):
    (tmp_path / "in.yaml").write_text("read")
    result, out = kind(recording=tmp_path / "in.yaml"), tmp_path / "out.yaml"
    with pytest.raises(OutputError, match="in.yaml"):
        result.save(tmp_path / "in.yaml", overwrite=True)
    with pytest.raises(OutputError, match="figures: expected some of png, svg, pdf, got 'gif'"):
        result.save(out, figures=("gif",))

    def fail(self):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(kind, "plot", fail)
        with pytest.raises(OutputError, match="No space left on device"):
            result.save(out)
    assert os.listdir(tmp_path) == ["in.yaml"]


def test_its_text_has_ten_lines_at_most():
    assert repr(SumFiles()).split("\n") == [
        "SumFiles",
        "robot: An arm",
        "sum: 3.0",
        "table: Values",
    ]
    lines = repr(SumFiles(notes=("long " * 100,) * 20)).split("\n")
    assert len(lines) == 10
    assert max(map(len, lines)) <= 110


def test_it_is_copied_and_pickled_with_its_members():
    result = SumFiles((3.0,), ("a note",))
    assert copy.deepcopy(result) == result == pickle.loads(pickle.dumps(result))

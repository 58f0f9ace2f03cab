# SPDX-License-Identifier: Apache-2.0
import json
import os
import runpy
from dataclasses import make_dataclass, replace

import numpy as np
import pytest
from example_evaluations import make_evaluation

from inverse_dynamics import read_evaluation, read_joint_log, write_evaluation
from inverse_dynamics._core import Effort, Verdict
from inverse_dynamics.errors import OutputError, UserError
from inverse_dynamics.evaluation.evaluation import SCHEMA
from inverse_dynamics.outputs import plain

FILES = {
    "bag",
    "evaluation.json",
    "metrics.json",
    "series.npz",
    "torques.png",
}


@pytest.fixture(scope="module")
def evaluation():
    return make_evaluation()


@pytest.fixture(scope="module")
def result(tmp_path_factory, evaluation):
    target = tmp_path_factory.mktemp("results") / "result"
    write_evaluation(evaluation, target)
    return target


def test_all_files_are_there(result):
    assert set(os.listdir(result)) == FILES
    assert os.listdir(result.parent) == ["result"]


def test_a_result_is_read_back_whole(result, evaluation):
    read = read_evaluation(result)
    for field in ("robot", "bag", "joint_names", "units", "accelerations", "errors", "notes"):
        assert getattr(read, field) == getattr(evaluation, field)
    assert read.errors_of_kept == evaluation.errors_of_kept
    for field in ("qdd", "computed", "measured", "time"):
        np.testing.assert_array_equal(getattr(read, field), getattr(evaluation, field))
    for field in ("repeated", "start_transient", "kept"):
        np.testing.assert_array_equal(
            getattr(read.samples, field), getattr(evaluation.samples, field)
        )
    assert read.log.frame_id == "base"
    np.testing.assert_array_equal(read.log.receive_stamps, evaluation.log.receive_stamps)


@pytest.mark.parametrize(
    ("kind", "array"),
    [("Floats", np.ones(2)), ("Integers", np.arange(2)), ("Mask", np.ones(2, dtype=bool))],
)
def test_arrays_are_read_back_whatever_numpys_own_annotation_is(monkeypatch, kind, array):
    # That of NumPy 2.5 is an alias: as of this stand-in, its origin isn't ndarray.
    monkeypatch.setattr("numpy.typing.NDArray", list)
    read_back = runpy.run_path(plain.__file__)["read_back"]
    holder = make_dataclass("Holder", [("array", kind)])
    assert read_back(holder, {"array": array}, "holder").array is array
    with pytest.raises(ValueError, match=r"holder.array: expected ndarray, got "):
        read_back(holder, {"array": array.astype(complex)}, "holder")


def test_currents_are_kept_beside_the_torques_that_they_mean(tmp_path):
    verdict = Verdict("current", sure=True, summary="current is 1 % of the range off")
    effort = Effort("current", "found from the data", (2.0, 3.0, 4.0), verdict)
    evaluation = make_evaluation(effort=effort)
    evaluation = replace(evaluation, log=replace(evaluation.log, effort_is="current"))
    write_evaluation(evaluation, tmp_path / "result", figures=())
    read = read_evaluation(tmp_path / "result")
    assert read.effort == effort
    assert read.log.effort_is == "current"
    np.testing.assert_array_equal(read.log.effort, evaluation.log.effort)
    np.testing.assert_array_equal(read.measured, evaluation.log.effort * [2.0, 3.0, 4.0])
    with np.load(tmp_path / "result/series.npz") as series:
        np.testing.assert_array_equal(series["effort"], evaluation.log.effort)
        np.testing.assert_array_equal(series["measured"], read.measured)
    recorded = read_joint_log(tmp_path / "result/bag", topic="/torques_gt")
    np.testing.assert_array_equal(recorded.effort, read.measured)
    metrics = json.loads((tmp_path / "result/metrics.json").read_text())
    assert metrics["effort"]["meaning"] == "current"
    assert metrics["effort"]["drive_gains"] == [2.0, 3.0, 4.0]
    assert metrics["effort"]["verdict"]["sure"] is True
    assert metrics["effort"]["verdict"]["summary"] == verdict.summary


def test_metrics_say_what_they_are_of(result, evaluation):
    metrics = json.loads((result / "metrics.json").read_text())
    assert (metrics["robot"], metrics["plugin"], metrics["bag"]) == ("arm", "a/B", "recording")
    assert metrics["samples"] == 400
    assert metrics["accelerations"]["cutoff"] == 3.25
    first = metrics["joints"][0]
    assert (first["joint"], first["unit"]) == ("joint_1", "N m")
    for name in ("mae", "rmse", "nrmse", "bias", "r2", "max_abs"):
        assert first[name] == getattr(evaluation.errors[0], name)
    assert metrics["mean_rmse"] == pytest.approx(evaluation.mean_rmse)
    assert metrics["kept"]["samples"] == 395


def test_undefined_figures_are_null(tmp_path, evaluation):
    undefined = tuple(replace(e, nrmse=float("nan"), r2=float("nan")) for e in evaluation.errors)
    write_evaluation(replace(evaluation, errors=undefined), tmp_path / "result", figures=())
    metrics = json.loads((tmp_path / "result/metrics.json").read_text())
    assert metrics["joints"][0]["nrmse"] is None
    assert np.isnan(read_evaluation(tmp_path / "result").errors[0].r2)


def test_the_output_recording_keeps_stamps_names_and_motion(result, evaluation):
    for topic, effort in (("/torques", evaluation.computed), ("/torques_gt", evaluation.measured)):
        log = read_joint_log(result / "bag", evaluation.log.joint_names, topic=topic)
        np.testing.assert_array_equal(log.effort, effort)
        for field in ("header_stamps", "receive_stamps", "q", "qd"):
            np.testing.assert_array_equal(getattr(log, field), getattr(evaluation.log, field))
        assert log.frame_id == "base"
        assert log.storage == "sqlite3"


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_the_output_recording_has_the_storage_of_the_input_or_the_one_given(
    tmp_path, evaluation, storage
):
    other = replace(evaluation, log=replace(evaluation.log, storage="mcap"))
    write_evaluation(other, tmp_path / "same", figures=())
    assert read_joint_log(tmp_path / "same/bag", topic="/torques").storage == "mcap"
    write_evaluation(other, tmp_path / "given", storage=storage, figures=())
    assert read_joint_log(tmp_path / "given/bag", topic="/torques").storage == storage


def test_a_directory_of_something_else_is_no_result(tmp_path):
    expected = "expected one written by `ids evaluate`"
    with pytest.raises(OutputError, match=f": holds no evaluation.json; {expected}"):
        read_evaluation(tmp_path)
    with pytest.raises(OutputError, match=f"elsewhere: no such directory; {expected}"):
        read_evaluation(tmp_path / "elsewhere")


@pytest.mark.parametrize("file", ["metrics.json", "series.npz"])
def test_an_incomplete_result_is_an_error(tmp_path, evaluation, file):
    write_evaluation(evaluation, tmp_path / "result", figures=())
    os.truncate(tmp_path / "result" / file, 20)
    with pytest.raises(OutputError, match="isn't a complete evaluation"):
        read_evaluation(tmp_path / "result")


def test_a_result_of_another_version_is_an_error(tmp_path, evaluation):
    write_evaluation(evaluation, tmp_path / "result", figures=())
    file = tmp_path / "result/evaluation.json"
    file.write_text(file.read_text().replace(f'"schema": {SCHEMA}', '"schema": 70'))
    with pytest.raises(OutputError, match=f"expected schema {SCHEMA}, got 70; evaluate again"):
        read_evaluation(tmp_path / "result")


def edited(kind):
    """What somebody may have put in place of a value of JSON by hand."""
    return {
        "null": None,
        "text": "x",
        "list": [],
        "mapping": {},
    }[kind]


def paths_of(data, path=()):
    """Paths of all values in JSON; of a list, its first."""
    yield path
    if isinstance(data, dict):
        for key, value in data.items():
            yield from paths_of(value, (*path, key))
    elif isinstance(data, list) and data:
        yield from paths_of(data[0], (*path, 0))


def use(directory, *, page=True):
    """What report, compare and export do with a result. page: the slow part too."""
    from inverse_dynamics.comparison.comparison import compare
    from inverse_dynamics.evaluation.exports import series_columns
    from inverse_dynamics.evaluation.page import report_run
    from inverse_dynamics.evaluation.tables import evaluation_table
    from inverse_dynamics.show.page import render_page

    read = read_evaluation(directory)
    evaluation_table(read)
    series_columns(read)
    compare([read, read], ("a", "b"))
    if page:
        render_page("title", [report_run(read)])


@pytest.fixture(scope="module")
def plain_result(tmp_path_factory):
    """A result without a description, and with a verdict: it can be shown, and has every kind of entry."""
    effort = Effort("current", "found from the data", (2.0,), Verdict("current", sure=True))
    plain = make_evaluation(samples=60, joints=1, effort=effort)
    plain = replace(plain, robot=replace(plain.robot, urdf=None))
    target = tmp_path_factory.mktemp("plain") / "result"
    write_evaluation(plain, target, figures=())
    use(target)
    return target


@pytest.mark.parametrize("kind", ["null", "text", "list", "mapping"])
@pytest.mark.parametrize("file", ["evaluation.json", "metrics.json"])
def test_any_entry_that_was_edited_is_an_error_or_does_no_harm(plain_result, file, kind):
    target = plain_result / file
    text = target.read_text()
    refused = 0
    try:
        for k, path in enumerate(paths_of(json.loads(text))):
            data = json.loads(text)
            if not path:
                data = edited(kind)
            else:
                *above, last = path
                place = data
                for key in above:
                    place = place[key]
                place[last] = edited(kind)
            target.write_text(json.dumps(data))
            try:
                use(plain_result, page=k % 10 == 0)
            except UserError:
                refused += 1
    finally:
        target.write_text(text)
    assert refused >= 10


SERIES = ["q", "effort", "computed", "header_stamps", "kept"]


@pytest.mark.parametrize("name", SERIES)
def test_series_that_were_edited_are_an_error(plain_result, name):
    target = plain_result / "series.npz"
    content = target.read_bytes()
    with np.load(target) as series:
        arrays = dict(series)
    wrong = (arrays[name][:-1], arrays[name][..., None], arrays[name].astype(str), np.float64(1.0))
    try:
        for changed in wrong:
            np.savez(target, **{**arrays, name: changed})
            with pytest.raises(OutputError, match="isn't a complete evaluation .*; evaluate again"):
                read_evaluation(plain_result)
        del arrays[name]
        np.savez(target, **arrays)
        with pytest.raises(OutputError, match="isn't a complete evaluation .*; evaluate again"):
            read_evaluation(plain_result)
    finally:
        target.write_bytes(content)

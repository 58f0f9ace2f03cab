# SPDX-License-Identifier: Apache-2.0
import json
import os
from dataclasses import replace

import numpy as np
import pytest
from example_evaluations import make_evaluation

from inverse_dynamics import read_evaluation, read_joint_log, write_evaluation
from inverse_dynamics._core import Effort, Verdict
from inverse_dynamics.errors import OutputError

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


def test_an_incomplete_result_is_an_error(tmp_path, evaluation):
    write_evaluation(evaluation, tmp_path / "result", figures=())
    os.truncate(tmp_path / "result/series.npz", 20)
    with pytest.raises(OutputError, match="expected a result of this version .*; compute it again"):
        read_evaluation(tmp_path / "result")


@pytest.fixture(scope="module")
def plain_result(tmp_path_factory):
    target = tmp_path_factory.mktemp("plain") / "result"
    write_evaluation(make_evaluation(samples=60, joints=1), target, figures=())
    return target


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
            with pytest.raises(OutputError, match="expected a result of this version"):
                read_evaluation(plain_result)
        del arrays[name]
        np.savez(target, **arrays)
        with pytest.raises(OutputError, match="expected a result of this version"):
            read_evaluation(plain_result)
    finally:
        target.write_bytes(content)

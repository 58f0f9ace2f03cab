# SPDX-License-Identifier: Apache-2.0
import re
from dataclasses import replace

import numpy as np
import pytest
from command_line import fails
from example_recordings import recording, table_of, write_table

from inverse_dynamics import evaluate, read_evaluation, write_joint_logs

# The recordings have samples at 0, 0.004, ... 5.996 s after the first.


@pytest.fixture(scope="module")
def log(tmp_path_factory, solver):
    return recording(tmp_path_factory.mktemp("log") / "whole", solver)


@pytest.fixture(scope="module")
def bag(tmp_path_factory, log):
    path = tmp_path_factory.mktemp("recording") / "bag"
    write_joint_logs(path, {log.topic: log})
    return path


def part_of(log, rows):
    names = ("header_stamps", "receive_stamps", "q", "qd", "effort")
    return replace(log, **{name: getattr(log, name)[rows] for name in names})


@pytest.mark.parametrize(
    ("start", "end", "rows"),
    [
        (1.0, 2.0, slice(250, 501)),
        (None, 2.0, slice(0, 501)),
        (4.0, None, slice(1000, 1500)),
        (1.001, 1.999, slice(251, 500)),
        (0.3, 0.6, slice(75, 151)),  # 1e-9 * 3e8 > 0.3
        (-5.0, 100.0, slice(0, 1500)),
    ],
)
def test_the_result_is_that_of_a_recording_of_the_samples_in_the_window(
    tmp_path, log, bag, start, end, rows
):
    write_joint_logs(tmp_path / "part", {log.topic: part_of(log, rows)})
    part, window = (
        evaluate(tmp_path / "part", "ur10_simulated"),
        evaluate(bag, "ur10_simulated", start=start, end=end),
    )
    assert window.errors == part.errors
    assert window.errors_of_kept == part.errors_of_kept
    assert window.accelerations == part.accelerations
    for name in ("time", "qdd", "computed", "measured"):
        np.testing.assert_array_equal(getattr(window, name), getattr(part, name))
    np.testing.assert_array_equal(window.log.stamps, part.log.stamps)
    assert [n for n in window.notes if n not in part.notes] == [window.notes[0]]


def test_the_window_is_told(ids, bag):
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--figures", "none", "--out", "out")
    code, out, _ = ids(*command, "--from", "1", "--to", "2.25")
    assert code == 0
    text = "only the samples from 1 s to 2.25 s after the recording's first one are evaluated"
    assert re.search(rf"^note +{text}", out, re.M)
    assert re.search(r"^recording .*: 313 samples, 1.2 s$", out, re.M)
    assert read_evaluation("out").notes[0].startswith(text)


def test_tables_and_receive_stamps_have_windows_too(tmp_path, log, bag):
    write_table(tmp_path / "table.csv", table_of(log.effort))
    assert len(evaluate(tmp_path / "table.csv", "ur10_simulated", start=1.0, end=2.0).log) == 251
    late = replace(log, receive_stamps=log.receive_stamps + 1000 * np.arange(1500) ** 2)
    write_joint_logs(tmp_path / "late", {log.topic: late})
    header = evaluate(tmp_path / "late", "ur10_simulated", start=4.0)
    receive = evaluate(tmp_path / "late", "ur10_simulated", start=4.0, clock="receive")
    assert len(header.log) == 500
    assert 500 < len(receive.log) < 1500


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (
            ("--from", "10", "--to", "20"),
            "expected samples from 10 s to 20 s after the first one, got",
        ),
        (("--from", "5.997"), "none: those of the recording go from 0 s to 5.996 s; choose --from"),
        (("--to", "-1"), "expected samples to -1 s after the first one, got none"),
        (("--from", "1.001", "--to", "1.003"), "expected samples from 1.001 s to 1.003 s"),
        (
            ("--from", "2", "--to", "1"),
            "--to (end=): expected a time after --from (start=), 2 s, got 1",
        ),
        (
            ("--from", "2", "--to", "2"),
            "--to (end=): expected a time after --from (start=), 2 s, got 2",
        ),
        (("--from", "nan"), "argument --from: expected a number, got 'nan'"),
        (("--to", "1e300"), "--to (end=): expected a time in s since the first sample, got 1e+300"),
    ],
)
def test_a_window_without_samples_is_an_error(ids, bag, tmp_path, options, text):
    fails(ids("evaluate", bag, "--robot", "ur10_simulated", *options), text)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("samples", [1, 2])
def test_too_few_samples_in_a_window_are_an_error_that_names_the_window(
    ids, bag, tmp_path, samples
):
    end = 1.002 if samples == 1 else 1.006
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--from", "1", "--to", end)
    fails(ids(*command), f"{bag}, from 1 s to {end} s: /joint_states: ")
    write_table(tmp_path / "table.csv", table_of(np.zeros((1500, 6))))
    command = ("evaluate", "table.csv", "--robot", "ur10_simulated", "--from", "1", "--to", end)
    fails(ids(*command), f"table.csv, from 1 s to {end} s: ")

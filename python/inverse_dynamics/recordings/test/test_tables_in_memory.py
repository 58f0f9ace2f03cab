# SPDX-License-Identifier: Apache-2.0
"""Recordings that are no files: arrays by name, structured arrays, DataFrames, samples."""

import numpy as np
import pytest

from inverse_dynamics import (
    Solver,
    UserError,
    estimate_payload,
    evaluate,
    find_contacts,
    identify,
    read_recording,
)

ROBOT = "ur10_simulated"
COUNT = 1001
ROUNDING = 1e-9  # N m


@pytest.fixture(scope="module")
def arrays():
    """A motion with a load of 3 kg, whose efforts the described arm explains but for it."""
    time = np.linspace(0, 10, COUNT)
    phase = time[:, None] + np.arange(6)
    q, qd = np.sin(phase), np.cos(phase)
    solver = Solver(ROBOT)
    solver.set_payload("load", 3.0)
    return {"time": time, "q": q, "qd": qd, "qdd": -q, "effort": solver.torques(q, qd, -q)}


def structured(arrays):
    kinds = [(name, float, array.shape[1:]) for name, array in arrays.items()]
    table = np.zeros(COUNT, kinds)
    for name, array in arrays.items():
        table[name] = array
    return table


def frame(library, arrays):
    """A DataFrame with the joints in another order than that of the chain."""
    columns = {"time": arrays["time"]}
    for name, array in arrays.items():
        if array.ndim == 2:
            pairs = list(zip(Solver(ROBOT).joint_names, array.T, strict=True))
            columns |= {f"{name}.{joint}": column for joint, column in reversed(pairs)}
    return library.DataFrame(columns)


def frames(library, arrays):
    """A DataFrame per quantity, with columns that are named like the joints, in another order."""
    joints = Solver(ROBOT).joint_names[::-1]
    return {
        name: array
        if array.ndim == 1
        else library.DataFrame(dict(zip(joints, array.T[::-1], strict=True)))
        for name, array in arrays.items()
    }


SOURCES = {
    "arrays": lambda arrays: arrays,
    "lists": lambda arrays: {name: array.tolist() for name, array in arrays.items()},
    "structured array": structured,
    "samples": lambda arrays: read_recording(arrays, Solver(ROBOT).joint_names),
    **{
        f"{library} {kind.__name__}": lambda arrays, library=library, kind=kind: kind(
            pytest.importorskip(library), arrays
        )
        for library in ("pandas", "polars")
        for kind in (frame, frames)
    },
}


@pytest.mark.parametrize("source", SOURCES)
def test_every_source_gives_the_same_evaluation(source, arrays):
    expected = evaluate(arrays, ROBOT)
    result = evaluate(SOURCES[source](arrays), ROBOT)
    np.testing.assert_allclose(result.computed, expected.computed, atol=1e-6)
    np.testing.assert_allclose(result.measured, expected.measured, atol=ROUNDING)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("source", SOURCES)
def test_every_feature_takes_them(source, arrays, tmp_path):
    table = SOURCES[source](arrays)
    found = estimate_payload(table, ROBOT)
    assert found.estimate.mass == pytest.approx(3.0, abs=0.1)
    assert find_contacts(table, ROBOT, quiet=(0.0, 5.0)).contacts == ()
    model = identify(table, ROBOT, accept=["no_friction"])
    assert model.held_out["identified"].mean() < model.held_out["urdf"].mean()
    assert all(np.isfinite(interval.half_width) for interval in model.intervals)
    model.save(tmp_path / "arm.yaml")
    assert evaluate(table, tmp_path / "arm.yaml").mean_rmse < 1.0


class Frame:
    """Has the interface of DataFrames, as pandas and polars needn't be there."""

    def __init__(self, columns):
        self.columns = list(columns)
        self.of = columns

    def __getitem__(self, name):
        return self.of[name]


def test_columns_named_like_joints_are_taken_by_name():
    time = np.arange(20) / 100
    q = np.arange(40.0).reshape(20, 2)
    swapped = Frame({"elbow": q[:, 1], "shoulder": q[:, 0]})
    table = {"time": time, "q": swapped, "effort": q}
    log = read_recording(table, ["shoulder", "elbow"])
    np.testing.assert_array_equal(log.q, q)
    numbered = Frame({"q1": q[:, 0], "q2": q[:, 1]})
    log = read_recording({**table, "q": numbered}, ["shoulder", "elbow"])
    np.testing.assert_array_equal(log.q, q)
    by_name = {"elbow": q[:, 1], "shoulder": q[:, 0]}
    log = read_recording({**table, "q": by_name}, ["shoulder", "elbow"])
    np.testing.assert_array_equal(log.q, q)


def test_of_two_arms_in_a_frame_each_has_its_own_columns():
    q = np.arange(80.0).reshape(20, 4)
    names = ["left_joint1", "left_joint2", "right_joint1", "right_joint2"]
    frame = Frame(dict(zip(names, q.T, strict=True)))
    table = {"time": np.arange(20) / 100, "q": frame, "effort": frame}
    np.testing.assert_array_equal(read_recording(table, names[:2]).q, q[:, :2])
    np.testing.assert_array_equal(read_recording(table, names[2:]).q, q[:, 2:])


def test_columns_of_the_same_name_are_an_error(arrays):
    q = Frame({"shoulder": arrays["q"][:, 0]})
    q.columns *= 2
    with pytest.raises(UserError, match="two columns are called shoulder"):
        read_recording({**arrays, "q": q})


def test_what_is_no_number_in_a_frame_of_pandas_is_passed_over(arrays):
    pandas = pytest.importorskip("pandas")
    table = frame(pandas, arrays)
    log = read_recording(table, Solver(ROBOT).joint_names)
    table["text"], table["kind"] = "some", pandas.Categorical(["some"] * COUNT)
    table["list"], table["day"] = [[1, 2]] * COUNT, pandas.Timestamp("2026-01-01", tz="UTC")
    np.testing.assert_array_equal(read_recording(table, log.joint_names).q, log.q)
    table["time"] = pandas.Timestamp("2026-01-01", tz="UTC") + pandas.to_timedelta(
        table["time"], unit="s"
    )
    table.loc[5, "time"] = pandas.NaT
    assert len(read_recording(table, log.joint_names)) == COUNT - 1


def test_masked_numbers_are_missing(arrays):
    masked = np.ma.masked_array(arrays["q"].copy(), np.zeros((COUNT, 6), bool))
    masked[10, 2] = np.ma.masked
    masked.data[10, 2] = 1e3
    log = read_recording({**arrays, "q": masked})
    assert len(log) == COUNT - 1
    assert "1 row with an empty field left out" in log.notes
    assert np.abs(log.q).max() < 2


@pytest.mark.parametrize("name", ["time", "q", "qd", "effort"])
def test_lengths_that_differ_are_an_error(name, arrays):
    with pytest.raises(UserError, match=rf"^arrays: \w+: expected \d+ samples, .*{name} \(10,"):
        read_recording({**arrays, name: arrays[name][:10]})


def test_fewer_samples_than_joints_are_read():
    zeros = np.zeros((3, 6))
    table = {"time": np.arange(3) / 10, "q": zeros, "qd": zeros, "effort": zeros}
    assert read_recording(table).q.shape == (3, 6)


def test_what_is_no_table_is_named(arrays):
    with pytest.raises(UserError, match=r"expected Path .* got an array of float64 \(1001, 6\)"):
        evaluate(arrays["q"], ROBOT)


def test_samples_of_other_joints_are_an_error(arrays):
    log = read_recording(arrays, Solver(ROBOT).joint_names)
    with pytest.raises(UserError, match="missing other"):
        log.of(["other"])
    two = log.of(log.joint_names[3:1:-1])
    np.testing.assert_array_equal(two.q, log.q[:, 3:1:-1])
    assert repr(two) == "<JointLog: 1001 samples in 10 s of wrist_1_joint, elbow_joint>"

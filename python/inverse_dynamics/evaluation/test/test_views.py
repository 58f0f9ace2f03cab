# SPDX-License-Identifier: Apache-2.0
"""Arrays in, and an evaluation as people look at it."""

import pickle
import re
import sys
from types import ModuleType

import numpy as np
import pytest
from example_recordings import motion
from example_robots import JOINTS

import inverse_dynamics
from inverse_dynamics import Solver, evaluate, load_robot
from inverse_dynamics.errors import ArgumentError, BagError
from inverse_dynamics.robots.solvers import open_solver


@pytest.fixture(scope="module")
def arrays():
    q, qd, qdd, stamps = motion()
    solver: Solver = open_solver(
        load_robot("ur10_simulated"), load_robot("ur10_simulated").urdf.read_text()
    )
    return {"time": stamps * 1e-9, "q": q, "qd": qd, "tau": solver.torques(q, qd, qdd) + 0.1}


@pytest.fixture(scope="module")
def evaluation(arrays):
    return evaluate(arrays, "ur10_simulated")


def test_arrays_by_name_are_a_recording(evaluation, arrays):
    np.testing.assert_array_equal(evaluation.measured, arrays["tau"])
    assert evaluation.mean_rmse == pytest.approx(0.1, abs=0.01)
    assert evaluation.log.notes[0].startswith("columns: time: time; position: q[0] to q[5]")


def test_a_data_frame_is_a_recording(evaluation, arrays):
    class DataFrame:
        """What pandas and polars have in common."""

        columns = (*(f"{joint}_{kind}" for joint in JOINTS for kind in ("pos", "tau")), "t")

        def __getitem__(self, name):
            if name == "t":
                return arrays["time"]
            joint, _, kind = name.rpartition("_")
            return arrays["q" if kind == "pos" else "tau"][:, JOINTS.index(joint)]

    assert evaluate(DataFrame(), "ur10_simulated").mean_rmse == pytest.approx(
        0.1, abs=0.1
    )  # velocities of the positions


@pytest.mark.parametrize(
    ("changed", "error", "expected"),
    [
        (
            {"q": None},
            BagError,
            "arrays: expected columns of position for 6 joints, shoulder_pan_joint, ",
        ),
        (
            {"tau": np.full((1500, 6), np.inf)},
            BagError,
            "arrays: tau[0]: expected finite numbers, got inf in row 1",
        ),
        (
            {5: 1},
            ArgumentError,
            "evaluate: argument bag: expected Path | str | JointLog | Mapping[str, Any] | DataFrame, got {",
        ),
    ],
)
def test_arrays_that_are_no_recording_are_refused(arrays, changed, error, expected):
    with pytest.raises(error, match=re.escape(expected)):
        evaluate({**arrays, **changed}, "ur10_simulated")


def test_an_evaluation_is_shown_on_one_screen(evaluation):
    lines = repr(evaluation).splitlines()
    assert lines[0].startswith(
        "Evaluation of arrays as ur10_simulated: 1500 samples, 6.0 s, mean RMSE 0.1"
    )
    assert lines[2].split()[:2] == ["shoulder_pan_joint", "N"]
    assert re.search(r" [\d.e-]+ %", lines[2])  # NRMSE, as in tables
    assert len(lines) < 12
    html = evaluation._repr_html_()
    assert html.count("<tr>") == 7
    assert "<td>wrist_3_joint</td>" in html


def test_an_evaluation_is_drawn(evaluation):
    pytest.importorskip("matplotlib")
    assert len(evaluation.plot().axes) >= 12


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_an_evaluation_is_a_data_frame(evaluation, monkeypatch, library):
    module = ModuleType(library)
    module.DataFrame = dict
    monkeypatch.setitem(sys.modules, library, module)
    monkeypatch.setattr("inverse_dynamics.installation.extras.is_installed", lambda _: True)
    frame = getattr(evaluation, f"to_{library}")()
    np.testing.assert_array_equal(frame["measured.elbow_joint"], evaluation.measured[:, 2])
    assert {"time", "position.elbow_joint", "kept"} <= set(frame)


def test_names_of_the_package_are_those_for_users():
    assert {"Solver", "evaluate", "identify"} <= set(dir(inverse_dynamics))
    assert not {"TYPE_CHECKING", "import_module"} & set(dir(inverse_dynamics))


def test_it_is_pickled_with_its_explanation_and_without_its_run(evaluation):
    again = pickle.loads(pickle.dumps(evaluation))
    assert (repr(again), again.causes) == (repr(evaluation), evaluation.causes)
    np.testing.assert_array_equal(again.computed, evaluation.computed)
    assert again.run is None

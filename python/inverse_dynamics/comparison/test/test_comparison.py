# SPDX-License-Identifier: Apache-2.0
import re
from dataclasses import replace

import numpy as np
import pytest
import two_arms
from example_evaluations import make_evaluation

from inverse_dynamics import Solver, cli, evaluate, write_evaluation
from inverse_dynamics._core import Effort
from inverse_dynamics.comparison.comparison import compare
from inverse_dynamics.errors import UserError


@pytest.fixture(scope="module")
def evaluation():
    return make_evaluation()


def currents(*gains):
    return Effort("current", "as given", gains)


def test_runs_are_called_by_what_differs(evaluation):
    robot = replace(evaluation.robot, plugin="other_inverse_dynamics_solver/Class", friction=False)
    compared = compare([evaluation, replace(evaluation, robot=robot)])
    assert compared.labels == ("a", "other, without friction")


def test_other_recordings_are_refused(evaluation):
    text = (
        r"expected evaluations of one recording, got recording \(400 samples\) and recording \(300"
    )
    with pytest.raises(UserError, match=text):
        compare([evaluation, make_evaluation(300)])
    log = replace(evaluation.log, effort=evaluation.log.effort + 1)
    other = replace(evaluation, log=log, measured=log.effort)
    with pytest.raises(UserError, match="evaluate the same recording with each solver"):
        compare([evaluation, other])


@pytest.mark.parametrize(
    ("first", "other", "said"),
    [
        (
            Effort(stated_by="as the recording's format says"),
            currents(2.0, 3.0, 4.0),
            "got 'torque, as the recording's format says' and 'current, as given, with drive gains 2 "
            "3 4 N m/A', so measured torques differ; evaluate again with the same "
            "effort_is=",
        ),
        (currents(2.0, 3.0, 4.0), currents(2.0, 3.0, 5.0), "with drive gains 2 3 5 N m/A'"),
    ],
)
def test_other_meanings_of_the_same_efforts_are_refused_with_the_reason(
    evaluation, first, other, said
):
    recorded = evaluation.log.effort
    runs = [replace(evaluation, effort=e, measured=e.torques(recorded)) for e in (first, other)]
    with pytest.raises(UserError, match=re.escape(said)) as caught:
        compare(runs)
    assert str(caught.value).startswith("compare: recording: expected evaluations with one mea")


def test_the_verb_says_what_it_needs(tmp_path, evaluation, capsys):
    write_evaluation(evaluation, tmp_path / "run", figures=())
    run = str(tmp_path / "run")
    for arguments, said in (
        ([run], "compare: expected two evaluations or more, got 1"),
        ([run, run, "--labels", "one"], "compare: expected 2 labels, got 1"),
        ([run, run, "--labels", "a,a"], "expected a label of its own for each run, got twice: a"),
        ([run, str(tmp_path)], "holds no evaluation.json; expected one written by `ids evaluate`"),
    ):
        assert cli.main(["compare", *arguments]) == 2
        assert said in capsys.readouterr().err
    assert cli.main(["compare", run, run, "--labels", "one,two"]) == 0
    assert "two" in capsys.readouterr().out


def test_the_verb_calls_runs_as_the_user_does(tmp_path, evaluation, capsys):
    for name in ("urdf", "identified", "other/urdf"):
        write_evaluation(evaluation, tmp_path / name, figures=())
    assert cli.main(["compare", str(tmp_path / "urdf"), str(tmp_path / "identified")]) == 0
    assert re.search(r"joint +unit +urdf +identified\n", capsys.readouterr().out)
    same = [str(tmp_path / name) for name in ("urdf", "other/urdf")]
    assert cli.main(["compare", *same]) == 0
    assert re.search(rf"joint +unit +{same[0]} +{same[1]}\n", capsys.readouterr().out)


def test_runs_of_a_tree_are_compared_joint_by_joint(tmp_path, capsys):
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    table, file = two_arms.motion(tree, seconds=4.0), two_arms.written(tmp_path)
    place = [0.05, 0.1, 0.05]
    load = {"payload.mass": 2.0, "payload.center_of_mass": place, "payload.tip": "right_tool"}
    runs = [
        evaluate(table, urdf=file, tip=two_arms.ARMS, parameters=given) for given in (None, load)
    ]
    right, loaded = compare(runs).rmse
    assert right.max() < 1e-3
    carries = np.array([not name.startswith("left") for name in tree.joint_names])
    assert (loaded[carries] > 0.1).all()
    np.testing.assert_allclose(loaded[~carries], right[~carries], rtol=1e-6)
    for name, run in zip(("bare", "loaded"), runs, strict=True):
        write_evaluation(run, tmp_path / name, figures=())
    assert cli.main(["compare", str(tmp_path / "bare"), str(tmp_path / "loaded")]) == 0
    assert re.search(r"lift_joint +N +\d", capsys.readouterr().out)

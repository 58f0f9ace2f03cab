# SPDX-License-Identifier: Apache-2.0
"""The option --json: one object on standard output, with the keys that docs/command_line.md lists."""

from __future__ import annotations

import json
import re
from functools import partial
from pathlib import Path

import pytest
from command_line import fails
from example_robots import RIGID_BODY
from simulation_arms import pendulum, two_links, write_robot

from inverse_dynamics import cli
from inverse_dynamics.excitation import excitation
from inverse_dynamics.excitation.excitation import ExcitationOptions

PAGE = Path(__file__).resolve().parents[4] / "docs" / "command_line.md"
DOCUMENTED = dict(
    re.findall(r"^\| `(\w+[^|]*?) *\| (.*) \|$", PAGE.read_text().partition("## JSON")[2], re.M)
)
RAW = ("--accelerations", "backward-difference", "--no-figures")


@pytest.fixture
def found(ids, tmp_path):
    """Run `ids` with --json; gives the result, whose keys are those of a row of the page."""

    def run(row, *arguments, written=(), more=frozenset()):
        code, out, err = ids(*arguments, "--json")
        assert (code, err) == (0, "")
        document = json.loads(out, parse_constant=pytest.fail)
        assert list(document) == ["schema", "verb", "written", "result"]
        assert (document["schema"], document["verb"]) == (3, arguments[0])
        assert document["written"] == [str(path) for path in written]
        assert all((tmp_path / path).exists() for path in written)
        assert set(document["result"]) - more == set(re.findall(r"`(\w+)`", DOCUMENTED[row]))
        return document["result"]

    return run


def test_robots(found):
    robots = found("robots`", "robots")["robots"]
    assert "ur10_real" in {robot["name"] for robot in robots}
    robot = found("robots NAME`", "robots", "ur10_real")
    assert robot["chain"][2] == "elbow_joint"
    assert robot["units"] == ["N m"] * 6
    assert RIGID_BODY in found("robots --plugins`", "robots", "--plugins")["plugins"]


def test_data(found, tmp_path):
    result = found("data`", "data", "--dry-run", "--out", tmp_path)
    assert not any(recording["intact"] for recording in result["recordings"])
    assert result["recordings"][0]["files"][0]["sha256"]


def test_evaluate(found, bag, tmp_path):
    command = ("evaluate", bag, "--robot", "ur10_simulated", *RAW)
    result = found("evaluate`", *command, "--out", "out", written=["out"])
    assert result == json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert result["diagnosis"] == []
    assert result["joints"][0]["rmse"] > 0
    several = found(
        "evaluate`, of several recordings", *command, "--jobs", "1", "--out", "all", written=["all"]
    )
    assert [row["joint"] for row in several["rows"]] == [row["joint"] for row in result["joints"]]
    result = found("compare`", "compare", "out", "all/motion", "--labels", "a,b")
    assert [run["label"] for run in result["runs"]] == ["a", "b"]


def test_a_recording_that_fails_is_in_the_object_and_on_standard_error(ids, bag, tmp_path):
    (tmp_path / "empty.csv").touch()
    command = ("evaluate", bag, "empty.csv", "--robot", "ur10_simulated", *RAW, "--out", "out")
    code, out, err = ids(*command, "--json")
    assert code == 3
    assert "1 of 2 recordings failed" in err
    recordings = {r["name"]: r["error"] for r in json.loads(out)["result"]["recordings"]}
    assert recordings["motion"] is None
    assert "empty.csv" in recordings["empty"]


def test_the_likely_cause_of_errors_has_its_kind(ids, bag, tmp_path):
    """Mounted on a ceiling, said to stand on a floor."""
    command = ("evaluate", bag, "--robot", "ur10_simulated", *RAW, "--gravity", "0,0,9.81")
    code, out, _ = ids(*command, "--out", "out", "--json")
    assert code == 0
    causes = json.loads(out)["result"]["diagnosis"]
    cause = next(cause for cause in causes if cause["kind"] == "gravity")
    assert cause["reference"].startswith("docs/why_dont_my_torques_match.md#")
    assert any(cause["reason"] in note for note in json.loads(out)["result"]["notes"])


def test_an_error_leaves_standard_output_empty(ids):
    fails(ids("robots", "ur11", "--json"), "ids: error: robot 'ur11'")


def test_simulate_excite_and_torques(found, ids, tmp_path, monkeypatch):
    (tmp_path / "motion.yaml").write_text(
        "schema: 1\nkind: waypoints\njoints: [swing]\ntimes: [0, 0.5, 1]\npositions: [[0], [-0.3], [0]]\n"
    )
    robot = write_robot(tmp_path, pendulum())
    command = ("simulate", "--robot", robot, "--trajectory", "motion.yaml", "--out", "bag")
    code, out, err = ids(*command, "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)["result"]
    documented = re.findall(r"`(\w+)`", DOCUMENTED["simulate`"])
    assert set(documented) < set(result)
    assert result["messages"] == 500
    table = "time,position.swing,velocity.swing,acceleration.swing\n0,0,0,0\n1,1,0,0\n"
    (tmp_path / "plan.csv").write_text(table)
    out = ("--robot", robot, "--out", "out.csv")
    result = found("torques`", "torques", "plan.csv", *out, written=["out.csv"])
    assert result["joints"][0]["joint"] == "swing"

    monkeypatch.setattr(excitation, "ExcitationOptions", partial(ExcitationOptions, iterations=6))
    (tmp_path / "two.urdf").write_text(two_links())
    code, out, err = ids(
        "excite", "--urdf", "two.urdf", "--out", "two.yaml", "--duration", "8", "--json"
    )
    assert code == 0
    document = json.loads(out)
    assert document["written"] == ["two.yaml", "two.npz", "two_joint_trajectory.yaml"]
    assert set(document["result"]) == set(re.findall(r"`(\w+)`", DOCUMENTED["excite`"]))
    assert document["result"]["joints"][0]["deviation"]["motion"] > 0


def test_the_page_lists_the_verbs_that_have_the_option(ids):
    verbs = {key.partition(" ")[0].partition("`")[0] for key in DOCUMENTED}
    having = {
        verb
        for verb in cli.verb_modules().keys() - cli.BUILT_ON_REQUEST.keys()
        if "--json" in ids(verb, "--help")[1]
    }
    assert verbs == having

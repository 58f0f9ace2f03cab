# SPDX-License-Identifier: Apache-2.0
"""What all results and inputs of functions have in common: pickle, copy, a short text, files."""

import copy
import pickle
import re
from ast import literal_eval
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import inverse_dynamics as ids
from inverse_dynamics.demo.demo import stored_recording
from inverse_dynamics.excitation.excitation import ExcitationOptions
from inverse_dynamics.outputs.plain import plain
from inverse_dynamics.outputs.stored import stored
from inverse_dynamics.show.result import ResultDirectory, ResultFiles

ROBOT = "ur10_simulated"
WAYPOINTS = [[0.0] * 6, [0.5] * 6, [1.0, 0.2, 0.4, 0, 0, 0]]
MOST_LINES = 10


@cache
def rough():
    """A recording of an arm with friction and a load that its description lacks."""
    log = ids.read_joint_log(stored_recording(ROBOT))
    solver = ids.Solver(ROBOT)
    solver.set_payload("load", 2.0)
    load = solver.gravity_vector(log.q) - ids.Solver(ROBOT).gravity_vector(log.q)
    return replace(log, effort=log.effort + load + 5 * np.tanh(log.qd / 0.05))


def simulated():
    pytest.importorskip("mujoco")
    return ids.simulate(ROBOT, duration=1.0)


RESULTS = {
    "evaluate": lambda: ids.evaluate(rough(), ROBOT),
    "find_contacts": lambda: ids.find_contacts(rough(), ROBOT, quiet=(0.0, 3.0)),
    "estimate_payload": lambda: ids.estimate_payload(ids.read_joint_log(loaded()), ROBOT),
    "identify": lambda: ids.identify(rough(), ROBOT, hold_out=[stored_recording(ROBOT)]),
    "retime": lambda: ids.retime(WAYPOINTS, ROBOT),
    "excite": lambda: ids.excite(ROBOT, options=ExcitationOptions(duration=6.0, iterations=6)),
    "compare": lambda: ids.compare([RESULTS["evaluate"]()] * 2, ("a", "b")),
    "trajectory_torques": lambda: ids.trajectory_torques(trajectory(), ROBOT),
    "simulate": simulated,
    "read_joint_log": rough,
}
INPUTS = {
    "Robot": lambda: ids.load_robot(ROBOT),
    "Solver": lambda: ids.Solver(ROBOT),
    "FastModel": lambda: ids.FastModel.from_urdf(ids.load_robot(ROBOT).urdf),
    "MotionLimits": lambda: ids.MotionLimits(torque=[1.0, 2.0], tip_speed=0.5),
    "JointPath": lambda: ids.JointPath.lines(WAYPOINTS, 0.1, stops=[1]),
}


@pytest.fixture(scope="module", params=[*RESULTS, *INPUTS])
def made(request, tmp_path_factory):
    global directory
    directory = tmp_path_factory.mktemp("made")
    return {**RESULTS, **INPUTS}[request.param]()


def loaded():
    solver, log = ids.Solver(ROBOT), ids.read_joint_log(stored_recording(ROBOT))
    evaluation = ids.evaluate(log, ROBOT)
    solver.set_payload("load", 3.0)
    efforts = solver.torques(log.q, log.qd, evaluation.qdd)
    ids.write_joint_logs(directory / "loaded", {"/joint_states": replace(log, effort=efforts)})
    return directory / "loaded"


def trajectory():
    file = directory / "trajectory.csv"
    rows = np.column_stack([np.linspace(0, 1, 20), np.tile(np.linspace(0, 0.5, 20)[:, None], 6)])
    header = ",".join(["time", *(f"q{k}" for k in range(6))])
    np.savetxt(file, rows, delimiter=",", header=header, comments="")
    return file


def content(value):
    """All of it that can be compared."""
    if hasattr(value, "numbers"):
        return plain(value.numbers()), plain(stored(value))
    if hasattr(value, "states"):
        return plain(value.states(np.linspace(0, 10, 50)))
    if hasattr(value, "torques"):
        return plain(value.torques(*np.full((3, 4, 6), 0.3)))
    return plain(value.__dict__) if hasattr(value, "__dict__") else value


@pytest.mark.parametrize(
    "way",
    [lambda value: pickle.loads(pickle.dumps(value)), copy.copy, copy.deepcopy],
    ids=["pickle", "copy", "deepcopy"],
)
def test_it_is_copied(made, way):
    assert content(way(made)) == content(made)


def test_its_text_is_short_and_names_its_class(made):
    text = repr(made)
    assert text.count("\n") < MOST_LINES
    assert max(map(len, text.split("\n"))) < 1000
    assert type(made).__name__ in text


def test_results_have_files(made, tmp_path):
    if hasattr(made, "numbers") or isinstance(made, ids.SimulatedRun):
        out = tmp_path / (
            "result.csv" if isinstance(made, ids.TrajectoryTorques) else "result.yaml"
        )
        made.save(out)
        assert out.exists()
    if isinstance(made, ResultDirectory | ResultFiles):
        again = type(made).load(out)
        assert content(again) == content(made)
        if hasattr(made, "page"):
            assert again.page() == made.page()
        again.save(tmp_path / "again.yaml", figures=())
        other = ids.Retimed if isinstance(made, ids.Contacts) else ids.Contacts
        with pytest.raises(ids.UserError, match=r"series.npz: (no such file|expected a result of)"):
            other.load(out)


def test_an_identified_model_is_loaded_as_a_robot(tmp_path):
    found = RESULTS["identify"]()
    found.save(tmp_path / "arm.yaml")
    states = np.random.default_rng(1).uniform(-1, 1, size=(3, 20, 6))
    np.testing.assert_array_equal(
        ids.load_robot(tmp_path / "arm.yaml").solver().torques(*states),
        found.solver().torques(*states),
    )


def test_the_remedy_of_a_cause_is_an_argument(tmp_path):
    solver, log = ids.Solver(ROBOT), ids.read_joint_log(stored_recording(ROBOT))
    solver.set_payload("load", 3.0, center_of_mass=[0.0, 0.02, 0.1])
    efforts = solver.torques(log.q, log.qd, ids.evaluate(log, ROBOT).qdd)
    found = ids.evaluate(replace(log, effort=efforts), ROBOT)
    (cause,) = found.diagnosis
    (remedy,) = re.findall(r"give parameters=(\{.*?\}),", cause.remedy)
    assert remedy in found.notes[-1]
    assert ids.evaluate(found.log, ROBOT, parameters=literal_eval(remedy)).mean_rmse < 0.1


def test_a_solver_stands_for_its_robot():
    solver = ids.Solver("ur10_simulated")
    by_name = ids.evaluate(rough(), ROBOT)
    np.testing.assert_array_equal(ids.evaluate(rough(), solver).computed, by_name.computed)
    assert ids.load_robot(ROBOT).topic == solver.robot.topic
    solver.set_payload("load", 2.0)
    assert ids.evaluate(rough(), solver).mean_rmse < by_name.mean_rmse
    with pytest.raises(ids.UserError, match=r"^friction: .*give it to Solver\(\)"):
        ids.evaluate(rough(), solver, friction=False)


def test_a_description_alone_stands_for_a_robot():
    urdf = ids.load_robot(ROBOT).urdf
    found = ids.identify(rough(), urdf=urdf)
    assert found.held_out["identified"].mean() < found.held_out["urdf"].mean()
    with pytest.raises(ids.UserError, match=r"^expected a robot or urdf=, got neither"):
        ids.evaluate(rough())

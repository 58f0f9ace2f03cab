# SPDX-License-Identifier: Apache-2.0
"""Solvers pickled, copied, sent to other processes, and shown."""

import copy
import multiprocessing
import os
import pickle
import signal
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from example_robots import PENDULUM, RIGID_BODY, UR10

from inverse_dynamics import FastModel, Solver, errors, load_robot
from inverse_dynamics.robots.solvers import open_solver

COPIES = {
    "pickle": lambda solver: pickle.loads(pickle.dumps(solver)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}

# What a copy that forgot one of the arguments would not give. A planar robot of two links, turned.
CHAIN = PENDULUM.replace(
    "</robot>",
    """
  <link name="hand"><inertial><origin xyz="0 0 -0.2"/><mass value="1"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="wrist" type="continuous"><parent link="arm"/><child link="hand"/>
    <origin xyz="0 0 -1"/><axis xyz="0 1 0"/></joint>
</robot>""",
)


def set_since() -> Solver:
    """A body, gravity and an acceleration that were set after the solver was made."""
    solver = Solver(RIGID_BODY, urdf=CHAIN, parameters={"payload.old.mass": 1.0})
    solver.clear_payloads()
    solver.set_payload("tool", 2.0, [0.1, 0.2, 0.3], [1, 0, 0, 1, 0, 1])
    solver.set_gravity([1, 2, 3])
    solver.set_base_acceleration([3, 2, 1])
    return solver


MADE = {
    "urdf": lambda: Solver(RIGID_BODY, urdf=CHAIN),
    "tip": lambda: Solver(RIGID_BODY, urdf=CHAIN, tip="arm"),
    "root": lambda: Solver(RIGID_BODY, urdf=CHAIN, root="arm"),
    "attached": lambda: Solver(RIGID_BODY, urdf=CHAIN, tip="arm", attached="ignore"),
    "gravity": lambda: Solver(RIGID_BODY, urdf=CHAIN, gravity=(1, 2, 3)),
    "parameters": lambda: Solver(
        RIGID_BODY, urdf=CHAIN, tip="arm", parameters={"locked_joints.wrist": 1.0}
    ),
    "friction": lambda: Solver(UR10, friction=False),
    "model": lambda: Solver(RIGID_BODY, model="ur10_identified"),
    "set since": set_since,
}


@pytest.mark.parametrize("way", COPIES)
@pytest.mark.parametrize("made", MADE)
def test_a_copy_has_all_that_the_solver_was_made_from(made, way):
    solver = MADE[made]()
    twin = COPIES[way](solver)
    assert twin is not solver
    assert (twin.plugin, twin.joint_names) == (solver.plugin, solver.joint_names)
    state = np.linspace(-3, 3, 5 * len(solver.joint_names)).reshape(5, -1)
    expected = solver.torques(state, state, state)
    np.testing.assert_array_equal(twin.torques(state, state, state), expected)


def test_what_solvers_are_made_from_matters():
    """The test above would see a copy that forgot it: no two of these have the same torques."""
    state = [np.linspace(-3, 3, 2)]
    torques = [tuple(MADE[name]().torques(*3 * state)) for name in ("urdf", "gravity")]
    state = [np.ones(1)]
    one = ("tip", "root", "attached", "parameters")
    torques += [tuple(MADE[name]().torques(*3 * state)) for name in one]
    assert len(set(torques)) == len(torques)


def test_processes_that_know_nothing_compute_the_same():
    robot = load_robot("ur10_real")
    solver = open_solver(robot)
    parts = list(np.random.default_rng(0).normal(size=(4, 50, 6)))
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        results = pool.map(solver.gravity_vector, parts)
    for part, result in zip(parts, results, strict=True):
        np.testing.assert_array_equal(result, solver.gravity_vector(part))


def test_errors_come_back_from_other_processes():
    gravity = Solver(UR10).gravity_vector
    wrong = pytest.raises(errors.SizeMismatchError, match=r"^gravity_vector: argument q: wrong")
    with multiprocessing.get_context("spawn").Pool(1) as pool, wrong:
        pool.map(gravity, [np.zeros(5)])


def test_a_solver_shows_what_it_is():
    assert repr(Solver(UR10)) == f"<Solver {UR10}: 6 joints, shoulder_pan_joint to wrist_3_joint>"
    assert repr(Solver(RIGID_BODY, urdf=PENDULUM)) == f"<Solver {RIGID_BODY}: joint swing>"


def test_a_child_that_is_forked_during_batches_can_change_its_robot():
    too_long = 60  # s, after which a child is ended
    solver, states = Solver("ur10_simulated"), np.zeros((3, 20_000, 6))
    stop = threading.Event()

    def compute():
        while not stop.is_set():
            solver.torques(*states)

    batches = threading.Thread(target=compute)
    batches.start()
    try:
        for _ in range(5):
            child = os.fork()
            if child == 0:
                signal.alarm(too_long)
                solver.set_payload("tool", 1.0)
                os._exit(0 if "tool" in solver.payloads else 1)
            assert os.waitpid(child, 0)[1] == 0
    finally:
        stop.set()
        batches.join()
    assert not solver.payloads


def identified():
    n = 2
    found = SimpleNamespace(
        parameters=np.tile([2.0, 0.1, 0, 0.2, 1, 0, 0, 1, 0, 1], (n, 1)),
        rotor_inertia=np.full(n, 0.3),
        friction=({"fc": 1.0, "fv": 2.0, "fo": 0.1, "width": 0.1, "shift": 0.0},) * n,
        torque_deviation=np.ones(n),
        seen=np.tile([-1.0, 1.0], (3, n, 1)),
        coupling=None,
        friction_at={},
        springs=None,
    )
    return FastModel.from_urdf(CHAIN).identified(found)


MODELS = {
    "from_urdf": lambda _: FastModel.from_urdf(CHAIN, root="arm", gravity=(1, 2, 3), threads=2),
    "from_file": lambda file: FastModel.from_file(file),
    "from_joints": lambda _: FastModel.from_joints(
        *(["a", "b"], [False, True], np.stack([np.eye(3)] * 2), np.ones((2, 3)), np.ones((2, 10))),
        gravity=(0, 0, -9.81),
    ),
    "identified": lambda _: identified(),
}


@pytest.mark.parametrize("way", COPIES)
@pytest.mark.parametrize("made", MODELS)
def test_a_copy_of_a_model_computes_the_same(made, way, tmp_path):
    file = tmp_path / "model.yaml"
    file.write_text(FastModel.from_urdf(CHAIN).file_text(name="m", source="", validity=""))
    model = MODELS[made](f"{file}")
    twin = COPIES[way](model)
    state = np.linspace(-3, 3, 5 * len(model.joint_names)).reshape(5, -1)
    np.testing.assert_array_equal(twin.torques(*3 * [state]), model.torques(*3 * [state]))
    assert repr(twin) == repr(model)

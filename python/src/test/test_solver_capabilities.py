# SPDX-License-Identifier: Apache-2.0
"""What only some solvers compute: against one another, against MuJoCo, on arrays, and its errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np
import pytest
from example_robots import FRANKA, KDL, PINOCCHIO, RIGID_BODY, UR10
from simulation_arms import simulated, urdf_of

from inverse_dynamics import Solver, available_solvers, errors

TIPS = {"ur10": "tool0", "panda": "fer_link8", "oblique_arm": "tool"}
N = 20
# Two programs do the same operations in another order; forward dynamics divides by small inertias.
ROUNDING, SOLVED = 1e-11, 1e-8


def made(plugin: str, arm: str) -> Solver:
    if plugin not in available_solvers():
        pytest.skip(f"{plugin} isn't installed")
    return Solver(plugin, urdf=urdf_of(arm), tip=TIPS[arm])


class Motion(NamedTuple):
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    wrench: np.ndarray


def motion(solver: Solver, count: int = N) -> Motion:
    random = np.random.default_rng(3)
    q, qd, qdd = random.uniform(-2, 2, size=(3, count, len(solver.joint_names)))
    return Motion(q, qd, qdd, random.uniform(-10, 10, size=(count, 6)))


def expect_equal(ours: Any, theirs: Any, tolerance: float = ROUNDING) -> None:
    scale = 1.0 + np.abs(theirs).max()
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance * scale)


# Arguments of each method, of the fields of a Motion (accelerations take the third as torques).
METHODS = {
    "tip_pose": "q",
    "jacobian": "q",
    "tip_jacobian_derivative": "q qd",
    "external_torques": "q wrench",
    "coriolis_matrix": "q qd",
    "kinetic_energy": "q qd",
    "potential_energy": "q",
    "torque_derivatives": "q qd qdd",
    "regressor": "q qd qdd",
    "accelerations": "q qd qdd",
}
OF_KDL = (
    "tip_pose",
    "jacobian",
    "tip_jacobian_derivative",
    "external_torques",
    "accelerations",
)


def call(solver: Solver, method: str, states: Motion, **more: Any) -> Any:
    arguments = [getattr(states, name) for name in METHODS[method].split()]
    return getattr(solver, method)(*arguments, **more)


@pytest.mark.parametrize("plugin", [KDL, PINOCCHIO])
@pytest.mark.parametrize("arm", TIPS)
@pytest.mark.parametrize("method", METHODS)
def test_libraries_agree_with_the_engine(plugin: str, arm: str, method: str) -> None:
    library, engine = made(plugin, arm), made(RIGID_BODY, arm)
    if plugin == KDL and method not in OF_KDL:
        pytest.skip("KDL doesn't compute it")
    states = motion(engine)
    ours, theirs = call(engine, method, states), call(library, method, states)
    for our, their in zip(
        *(r if isinstance(r, tuple) else (r,) for r in (ours, theirs)), strict=True
    ):
        expect_equal(our, their, SOLVED if method == "accelerations" else ROUNDING)


@pytest.mark.parametrize("plugin", [KDL, PINOCCHIO, RIGID_BODY])
@pytest.mark.parametrize("arm", ["ur10", "panda"])
@pytest.mark.parametrize("frame", ["root", "tip"])
def test_mujoco_moves_as_asked_while_the_surroundings_push_back(
    plugin: str, arm: str, frame: str
) -> None:
    """Forward dynamics of MuJoCo under our torques and the reaction -w, as xfrc_applied."""
    solver, simulator = made(plugin, arm), simulated(arm)
    states = motion(solver)
    tau = solver.torques(*states[:3], wrench=states.wrench, frame=frame)
    R, p = solver.tip_pose(states.q)
    last = simulator.model.jnt_bodyid[simulator.model.joint(simulator.chain.joint_names[-1]).id]
    data = simulator.new_data()
    for k in range(N):
        force, torque = states.wrench[k].reshape(2, 3) @ (R[k].T if frame == "tip" else np.eye(3))
        data.qpos[simulator.dofs], data.qvel[simulator.dofs] = states.q[k], states.qd[k]
        data.qfrc_applied[simulator.dofs] = tau[k]
        mujoco.mj_kinematics(simulator.model, data)
        # MuJoCo's reference point is the center of mass
        arm_to_tip = p[k] - data.xipos[last]
        data.xfrc_applied[last] = -np.concatenate([force, torque + np.cross(arm_to_tip, force)])
        mujoco.mj_forward(simulator.model, data)
        expect_equal(data.qacc[simulator.dofs], states.qdd[k], SOLVED)


@pytest.mark.parametrize("plugin", [UR10, FRANKA])
def test_identified_models_have_all_but_what_needs_a_physical_inertia(plugin: str) -> None:
    solver = Solver(plugin)
    states = motion(solver)
    assert not solver.inertia_is_physical
    C = solver.coriolis_matrix(states.q, states.qd)
    expect_equal(np.einsum("kij,kj->ki", C, states.qd), solver.coriolis_vector(*states[:2]))
    dtau_dq, dtau_dqd, H = solver.torque_derivatives(*states[:3])
    assert dtau_dq.shape == dtau_dqd.shape == (N, *H.shape[1:])
    expect_equal(H, solver.inertia_matrix(states.q))
    J = solver.jacobian(states.q)
    expect_equal(
        solver.torques(*states[:3], wrench=states.wrench),
        solver.torques(*states[:3]) + np.einsum("kij,ki->kj", J, states.wrench),
    )
    with pytest.raises(errors.SolverError, match="^accelerations: .*isn't that of rigid bodies"):
        call(solver, "accelerations", states)


def asymmetries(solver: Solver) -> tuple[float, float]:
    """Greatest differences of H and dg/dq from their transposes, over 1000 states."""
    q = np.random.default_rng(1).uniform(-3.1, 3.1, size=(1000, len(solver.joint_names)))
    H = solver.inertia_matrix(q)
    dg_dq = solver.torque_derivatives(q, 0 * q, 0 * q)[0]
    of_H, of_dg_dq = (float(np.abs(M - M.swapaxes(1, 2)).max()) for M in (H, dg_dq))
    return of_H, of_dg_dq


def test_identified_models_have_energies_where_their_inertia_is_symmetric() -> None:
    solver = Solver(FRANKA)
    states = motion(solver)
    assert asymmetries(solver) == pytest.approx((0.0, 0.0), abs=1e-12)
    H = solver.inertia_matrix(states.q)
    T = solver.kinetic_energy(states.q, states.qd)
    expect_equal(T, np.einsum("ki,kij,kj->k", states.qd, H, states.qd) / 2)

    # along a line U grows with g dq; Gauss's rule of 40 points is exact for so smooth a function
    a, b = states.q[0], states.q[1]
    nodes, weights = np.polynomial.legendre.leggauss(40)
    between = a + np.outer((nodes + 1) / 2, b - a)
    work = weights @ (solver.gravity_vector(between) @ (b - a)) / 2
    U = solver.potential_energy(states.q[:2])
    expect_equal(np.diff(U), [work], SOLVED)

    ur10 = Solver(UR10)
    assert asymmetries(ur10) == pytest.approx((0.8, 0.7), abs=0.1)  # kg m^2, N m/rad
    for method in ("kinetic_energy", "potential_energy"):
        with pytest.raises(errors.SolverError, match=f"^{method}: the robot has no energies: ex"):
            call(ur10, method, motion(ur10))


@pytest.mark.parametrize("method", METHODS)
def test_one_state_is_that_of_a_batch(method: str) -> None:
    solver = made(RIGID_BODY, "oblique_arm")
    states = motion(solver)
    batch = call(solver, method, states)
    one = call(solver, method, Motion(*(values[4] for values in states)))
    for many, single in zip(
        *(r if isinstance(r, tuple) else (r,) for r in (batch, one)), strict=True
    ):
        assert np.shape(single) == many.shape[1:]
        expect_equal(single, many[4])


@pytest.mark.parametrize("method", sorted(METHODS.keys() - {"tip_pose", "torque_derivatives"}))
def test_results_go_into_memory_of_any_layout(method: str) -> None:
    solver = made(RIGID_BODY, "panda")
    states = motion(solver)
    expected = call(solver, method, states)
    if method.endswith("energy"):
        assert expected.shape == (N,)
        return
    out = np.full((*expected.shape[:-1], 2 * expected.shape[-1]), np.nan)[..., ::2]
    assert call(solver, method, states, out=out) is out
    np.testing.assert_array_equal(out, expected)
    with pytest.raises(errors.SizeMismatchError, match=f"{method}: argument out: wrong shape"):
        call(solver, method, states, out=out[:-1])


def test_a_frame_without_a_wrench_is_an_error() -> None:
    solver = made(RIGID_BODY, "ur10")
    with pytest.raises(errors.InvalidParameterError, match="argument frame: .*'tip' and no wrench"):
        solver.torques(*motion(solver)[:3], frame="tip")


def test_one_wrench_serves_all_states() -> None:
    solver = made(RIGID_BODY, "ur10")
    states = motion(solver)
    w = states.wrench[0]
    expect_equal(
        solver.external_torques(states.q, w), solver.external_torques(states.q, np.tile(w, (N, 1)))
    )
    assert solver.external_torques(states.q[0], w).shape == (6,)


def test_result_may_not_stand_where_the_wrench_does() -> None:
    solver = made(RIGID_BODY, "ur10")
    wrench = np.ones((2, 6))
    with pytest.raises(errors.InvalidParameterError, match="argument out: .*that of wrench"):
        solver.external_torques(np.zeros((2, 6)), wrench, out=wrench)


@pytest.mark.parametrize("shape", [(5,), (7,), (N, 5), (N - 1, 6), (6, N), (1, N, 6), ()])
def test_wrench_of_another_shape_is_refused(shape: tuple[int, ...]) -> None:
    solver = made(RIGID_BODY, "ur10")
    states = motion(solver)
    with pytest.raises(errors.SizeMismatchError, match=r"argument wrench: .*\(6,\) or \(20, 6\)"):
        solver.external_torques(states.q, np.zeros(shape))
    with pytest.raises(errors.SizeMismatchError, match="torques: argument wrench"):
        solver.torques(*states[:3], wrench=np.zeros(shape))


@pytest.mark.parametrize("wrench", ["up", [None] * 6, [1j] * 6, object()])
def test_wrench_that_is_no_numbers_is_refused(wrench: Any) -> None:
    solver = made(RIGID_BODY, "ur10")
    with pytest.raises(errors.InvalidParameterError, match="argument wrench"):
        solver.external_torques(np.zeros(6), wrench)


@pytest.mark.parametrize("frame", ["base", "", "Tip", "tool0"])
def test_wrong_frame_is_refused(frame: str) -> None:
    solver = made(RIGID_BODY, "ur10")
    states = motion(solver)
    expected = f"argument frame: .*'root' or 'tip'.*got '{frame}'"
    with pytest.raises(errors.InvalidParameterError, match=expected):
        solver.external_torques(states.q, states.wrench, frame)
    with pytest.raises(errors.InvalidParameterError, match=expected):
        solver.torques(*states[:3], wrench=states.wrench, frame=frame)


def test_error_of_a_solver_without_a_capability_names_those_that_have_it() -> None:
    solver = made(KDL, "ur10")
    states = motion(solver)
    for method in sorted(METHODS.keys() - set(OF_KDL)):
        with pytest.raises(
            errors.SolverError, match=f"{method}: .*one of .*{RIGID_BODY}.*got {KDL}"
        ):
            call(solver, method, states)


def test_friction_takes_a_position() -> None:
    solver = Solver(UR10)
    q, qd, *_ = motion(solver)
    np.testing.assert_array_equal(solver.friction_vector(qd, q=q), solver.friction_vector(qd))
    with pytest.raises(errors.SizeMismatchError, match="argument q"):
        solver.friction_vector(qd, q=q[:-1])


LIFT = """
schema: 2
name: lift
source: worked by hand
validity: a test
units: SI
geometry: placements
gravity: [0, 0, -9.81]
parameters: about_center_of_mass
joints:
  - name: lift
    type: prismatic
    placement: {xyz: [0, 0, 0], rpy: [0, 0, 0], axis: [0, 0, 1]}
    friction: {law: smooth_coulomb, fv: 0, fc: 3, width: 0.001, fl: 0.5}
    torque_deviation: 0.75
    seen: {q: [-1, 1], qd: [-2, 2], qdd: [-3, 4]}
    link: [2, 0, 0, 0, 0.1, 0, 0, 0.1, 0, 0.1]
"""


def test_friction_that_depends_on_load_needs_a_position_and_counts_a_payload(
    tmp_path: Path,
) -> None:
    file = tmp_path / "lift.yaml"
    file.write_text(LIFT)
    solver = Solver(RIGID_BODY, model=str(file))
    assert solver.friction_depends_on_position
    assert not Solver(UR10).friction_depends_on_position
    remedy = r"^friction_vector: argument q: missing.*; call friction_vector\(qd, q=q\)"
    with pytest.raises(errors.SizeMismatchError, match=remedy):
        solver.friction_vector([1.0])
    assert solver.friction_vector([1.0], q=[0.0]) == pytest.approx(3 + 0.5 * 2 * 9.81)
    solver.set_payload("part", 5.0)
    assert solver.friction_vector([1.0], q=[0.0]) == pytest.approx(3 + 0.5 * 7 * 9.81)
    many = solver.friction_vector(np.ones((20, 1)), q=np.zeros((20, 1)))
    np.testing.assert_allclose(many, 3 + 0.5 * 7 * 9.81)


def test_model_tells_the_deviation_of_torques_and_the_range_that_was_seen(tmp_path: Path) -> None:
    file = tmp_path / "lift.yaml"
    file.write_text(LIFT)
    solver = Solver(RIGID_BODY, model=str(file))
    np.testing.assert_array_equal(solver.torque_deviation, [0.75])
    np.testing.assert_array_equal(solver.seen, [[[-1, 1]], [[-2, 2]], [[-3, 4]]])
    for other in (Solver(UR10), made(KDL, "ur10")):
        assert other.torque_deviation is None
        assert other.seen is None

# SPDX-License-Identifier: Apache-2.0
"""Jacobians of links and joints of a description: against Pinocchio, poses and gravity torques."""

from xml.etree import ElementTree

import numpy as np
import pytest
from example_robots import PINOCCHIO, RIGID_BODY, UR10
from simulation_arms import joint, link, robot, urdf_of

from inverse_dynamics import FastModel, Solver, UserError, available_solvers

ARMS = ["ur10", "panda", "oblique_arm"]
TIPS = {"ur10": "tool0", "panda": "fer_link8", "oblique_arm": "tool"}
ROUNDING, DIFFERENCES = 1e-12, 1e-7  # of another order of operations; of steps of 1e-5 rad
# A finger beside the chain, and a camera at the root.
HAND = robot(
    link("base"),
    link("camera"),
    link("arm", 2.0),
    link("tool", 0.5),
    link("finger", 1.0),
    joint("mount", "base", "camera", kind="fixed", xyz="1 0 0"),
    joint("swing", "base", "arm"),
    joint("wrist", "arm", "tool", xyz="1 0 0"),
    joint("bend", "tool", "finger", xyz="0.3 0 0"),
)


def solver_of(arm, plugin=RIGID_BODY, tip=""):
    return Solver(plugin, urdf=urdf_of(arm), tip=tip or TIPS[arm])


def states(solver, count=7):
    return np.random.default_rng(2).uniform(-2, 2, size=(count, len(solver.joint_names)))


def moving_links(arm):
    """Those that a joint of the chain moves, by fixed joints too, and the chain's joints that move each."""
    solver, found = solver_of(arm), {}
    for each in ElementTree.fromstring(urdf_of(arm)).iter("link"):
        try:
            of_link = solver_of(arm, tip=each.get("name"))
        except UserError:  # nothing moves it
            continue
        if set(of_link.joint_names) <= set(solver.joint_names):
            found[each.get("name")] = of_link
    assert len(found) > len(solver.joint_names)
    return found


def expect(J, of_frame, tolerance):
    """Columns of the joints that move the frame; others are zero."""
    n = of_frame.shape[-1]
    np.testing.assert_allclose(J[..., :n], of_frame, rtol=0, atol=tolerance)
    assert not J[..., n:].any()


@pytest.mark.parametrize("arm", ARMS)
def test_frames_are_those_of_pinocchio(arm):
    if PINOCCHIO not in available_solvers():
        pytest.skip(f"{PINOCCHIO} isn't installed")
    solver = solver_of(arm)
    q = states(solver)
    for name, of_link in moving_links(arm).items():
        pinocchio = solver_of(arm, PINOCCHIO, name)
        n = len(of_link.joint_names)
        expect(solver.jacobian(q, frame=name), pinocchio.jacobian(q[:, :n]), ROUNDING)


@pytest.mark.parametrize("arm", ARMS)
def test_frames_move_as_their_poses(arm):
    solver, step = solver_of(arm), 1e-5
    for name, of_link in moving_links(arm).items():
        q = states(of_link, 1)[0]
        J = solver.jacobian([*q, *[0.5] * (len(solver.joint_names) - len(q))], frame=name)
        steps = step * np.eye(len(q))
        (R_up, p_up), (R_down, p_down) = (of_link.tip_pose(q + sign * steps) for sign in (1, -1))
        turn = (R_up - R_down) / (2 * step) @ of_link.tip_pose(q)[0].T  # w x
        w = np.stack([turn[:, 2, 1], turn[:, 0, 2], turn[:, 1, 0]])
        expect(J, np.concatenate([(p_up - p_down).T / (2 * step), w]), DIFFERENCES)


def test_the_tip_is_the_usual_frame_and_a_joint_stands_for_its_link():
    solver, engine = solver_of("ur10"), FastModel.from_urdf(urdf_of("ur10"))
    q = states(solver)
    for model in (solver, engine):
        np.testing.assert_allclose(
            model.jacobian(q), model.jacobian(q, frame="tool0"), atol=ROUNDING
        )
        wrist = model.jacobian(q, frame="wrist_1_link")
        np.testing.assert_array_equal(model.jacobian(q, "wrist_1_joint"), wrist)
        np.testing.assert_allclose(model.jacobian(q[3], "wrist_1_link"), wrist[3], atol=ROUNDING)
    out = np.zeros((len(q), 6, 12))[..., ::2]
    assert solver.jacobian(q, frame="wrist_1_link", out=out) is out
    np.testing.assert_array_equal(out, wrist)


def test_joints_beside_the_chain_are_held():
    q, bent = np.array([0.3, -0.4]), 1.2
    solver = Solver(urdf=HAND, tip="tool", parameters={"locked_joints": {"bend": bent}})
    whole = Solver(urdf=HAND, tip="finger")
    J = whole.jacobian([*q, bent])[:, :2]
    np.testing.assert_allclose(solver.jacobian(q, frame="finger"), J, atol=ROUNDING)
    for fixed in ("camera", "base", "mount"):
        assert not solver.jacobian(q, frame=fixed).any()


@pytest.mark.parametrize("locked", ["swing", "wrist"])
def test_joints_of_the_chain_that_are_locked_are_held(locked):
    q, held = np.array([0.3, -0.4]), {locked: 0.5}
    whole = Solver(urdf=HAND, tip="finger")
    moving = [name != locked for name in whole.joint_names]
    all_q = np.insert(q, moving.index(False), 0.5)
    for model in (
        Solver(urdf=HAND, tip="finger", parameters={"locked_joints": held}),
        FastModel.from_urdf(HAND, tip="finger", locked_joints=held),
    ):
        J = whole.jacobian(all_q)[:, moving]
        np.testing.assert_allclose(model.jacobian(q, frame="finger"), J, atol=ROUNDING)
        for one, other in zip(model.pose(q, "finger"), whole.tip_pose(all_q), strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize(
    ("solver", "frame", "text"),
    [
        (lambda: solver_of("ur10"), "wrist_1_lnk", "did you mean 'wrist_1_link'?"),
        (lambda: Solver(UR10), "tool0", "got 'tool0' and no description; give urdf="),
        (
            lambda: Solver(UR10, urdf=HAND),
            "tool",
            "with joint shoulder_pan_joint, got one without it",
        ),
    ],
)
def test_wrong_frames_are_named(solver, frame, text):
    with pytest.raises(UserError, match="^jacobian: argument frame: expected") as error:
        solver().jacobian(np.zeros(6), frame=frame)
    assert text in str(error.value)


@pytest.mark.parametrize("plugin", [RIGID_BODY, PINOCCHIO])
@pytest.mark.parametrize("arm", ARMS)
def test_the_pose_of_a_link_is_that_of_the_tip_of_a_chain_to_it(arm, plugin):
    if plugin not in available_solvers():
        pytest.skip(f"{plugin} isn't built")
    solver = solver_of(arm, plugin)
    q = states(solver)
    for name, of_link in moving_links(arm).items():
        expected = of_link.tip_pose(q[:, : len(of_link.joint_names)])
        for one, other in zip(solver.pose(q, frame=name), expected, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=ROUNDING)
    for one, other in zip(solver.pose(q), solver.tip_pose(q), strict=True):
        np.testing.assert_array_equal(one, other)


def test_poses_of_what_doesnt_move_and_of_what_is_beside_the_chain():
    solver = Solver(RIGID_BODY, urdf=HAND, tip="tool", parameters={"locked_joints.bend": 0.5})
    R, p = solver.pose([[0.0, 0.0], [1.0, 2.0]], frame="camera")
    np.testing.assert_array_equal(p, [[1, 0, 0]] * 2)
    np.testing.assert_array_equal(R, [np.eye(3)] * 2)
    held = Solver(RIGID_BODY, urdf=HAND, tip="finger")
    for one, other in zip(
        solver.pose([0.1, 0.2], "finger"), held.tip_pose([0.1, 0.2, 0.5]), strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=0, atol=ROUNDING)
    with pytest.raises(
        UserError, match=r"^pose: argument frame: expected a link or joint .*tool'\?"
    ):
        solver.pose([0, 0], frame="tol")


def test_a_solver_knows_its_description():
    solver = Solver(RIGID_BODY, urdf=HAND, tip="tool")
    assert (solver.urdf, solver.root, solver.tip) == (HAND, "base", "tool")
    assert Solver(RIGID_BODY, urdf=HAND, root="arm", tip="finger").root == "arm"
    for arm in ARMS:
        solver = Solver(RIGID_BODY, urdf=urdf_of(arm))
        q = states(solver)
        for one, other in zip(solver.pose(q, solver.tip), solver.tip_pose(q), strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=ROUNDING)
    unknown = Solver(UR10)
    assert (unknown.urdf, unknown.root, unknown.tip) == ("", "", "")


def test_a_solver_knows_its_limits():
    turning = robot(
        link("base"), link("arm", 2.0), joint("swing", "base", "arm", kind="continuous")
    )
    for urdf, lower, upper in ((HAND, -3.0, 3.0), (turning, -np.inf, np.inf)):
        solver = Solver(RIGID_BODY, urdf=urdf)
        for name, value in {
            "lower": lower,
            "upper": upper,
            "velocity": 2.0,
            "effort": 100.0,
        }.items():
            np.testing.assert_array_equal(
                solver.limits[name], np.full(len(solver.joint_names), value)
            )
    assert np.isfinite(Solver("ur10_real").limits["effort"]).all()


def test_a_solver_knows_the_accelerations_that_its_model_file_allows(tmp_path):
    urdf = HAND.replace("<robot ", '<robot version="1.2" ').replace(
        "<limit ", '<limit acceleration="5" '
    )
    file = tmp_path / "hand.yaml"
    text = FastModel.from_urdf(urdf, tip="finger").file_text(name="hand", source="x", validity="x")
    file.write_text(text)
    for solver in (Solver(urdf=urdf, tip="finger"), Solver(RIGID_BODY, model=str(file))):
        np.testing.assert_array_equal(solver.limits["acceleration"], [5.0] * 3)
        assert "jerk" not in solver.limits

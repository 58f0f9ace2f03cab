# SPDX-License-Identifier: Apache-2.0
"""Chains between any two links of a description, by all solvers that read one.

The judge is MuJoCo, which knows nothing of the chain: the whole robot floats, with the movable joints of the chain
alone, and the chain's root link is held by a force. What that force doesn't do, the joints must.
"""

import mujoco
import numpy as np
import pytest
from simulation_arms import joint, link, robot

from inverse_dynamics import Solver, available_solvers, errors
from inverse_dynamics._core import RobotDescription
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.urdf import chain_from_urdf

SOLVERS = [
    name for name in available_solvers() if name.startswith(("rigid_body_", "kdl_", "pinocchio_"))
]
ROUNDING = 1e-10  # two programs, operations in another order, on terms of up to some hundred N m


def arm(side, lateral):
    """Shoulder, slider and elbow of one side of the torso, with a camera on the upper arm, and a hand."""
    upper, rail, lower, hand, camera = (
        f"{side}/{name}" for name in ("upper", "rail", "lower", "hand", "camera")
    )
    return (
        link(upper, 3, "0.02 0 0.2"),
        link(rail, 1.5, "0 0.05 0.1"),
        link(lower, 2, "0 0.02 0.15"),
        link(hand, 0.8, "0.01 0 0.05"),
        link(camera, 0.4, "0 0 0.03"),
        joint(f"{side}/j1", "torso", upper, axis="0.6 0 0.8",
              xyz=f"0 {lateral} 0.8", rpy=f"1.3 0.2 {lateral}"),
        joint(f"{side}/slide", upper, rail, "prismatic", "0 0.03 0.4", "0 0.6 -0.8", rpy="0 0.4 0"),
        joint(f"{side}/j2", rail, lower, "continuous", "0.1 0 0.2", rpy="0.5 0 0.2"),
        joint(f"{side}/grip", lower, hand, "fixed", "0 0.02 0.3", rpy="0 0 0.7"),
        joint(f"{side}/pan", upper, camera, xyz="0.1 0 0.1", axis="0 0 1", rpy="0.3 0 0"),
    )  # fmt: skip


TWO_ARMS = robot(
    link("world"),
    link("floor", 30, "0 0 -0.1"),
    link("torso", 20, "0 0 0.4"),
    joint("stand", "world", "floor", "fixed", "0 0 0.5", rpy="0 0 0.4"),
    joint("waist", "floor", "torso", xyz="0 0 0.2", axis="0 0 1", rpy="0 0.1 0"),
    *arm("left", 0.3),
    *arm("right", -0.3),
)
LABEL = link("label", 1) + joint("print", "torso", "label", "fixed", "0 0 0.1", rpy="0 0 1")
LABELLED = TWO_ARMS.replace("</robot>", LABEL + "</robot>")


class Held:
    """The robot with one link held, by MuJoCo: the joints named move, all others are fixed at zero."""

    def __init__(self, root, joints, gravity):
        text = TWO_ARMS
        spec = mujoco.MjSpec.from_string(text)
        spec.compiler.fusestatic = False
        for moving in list(spec.joints):
            if moving.name not in joints:
                spec.delete(moving)
        spec.body("floor").add_freejoint()
        self.model = spec.compile()
        self.model.opt.gravity = gravity
        self.model.dof_armature[:] = self.model.dof_damping[:] = self.model.dof_frictionloss[:] = 0
        self.data = mujoco.MjData(self.model)
        self.root = self.model.body(root).id
        self.places = [self.model.joint(name).qposadr[0] for name in joints]
        self.dofs = [self.model.joint(name).dofadr[0] for name in joints]
        free = np.flatnonzero(self.model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)[0]
        self.free = self.model.jnt_qposadr[free]
        self.base = self.model.jnt_dofadr[free] + np.arange(6)

    def jacobian(self, call):
        J = np.zeros((6, self.model.nv))
        call(self.model, self.data, J[:3], J[3:], *self.at)
        return J

    def place(self, q):
        """Puts the root link where the frame of the world is."""
        free = self.free
        self.data.qpos[:] = 0
        self.data.qpos[free + 3] = 1
        self.data.qpos[self.places] = q
        mujoco.mj_kinematics(self.model, self.data)
        R, p = self.data.xmat[self.root].reshape(3, 3), self.data.xpos[self.root]
        self.data.qpos[free : free + 3] = -R.T @ p
        mujoco.mju_mat2Quat(self.data.qpos[free + 3 : free + 7], R.T.flatten())
        mujoco.mj_fwdPosition(self.model, self.data)
        assert np.allclose(self.data.xmat[self.root].reshape(3, 3), np.eye(3))

    def torques(self, q, qd, qdd):
        self.place(q)
        self.at = (self.data.xpos[self.root].copy(), self.root)
        J = self.jacobian(mujoco.mj_jac)
        # velocity and acceleration of the base for which the root link rests
        v, a = np.zeros(self.model.nv), np.zeros(self.model.nv)
        v[self.dofs], a[self.dofs] = qd, qdd
        v[self.base] = np.linalg.solve(J[:, self.base], -J @ v)
        self.data.qvel[:] = v
        mujoco.mj_fwdVelocity(self.model, self.data)
        a[self.base] = np.linalg.solve(
            J[:, self.base], -J @ a - self.jacobian(mujoco.mj_jacDot) @ v
        )
        self.data.qacc[:] = a
        mujoco.mj_inverse(self.model, self.data)
        # J^T w: the wrench that holds the root link instead of a motor at the base
        needed = self.data.qfrc_inverse
        w = np.linalg.solve(J[:, self.base].T, needed[self.base])
        return (needed - J.T @ w)[self.dofs]


CHAINS = {
    "hand to hand": ("left/hand", "right/hand"),
    "hand to floor": ("left/hand", "floor"),
    "upwards from an inner link": ("right/lower", "torso"),
    "from a camera beside the chain": ("left/camera", "left/hand"),
    "down": ("torso", "right/hand"),
}


@pytest.mark.parametrize("plugin", SOLVERS)
@pytest.mark.parametrize(("root", "tip"), CHAINS.values(), ids=CHAINS)
def test_any_two_links_are_root_and_tip(plugin, root, tip):
    gravity = (1.0, -2.0, -9.0)
    solver = Solver(plugin, TWO_ARMS, root=root, tip=tip, gravity=gravity)
    held = Held(root, solver.joint_names, gravity)
    random = np.random.default_rng(1)
    for _ in range(5):
        q, qd, qdd = random.uniform(-1, 1, (3, len(solver.joint_names)))
        expected = held.torques(q, qd, qdd)
        assert np.abs(expected).max() > 1
        np.testing.assert_allclose(solver.torques(q, qd, qdd), expected, rtol=0, atol=ROUNDING)


def test_placements_of_a_model_file_begin_at_any_link_that_is_fixed_to_the_first():
    names = ("left/j1", "left/slide", "left/j2")
    first, second = (RobotDescription(LABELLED).chain(names, root) for root in ("torso", "label"))
    c, s = np.cos(1), np.sin(1)
    to_label = [[c, s, 0, 0], [-s, c, 0, 0], [0, 0, 1, -0.1], [0, 0, 0, 1]]
    np.testing.assert_allclose(second[0].pose, to_label @ first[0].pose, atol=ROUNDING)
    assert np.array_equal(second[1].pose, first[1].pose)
    with pytest.raises(errors.RobotError, match="choose a root nearer to that of the description"):
        RobotDescription(LABELLED).chain(("left/j2",), "left/hand")


def test_a_simulated_robot_stands_on_any_link_that_is_fixed_to_its_root():
    names = ("left/j1", "left/slide", "left/j2")
    assert chain_from_urdf(LABELLED, "label", "left/hand").joint_names == names
    with pytest.raises(SimulationError, match="choose a root nearer to that of the description"):
        chain_from_urdf(LABELLED, "left/hand", "right/hand")

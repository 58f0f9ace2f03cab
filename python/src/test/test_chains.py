# SPDX-License-Identifier: Apache-2.0
"""Chains between any two links of a description, by all solvers that read one.

The judge is MuJoCo, which knows nothing of the chain: the whole robot floats, with the movable joints of the chain
alone, and the chain's root link is held by a force. What that force doesn't do, the joints must.
"""

import mujoco
import numpy as np
import pytest

from inverse_dynamics import Solver, available_solvers, errors
from inverse_dynamics._core import RobotDescription
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.urdf import chain_from_urdf

SOLVERS = [
    name for name in available_solvers() if name.startswith(("rigid_body_", "kdl_", "pinocchio_"))
]
ROUNDING = 1e-10  # two programs, operations in another order, on terms of up to some hundred N m


def link(name, mass, center):
    return (
        f'<link name="{name}"><inertial><origin xyz="{center}" rpy="0.1 0.2 0.3"/><mass value="{mass}"/>'
        '<inertia ixx="0.04" ixy="0.002" ixz="0" iyy="0.03" iyz="-0.001" izz="0.02"/></inertial></link>'
    )


def joint(name, kind, parent, child, origin, axis="1 0 0", more=""):
    limit = '<limit lower="-3" upper="3" velocity="3" effort="200"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin {origin}/><axis xyz="{axis}"/>{limit}{more}</joint>'
    )


def arm(side, lateral):
    """Shoulder, slider and elbow of one side of the torso, with a camera on the upper arm, and a hand."""
    return (
        link(f"{side}/upper", 3, "0.02 0 0.2")
        + link(f"{side}/rail", 1.5, "0 0.05 0.1")
        + link(f"{side}/lower", 2, "0 0.02 0.15")
        + link(f"{side}/hand", 0.8, "0.01 0 0.05")
        + link(f"{side}/camera", 0.4, "0 0 0.03")
        + joint(
            f"{side}/j1",
            "revolute",
            "torso",
            f"{side}/upper",
            f'xyz="0 {lateral} 0.8" rpy="1.3 0.2 {lateral}"',
            "0.6 0 0.8",
        )
        + joint(
            f"{side}/slide",
            "prismatic",
            f"{side}/upper",
            f"{side}/rail",
            'xyz="0 0.03 0.4" rpy="0 0.4 0"',
            "0 0.6 -0.8",
        )
        + joint(
            f"{side}/j2",
            "continuous",
            f"{side}/rail",
            f"{side}/lower",
            'xyz="0.1 0 0.2" rpy="0.5 0 0.2"',
            "0 1 0",
        )
        + joint(
            f"{side}/grip",
            "fixed",
            f"{side}/lower",
            f"{side}/hand",
            'xyz="0 0.02 0.3" rpy="0 0 0.7"',
        )
        + joint(
            f"{side}/pan",
            "revolute",
            f"{side}/upper",
            f"{side}/camera",
            'xyz="0.1 0 0.1" rpy="0.3 0 0"',
            "0 0 1",
        )
    )


TWO_ARMS = (
    '<robot name="two_arms"><link name="world"/>'
    + link("floor", 30, "0 0 -0.1")
    + link("torso", 20, "0 0 0.4")
    + joint("stand", "fixed", "world", "floor", 'xyz="0 0 0.5" rpy="0 0 0.4"')
    + joint("waist", "revolute", "floor", "torso", 'xyz="0 0 0.2" rpy="0 0.1 0"', "0 0 1")
    + arm("left", 0.3)
    + arm("right", -0.3)
    + "</robot>"
)


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


@pytest.mark.parametrize("plugin", SOLVERS)
def test_bodies_above_a_chain_move_with_it_unless_they_are_ignored(plugin):
    q = np.array([0.3, -0.2, 0.5])
    held, turned, ignored = (
        Solver(plugin, TWO_ARMS, root="left/hand", tip="torso", gravity=(0, 0, -9.81), **options)
        for options in (
            {},
            {"parameters": {"locked_joints.right/j1": 1.0}},
            {"attached": "ignore"},
        )
    )
    assert held.joint_names == ("left/j2", "left/slide", "left/j1")
    (warning,) = held.warnings
    assert "swap root and tip if the robot stands on its base" in warning
    # the other arm hangs on the torso, and so does the floor
    weights = [solver.gravity_vector(q)[1] for solver in (held, turned, ignored)]
    assert weights[0] == pytest.approx(weights[1])  # a slider bears the weight, wherever it is
    assert not np.allclose(held.gravity_vector(q), turned.gravity_vector(q))
    assert abs(weights[0]) > 2 * abs(weights[2])


@pytest.mark.parametrize("plugin", SOLVERS)
def test_a_second_base_is_the_first_one_turned(plugin):
    label = link("label", 1, "0 0 0") + joint(
        "print", "fixed", "torso", "label", 'xyz="0 0 0.1" rpy="0 0 3.141592653589793"'
    )
    urdf = TWO_ARMS.replace("</robot>", label + "</robot>")
    states = np.random.default_rng(3).uniform(-1, 1, (3, 4, 3))
    first, second = (
        Solver(plugin, urdf, root=root, tip="left/hand", gravity=(0, 0, -9.81))
        for root in ("torso", "label")
    )
    np.testing.assert_allclose(
        second.torques(*states), first.torques(*states), rtol=0, atol=ROUNDING
    )
    (_, there), (_, here) = (solver.tip_pose(states[0]) for solver in (first, second))
    np.testing.assert_allclose(here, there * [-1, -1, 1] - [0, 0, 0.1], rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("plugin", SOLVERS)
def test_rotor_inertia_of_transmissions_is_added_where_it_is_asked_for(plugin):
    motor = """<transmission name="t"><joint name="left/slide"/><actuator name="m">
      <mechanicalReduction>100</mechanicalReduction><motorInertia>3e-5</motorInertia></actuator></transmission>"""
    urdf = TWO_ARMS.replace("</robot>", motor + "</robot>")

    def solver(**parameters):
        return Solver(
            plugin,
            urdf,
            root="left/hand",
            tip="torso",
            gravity=(0, 0, -9.81),
            parameters=parameters,
        )

    q, qdd = np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, 3.0])
    bare = solver()
    assert sum("'rotor_inertia'" in text for text in bare.warnings) == 1
    for parameters, expected in (
        ({"rotor_inertia": True}, [0, 0.3, 0]),
        ({"rotor_inertia.left/j1": 0.2}, [0, 0, 0.2]),
        ({"rotor_inertia": True, "rotor_inertia.left/slide": 0.1}, [0, 0.1, 0]),
    ):
        driven = solver(**parameters)
        added = driven.inertia_matrix(q) - bare.inertia_matrix(q)
        np.testing.assert_allclose(added, np.diag(expected), atol=ROUNDING)
        added = driven.torques(q, 0 * q, qdd) - bare.torques(q, 0 * q, qdd)
        np.testing.assert_allclose(added, expected * qdd, atol=ROUNDING)
        driven.set_payload("p", 1.0)
        assert np.diag(driven.inertia_matrix(q) - solver().inertia_matrix(q)).min() > -ROUNDING
    assert not any("rotor_inertia" in text for text in solver(rotor_inertia=True).warnings)
    with pytest.raises(
        errors.InvalidParameterError, match=r"did you mean 'rotor_inertia\.left/j1'"
    ):
        solver(**{"rotor_inertia.left/j7": 0.2})


@pytest.mark.parametrize("plugin", SOLVERS)
def test_a_root_that_is_mounted_turned_is_named_unless_gravity_is_given(plugin):
    wall = TWO_ARMS.replace('rpy="0 0 0.4"', 'rpy="1.5707963267948966 0 0.4"')
    (warning,) = Solver(plugin, wall, root="floor", tip="right/hand").warnings
    assert "link floor: gravity isn't given" in warning
    assert "it would be [0, -9.81, 0]" in warning
    assert not Solver(plugin, wall, root="floor", tip="right/hand", gravity=(0, 0, -9.81)).warnings
    assert not Solver(plugin, wall, root="world", tip="right/hand").warnings
    assert not Solver(plugin, TWO_ARMS, root="floor", tip="right/hand").warnings


def test_placements_of_a_model_file_begin_at_any_link_that_is_fixed_to_the_first():
    label = link("label", 1, "0 0 0") + joint(
        "print", "fixed", "torso", "label", 'xyz="0 0 0.1" rpy="0 0 1"'
    )
    urdf = TWO_ARMS.replace("</robot>", label + "</robot>")
    names = ("left/j1", "left/slide", "left/j2")
    first, second = (RobotDescription(urdf).chain(names, root) for root in ("torso", "label"))
    c, s = np.cos(1), np.sin(1)
    to_label = [[c, s, 0, 0], [-s, c, 0, 0], [0, 0, 1, -0.1], [0, 0, 0, 1]]
    np.testing.assert_allclose(second[0].pose, to_label @ first[0].pose, atol=ROUNDING)
    assert np.array_equal(second[1].pose, first[1].pose)
    with pytest.raises(errors.RobotError, match="choose a root nearer to that of the description"):
        RobotDescription(urdf).chain(("left/j2",), "left/hand")


def test_a_simulated_robot_stands_on_any_link_that_is_fixed_to_its_root():
    urdf = TWO_ARMS.replace(
        "</robot>",
        link("label", 1, "0 0 0") + joint("print", "fixed", "torso", "label", "") + "</robot>",
    )
    assert chain_from_urdf(urdf, "label", "left/hand").joint_names == (
        "left/j1",
        "left/slide",
        "left/j2",
    )
    with pytest.raises(SimulationError, match="choose a root nearer to that of the description"):
        chain_from_urdf(urdf, "left/hand", "right/hand")

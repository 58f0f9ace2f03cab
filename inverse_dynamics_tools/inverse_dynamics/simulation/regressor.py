# SPDX-License-Identifier: Apache-2.0
"""The engine's regressor of a simulated robot, for many states at once: `tau = Y(q, qd, qdd) p`.

    arm = ArmGeometry.of(robot)
    Y = regressor(arm, q, qd, qdd)          # (N, n, 10 n)
    condition_number(Y, base_count(arm))

Parameters per link: m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz in the frame of the link's body, the moment of
inertia about that frame's origin. It serves the search for exciting trajectories, which needs thousands of states per
trial. [Gautier 1991 for base parameters]
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import FastModel
from inverse_dynamics.base.extras import lazily_imported
from inverse_dynamics.robot.link_parameters import turned

if TYPE_CHECKING:
    import mujoco

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.simulation.model import SimulatedRobot
else:
    mujoco = lazily_imported("mujoco", "a simulation")

PARAMETERS_PER_LINK = 10


@dataclass(frozen=True)
class ArmGeometry:
    """Joints of a chain as MuJoCo has placed them; link i is the body that joint i moves."""

    axis: Floats  # (n, 3) in link i
    model: FastModel  # of links in frames whose z are the axes
    in_axis_frames: Floats  # (n, 10, 10): their parameters from those in the bodies' frames

    @classmethod
    def of(cls, robot: SimulatedRobot) -> ArmGeometry:
        """Geometry of the chain of a robot."""
        model, data = robot.model, robot.new_data()
        mujoco.mj_kinematics(model, data)
        rotations, offsets, axes, prismatic, to_axis_frames = [], [], [], [], []
        R_W, p_W = np.eye(3), np.zeros(3)
        for name in robot.chain.joint_names:
            joint = model.joint(name)
            body = data.body(joint.bodyid[0])
            R_BA = _axis_frame(np.array(joint.axis))
            R_WA = np.array(body.xmat).reshape(3, 3) @ R_BA
            rotations.append(R_W.T @ R_WA)
            offsets.append(R_W.T @ (body.xpos - p_W))
            axes.append(np.array(joint.axis))
            prismatic.append(bool(joint.type[0] != mujoco.mjtJoint.mjJNT_HINGE))
            # column k: the unit parameter k, seen in the axis frame
            to_axis_frames.append(
                np.transpose([turned(p, R_BA.T) for p in np.eye(PARAMETERS_PER_LINK)])
            )
            R_W, p_W = R_WA, np.array(body.xpos)
        p = inertial_parameters(robot).reshape(-1, PARAMETERS_PER_LINK)
        fast = FastModel.from_joints(
            list(robot.chain.joint_names),
            prismatic,
            np.array(rotations),
            np.array(offsets),
            np.einsum("icb,ib->ic", to_axis_frames, p),
            gravity=list(model.opt.gravity),
        )
        return cls(np.array(axes), fast, np.array(to_axis_frames))


def regressor(arm: ArmGeometry, q: Floats, qd: Floats, qdd: Floats) -> Floats:
    """Y, (N, n, 10 n), of states (N, n)."""
    joints = len(arm.axis)
    Y = arm.model.regressor(q, qd, qdd).reshape(len(q), joints, joints, PARAMETERS_PER_LINK)
    # from parameters in the engine's frames, whose z are the axes, to those in the bodies'
    bodies: Floats = np.einsum("ktic,icb->ktib", Y, arm.in_axis_frames)
    return bodies.reshape(len(q), joints, PARAMETERS_PER_LINK * joints)


def inertial_parameters(robot: SimulatedRobot) -> Floats:
    """p, (10 n,): what is fixed to a link counts as part of it."""
    model, data = robot.model, robot.new_data()
    mujoco.mj_kinematics(model, data)
    links = [int(model.joint(name).bodyid[0]) for name in robot.chain.joint_names]
    p = np.zeros((len(links), PARAMETERS_PER_LINK))
    for body in range(1, model.nbody):
        link = body
        while link and link not in links:
            link = model.body_parentid[link]
        if not link:
            continue  # fixed to the ground
        R_WL = data.xmat[link].reshape(3, 3)
        R = R_WL.T @ data.ximat[body].reshape(3, 3)
        c = R_WL.T @ (data.xipos[body] - data.xpos[link])
        m = model.body_mass[body]
        # moment of inertia about the link's origin: Steiner
        tensor = R @ np.diag(model.body_inertia[body]) @ R.T + m * (
            c @ c * np.eye(3) - np.outer(c, c)
        )
        p[links.index(link)] += np.r_[m, m * c, tensor[np.triu_indices(3)]]
    return p.ravel()


def base_count(arm: ArmGeometry) -> int:
    """Number of base parameters: the rank of Y over all motions."""
    random = np.random.default_rng(0)
    joints = len(arm.axis)
    q, qd, qdd = random.uniform(-np.pi, np.pi, (3, 20 * joints, joints))
    Y = regressor(arm, q, qd, qdd).reshape(-1, PARAMETERS_PER_LINK * joints)
    values = np.linalg.svd(Y, compute_uv=False)
    # rounding leaves about 1e-15 of the greatest one where there is none
    return int((values > 1e-8 * values[0]).sum())


def condition_number(Y: Floats, count: int) -> float:
    """Ratio of the greatest to the least of the `count` nonzero singular values of the stacked Y.

    It is the condition number of `Y V`, V an orthonormal basis of the base parameters: every such basis gives the same
    one. A choice of independent columns of Y would not: columns of equal norm leave that choice to rounding.
    """
    # the square of the condition, from a small matrix: enough digits up to about 1e6
    # (summed sample by sample: one large product would start threads, which costs more than it saves)
    squares = np.linalg.eigvalsh((Y.transpose(0, 2, 1) @ Y).sum(axis=0))
    return float(np.sqrt(squares[-1] / max(squares[-count], 1e-16 * squares[-1])))


def _axis_frame(axis: Floats) -> Floats:
    """A rotation (3, 3) whose third column is the axis."""
    z = axis / np.linalg.norm(axis)
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])

# SPDX-License-Identifier: Apache-2.0
"""Regressor of a simulated robot for many states at once: `tau = Y(q, qd, qdd) p`.

    arm = ArmGeometry.of(robot)
    Y = regressor(arm, q, qd, qdd)          # (N, n, 10 n)
    condition_number(Y, base_count(arm))

Parameters per link: m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz in the frame of the link's body, the moment of
inertia about that frame's origin. It serves the search for exciting trajectories, which needs thousands of states per
trial, and MuJoCo has no regressor. [Khalil and Dombre 2002, ch. 12; Gautier 1991 for base parameters]
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.simulation.model import SimulatedRobot

PARAMETERS_PER_LINK = 10


@dataclass(frozen=True)
class ArmGeometry:
    """Joints of a chain as MuJoCo has placed them; link i is the body that joint i moves."""

    rotation: Floats  # (n, 3, 3) R of link i in link i - 1 at q = 0
    offset: Floats  # (n, 3) m, origin of link i in link i - 1 at q = 0
    axis: Floats  # (n, 3) in link i
    revolute: NDArray[np.bool_]  # (n,)
    gravity: Floats  # (3,) m/s^2 in MuJoCo's world

    @classmethod
    def of(cls, robot: SimulatedRobot) -> ArmGeometry:
        """Geometry of the chain of a robot."""
        model, data = robot.model, robot.new_data()
        mujoco.mj_kinematics(model, data)
        rotations, offsets, axes, revolute = [], [], [], []
        R_W, p_W = np.eye(3), np.zeros(3)
        for name in robot.chain.joint_names:
            joint = model.joint(name)
            body = data.body(joint.bodyid[0])
            R_WB = np.array(body.xmat).reshape(3, 3)
            rotations.append(R_W.T @ R_WB)
            offsets.append(R_W.T @ (body.xpos - p_W))
            axes.append(np.array(joint.axis))
            revolute.append(joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE)
            R_W, p_W = R_WB, np.array(body.xpos)
        return cls(
            np.array(rotations),
            np.array(offsets),
            np.array(axes),
            np.array(revolute),
            np.array(model.opt.gravity),
        )


def regressor(arm: ArmGeometry, q: Floats, qd: Floats, qdd: Floats) -> Floats:
    """Y, (N, n, 10 n), of states (N, n)."""
    samples, joints = q.shape
    Y = np.zeros((samples, joints, PARAMETERS_PER_LINK * joints))
    R_parent: list[Floats] = []  # R of link i in link i - 1, (N, 3, 3)
    p_parent: list[Floats] = []  # origin of link i in link i - 1, (N, 3)
    w, alpha = np.zeros((samples, 3)), np.zeros((samples, 3))
    a = np.tile(-arm.gravity, (samples, 1))  # a base accelerating upwards is gravity
    for i in range(joints):
        # motion of link i in its own frame, from that of link i - 1
        R, p = _pose(arm, i, q[:, i])
        R_parent.append(R)
        p_parent.append(p)
        a = a + np.cross(alpha, p) + np.cross(w, np.cross(w, p))
        w, alpha, a = (_turned_back(R, v) for v in (w, alpha, a))
        s, sd, sdd = arm.axis[i], qd[:, i, None], qdd[:, i, None]
        if arm.revolute[i]:
            alpha = alpha + s * sdd + np.cross(w, s * sd)
            w = w + s * sd
        else:
            a = a + s * sdd + 2.0 * np.cross(w, s * sd)
        # wrench of each parameter of link i, carried down the chain
        force, moment = _wrench_columns(w, alpha, a)
        columns = slice(PARAMETERS_PER_LINK * i, PARAMETERS_PER_LINK * (i + 1))
        for j in range(i, -1, -1):
            Y[:, j, columns] = arm.axis[j] @ (moment if arm.revolute[j] else force)
            force = R_parent[j] @ force
            moment = R_parent[j] @ moment + _skew(p_parent[j]) @ force
    return Y


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


def _pose(arm: ArmGeometry, i: int, q: Floats) -> tuple[Floats, Floats]:
    """Rotation (N, 3, 3) and origin (N, 3) of link i in link i - 1."""
    R_0, p_0, s = arm.rotation[i], arm.offset[i], arm.axis[i]
    if not arm.revolute[i]:
        return np.tile(R_0, (len(q), 1, 1)), p_0 + q[:, None] * (R_0 @ s)
    K = _skew(s)
    sine, versine = np.sin(q)[:, None, None], (1.0 - np.cos(q))[:, None, None]
    return R_0 @ (np.eye(3) + sine * K + versine * (K @ K)), np.tile(p_0, (len(q), 1))


def _wrench_columns(w: Floats, alpha: Floats, a: Floats) -> tuple[Floats, Floats]:
    """Force and moment about the link's origin, (N, 3, 10): one column a parameter."""
    samples = len(w)
    force, moment = np.zeros((samples, 3, 10)), np.zeros((samples, 3, 10))
    W = _skew(w)
    # f = m a + (alpha x + w x w x) mc
    force[:, :, 0] = a
    force[:, :, 1:4] = _skew(alpha) + W @ W
    # n = mc x a + I alpha + w x (I w)
    moment[:, :, 1:4] = -_skew(a)
    moment[:, :, 4:] = _inertia_columns(alpha) + W @ _inertia_columns(w)
    return force, moment


def _inertia_columns(w: Floats) -> Floats:
    """L with `I w = L(w) [Ixx, Ixy, Ixz, Iyy, Iyz, Izz]`, (N, 3, 6)."""
    L = np.zeros((len(w), 3, 6))
    x, y, z = w.T
    L[:, 0, 0], L[:, 0, 1], L[:, 0, 2] = x, y, z
    L[:, 1, 1], L[:, 1, 3], L[:, 1, 4] = x, y, z
    L[:, 2, 2], L[:, 2, 4], L[:, 2, 5] = x, y, z
    return L


def _skew(v: Floats) -> Floats:
    """Matrices of the cross product with each of v (..., 3)."""
    out = np.zeros((*v.shape[:-1], 3, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return out


def _turned_back(R: Floats, v: Floats) -> Floats:
    """R^T v for each sample."""
    turned: Floats = np.einsum("kji,kj->ki", R, v)
    return turned

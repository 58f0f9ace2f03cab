# SPDX-License-Identifier: Apache-2.0
"""A robot arm in MuJoCo, with exactly the inertia its URDF states.

    robot = SimulatedRobot.from_urdf(Path("ur10.urdf").read_text(), root="base_link", tip="tool0")
    data = robot.new_data()

What MuJoCo would do to a URDF on its own, and what is done about it:

- it refuses inertia that breaks the triangle inequality (vendors publish such numbers): it may balance them while it
  compiles, then the URDF's inertia is written back;
- it takes `<dynamics>` for damping and friction: set to zero; the chosen friction has its own law;
- it pushes at position limits and contacts: switched off, since a trajectory must stay clear of both (limits.py and
  collision.py check that);
- it lets joints that mimic others lag behind them: the springs that hold them are made stiff.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from inverse_dynamics.installation.extras import lazily_imported
from inverse_dynamics.simulation.errors import SimulationError
from inverse_dynamics.simulation.urdf import UrdfChain, chain_from_urdf
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Sequence

    import mujoco

    from inverse_dynamics.arrays import Floats
else:
    mujoco = lazily_imported("mujoco", "a simulation")

Gravity = tuple[float, float, float]

GRAVITY: Gravity = (0.0, 0.0, -9.81)
"""Acceleration of falling bodies in the frame of the root link [m/s^2], robot standing on the floor."""

MOUNTS = {"floor": (0.0, 0.0, -9.81), "wall": (-9.81, 0.0, 0.0), "ceiling": (0.0, 0.0, 9.81)}
"""Gravity in the frame of the root link: its z axis points up, away from the wall (x up), or down."""

# Time constant [s] and damping ratio of the springs that hold joints which mimic others.
_STIFF = (0.002, 1.0)

_NEAR = 1e-7  # rad/s; slopes between closer velocities are rounding


@dataclass(frozen=True)
class Payload:
    """A body fixed to a tip: kg; center of mass in the tip's frame, m.

    inertia: ixx ixy ixz iyy iyz izz, kg m^2 about the center of mass, along the axes of the tip's frame. tip: its link;
    empty: the first.
    """

    mass: float
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: tuple[float, ...] = (0.0,) * 6
    tip: str = ""


def payloads_of(given: Payload | Sequence[Payload] | None) -> tuple[Payload, ...]:
    """One, several or none."""
    if given is None:
        return ()
    return (given,) if isinstance(given, Payload) else tuple(given)


@dataclass(frozen=True)
class Inertia:
    """Inertia of one link: mass [kg], tensor [kg m^2] about the center of mass."""

    mass: float
    center: Floats  # (3,) m, in the link's frame
    tensor: Floats  # (3, 3), along the axes of the link's frame


class Friction:
    """Friction in each joint, n: a law of velocity and position."""

    viscous: Floats  # (n,) N m s/rad that a controller makes up for with ff_velocity_scale
    steepest: Floats | float = 0.0  # (n,) rad/s, the velocity at which friction changes fastest

    def torques(self, qd: Floats, q: Floats) -> Floats:
        """Friction torques (..., n) in states (..., n), as the actuators must add them."""
        raise NotImplementedError

    def restart(self) -> None:
        """Forgets the motion so far."""

    def remembered(self, qd: Floats, q: Floats) -> Floats | float:
        """(n,) what the motion up to this state adds to torques(); called for states in the order of time."""
        return 0.0

    def line(self, qd: Floats, q: Floats) -> tuple[Floats, Floats]:
        """(n,) slope, not negative, and torque at zero velocity of a line.

        It has the torque of friction at qd and, while friction grows with velocity, also where the law is steepest,
        such as the step of Coulomb friction.
        """
        center = 0.0 * qd + self.steepest
        apart = qd - center
        apart = np.where(np.abs(apart) < _NEAR, _NEAR, apart)
        near = center + apart
        # each joint by itself at its center: joints may share motors
        at = np.vstack([near, np.where(np.eye(len(near), dtype=bool), center, near)])
        there, *middle = self.torques(at, np.tile(q, (len(at), 1)))
        slope = np.maximum((there - np.diag(middle)) / apart, 0.0)
        return slope, there - slope * near


@dataclass(frozen=True)
class JointFriction(Friction):
    """Friction in each joint: `coulomb tanh(qd / slip) + viscous qd`; n each.

    The hyperbolic tangent is the sign function with a slope at rest, and a case of the sigmoid that identified models
    use: 2 coulomb / (1 + exp(-2 qd / slip)) - coulomb.
    """

    coulomb: Floats  # N m
    viscous: Floats  # N m s/rad
    slip: float = 0.02  # rad/s

    def torques(self, qd: Floats, q: Floats | None = None) -> Floats:
        """Friction torques (..., n) at velocities (..., n), as the actuators must add them."""
        return self.coulomb * np.tanh(qd / self.slip) + self.viscous * qd


@dataclass(frozen=True)
class SimulatedRobot:
    """A chain or tree and its MuJoCo model. One simulation at a time: friction and step size are set in the model.

    MuJoCo's nv positions are S q + s: joints may mimic others.
    """

    chain: UrdfChain
    model: mujoco.MjModel
    dofs: Floats = field(repr=False)  # (n,) index of each joint in MuJoCo's vectors
    S: Floats = field(repr=False)  # (nv, n)
    s: Floats = field(repr=False)  # (nv,)
    gravity: Gravity
    friction: Friction | None

    @classmethod
    def from_urdf(
        cls,
        urdf: str,
        root: str = "",
        tip: str = "",
        *,
        gravity: Gravity = GRAVITY,
        payload: Payload | Sequence[Payload] | None = None,
        friction: Friction | None = None,
        rotor_inertia: Floats | None = None,
    ) -> SimulatedRobot:
        """Model of the chain from root to tip, or of a tree; as chain_from_urdf() takes them.

        rotor_inertia: (n,) kg m^2 (prismatic kg), seen at the joint.
        """
        chain = chain_from_urdf(urdf, root, tip)
        for k, body in enumerate(payloads_of(payload)):
            chain = _loaded(chain, body, f"ids_payload_{k}")
        spec, warnings = _read_spec(chain)
        chain = replace(chain, notes=(*chain.notes, *warnings))
        inertia = _inertia(spec)
        try:
            model = spec.compile()
        except ValueError as error:
            raise SimulationError(
                f"robot description: MuJoCo refuses it: {_massless(error, chain, inertia) or _line(error)}"
            ) from error
        _write_true_inertia(model, inertia)
        dofs = np.array([model.joint(name).dofadr[0] for name in chain.joint_names])
        S, s = np.zeros((model.nv, len(dofs))), np.zeros(model.nv)
        for name, (i, factor, offset) in chain.moves.items():
            S[model.joint(name).dofadr[0], i], s[model.joint(name).dofadr[0]] = factor, offset
        model.eq_solref[:] = _STIFF
        if isinstance(friction, JointFriction):
            _check_friction(friction, len(dofs))
        if rotor_inertia is not None:
            model.dof_armature[dofs] = rotor_inertia
        model.dof_damping[:] = 0.0
        model.dof_frictionloss[:] = 0.0
        model.opt.gravity = _rotation_of_root(model, chain.root) @ np.array(gravity)
        model.opt.integrator = (
            mujoco.mjtIntegrator.mjINT_RK4
            if friction is None
            else mujoco.mjtIntegrator.mjINT_IMPLICITFAST  # friction is stiff: see physics.py
        )
        model.opt.disableflags |= int(
            mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
        )
        return cls(chain, model, dofs, S, s, gravity, friction)

    def new_data(self) -> mujoco.MjData:
        """State of a simulation: q = qd = 0."""
        return mujoco.MjData(self.model)

    def torques(self, q: Floats, qd: Floats, qdd: Floats) -> Floats:
        """Torques of given motions by MuJoCo: `H qdd + C qd + g`, without friction.

        All (N, n), order of `chain.joint_names`; payload and gravity as in this model.
        """
        data, torque = self.new_data(), np.empty(self.model.nv)
        states = np.array([q, qd, qdd]) @ self.S.T  # in MuJoCo's order
        states[0] += self.s
        out = np.empty(states.shape[1:])
        for k, (position, velocity, acceleration) in enumerate(states.transpose(1, 0, 2)):
            data.qpos[:], data.qvel[:] = position, velocity
            mujoco.mj_fwdPosition(self.model, data)
            mujoco.mj_fwdVelocity(self.model, data)
            mujoco.mj_mulM(self.model, data, torque, acceleration)
            out[k] = torque + data.qfrc_bias
        return out @ self.S

    def inertia_matrix(self, q: Floats) -> Floats:
        """H(q), (n, n)."""
        data = self.new_data()
        data.qpos[:] = self.S @ q + self.s
        mujoco.mj_fwdPosition(self.model, data)
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, data, full)
        return self.S.T @ full @ self.S


def spec_of(urdf: str) -> tuple[mujoco.MjSpec, list[str]]:
    """A description as MuJoCo reads it, and its warnings, which else are written to the screen."""
    warnings: list[str] = []
    mujoco.set_mju_user_warning(warnings.append)
    try:
        return mujoco.MjSpec.from_string(urdf), warnings
    finally:
        mujoco.set_mju_user_warning(None)


def _read_spec(chain: UrdfChain) -> tuple[mujoco.MjSpec, list[str]]:
    try:
        spec, warnings = spec_of(chain.urdf)
    except ValueError as error:
        raise SimulationError(f"robot description: MuJoCo can't read it: {_line(error)}") from error
    spec.compiler.fusestatic = False  # each link stays a body, so its inertia can be compared
    spec.compiler.balanceinertia = True
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    return spec, [f"robot description: MuJoCo: {warning}" for warning in warnings]


def _line(error: Exception) -> str:
    """MuJoCo's text in one line."""
    return " ".join(str(error).split())


def _massless(error: Exception, chain: UrdfChain, inertia: dict[str, Inertia]) -> str:
    """Which links MuJoCo finds too light, and what to do; empty where it minds something else."""
    links = [n for n in chain.moving_links if n not in inertia or not inertia[n].mass > 0]
    if "mjMINVAL" not in str(error) or not links:
        return ""
    return (
        f"it can't move a body without mass, as {listed(links)}; give each an <inertial> (1e-6 kg and "
        "1e-9 kg m^2 change no torque visibly), or simulate a chain without them: `root` of the run configuration"
    )


def _loaded(chain: UrdfChain, payload: Payload, name: str) -> UrdfChain:
    """The chain with a link without a volume, fixed to a tip."""
    if not (np.isfinite(payload.mass) and payload.mass > 0 and np.isfinite(payload.center).all()):
        raise SimulationError(
            "payload: expected a mass above zero [kg] and a finite center of mass [m], got "
            f"{payload.mass:g} kg at {', '.join(f'{x:g}' for x in payload.center)}"
        )
    tip = payload.tip or chain.tips[0]
    if tip not in chain.tips:
        raise SimulationError(f"payload: tip: expected one of {listed(chain.tips)}, got {tip}")
    place = " ".join(repr(float(number)) for number in payload.center)
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    moments = " ".join(f'{k}="{float(v)!r}"' for k, v in zip(names, payload.inertia, strict=True))
    load = (
        f'<link name="{name}"><inertial><origin xyz="{place}"/><mass value="{float(payload.mass)!r}"/>'
        f"<inertia {moments}/></inertial></link>"
        f'<joint name="{name}" type="fixed"><parent link={quoteattr(tip)}/><child link="{name}"/></joint>'
    )
    return replace(chain, urdf=chain.urdf.removesuffix("</robot>") + f"{load}</robot>")


def _inertia(spec: mujoco.MjSpec) -> dict[str, Inertia]:
    """What the URDF states, by link, before MuJoCo balances it."""
    found = {}
    for body in spec.bodies:
        if not body.explicitinertial:
            continue
        R = np.empty((3, 3))
        mujoco.mju_quat2Mat(R.reshape(9), body.iquat)
        xx, yy, zz, xy, xz, yz = np.nan_to_num(body.fullinertia)  # NaN: all are zero
        tensor = R @ [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] @ R.T
        found[body.name] = Inertia(body.mass, np.array(body.ipos), tensor)
    return found


def _write_true_inertia(model: mujoco.MjModel, inertia: dict[str, Inertia]) -> None:
    """Puts back what balancing changed: moments about the principal axes, and the axes."""
    for link, true in inertia.items():
        body = model.body(link).id
        moments, axes = np.linalg.eigh(true.tensor)
        if np.linalg.det(axes) < 0:
            axes[:, 0] = -axes[:, 0]
        model.body_mass[body] = true.mass
        model.body_ipos[body] = true.center
        model.body_inertia[body] = moments
        mujoco.mju_mat2Quat(model.body_iquat[body], axes.flatten())
    mujoco.mj_setConst(model, mujoco.MjData(model))


def _check_friction(friction: JointFriction, joints: int) -> None:
    for name, values in (("coulomb", friction.coulomb), ("viscous", friction.viscous)):
        if np.shape(values) != (joints,) or not (np.isfinite(values).all() and min(values) >= 0):
            raise SimulationError(
                f"joint friction: {name}: expected {joints} numbers that aren't negative, got {values}"
            )


def _rotation_of_root(model: mujoco.MjModel, root: str) -> Floats:
    """R_world_root: joints above the root are locked, so it is constant."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return np.array(data.body(root).xmat).reshape(3, 3)

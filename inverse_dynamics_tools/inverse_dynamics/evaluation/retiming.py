# SPDX-License-Identifier: Apache-2.0
"""The fastest motion along a path within the torque limits of the joints.

    fastest = retime([[0, -1.5, 1, 0, 0, 0], [1, -1, 0.5, 0, 0.5, 0]], "ur10_real")
    print(fastest.duration, fastest.seconds_saved)

The method is that of the C++ header inverse_dynamics_timing/retime.hpp: docs/retime.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import JointPath, MotionLimits, RetimeOptions, retime_path, speed_limit
from inverse_dynamics.base.arguments import checked
from inverse_dynamics.base.located_yaml import read_mapping
from inverse_dynamics.data.columns import POSITION
from inverse_dynamics.data.csv_table import is_csv
from inverse_dynamics.data.joint_trajectories import read_joint_trajectories
from inverse_dynamics.data.table_logs import LogFormat, open_table, read_motion
from inverse_dynamics.errors import BagError, UserError
from inverse_dynamics.evaluation.evaluation import Arm
from inverse_dynamics.robot.descriptions import joint_limits
from inverse_dynamics.robot.robots import Robot, load_robot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from inverse_dynamics._core import Solver, TimedPath
    from inverse_dynamics.base.arrays import Floats, Integers

_UNLIMITED = 1e6  # N m: of motions that only accelerations limit
_AT_LIMIT = 0.99  # of a limit: the joint is said to be at it


@dataclass(frozen=True)
class MotionEnergy:
    """What a motion takes. Joints that brake give nothing back."""

    driven: float  # J, integral of positive power over all joints
    friction: float  # J, of it lost to friction
    peak_power: float  # W, the greatest sum of positive powers

    @classmethod
    def of(
        cls, solver: Solver, time: Floats, q: Floats, qd: Floats, efforts: Floats
    ) -> MotionEnergy:
        """Of N states at times (N,) s: q, qd, efforts (N, n)."""
        power = np.maximum(efforts * qd, 0.0).sum(axis=1)
        lost = (solver.friction_vector(qd, q=q) * qd).sum(axis=1)
        return cls(
            float(np.trapezoid(power, time)), float(np.trapezoid(lost, time)), float(power.max())
        )


@dataclass(frozen=True)
class Retimed:
    """A path with the shortest time. N samples, n joints in the order of the chain; SI units."""

    robot: Robot
    joint_names: tuple[str, ...]  # as recorded
    units: tuple[str, ...]
    limits: MotionLimits
    time: Floats  # (N,) s
    q: Floats  # (N, n) rad
    qd: Floats  # (N, n) rad/s
    qdd: Floats  # (N, n) rad/s^2
    efforts: Floats  # (N, n) N m
    band: Floats  # (n,) N m, half the width that --margin keeps free
    timed: TimedPath  # the motion on its grid
    speed_limit: Floats  # (K,) of the grid: ds/dt that limits allow for an instant
    energy: MotionEnergy
    by_acceleration: TimedPath | None  # the same path, one acceleration limit for all joints
    acceleration: float  # rad/s^2, that limit: the greatest that keeps torques within theirs
    notes: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Of the motion, s."""
        return float(self.timed.duration)

    @property
    def seconds_saved(self) -> float:
        """Against the same path under the best constant acceleration limit; NaN: there is none."""
        return self.by_acceleration.duration - self.duration if self.by_acceleration else np.nan

    @property
    def use(self) -> Floats:
        """(N, n) torque over what it may be, signed."""
        used: Floats = self.efforts / (self.limits.torque - self.band)
        return used

    @property
    def at_limit(self) -> Floats:
        """(n,) share of the time that each joint's torque is at its limit."""
        share: Floats = (np.abs(self.use) > _AT_LIMIT).mean(axis=0)
        return share

    @property
    def limiting(self) -> Integers:
        """(N,) the joint whose torque is at its limit, of several the one nearest to it; -1: none is."""
        use = np.abs(self.use)
        return np.where(use.max(axis=1) > _AT_LIMIT, use.argmax(axis=1), -1)

    def plot(self) -> Any:
        """The figure of retime_figure(), of matplotlib."""
        return import_module("inverse_dynamics.figures.retiming").retime_figure(self)


@checked
def retime(
    path: JointPath | Path | str | ArrayLike,
    robot: Robot | Path | str,
    limits: MotionLimits | None = None,
    *,
    topic: str = "",
    deviation: float | None = None,
    stops: Sequence[int] = (),
    options: RetimeOptions | None = None,
    rate: float = 250.0,
) -> Retimed:
    """Time a path so that it takes as little as the limits allow.

    path: waypoints (m, n) [rad]; a file of them: trajectory_msgs/JointTrajectory of a recording, a
    table, or a YAML file with `joints` and `positions`, times ignored; or a JointPath. limits:
    None: those of the robot description. deviation: straight lines whose corners the path passes by
    at most this distance [rad]; None: a cubic spline through all waypoints. stops: numbers of
    waypoints, from 0, to stand still at. rate: of the samples, Hz.

    Raises UserError: BagError, RobotError, SolverError; the path can't be held, and where.
    """
    if not isinstance(robot, Robot):
        robot = load_robot(robot)
    if not rate > 0.0:
        raise UserError(f"rate: expected a number above zero, Hz, got {rate:g}")
    arm = Arm(robot)
    options = options or RetimeOptions()
    limits = limits or description_limits(arm, robot)
    if not isinstance(path, JointPath):
        waypoints = unwrapped(waypoints_of(path, robot, arm, topic), arm.solver)
        path = (
            JointPath.spline(waypoints, list(stops))
            if deviation is None
            else JointPath.lines(waypoints, deviation, list(stops))
        )
    timed = retime_path(arm.solver, path, limits, options)
    time = sample_times(timed.duration, rate)
    q, qd, qdd = timed.states(time)
    efforts = arm.solver.torques(q, qd, qdd)
    acceleration, by_acceleration = _by_acceleration(arm.solver, path, limits, options)
    return Retimed(
        robot=robot,
        joint_names=arm.recorded_names,
        units=arm.units,
        limits=limits,
        time=time,
        q=q,
        qd=qd,
        qdd=qdd,
        efforts=efforts,
        band=_band(arm.solver, options.margin),
        timed=timed,
        speed_limit=speed_limit(arm.solver, timed, limits, options),
        energy=MotionEnergy.of(arm.solver, time, q, qd, efforts),
        by_acceleration=by_acceleration,
        acceleration=acceleration,
        notes=tuple(arm.solver.warnings),
    )


def sample_times(duration: float, rate: float) -> Floats:
    """0 to the duration, both included, `rate` per second and the last interval shorter."""
    return np.append(np.arange(0.0, duration, 1.0 / rate), duration)


def description_limits(arm: Arm, robot: Robot, **given: Sequence[float]) -> MotionLimits:
    """Limits of torque and velocity of the robot description; those given replace them.

    Raises UserError where a joint has no torque limit.
    """
    joints = arm.solver.joint_names
    found = {
        "torque": joint_limits(robot.urdf, arm.description, joints, "effort"),
        "velocity": joint_limits(robot.urdf, arm.description, joints, "velocity"),
    }
    found = {name: values for name, values in found.items() if np.isfinite(values).all()}
    for name, values in given.items():
        if len(values) not in (1, len(joints)):
            raise UserError(
                f"{name} limits: expected 1 number or {len(joints)}, one per joint ({', '.join(joints)}), "
                f"got {len(values)}"
            )
        found[name] = np.resize(values, len(joints))
    if "torque" not in found:
        raise UserError(
            f"torque limits: expected one for each joint, got none for some in "
            f"{robot.urdf or 'the robot, which has no description'}; give them with --torque"
        )
    return MotionLimits(**found)


def waypoints_of(path: Path | str | ArrayLike, robot: Robot, arm: Arm, topic: str) -> Floats:
    """(m, n) rad, in the order of the chain. Raises UserError."""
    if not isinstance(path, Path | str):
        waypoints = np.asarray(path, dtype=np.float64)
        if waypoints.ndim != 2 or waypoints.shape[1] != len(arm.joint_names):
            raise UserError(
                f"path: expected waypoints (m, {len(arm.joint_names)}), one per row, got an array "
                f"{waypoints.shape}"
            )
        return waypoints
    path = Path(path)
    if path.suffix in (".yaml", ".yml"):
        return _waypoints_of_yaml(path, arm.joint_names)
    if is_csv(path):
        form = replace(LogFormat.of(robot), rate=1.0)  # without a column of time: it is ignored
        return read_motion(
            open_table(path, topic=topic), arm.recorded_names, form, (POSITION,)
        ).numbers[POSITION]
    trajectories = read_joint_trajectories(path, topic)
    return np.concatenate([t.numbers("positions", arm.recorded_names) for t in trajectories])


def _waypoints_of_yaml(path: Path, joints: Sequence[str]) -> Floats:
    top = read_mapping(path, BagError)
    names = [entry.text() for entry in top.required("joints").entries()]
    if sorted(names) != sorted(joints):
        top.required("joints").fail(f"the joints {', '.join(joints)}")
    positions = top.required("positions")
    rows = [[number.number() for number in row.entries()] for row in positions.entries()]
    if any(len(row) != len(names) for row in rows):
        positions.fail(f"rows of {len(names)} numbers, one per joint")
    return np.array(rows).reshape(-1, len(names))[:, [names.index(joint) for joint in joints]]


def unwrapped(waypoints: Floats, solver: Solver) -> Floats:
    """Waypoints of continuous joints, each by the short way from the one before."""
    turning = [kind == "continuous" for kind in solver.joint_types]
    return np.where(turning, np.unwrap(waypoints, axis=0), waypoints)


def _band(solver: Solver, margin: float) -> Floats:
    if margin == 0.0:
        return np.zeros(len(solver.joint_names))
    from statistics import NormalDist

    deviation = solver.torque_deviation
    assert deviation is not None  # retime_path() has refused a margin without one
    return deviation * NormalDist().inv_cdf((1 + margin) / 2) / 1.959963984540054


def _by_acceleration(
    solver: Solver, path: JointPath, limits: MotionLimits, options: RetimeOptions
) -> tuple[float, TimedPath | None]:
    """The greatest acceleration limit, the same for all joints, under which torques hold, and its motion."""
    band = _band(solver, options.margin)
    n = len(solver.joint_names)

    def motion(acceleration: float) -> TimedPath | None:
        common = {"velocity": limits.velocity} if len(limits.velocity) else {}
        timed = retime_path(
            solver,
            path,
            MotionLimits(
                torque=np.full(n, _UNLIMITED), acceleration=np.full(n, acceleration), **common
            ),
            RetimeOptions(points=options.points),
        )
        torques = solver.torques(*timed.states(sample_times(timed.duration, 500.0)))
        return timed if (np.abs(torques) <= limits.torque - band).all() else None

    low, high = 1e-2, 1e3
    found = motion(low)
    if found is None:
        return np.nan, None
    for _ in range(14):
        middle = float(np.sqrt(low * high))
        tried = motion(middle)
        low, high, found = (middle, high, tried) if tried else (low, middle, found)
    return low, found

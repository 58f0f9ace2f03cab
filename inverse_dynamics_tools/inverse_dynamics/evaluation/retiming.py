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

from inverse_dynamics._core import (
    JointPath,
    MotionLimits,
    RetimeOptions,
    retime_path,
    speed_limit,
    torque_band,
)
from inverse_dynamics.base.arguments import checked
from inverse_dynamics.base.located_yaml import read_mapping
from inverse_dynamics.data.csv_table import is_csv
from inverse_dynamics.data.joint_trajectories import read_joint_trajectories
from inverse_dynamics.data.log_format import LogFormat
from inverse_dynamics.data.table_logs import read_motion
from inverse_dynamics.data.tables import open_table
from inverse_dynamics.data.vocabulary import POSITION
from inverse_dynamics.errors import BagError, UserError
from inverse_dynamics.evaluation.evaluation import Arm
from inverse_dynamics.evaluation.motion_energy import MotionEnergy
from inverse_dynamics.robot.chain_geometry import chain_geometry
from inverse_dynamics.robot.robots import Robot, load_robot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from inverse_dynamics._core import Solver, TimedPath
    from inverse_dynamics.base.arrays import Floats, Integers

_UNLIMITED = 1e6  # N m, rad/s: beyond every joint
_OF_MOTORS = ("knee_velocity", "no_load_velocity")
PER_JOINT = ("torque", "velocity", "acceleration", "jerk", *_OF_MOTORS)
_WEIGHING_RATE = 250.0  # Hz, of samples for energies
_SLOWEST = 0.05  # share of the fastest motion's velocities
_SECTIONS = 9  # of the search: the share is known to 3 %, the sum to far less
_STILL = 1e-6  # rad/s
_LEAST = 1e-9  # N m, of a limit
_PLACES = 1001  # of a path, at which positions are checked
_ROUNDING = 1e-6  # rad
_AT_LIMIT = 0.99  # of a limit: the joint counts as being at it


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
        used: Floats = self.efforts / np.maximum(self.torque_limit - self.band, _LEAST)
        return used

    @property
    def torque_limit(self) -> Floats:
        """(N, n) N m; less at speed where the motors' torque falls."""
        return torque_limit(self.limits, self.qd)

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
    weight: float = 0.0,
    rate: float = 250.0,
) -> Retimed:
    """Time a path so that it takes as little as the limits allow.

    Parameters
    ----------
    path
        Waypoints (m, n) [rad]; a file of them: trajectory_msgs/JointTrajectory of a recording, a table, or a
        YAML file with `joints` and `positions`, times ignored; or a JointPath.
    robot
        As evaluate() takes it.
    limits
        By default those of the robot description.
    deviation
        Straight lines whose corners the path passes by at most this distance [rad]; by default a cubic
        spline through all waypoints.
    stops
        Numbers of waypoints, from 0, to stand still at.
    weight
        s/J. Above 0 the motion is slower and minimises about duration + weight * energy.
    rate
        Of the samples, Hz.

    Raises
    ------
    UserError
        BagError, RobotError, SolverError; the path leaves a joint's range, or can't be held.

    Examples
    --------
    >>> import numpy as np
    >>> from inverse_dynamics import retime
    >>> fast = retime(np.array([[0.0] * 6, [0.5] * 6]), "ur10_simulated")
    >>> bool(fast.duration < 2), fast.efforts.shape[1]  # s
    (True, 6)
    """
    if not isinstance(robot, Robot):
        robot = load_robot(robot)
    if not rate > 0.0:
        raise UserError(f"rate: expected a number above zero, Hz, got {rate:g}")
    if not 0.0 <= weight < np.inf:
        raise UserError(f"weight: expected a finite number, s/J, at least zero, got {weight:g}")
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
    _check_positions(path, arm, robot)
    timed = retime_path(arm.solver, path, limits, options)
    if weight > 0.0:
        timed = _weighted(arm.solver, timed, limits, options, weight)
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
        band=torque_band(arm.solver, options.margin),
        timed=timed,
        speed_limit=speed_limit(arm.solver, timed, limits, options),
        energy=MotionEnergy.of(arm.solver, time, q, qd, efforts),
        by_acceleration=by_acceleration,
        acceleration=acceleration,
        notes=tuple(arm.solver.warnings),
    )


def torque_limit(limits: MotionLimits, qd: Floats) -> Floats:
    """(N, n) N m, of joints at velocities (N, n)."""
    knee, none = limits.knee_velocity, limits.no_load_velocity
    share = (
        np.clip((none - np.abs(qd)) / (none - knee), 0.0, 1.0) if len(knee) else np.ones_like(qd)
    )
    return limits.torque * share


def sample_times(duration: float, rate: float) -> Floats:
    """0 to the duration, both included, `rate` per second and the last interval shorter."""
    return np.append(np.arange(0.0, duration, 1.0 / rate), duration)


def description_limits(arm: Arm, robot: Robot, **given: Sequence[float]) -> MotionLimits:
    """Limits of torque and velocity of the robot description; those given replace them.

    Raises UserError where a joint has no torque limit.
    """
    joints = arm.solver.joint_names
    torque = _described(arm, robot, "effort", np.inf)
    found = {"velocity": _described(arm, robot, "velocity", _UNLIMITED)}
    if np.isfinite(torque).all():
        found["torque"] = torque
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


def _described(arm: Arm, robot: Robot, limit: str, absent: float) -> Floats:
    """(n,) of one of `lower`, `upper`, `velocity` and `effort`, as the description states it."""
    if not arm.description:
        return np.full(len(arm.joint_names), absent)
    chain = chain_geometry(arm.description, robot.root, arm.joint_names)
    return np.array([joint.limits.get(limit, absent) for joint in chain])


def _check_positions(path: JointPath, arm: Arm, robot: Robot) -> None:
    """Raise UserError where the path leaves the joints' ranges."""
    q, _, _ = path.states(np.linspace(path.knots[0], path.knots[-1], _PLACES))
    lower, upper = _described(arm, robot, "lower", -np.inf), _described(arm, robot, "upper", np.inf)
    for j, joint in enumerate(arm.joint_names):
        least, most = q[:, j].min(), q[:, j].max()
        if least < lower[j] - _ROUNDING or most > upper[j] + _ROUNDING:
            raise UserError(
                f"path: joint {joint}: expected positions from {lower[j]:g} to {upper[j]:g}, the limits in "
                f"{robot.urdf}, got {least:.4g} to {most:.4g}; change the path, and if waypoints are in "
                "degrees, convert them (of a table: --scale q=deg)"
            )


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
    found = _waypoints_of_file(path, robot, arm, topic)
    if len(found) < 2:
        raise BagError(f"{path}: expected two waypoints at least, got {len(found)}")
    return found


def _waypoints_of_file(path: Path, robot: Robot, arm: Arm, topic: str) -> Floats:
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
        raise BagError(
            f"{path}: joints: expected {', '.join(joints)}, got {', '.join(names)}; name the joints of the chain"
        )
    positions = top.required("positions")
    rows = [[number.number() for number in row.entries()] for row in positions.entries()]
    if any(len(row) != len(names) for row in rows):
        positions.fail(f"rows of {len(names)} numbers, one per joint")
    return np.array(rows).reshape(-1, len(names))[:, [names.index(joint) for joint in joints]]


def unwrapped(waypoints: Floats, solver: Solver) -> Floats:
    """Waypoints of continuous joints, each by the short way from the one before."""
    turning = [kind == "continuous" for kind in solver.joint_types]
    return np.where(turning, np.unwrap(waypoints, axis=0), waypoints)


def _changed(limits: MotionLimits, **changes: Floats) -> MotionLimits:
    """A copy with other limits."""
    names = (*PER_JOINT, "tip_speed")
    return MotionLimits(**{**{name: getattr(limits, name) for name in names}, **changes})


def _weighted(
    solver: Solver,
    fastest: TimedPath,
    limits: MotionLimits,
    options: RetimeOptions,
    weight: float,
) -> TimedPath:
    """The motion of least duration + weight * energy among those that cap velocities.

    Each joint keeps below one share, the same for all, of its greatest velocity in the fastest motion.
    """
    time = sample_times(fastest.duration, _WEIGHING_RATE)
    greatest = np.maximum(np.abs(fastest.states(time)[1]).max(axis=0), _STILL)

    def total(timed: TimedPath) -> float:
        time = sample_times(timed.duration, _WEIGHING_RATE)
        states = timed.states(time)
        energy = MotionEnergy.of(solver, time, *states[:2], solver.torques(*states))
        return float(timed.duration) + weight * energy.driven

    def weighed(exponent: float) -> tuple[float, TimedPath]:
        capped = _changed(limits, velocity=greatest * np.exp(exponent))
        try:
            timed = retime_path(solver, fastest.path, capped, options)
        except UserError:  # a place that can't be passed that slowly
            return np.inf, fastest
        return total(timed), timed

    # golden section search for the logarithm of the share
    low, high = np.log(_SLOWEST), 0.0
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    places = [high - ratio * (high - low), low + ratio * (high - low)]
    found = [weighed(place) for place in places]
    best = min((total(fastest), fastest), *found, key=lambda one: one[0])
    for _ in range(_SECTIONS):
        left = found[0][0] < found[1][0]
        low, high = (low, places[1]) if left else (places[0], high)
        new = high - ratio * (high - low) if left else low + ratio * (high - low)
        tried = weighed(new)
        places = [new, places[0]] if left else [places[1], new]
        found = [tried, found[0]] if left else [found[1], tried]
        best = min(best, tried, key=lambda one: one[0])
    return best[1]


def _by_acceleration(
    solver: Solver, path: JointPath, limits: MotionLimits, options: RetimeOptions
) -> tuple[float, TimedPath | None]:
    """The greatest acceleration limit, the same for all joints, under which torques hold, and its motion."""
    band = torque_band(solver, options.margin)
    n = len(solver.joint_names)
    own = limits.acceleration if len(limits.acceleration) else np.full(n, np.inf)
    unlimited = _changed(
        limits, torque=np.full(n, _UNLIMITED), **dict.fromkeys(_OF_MOTORS, np.zeros(0))
    )
    speeds = {"start_speed": options.start_speed, "end_speed": options.end_speed}
    grid = RetimeOptions(points=options.points, **speeds)

    def motion(acceleration: float) -> TimedPath | None:
        common = _changed(unlimited, acceleration=np.minimum(own, acceleration))
        try:
            timed = retime_path(solver, path, common, grid)
        except UserError:  # a speed at an end is too high
            return None
        states = timed.states(sample_times(timed.duration, 500.0))
        held = np.abs(solver.torques(*states)) <= torque_limit(limits, states[1]) - band
        return timed if held.all() else None

    low, high = 1e-2, 1e3
    found = motion(low)
    if found is None:
        return np.nan, None
    for _ in range(14):
        middle = float(np.sqrt(low * high))
        tried = motion(middle)
        low, high, found = (middle, high, tried) if tried else (low, middle, found)
    return low, found

# SPDX-License-Identifier: Apache-2.0
"""The fastest motion along a path within the torque limits of the joints.

    fastest = retime([[0, -1.5, 1, 0, 0, 0], [1, -1, 0.5, 0, 0.5, 0]], "ur10_real")
    print(fastest.duration, fastest.seconds_saved)

The method is that of the C++ header inverse_dynamics_timing/retime.hpp: docs/retime.md.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import (
    JointPath,
    MotionLimits,
    RetimeOptions,
    Solver,
    retime_path,
    sample_times,
    speed_limit,
    torque_band,
)
from inverse_dynamics.arguments import checked
from inverse_dynamics.errors import UserError
from inverse_dynamics.retiming.figure import retime_figure
from inverse_dynamics.retiming.files import FILES, write_trajectory
from inverse_dynamics.retiming.page import retime_page
from inverse_dynamics.retiming.tables import retime_lines, retime_numbers
from inverse_dynamics.retiming.waypoints import PathShape, check_positions, joint_path
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.motion_energy import MotionEnergy
from inverse_dynamics.robots.robots import Robot, robot_of
from inverse_dynamics.show.result import PAGE, ResultDirectory, files_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from inverse_dynamics._core import TimedPath
    from inverse_dynamics.arrays import Floats, Integers
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Storage

_UNLIMITED = 1e6  # N m, rad/s: beyond every joint
_OF_MOTORS = ("knee_velocity", "no_load_velocity")
PER_JOINT = ("torque", "velocity", "acceleration", "jerk", "torque_rate", *_OF_MOTORS)
_ABOUT_ONE = 0.998  # share of torque limits from which on the compared acceleration is good enough
_AIM = 0.999  # the share that its search aims at
_MOST_STEPS = 12  # of its search
_WEIGHING_RATE = 250.0  # Hz, of samples for energies
_MOST_WEIGHED = 100_000  # samples
_SLOWEST = 0.05  # share of the fastest motion's velocities
_SECTIONS = 9  # of the search: the share is known to 3 %, the sum to far less
_STILL = 1e-6  # rad/s
_LEAST = 1e-9  # N m, of a limit
_ARMS: deque[tuple[Robot, tuple[int, ...], Arm]] = deque(maxlen=4)
_ABOVE = 1.003  # of a limit, between samples
_AT_LIMIT = 0.99  # of a limit: the joint counts as being at it


@dataclass(frozen=True, repr=False)
class Retimed(ResultDirectory):
    """A path with the shortest time. N samples, n joints in the order of the chain; SI units."""

    contents = files_of("retime.json", "torques", PAGE, *FILES)
    numbers, lines, plot, page = retime_numbers, retime_lines, retime_figure, retime_page

    robot: Robot
    joint_names: tuple[str, ...]  # as recorded
    units: tuple[str, ...]
    limits: MotionLimits
    time: Floats  # (N,) s
    q: Floats  # (N, n) rad
    qd: Floats  # (N, n) rad/s
    qdd: Floats  # (N, n) rad/s^2
    efforts: Floats  # (N, n) N m; friction with what it remembers of the motion
    greatest: Floats  # (N, n) N m, efforts of the greatest size, whatever the motion before was
    band: Floats  # (n,) N m, half the width that --margin keeps free
    timed: TimedPath  # the motion on its grid
    speed_limit: Floats  # (K,) of the grid: ds/dt that limits allow for an instant
    energy: MotionEnergy
    by_acceleration: TimedPath | None  # the same path, one acceleration limit for all joints
    acceleration: float  # rad/s^2, that limit: the greatest under which torques keep to theirs
    notes: tuple[str, ...] = ()
    solver: Solver | None = field(default=None, compare=False)  # the one that was given as robot

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
        """(N, n) greatest torque over what it may be, signed."""
        used: Floats = self.greatest / np.maximum(self.torque_limit - self.band, _LEAST)
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
        return _limiting(self.use)

    @property
    def limiting_velocity(self) -> Integers:
        """(N,) the joint whose velocity is at its limit, of several the one nearest to it; -1: none is."""
        return _limiting(self.qd / self.limits.velocity)

    def inputs(self) -> tuple[Path | None, ...]:
        """The robot's files."""
        return self.robot.files

    def write_more(self, directory: Path, storage: Storage | None, progress: Progress) -> None:
        """Write the trajectory."""
        write_trajectory(self, directory, storage or "sqlite3")


write_retimed = Retimed.save


def _limiting(use: Floats) -> Integers:
    use = np.abs(use)
    return np.where(use.max(axis=1) > _AT_LIMIT, use.argmax(axis=1), -1)


@checked
def retime(
    path: JointPath | Path | str | ArrayLike,
    robot: Robot | Solver | Path | str,
    limits: MotionLimits | None = None,
    *,
    options: RetimeOptions | None = None,
    weight: float = 0.0,
    rate: float = 250.0,
    duration: float | None = None,
    compare: bool = True,
    **shape: Unpack[PathShape],
) -> Retimed:
    """Time a path so that it takes as little as the limits allow.

    Parameters
    ----------
    path
        Waypoints (m, n) [rad]; a file of them: trajectory_msgs/JointTrajectory of a recording, a table, or a
        YAML file with `joints` and `positions`; or a JointPath. Times that a file has must increase, and tell
        nothing but mistakes, as velocities do; all may be zero. A continuous joint turns as
        far as the numbers say; in a table recorded within one turn, wrap-around is undone.
    robot
        As evaluate() takes it.
    limits
        Those that aren't among them are those of the robot description.
    weight
        s/J. Above 0 the motion is slower and minimises about duration + weight * energy.
    options
        The motion's speed at both ends, the share of measured torques within limits, the points of the grid.
    rate
        Of the samples, Hz. The last step takes half a period to one and a half.
    duration
        Of the motion, s, if not the shortest: at each place it is slower by the same factor.
    compare
        Whether the path is timed with one acceleration limit too; without it `by_acceleration` is None, and
        the call takes about a sixth of the time.
    **shape
        How waypoints become a path: PathShape.

    Raises
    ------
    UserError
        BagError, RobotError, SolverError; the path leaves a joint's range, or can't be held; the duration is
        shorter than the fastest motion's, or the motion has too many samples.

    Examples
    --------
    >>> import numpy as np
    >>> from inverse_dynamics import retime
    >>> fast = retime(np.array([[0.0] * 6, [0.5] * 6]), "ur10_simulated")
    >>> bool(fast.duration < 2), fast.efforts.shape[1]  # s
    (True, 6)
    """
    solver = robot if isinstance(robot, Solver) else None
    robot = robot_of(robot)
    for name, unit, value in (("rate", "Hz", rate), ("duration", "s", duration)):
        if value is not None and not 0.0 < value < np.inf:
            raise UserError(f"{name}: expected a finite number above zero, {unit}, got {value:g}")
    if not 0.0 <= weight < np.inf:
        raise UserError(f"weight: expected a finite number, s/J, at least zero, got {weight:g}")
    arm = _arm_of(robot) if solver is None else Arm(robot, solver)
    options = options or RetimeOptions()
    stated, limits = limits, described_limits(arm, limits)
    notes = [*filter(None, [arm.guess]), *arm.solver.warnings, *_notes_of_velocities(arm, limits)]
    if options.start_speed + options.end_speed > 0.0 and not (stated and len(stated.jerk)):
        if len(limits.jerk):
            notes.append(
                "jerk isn't limited, as the description says, where a motion begins or ends at speed"
            )
        limits = _changed(limits, jerk=np.zeros(0))
    if not isinstance(path, JointPath):
        path, seams = joint_path(path, arm, **shape)
        notes += seams
    check_positions(path, arm)
    fastest = retime_path(arm.solver, path, limits, options)
    acceleration, by_acceleration = (
        _by_acceleration(arm.solver, fastest, limits, options) if compare else (np.nan, None)
    )
    timed = fastest
    if (
        len(limits.jerk) + len(limits.torque_rate) and by_acceleration
    ):  # neither is the fastest of all
        timed = min(fastest, by_acceleration, key=lambda one: one.duration)
    if weight > 0.0:
        timed = _weighted(arm.solver, timed, limits, options, weight)
    if duration is not None:
        timed = _slowed(arm, timed, duration, limits, options)
    time = sample_times(timed.duration, rate)
    q, qd, qdd = timed.states(time)
    efforts = arm.solver.torques(q, qd, qdd) + arm.solver.friction_state().along(q, qd)
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
        greatest=_greatest(arm.solver, q, qd, qdd),
        band=torque_band(arm.solver, options.margin),
        timed=timed,
        speed_limit=speed_limit(arm.solver, timed, limits, options),
        energy=MotionEnergy.of(arm.solver, time, q, qd, efforts),
        by_acceleration=by_acceleration,
        acceleration=acceleration,
        notes=tuple(notes),
        solver=solver,
    )


def _arm_of(robot: Robot) -> Arm:
    """Its arm, of an earlier call if neither the robot nor its files changed: making solvers takes 10 to 30 ms."""
    stamps = tuple(file.stat().st_mtime_ns for file in robot.files if file and file.exists())
    for known, at, arm in list(_ARMS):
        if known == robot and at == stamps:
            return arm
    arm = Arm(robot)
    _ARMS.append((robot, stamps, arm))
    return arm


def torque_limit(limits: MotionLimits, qd: Floats) -> Floats:
    """(N, n) N m, of joints at velocities (N, n)."""
    knee, none = limits.knee_velocity, limits.no_load_velocity
    share = (
        np.clip((none - np.abs(qd)) / (none - knee), 0.0, 1.0) if len(knee) else np.ones_like(qd)
    )
    return limits.torque * share


def described_limits(arm: Arm, given: MotionLimits | None = None) -> MotionLimits:
    """Limits with those that aren't given from the robot description.

    One number stands for all joints. Raises UserError where a joint has no torque limit.
    """
    robot, given = arm.robot, given or MotionLimits()
    joints = arm.solver.joint_names
    found = {}
    for name in PER_JOINT:
        values = getattr(given, name)
        if len(values) not in (0, 1, len(joints)):
            raise UserError(
                f"{name} limits: expected 1 number or {len(joints)}, one per joint ({', '.join(joints)}), "
                f"got {len(values)}"
            )
        found[name] = np.resize(values, len(joints)) if len(values) else values
    for name, limit in (("torque", "effort"), ("velocity", "velocity")):
        if not len(found[name]):
            found[name] = np.minimum(arm.limit(limit, np.inf), _UNLIMITED)
    acceleration = np.minimum(arm.limit("acceleration", np.inf), arm.limit("deceleration", np.inf))
    for name, stated in (("acceleration", acceleration), ("jerk", arm.limit("jerk", np.inf))):
        if not len(found[name]) and np.isfinite(stated).any():
            found[name] = np.minimum(stated, _UNLIMITED)
    lacking = [j for j, torque in zip(joints, found["torque"], strict=True) if torque == _UNLIMITED]
    if lacking:
        raise UserError(
            f"torque limits: expected one for each joint, got none for {', '.join(lacking)} in "
            f"{robot.urdf or robot.model or 'the robot, which has no description'}; give them with --torque"
        )
    return MotionLimits(**found, tip_speed=given.tip_speed)


def _notes_of_velocities(arm: Arm, limits: MotionLimits) -> list[str]:
    free = [j for j, v in zip(arm.joint_names, limits.velocity, strict=True) if v >= _UNLIMITED]
    return [
        f"the velocity of {', '.join(free)} isn't limited: the robot's description states no limit, or 0; "
        "give --velocity"
    ] * bool(free)


def _changed(limits: MotionLimits, **changes: Floats) -> MotionLimits:
    """A copy with other limits."""
    names = (*PER_JOINT, "tip_speed")
    return MotionLimits(**{**{name: getattr(limits, name) for name in names}, **changes})


def _dense(timed: TimedPath) -> Floats:
    """Times at points of the grid and in the middle between them, s."""
    return np.sort(np.append(timed.time, (timed.time[1:] + timed.time[:-1]) / 2))


def _greatest(solver: Solver, q: Floats, qd: Floats, qdd: Floats) -> Floats:
    """(N, n) N m, signed: of the torques that friction's memory of the motion before allows, the greatest in size."""
    torques = solver.torques(q, qd, qdd)
    least, most = (torques + by for by in solver.friction_state().range_along(q, qd))
    greatest: Floats = np.where(most > -least, most, least)
    return greatest


def _use(
    solver: Solver, limits: MotionLimits, band: Floats, states: tuple[Floats, Floats, Floats]
) -> Floats:
    """(N, n) greatest sizes of torques over what they may be."""
    room = np.maximum(torque_limit(limits, states[1]) - band, _LEAST)
    use: Floats = np.abs(_greatest(solver, *states)) / room
    return use


def _slowed(
    arm: Arm, timed: TimedPath, duration: float, limits: MotionLimits, options: RetimeOptions
) -> TimedPath:
    """The motion with a longer duration. Raises UserError."""
    least = np.ceil(timed.duration * 1e4) / 1e4
    if options.start_speed or options.end_speed:
        raise UserError(
            "duration: expected none for a motion that starts or ends at a speed, which it would change; "
            "leave out one of them"
        )
    if duration < timed.duration:
        raise UserError(
            f"duration: expected at least {least:.4f} s, what the fastest motion takes, got {duration:g} s"
        )
    slower = timed.slowed(duration / timed.duration)
    times = _dense(slower)
    use = _use(arm.solver, limits, torque_band(arm.solver, options.margin), slower.states(times))
    k, j = np.unravel_index(use.argmax(), use.shape)
    if use[k, j] > _ABOVE:
        raise UserError(
            f"duration: at {times[k]:.4g} s of {duration:g} s joint {arm.joint_names[j]} needs "
            f"{100 * use[k, j]:.0f} % of its torque limit: there the robot can pass, but not slowly; choose a "
            "shorter duration, or change the path"
        )
    return slower


def _weighing_times(timed: TimedPath) -> Floats:
    return sample_times(timed.duration, min(_WEIGHING_RATE, _MOST_WEIGHED / timed.duration))


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
    time = _weighing_times(fastest)
    greatest = np.maximum(np.abs(fastest.states(time)[1]).max(axis=0), _STILL)

    def total(timed: TimedPath) -> float:
        time = _weighing_times(timed)
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
    solver: Solver, fastest: TimedPath, limits: MotionLimits, options: RetimeOptions
) -> tuple[float, TimedPath | None]:
    """The greatest acceleration limit, the same for all joints, under which torques hold, and its motion.

    Torques are about linear in it, so the search interpolates: by false position [Illinois algorithm].
    """
    band = torque_band(solver, options.margin)
    n = len(solver.joint_names)
    own = limits.acceleration if len(limits.acceleration) else np.full(n, np.inf)
    unlimited = _changed(
        limits, torque=np.full(n, _UNLIMITED), **dict.fromkeys(_OF_MOTORS, np.zeros(0))
    )
    speeds = {"start_speed": options.start_speed, "end_speed": options.end_speed}
    grid = RetimeOptions(points=options.points, **speeds)
    grid_times = (fastest.time[1:] + fastest.time[:-1]) / 2

    def use(q: Floats, qd: Floats, qdd: Floats) -> float:
        return float(_use(solver, limits, band, (q, qd, qdd)).max())

    def motion(acceleration: float) -> tuple[float, TimedPath | None]:
        common = _changed(unlimited, acceleration=np.minimum(own, acceleration))
        try:
            timed = retime_path(solver, fastest.path, common, grid)
        except UserError:  # a speed at an end is too high
            return np.inf, None
        return use(*timed.states(_dense(timed))), timed

    q, qd, qdd = fastest.states(grid_times)
    low, low_use = 0.0, use(q, _STILL * qd, np.zeros_like(q))
    high = float(np.abs(qdd).max())
    high_use, timed = motion(high)
    if high_use <= 1.0 or low_use > 1.0 or timed is None:
        return (high, timed) if high_use <= 1.0 else (np.nan, None)
    found: tuple[float, TimedPath | None] = (np.nan, None)
    for _ in range(_MOST_STEPS):
        middle = low + (high - low) * (_AIM - low_use) / (high_use - low_use)
        middle_use, timed = motion(middle)
        if middle_use <= 1.0:
            low, low_use, found = middle, middle_use, (middle, timed)
            high_use = 1.0 + (high_use - 1.0) / 2
        else:
            high, high_use = middle, middle_use
            low_use = 1.0 - (1.0 - low_use) / 2
        if timed is None or _ABOUT_ONE < middle_use <= 1.0:
            break
    return found

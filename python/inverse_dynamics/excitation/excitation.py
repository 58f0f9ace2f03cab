# SPDX-License-Identifier: Apache-2.0
"""Search for an exciting motion: one after which the torques of an arm are predicted best.

    found = optimise_excitation(robot, ExcitationOptions(duration=20.0), seed=0)
    found.trajectory, found.deviation, found.condition_number

The search minimises the variance of predicted torques, averaged over states drawn evenly from the limits: V-optimality
[Fedorov 1972; Atkinson, Donev, Tobias, Optimum Experimental Designs, with SAS, 2007, ch. 10], in logarithms, so that
each joint counts by its ratio, whatever its size and unit:

    1 / (2 n) sum_j log mean_k z_jk V z_jk'           V, z: information.py

D-optimality, log det V, is not the same: it counts combinations of parameters that hardly act on torques as much as
those that decide them. Limits of position, velocity, acceleration, effort and distance are quadratic penalties that
grow from step to step; the motion found is then checked at 1 kHz, and made smaller until the check passes.

The gradient is that of the chain rule: d tr(A V) = -tr(V A V dM), dM from derivatives of the rows z by q, qd and qdd,
which are finite differences of the regressor, in one batch. The same seed gives the same motion (on one kind of
machine: rounding differs between processors).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.excitation.excitation_motion import MotionFamily
from inverse_dynamics.excitation.information import (
    Unknowns,
    base_count,
    condition_number,
    engine_of,
    sample_weight,
)
from inverse_dynamics.progress import no_progress
from inverse_dynamics.simulation.collision import ContactChecker
from inverse_dynamics.simulation.errors import SimulationError, TrajectoryError
from inverse_dynamics.simulation.limits import MotionLimits, check_trajectory, require_limits

if TYPE_CHECKING:
    from collections.abc import Callable

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.simulation.model import SimulatedRobot
    from inverse_dynamics.simulation.trajectory import Trajectory, WaypointTrajectory
    from inverse_dynamics.simulation.urdf import UrdfChain

WRIST = 3  # how many joints move for a payload

_START_WAVES = 2  # of each joint
_FASTEST_START = 20  # half turns of the fastest
_STARTS = 20  # random ones, of which the best is improved
_FIRST_WEIGHT, _LAST_WEIGHT = 3.0, 300.0  # of the penalties
_SAMPLE_STEP = 0.1  # s between the points at which a motion is judged
_LIMIT_STEP = 0.025  # s, the same for velocities and accelerations
_CHECK_STEP = 1e-3  # s, of the last check
_CLOSER = 0.002  # m of distance that the search keeps beyond the clearance
_AIM = 0.985  # part of the limits that the search aims at
_SHRINKING, _SHRINKINGS = 0.96, 20  # each time to that part, so often, where the last check fails
_TEST_STATES = 300
_LOADED = 0.25  # of the greatest gravity torque, at both slow reversals
_LIGHT = 0.01  # part of the effort limit: less gravity than that is neglected
_DIFFERENCE = 1e-6  # of velocity limit and so on, in finite differences
_TURN = 1e-4  # rad, in finite differences of distances
_CONDITION_SAMPLES = 200

# Of the descent.
_STEP = 0.02  # of each coordinate, at first
_MEAN, _SQUARES = 0.9, 0.98  # of the running means, what is kept per step
_LEAST = 1e-9  # gradient that counts


@dataclass(frozen=True)
class ExcitationOptions:
    """Constraints of a motion, and its purpose."""

    duration: float = 0.0  # s; 0: 20, or 8 for a payload
    share: float = 0.8  # of the limits of position, velocity, acceleration, jerk and effort
    time_to_full_speed: float = 0.5  # s, what limits accelerations besides the URDF
    slow: float = 0.2  # share of the duration, for slow reversals; not for a payload
    payload: bool = False  # whether a body at the first tip is to be identified, not the arm
    clearance: float = 0.01  # m, from itself and from the table
    table: bool = True
    iterations: int = 600

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", self.duration or (8.0 if self.payload else 20.0))

    def unknowns(self, robot: SimulatedRobot, noise: Floats | None = None) -> Unknowns:
        """What is unknown before the motion. noise: (n,) N m, of the efforts; None: a part of each effort limit.

        Raises SimulationError where the description states no limit that the search needs.
        """
        return Unknowns.of(robot, self.limits(robot), noise, payload=self.payload)

    def limits(self, robot: SimulatedRobot) -> MotionLimits:
        """Limits of the motion."""
        limits = MotionLimits.of(robot, self.time_to_full_speed).fraction(self.share)
        _check_limits(robot, limits)
        return limits


@dataclass(frozen=True)
class Excitation:
    """An exciting motion and how good it is."""

    trajectory: WaypointTrajectory
    condition_number: float  # of the base regressor
    unknowns: Unknowns
    gram: Floats  # (m, m) information of the motion alone
    notes: tuple[str, ...] = ()


def optimise_excitation(
    robot: SimulatedRobot,
    options: ExcitationOptions | None = None,
    *,
    seed: int = 0,
    unknowns: Unknowns | None = None,
    given: Floats | None = None,
    progress: Progress = no_progress,
) -> Excitation:
    """Exciting motion of a robot; the same seed gives the same one.

    unknowns: None: those of the options. given: (m, m), information that is there already, of Unknowns.gram().

    Raises SimulationError if none was found within the limits, and where the URDF lacks limits.
    """
    options = options or ExcitationOptions()
    unknowns = unknowns or options.unknowns(robot)
    limits = unknowns.limits
    moving = np.ones(len(limits.lower), dtype=bool)
    if options.payload:
        moving[:] = False
        moving[_wrist(robot.chain)] = True
    family = MotionFamily.of(
        robot.chain.joint_names,
        limits,
        duration=options.duration,
        slow=0.0 if options.payload else options.slow * options.duration,
        moving=moving,
    )
    searched = ContactChecker(robot, clearance=options.clearance + _CLOSER, table=options.table)
    judge = _Judge(unknowns, family, searched, given)
    x = _start(judge, family, np.random.default_rng(seed))

    def gradient(x: Floats, done: float) -> Floats:
        judge.weight = _FIRST_WEIGHT * (_LAST_WEIGHT / _FIRST_WEIGHT) ** done
        return judge.cost(x)[1]

    x = minimise(gradient, x, iterations=options.iterations, progress=progress)
    checker = ContactChecker(robot, clearance=options.clearance, table=options.table)
    trajectory = _shrunk_until_free(robot, family, x, limits, checker)
    return Excitation(
        trajectory,
        condition_of(robot, trajectory),
        unknowns,
        motion_gram(unknowns, trajectory),
        (*checker.notes, *_one_sided(unknowns, family, trajectory)),
    )


def _wrist(chain: UrdfChain) -> list[int]:
    """The last joints, or those that they mimic, before the first tip."""
    ways = (chain.moves[name][0] for name in chain.joints_to(chain.tips[0]))
    return list(dict.fromkeys(reversed([*ways])))[:WRIST]


def minimise(
    gradient: Callable[[Floats, float], Floats],
    start: Floats,
    *,
    iterations: int,
    progress: Progress = no_progress,
) -> Floats:
    """The point (m,) after `iterations` steps of Adam from `start`, coordinates of about one.

    Steps go along a running mean of the gradients, each coordinate divided by the root of a running mean of their
    squares [Kingma and Ba, arXiv 1412.6980, algorithm 1], and become shorter towards the end [cosine: Loshchilov and
    Hutter, arXiv 1608.03983]. There is no line search, which kinks of the cost would stop.

    gradient: of the cost at x (m,), done a part from 0 to 1 of the steps, since penalties may grow.
    """
    x = np.array(start, dtype=np.float64)
    mean, squares = np.zeros_like(x), np.zeros_like(x)
    for k in range(iterations):
        progress("optimising", k, iterations)
        done = k / iterations
        slope = gradient(x, done)
        mean = _MEAN * mean + (1.0 - _MEAN) * slope
        squares = _SQUARES * squares + (1.0 - _SQUARES) * slope**2
        unbiased = mean / (1.0 - _MEAN ** (k + 1))
        size = np.sqrt(squares / (1.0 - _SQUARES ** (k + 1)))
        x = x - _STEP * 0.5 * (1.0 + np.cos(np.pi * done)) * unbiased / (size + _LEAST)
    progress("optimising", iterations, iterations)
    return x


def _check_limits(robot: SimulatedRobot, limits: MotionLimits) -> None:
    """Raises SimulationError where the description states no limit that the search needs."""
    require_limits(robot.chain, "the search")
    lower, upper = limits.window()
    for joint, low, high in zip(robot.chain.joint_names, lower, upper, strict=True):
        if not low < high:
            raise SimulationError(
                f"robot description: joint {joint}: expected a range of positions to move in, got "
                f"{low:g} to {high:g}; correct its <limit lower=... upper=.../>"
            )


def condition_of(robot: SimulatedRobot, trajectory: Trajectory, duration: float = np.inf) -> float:
    """Condition number of the base regressor over a trajectory, or the first seconds of it."""
    engine = engine_of(robot)
    end = min(duration, trajectory.duration)
    time = np.linspace(0.0, end, _CONDITION_SAMPLES, endpoint=False)
    return condition_number(engine.regressor(*trajectory.at(time)), base_count(engine))


def motion_gram(
    unknowns: Unknowns, trajectory: Trajectory, duration: float | None = None
) -> Floats:
    """Information (m, m) of a motion. duration: s; None: all of it."""
    duration = trajectory.duration if duration is None else duration
    time = np.arange(0.0, duration, _SAMPLE_STEP / 2)
    return unknowns.gram(*trajectory.at(time), period=duration / len(time))


def _start(judge: _Judge, family: MotionFamily, random: np.random.Generator) -> Floats:
    """The best of a few random motions: slow waves with a little of everything."""
    shape = family.amplitudes.shape
    starts = []
    for _ in range(_STARTS):
        about = np.zeros(shape)
        for _ in range(_START_WAVES):
            which = random.integers(2, min(_FASTEST_START, shape[0]), shape[1])
            about[which, np.arange(shape[1])] += random.choice([-1.0, 1.0], shape[1])
        center = np.asarray(random.uniform(-0.5, 0.5, shape[1]))
        starts.append(judge.slowed(center, about))
    judge.weight = _FIRST_WEIGHT
    return min(starts, key=lambda x: judge.cost(x)[0])


def _shrunk_until_free(
    robot: SimulatedRobot,
    family: MotionFamily,
    x: Floats,
    limits: MotionLimits,
    checker: ContactChecker,
) -> WaypointTrajectory:
    """The motion, made small enough about its mean pose that it passes the check."""
    waves = x.reshape(family.amplitudes.shape)
    for factor in _SHRINKING ** np.arange(_SHRINKINGS):
        small = np.vstack([waves[:1], factor * waves[1:]])
        trajectory = family.member(small.ravel())
        try:
            check_trajectory(robot, trajectory, limits, checker)
            check_trajectory(robot, trajectory, limits, None, step=_CHECK_STEP)
        except TrajectoryError as error:
            reason = error
        else:
            return trajectory
    raise SimulationError(
        f"no exciting motion of {trajectory.duration:g} s was found ({str(reason).rpartition('; ')[0]}); a longer "
        "--duration takes less speed, acceleration and effort"
    )


def _one_sided(
    unknowns: Unknowns, family: MotionFamily, trajectory: WaypointTrajectory
) -> list[str]:
    """A note on joints whose slow reversals see gravity in one direction only."""
    if not family.reversals:
        return []
    g = unknowns.gravity(trajectory.positions[list(family.reversals)])
    heavy = _greatest_gravity(unknowns) > _LIGHT * unknowns.limits.effort
    alike = heavy & (g.min(axis=0) * g.max(axis=0) >= 0.0)
    names = ", ".join(np.array(family.joint_names)[alike])
    return [f"slow reversals under gravity in one direction only: {names}"] if names else []


def _greatest_gravity(unknowns: Unknowns) -> Floats:
    """(n,) N m, over random states."""
    states = unknowns.random_states(_TEST_STATES)
    return np.asarray(np.abs(unknowns.gravity(states.q)).max(axis=0))


class _Judge:
    """Cost of a motion and its gradient: logarithm of the predicted deviations, and penalties."""

    def __init__(
        self,
        unknowns: Unknowns,
        family: MotionFamily,
        checker: ContactChecker,
        given: Floats | None,
    ) -> None:
        self.weight, limits = _FIRST_WEIGHT, unknowns.limits
        self._unknowns, self._family, self._limits = unknowns, family, limits
        self._checker = checker
        self._given = np.zeros_like(unknowns.scale) if given is None else given
        count = round(family.times[-1] / _SAMPLE_STEP)
        self._period = family.times[-1] / count
        self._basis = family.basis((np.arange(count) + 0.5) * self._period)
        fine = np.arange(0.0, family.times[-1], _LIMIT_STEP)
        self._fine = family.basis(fine)
        # A_j of the test states, in all unknowns
        Z = unknowns.rows(*unknowns.random_states(_TEST_STATES, seed=1)) * unknowns.predicted
        self._tested = np.einsum("kjm,kjl->jml", Z, Z) / len(Z)
        self._heavy = _greatest_gravity(unknowns)
        self._steps = _DIFFERENCE * np.array(
            [np.ones_like(limits.velocity), limits.velocity, limits.acceleration]
        )

    def cost(self, x: Floats) -> tuple[float, Floats]:
        """Value and gradient at free numbers x."""
        value, gradient = self._information(x)
        for penalty in (self._kinematic_penalty, self._contact_penalty, self._load_penalty):
            more, slope = penalty(x)
            value += self.weight * more
            gradient = gradient + self.weight * slope
        return value, gradient

    def slowed(self, center: Floats, waves: Floats) -> Floats:
        """Free numbers of waves (P, n) about a center (n,), made small enough for the limits."""
        still = np.zeros_like(waves)
        still[0] = center
        q0, _, _ = self._family.states(still.ravel(), self._fine)
        q, qd, qdd = self._family.states((still + waves).ravel(), self._fine)
        lower, upper = self._limits.window()
        room = np.minimum(upper - q0, q0 - lower).min(axis=0)
        used = [
            np.abs(values).max(axis=0) / limit
            for values, limit in (
                (q - q0, np.maximum(room, 1e-6)),
                (qd, self._limits.velocity),
                (qdd, self._limits.acceleration),
            )
        ]
        return np.asarray((still + waves / np.maximum(np.max(used, axis=0), 1.0)).ravel())

    def _information(self, x: Floats) -> tuple[float, Floats]:
        """Logarithm of the deviations, and the penalty of efforts, which takes the same rows."""
        unknowns, joints = self._unknowns, len(self._limits.lower)
        states = self._family.states(x, self._basis)
        Z, tau = unknowns.rows_and_torques(*states)
        V = unknowns.covariance(self._given + unknowns.weighted_gram(Z, self._period))
        variances = np.einsum("jml,lm->j", self._tested, V)
        value = float(np.log(variances).sum() / (2 * joints))
        # d value = -1/n sum_kj (w_j B z_kj)' dz_kj
        B = V @ np.einsum("jml,j->ml", self._tested, 1.0 / variances) @ V
        weight = sample_weight(self._period) / unknowns.noise**2 / joints
        U = -((Z * weight[:, None]).reshape(-1, len(B)) @ B).reshape(Z.shape)  # in one product
        excess = np.maximum(np.abs(tau) / self._limits.effort - _AIM, 0.0)
        U_tau = 2.0 * self.weight * excess * np.sign(tau) / self._limits.effort
        slopes = self._slopes(states, U, U_tau)
        value += self.weight * float((excess**2).sum())
        return value, self._family.pulled_back(slopes, self._basis)

    def _slopes(
        self, states: tuple[Floats, Floats, Floats], U: Floats, U_tau: Floats
    ) -> list[Floats]:
        """Derivatives (N, n) by q, qd, qdd of sum U . Z + sum U_tau . tau."""
        weighted = self._unknowns.weighted_sum(U, U_tau)
        gravity = self._unknowns.gravity(states[0])
        here = weighted(*states, gravity)
        slopes = []
        for which in range(3):
            slope = np.empty_like(states[which])
            for j, step in enumerate(self._steps[which]):
                q, qd, qdd = (
                    values.copy() if k == which else values for k, values in enumerate(states)
                )
                (q, qd, qdd)[which][:, j] += step
                there = weighted(q, qd, qdd, None if which == 0 else gravity)
                slope[:, j] = (there - here) / step
            slopes.append(slope)
        return slopes

    def _kinematic_penalty(self, x: Floats) -> tuple[float, Floats]:
        """Of positions, velocities and accelerations beyond their limits."""
        q, qd, qdd = self._family.states(x, self._fine)
        lower, upper = self._limits.window()
        half = (upper - lower) / 2
        total, slopes = 0.0, []
        for values, limit in (
            (q - (lower + upper) / 2, half),
            (qd, self._limits.velocity),
            (qdd, self._limits.acceleration),
        ):
            excess = np.maximum(np.abs(values) / limit - _AIM, 0.0)
            total += float((excess**2).sum())
            slopes.append(2.0 * excess * np.sign(values) / limit)
        return total, self._family.pulled_back(slopes, self._fine)

    def _contact_penalty(self, x: Floats) -> tuple[float, Floats]:
        """Of states that come too close to the arm itself or to the table, per 0.1 m."""
        q, still, _ = self._family.states(x, self._basis)
        still = np.zeros_like(q)
        slope = np.zeros_like(q)
        violations = self._checker.violations(q)
        for k in np.flatnonzero(violations > 0.0):
            moved = q[k] + _TURN * np.eye(q.shape[1])
            change = self._checker.violations(moved) - violations[k]
            slope[k] = 200.0 * violations[k] * change / _TURN
        value = 100.0 * float((violations**2).sum())
        return value, self._family.pulled_back((slope, still, still), self._basis)

    def _load_penalty(self, x: Floats) -> tuple[float, Floats]:
        """Of slow reversals that don't see gravity in both directions."""
        slope = np.zeros((self._family.pose_of.shape[1], len(self._limits.lower)))
        if not self._family.reversals:
            return 0.0, self._family.of_poses(slope)
        turning = self._family.positions(x)[list(self._family.reversals)]
        joints = turning.shape[1]
        heavy = self._heavy > _LIGHT * self._limits.effort

        def load(states: Floats) -> Floats:
            gravity = np.where(heavy, self._unknowns.gravity(states), 0.0)
            return np.asarray(gravity / np.where(heavy, self._heavy, 1.0))

        loads = load(turning)
        total, side = 0.0, np.where(loads[0] >= loads[1], 1.0, -1.0)
        for k, sign in enumerate((side, -side)):
            lacking = np.where(heavy, np.maximum(_LOADED - sign * loads[k], 0.0), 0.0)
            total += float((lacking**2).sum())
            change = (load(turning[k] + 1e-6 * np.eye(joints)) - loads[k]) / 1e-6
            slope[self._family.slow_poses[k]] = -change @ (2.0 * lacking * sign)
        return total, self._family.of_poses(slope)

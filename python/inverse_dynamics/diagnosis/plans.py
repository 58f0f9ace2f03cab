# SPDX-License-Identifier: Apache-2.0
"""Planned motions that contradict themselves, or that the joints of a robot can't follow.

for text in {**contradictions(plan, arm), **beyond_limits(plan, arm)}.values():
    print(text)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis import motions
from inverse_dynamics.diagnosis.arm import ArmModel
from inverse_dynamics.diagnosis.pieces import Pieces
from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.times import LONGEST_PERIOD
from inverse_dynamics.wording import counted, listed

if TYPE_CHECKING:
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.diagnosis.rival import Mistake
    from inverse_dynamics.robots.arm import Arm

_PARTS = 48  # of a plan, in which velocities are compared with positions: rounded numbers show less in them
_LEAST = 1e-3  # rad, of the way in a part: less is in rounded numbers
_JUMP = 0.01  # rad
_STEPS = 10.0  # times the steps of 90 % of the points: a jump, where no velocities say how far a step goes
_SLOWER = 0.01  # times as fast as velocities say: no plan is meant so
_OTHER = 0.2  # of the square of positions' ways: velocities of another motion leave more
_ROUNDING = {
    "position": 1e-6,
    "velocity": 1e-3,
    "acceleration": 1e-3,
}  # relative, of what may reach a limit
_IN_RANGE = (
    "change the motion, and if positions are degrees, convert them (of a table: --scale q=deg)"
)
_WITHIN_LIMITS = "`ids retime` times a path within the limits"
_REMEDIES = {
    "degrees": "convert them (of a table: --scale q=deg or qd=deg)",
    "clock": "correct the times, or velocities and accelerations",
    "velocity": "correct them, and the accelerations",
}


@dataclass(frozen=True)
class Plan:
    """Points of a planned motion: N points, n joints. None: not planned."""

    where: str  # file and trajectory, for errors
    point: str  # what texts call a point: point, row
    q: Floats  # (N, n) rad (prismatic m)
    time: Floats | None = None  # (N,) s
    qd: Floats | None = None  # (N, n) rad/s
    qdd: Floats | None = None  # (N, n) rad/s^2
    torques: Floats | None = None  # (N, n) N m, computed

    def place(self, k: int) -> str:
        """The k-th point: `point 5 (0.016 s)`."""
        at = "" if self.time is None else f" ({self.time[k]:.6g} s)"
        return f"{self.point} {k + 1}{at}"


def contradictions(plan: Plan, arm: Arm) -> dict[str, str]:
    """Positions, velocities, accelerations and times that contradict each other, in words, with places.

    By kind: those of motions.contradictions(); `rest`: velocities or accelerations are zero in a motion; `jump`.
    Raises BagError where the time has another unit.
    """
    way = np.diff(plan.q, axis=0)
    if not len(way):
        return {}
    if plan.time is None or plan.qd is None:
        usual = _STEPS * np.quantile(np.abs(way), 0.9, axis=0)
        return _jumps(plan, arm, np.abs(way) - usual > _JUMP, None)
    driven = _driven(plan, way)
    jumps = _beyond_velocities(way, driven)
    ways, drives = _parts(way), _parts(driven)
    moves = ~jumps.any(axis=0) & (np.abs(ways).max(axis=0) > _LEAST)
    found, named = _mistakes(plan, arm, way, driven, (ways, drives, moves))
    size = np.maximum((ways**2).sum(axis=0), (drives**2).sum(axis=0))
    other = ~named & ~jumps.any(axis=0) & (size > _LEAST**2)
    other &= ((ways - drives) ** 2).sum(axis=0) > _OTHER * size
    if other.any() and "velocity" not in found:
        text = f"velocities of {_of(arm, other)} aren't those of the positions"
        found["velocity"] = _most(plan, arm, text, other, way, driven, _REMEDIES["velocity"])
    return {**found, **_without_acceleration(plan, arm), **_jumps(plan, arm, jumps, driven)}


def _driven(plan: Plan, way: Floats) -> Floats:
    """(N - 1, n) how far velocities go from point to point: by the trapezoid, or nearer, as a cubic's slope."""
    assert plan.time is not None
    assert plan.qd is not None
    step = np.diff(plan.time)[:, None]
    trapezoid = 0.5 * step * (plan.qd[1:] + plan.qd[:-1])
    if plan.qdd is None:
        return trapezoid
    cubic = trapezoid - step**2 / 12 * np.diff(plan.qdd, axis=0)
    nearer = (trapezoid != 0) & (np.abs(way - cubic) < np.abs(way - trapezoid))
    return np.where(nearer, cubic, trapezoid)


def _beyond_velocities(way: Floats, driven: Floats) -> Mask:
    """(N - 1, n) steps that are longer than any of the joint's velocities makes, whatever their unit."""
    fast = np.abs(driven) > 0.1 * np.abs(driven).max(axis=0)
    ratio = np.array(
        [
            np.median(w[f] / d[f]) if f.any() else 0.0
            for w, d, f in zip(way.T, driven.T, fast.T, strict=True)
        ]
    )
    expected = ratio * driven
    beyond = np.abs(way - expected) > np.abs(expected).max(axis=0) + _JUMP
    return np.asarray(beyond & driven.any(axis=0))


def _parts(steps: Floats) -> Floats:
    """(K, n) sums of (N - 1, n) over contiguous parts."""
    starts = np.linspace(0, len(steps), min(_PARTS, len(steps)), endpoint=False).astype(int)
    return np.asarray(np.add.reduceat(steps, starts, axis=0))


def _mistakes(
    plan: Plan, arm: Arm, way: Floats, driven: Floats, ways: tuple[Floats, Floats, Mask]
) -> tuple[dict[str, str], Mask]:
    """What recordings are searched for as well, and the joints that it names."""
    assert plan.time is not None
    assert plan.qd is not None
    solver = arm.solver
    model = ArmModel(solver.torques, solver.gravity_vector, joint_types=tuple(solver.joint_types))
    arrays = (plan.time, plan.q, plan.qd, np.zeros_like(plan.q), np.zeros_like(plan.q))
    samples = Pieces(arm.recorded_names, *(values[None] for values in arrays))
    found, named = {}, np.zeros(way.shape[1], bool)
    for mistake, _ in motions.contradictions(samples, model, ways)[:1]:  # others explain the same
        joints = mistake.joints or arm.recorded_names
        mask = np.array([name in joints for name in arm.recorded_names])
        _check_clock(plan, mistake)
        kind, remedy = mistake.kind, _REMEDIES[mistake.kind]
        if kind == "velocity" and mistake.value == 0:
            kind = "rest"
            remedy = (
                "so torques are those of an arm that stands still in each point, mostly gravity; give velocities "
                "and accelerations: `ids retime` computes them for a path"
            )
        found[kind] = _most(plan, arm, mistake.reason, mask, way, driven, remedy)
        named |= mask
    return found, named


def _check_clock(plan: Plan, mistake: Mistake) -> None:
    """Raise BagError where velocities would go much farther than positions in such a time."""
    if mistake.kind == "degrees" or mistake.value == 0:
        return
    assert plan.time is not None
    step = float(np.median(np.diff(plan.time)))
    # how many times as fast as velocities say; of one joint, only long steps tell times from velocities
    rate = abs(mistake.value if mistake.kind == "clock" else 1 / mistake.value)
    if rate < _SLOWER and (mistake.kind == "clock" or step >= LONGEST_PERIOD):
        unit = {3: "ms", 6: "us", 9: "ns"}.get(round(-np.log10(rate)), "another unit")
        raise BagError(
            f"{plan.where}: time: expected seconds, got steps of {step:.6g}, in which positions change {rate:.3g} "
            f"times as fast as velocities say: are they {unit}? Then give seconds (of a table: --scale time={unit})"
        )


def _without_acceleration(plan: Plan, arm: Arm) -> dict[str, str]:
    """Joints whose velocities change, though their accelerations are zero throughout."""
    if plan.qd is None or plan.qdd is None:
        return {}
    lacking = (np.ptp(plan.qd, axis=0) > _LEAST) & ~plan.qdd.any(axis=0)
    if not lacking.any():
        return {}
    change = np.where(lacking, np.abs(np.diff(plan.qd, axis=0)), 0.0)
    k, j = np.unravel_index(change.argmax(), change.shape)
    return {
        "acceleration": f"accelerations of {_of(arm, lacking)} are zero, though velocities change, most in "
        f"{arm.recorded_names[j]} from {plan.place(int(k))} to {plan.place(int(k) + 1)}, by "
        f"{plan.qd[k + 1, j] - plan.qd[k, j]:.3g}; so torques lack inertia: give accelerations"
    }


def _jumps(plan: Plan, arm: Arm, jumps: Mask, driven: Floats | None) -> dict[str, str]:
    """The first of the steps (N - 1, n) that are jumps, in words."""
    if not jumps.any():
        return {}
    k, j = (int(i) for i in np.argwhere(jumps)[0])
    step = plan.q[k + 1, j] - plan.q[k, j]
    said = "" if driven is None else f", velocities say {driven[k, j]:.3g}"
    more = f", the first of {counted(int(jumps.sum()), 'jump')}" if jumps.sum() > 1 else ""
    return {
        "jump": f"the position of {arm.recorded_names[j]} jumps by {step:.3g} from {plan.place(k)} to "
        f"{plan.place(k + 1)}{said}{more}; correct what is wrong, or give the points between"
    }


def _most(
    plan: Plan, arm: Arm, text: str, mask: Mask, way: Floats, driven: Floats, remedy: str
) -> str:
    """The text with the place where joints of a mask contradict themselves most."""
    apart = np.where(mask, np.abs(way - driven), -1.0)
    k, j = (int(i) for i in np.unravel_index(apart.argmax(), apart.shape))
    return (
        f"{text}, most in {arm.recorded_names[j]}, which goes {way[k, j]:.3g} from {plan.place(k)} to "
        f"{plan.place(k + 1)}, by velocities {driven[k, j] + 0.0:.3g}; {remedy}"
    )


def beyond_limits(plan: Plan, arm: Arm) -> dict[str, str]:
    """Limits of the robot description that the plan passes, in words, by quantity, with the first place."""
    prismatic = np.array([kind == "prismatic" for kind in arm.solver.joint_types])
    turns = np.where(prismatic, np.inf, motions.TURNS)
    lower, upper = arm.limit("lower", np.nan), arm.limit("upper", np.nan)
    least, most = np.where(np.isnan(lower), -turns, lower), np.where(np.isnan(upper), turns, upper)
    qd = np.zeros_like(plan.q) if plan.qd is None else plan.qd.copy()
    if plan.time is not None:  # from point to point, joints are at least once as fast as on average
        mean = np.diff(plan.q, axis=0) / np.diff(plan.time)[:, None]
        qd[1:] = np.where(np.abs(mean) > np.abs(qd[1:]), mean, qd[1:])
    velocity, effort = arm.limit("velocity", np.inf), arm.limit("effort", np.inf)
    found = {
        **_passed(plan, arm, "position", plan.q, (least, most)),
        **_passed(plan, arm, "velocity", qd, (-velocity, velocity)),
    }
    if plan.qdd is not None:
        up, down = arm.limit("acceleration", np.inf), arm.limit("deceleration", np.inf)
        limit = np.where(qd * plan.qdd < 0, down, up)
        found |= _passed(plan, arm, "acceleration", plan.qdd, (-limit, limit))
    if plan.torques is not None:
        found |= _passed(plan, arm, "torque", plan.torques, (-effort, effort))
    return found


def _passed(
    plan: Plan, arm: Arm, what: str, values: Floats, limits: tuple[Floats, Floats]
) -> dict[str, str]:
    """The first of values (N, n) beyond limits, in words."""
    least, most = (np.broadcast_to(limit, values.shape) for limit in limits)
    room = _ROUNDING.get(what, 0.0) * (1.0 + np.abs(values))
    passed = np.asarray((values < least - room) | (values > most + room))
    if not passed.any():
        return {}
    k, j = (int(i) for i in np.argwhere(passed)[0])
    length = "m" if arm.units[j] == "N" else "rad"
    units = {"position": length, "velocity": f"{length}/s", "acceleration": f"{length}/s^2"}
    return {
        f"{what} limit": f"the {what} of {_of(arm, np.any(passed, axis=0))} passes limits, first in {plan.place(k)}: "
        f"expected {least[k, j]:.4g} to {most[k, j]:.4g} {units.get(what, arm.units[j])} of {arm.recorded_names[j]}, "
        f"got {values[k, j]:.4g}; {_IN_RANGE if what == 'position' else _WITHIN_LIMITS}"
    }


def _of(arm: Arm, mask: Mask) -> str:
    """Names of the joints of a mask (n,)."""
    names = [name for name, m in zip(arm.recorded_names, mask, strict=True) if m]
    return "all joints" if len(names) == len(mask) > 1 else listed(names)

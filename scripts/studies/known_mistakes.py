# SPDX-License-Identifier: Apache-2.0
"""Recordings with a known mistake: of the description, the mounting, the driver; or without one.

    for recording in recordings(seed=1, wheels=Path("out/wheels")):
        recording.mistakes          # what evaluate() ought to name
        evaluate(*recording.write(directory))

Arms, motions, friction, noise, errors of the description and mistakes are drawn at random. Friction is as large as
that of the identified UR10 and Panda: Coulomb friction, and viscous friction at 1 rad/s, of 1 to 5 % of a joint's
greatest torque. In half of the arms it grows with load, in half it falls with speed.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from described_arms import ARMS, GRAVITY, Arm, arm_of

from inverse_dynamics import read_joint_log
from inverse_dynamics.robots.robots import robot_of_description

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.robots.robots import Robot

Random = np.random.Generator
Make = Callable[["Draft", Random], "Mistake"]

# ---- recordings ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Mistake:
    """What evaluate() ought to name. joints: those that it ought to name with it; none: not compared."""

    kind: str
    joints: tuple[str, ...] = ()
    value: Any = None
    alike: tuple[str, ...] = ()  # other kinds that mean the same; of a joint: KIND of JOINT


@dataclass
class Draft:
    """A recording that is being made: N samples, n joints."""

    arm: Arm
    time: Floats
    q: Floats
    qd: Floats
    qdd: Floats
    effort: Floats
    description: str  # that evaluate() is given
    gravity: Floats = field(default_factory=lambda: GRAVITY)
    payload: tuple[float, Sequence[float]] | None = None
    stated: tuple[float, Sequence[float]] | None = None  # payload of the run configuration
    weightless: bool = False
    friction: Callable[[Draft, Floats, Random], Floats] | None = None

    @property
    def informative(self) -> list[int]:
        """Joints with a torque worth the name: others can't be known to be wrong."""
        strong = np.ptp(self.effort, axis=0)
        return [int(j) for j in np.flatnonzero(strong > 0.1 * strong.max())]

    def scale(self, names: str, factor: Floats | float) -> None:
        """Multiply columns of positions, velocities, accelerations or efforts."""
        for name in names.split():
            setattr(self, name, getattr(self, name) * factor)


@dataclass(frozen=True)
class Recording:
    """Samples and what is wrong with them."""

    name: str
    draft: Draft
    mistakes: tuple[Mistake, ...]  # none: nothing is wrong
    robot: str = ""  # run configuration; none: the draft's description

    def write(self, directory: Path) -> tuple[Path, str | Robot]:
        """Its CSV, and the robot: a name, or of the description beside the CSV."""
        d, path = self.draft, directory / f"{self.name}.csv"
        columns = [f"{k}.{j}" for k in ("position", "velocity", "effort") for j in d.arm.joints]
        samples = np.column_stack([d.time, d.q, d.qd, d.effort])
        header = ",".join(["time", *columns])
        np.savetxt(path, samples, fmt="%.7g", delimiter=",", header=header, comments="")
        if self.robot:
            return path, self.robot
        path.with_suffix(".urdf").write_text(d.description, encoding="utf-8")
        robot = robot_of_description(path.with_suffix(".urdf"))
        load = dict(zip(("payload.mass", "payload.center_of_mass"), d.stated or (), strict=False))
        return path, replace(robot, root=d.arm.root, tip=d.arm.tip, parameters=load)


def motion(arm: Arm, random: Random, fast: bool) -> tuple[Floats, Floats, Floats, Floats]:
    """Five harmonics for each joint: time (N,) and q, qd, qdd (N, n)."""
    n = len(arm.joints)
    most = np.minimum(np.where(arm.slides, 0.3, 1.2), 0.45 * (arm.upper - arm.lower))
    amplitude = most * random.uniform(0.5, 1.0, n)
    center = random.uniform(arm.lower + amplitude, arm.upper - amplitude)
    k = np.arange(1, 6)
    a, b = random.normal(size=(2, n, 5)) / np.sqrt(k)

    def harmonics(phase: Floats) -> tuple[Floats, Floats, Floats]:
        angle = phase[:, None, None] * k
        x, y = np.cos(angle), np.sin(angle)
        values, slopes = a * x + b * y, b * x - a * y
        return values.sum(2), (slopes * k).sum(2), -(values * k**2).sum(2)

    q, qd, _ = harmonics(np.linspace(0, 2 * np.pi, 400))
    size = amplitude / np.abs(q).max(axis=0)
    share = random.uniform(0.5, 0.9) if fast else random.uniform(0.12, 0.3)
    w = share / float((size * np.abs(qd) / arm.velocity).max())  # rad/s of the first harmonic
    w = min(max(w, 2 * np.pi / 40), 2 * np.pi / 4)
    duration = min(max(12.0, 2 * np.pi / w * random.uniform(1.0, 2.0)), 40.0)
    rate = float(random.choice([100.0, 125.0, 250.0, 500.0]))
    time = np.arange(min(int(duration * rate), 5000)) / rate
    q, qd, qdd = harmonics(w * time)
    return time, center + size * q, size * w * qd, size * w**2 * qdd


def friction_of(
    arm: Arm, random: Random, level: float
) -> Callable[[Draft, Floats, Random], Floats]:
    """A law, level: share of an identified arm's."""
    n = len(arm.joints)
    speed = np.where(arm.slides, 0.3, 1.0)
    coulomb, viscous = level * arm.effort * random.uniform(0.01, 0.05, (2, n))
    with_load, stribeck = (random.uniform(0, most, n) * random.integers(2) for most in (0.1, 0.5))
    width = speed * random.uniform(0.01, 0.05, n)
    offset = random.uniform(-0.3, 0.3, n) * coulomb

    def law(draft: Draft, torques: Floats, _: Random) -> Floats:
        slow = np.exp(-((draft.qd / (5 * width)) ** 2))
        step = coulomb * (1 + stribeck * slow) + level * with_load * np.abs(torques)
        return np.asarray(step * np.tanh(draft.qd / width) + viscous * draft.qd / speed + offset)

    return law


def drafted(arm: Arm, random: Random, fast: bool, *before: Make) -> tuple[Draft, list[Mistake]]:
    """A recording of an arm in the real world: mistakes before are those of it."""
    time, q, qd, qdd = motion(arm, random, fast)
    draft = Draft(arm, time, q, qd, qdd, arm.torques(q, qd, qdd), arm.text)
    level = float(random.choice([0.0, 0.25, 0.5, 1.0]))
    draft.friction = friction_of(arm, random, level)
    mistakes = [make(draft, random) for make in before]
    size = random.choice([0.0, 0.03, 0.07])
    factors = 1 + size * np.clip(random.normal(size=len(arm.joints)), -2, 2)
    world = {"gravity": draft.gravity, "payload": draft.payload, "factors": factors}
    torques = arm.torques(q, qd, qdd, **world)
    if draft.weightless:
        torques = torques - arm.torques(q, **world)
    effort = torques + draft.friction(draft, torques, random)
    span = np.maximum(np.ptp(effort, axis=0), 1e-3 * np.ptp(effort, axis=0).max())
    draft.effort = effort + span * random.choice([0.002, 0.01, 0.03]) * random.normal(size=q.shape)
    draft.q = q + 1e-5 * random.normal(size=q.shape)
    draft.qd = qd + 1e-3 * np.abs(qd).max(axis=0) * random.normal(size=q.shape)
    return draft, mistakes


# ---- mistakes of the world: before torques are computed -------------------------------------------


def ceiling(d: Draft, _: Random) -> Mistake:
    """The arm hangs."""
    d.gravity = -GRAVITY
    return Mistake("gravity", value=[0.0, 0.0, 9.81], alike=("ceiling",))


def wall(d: Draft, r: Random) -> Mistake:
    """The arm is mounted on a wall."""
    d.gravity = 9.81 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])[r.integers(4)]
    return Mistake("gravity", value=d.gravity.tolist(), alike=("wall",))


def tilt(d: Draft, r: Random) -> Mistake:
    """A mounting at any angle."""
    angle, about = np.radians(r.uniform(20, 150)), r.uniform(0, 2 * np.pi)
    side = np.sin(angle) * np.array([np.cos(about), np.sin(about)])
    d.gravity = 9.81 * np.array([*side, -np.cos(angle)])
    return Mistake("gravity", value=d.gravity.tolist())


def no_gravity(d: Draft, _: Random) -> Mistake:
    """The driver takes gravity off."""
    d.weightless = True
    return Mistake("no_gravity")


def _held(d: Draft, r: Random, center: Sequence[float]) -> Mistake:
    # a share of the load that doubles the strongest torque at 1 m
    mass = float(r.uniform(0.15, 0.5) * d.arm.strength.max() / 9.81)
    d.payload = (mass, center)
    links = (f"mass of {joint}" for joint in d.arm.joints[-2:])  # hardly another thing
    return Mistake("payload", value=mass, alike=("tool", *links))


def payload(d: Draft, r: Random) -> Mistake:
    """On the axis of the last joint."""
    return _held(d, r, (0.0, 0.0, float(r.uniform(0, 0.15))))


def tool(d: Draft, r: Random) -> Mistake:
    """Beside the axis of the last joint."""
    return _held(d, r, tuple(r.uniform(-0.15, 0.15, 3)))


def not_carried(d: Draft, r: Random) -> Mistake:
    """The run configuration states a payload that the arm has put down."""
    found = _held(d, r, (0.0, 0.0, float(r.uniform(0, 0.15))))
    d.stated, d.payload = d.payload, None
    return found


def mass(d: Draft, r: Random) -> Mistake:
    """One mass of the description is wrong by a power of ten, or three times."""
    tree = ElementTree.fromstring(d.description)
    k = int(r.integers(1, len(d.arm.joints)))
    link = next(x for x in tree.findall("link") if x.get("name") == d.arm.links[k])
    factor = float(r.choice([10.0, 3.0, 0.1]))
    element = link.find("inertial/mass")
    assert element is not None
    element.set("value", repr(factor * float(element.get("value", "0"))))
    inertia = link.find("inertial/inertia")
    if inertia is not None and r.integers(2):
        for key, value in inertia.items():
            inertia.set(key, repr(factor * float(value)))
    d.description = ElementTree.tostring(tree, encoding="unicode")
    last = k >= len(d.arm.joints) - 2  # a body at the tip does the same
    return Mistake("mass", (d.arm.joints[k],), factor, ("payload", "tool") if last else ())


def guided(d: Draft, r: Random) -> Mistake:
    """Somebody moves the arm by hand: what is missing is along the motion in all joints."""
    share = r.uniform(0.1, 0.3, len(d.arm.joints))

    def hand(draft: Draft, torques: Floats, random: Random) -> Floats:
        span = np.maximum(np.ptp(torques, axis=0), 0.05 * np.ptp(torques, axis=0).max())
        return np.asarray(-share * span * np.tanh(draft.qd / (0.1 * np.abs(draft.qd).max(axis=0))))

    d.friction = hand
    return Mistake("guided")


def friction(d: Draft, r: Random) -> Mistake:
    """Of an identified arm, or twice that: the description has none."""
    d.friction = friction_of(d.arm, r, r.uniform(1.0, 2.0))
    return Mistake("friction")


def drift(d: Draft, r: Random) -> Mistake:
    """Friction falls while gears warm up."""
    law = friction_of(d.arm, r, 2.0)
    d.friction = lambda draft, torques, random: (
        law(draft, torques, random) * (1.5 - draft.time / draft.time[-1])[:, None]
    )
    return Mistake("drift", alike=("friction",))


# ---- mistakes of the recording: afterwards --------------------------------------------------------

MOTION = "q qd qdd"


def currents(d: Draft, r: Random) -> Mistake:
    """In A, without gains."""
    share = d.arm.effort / d.arm.effort.max()
    d.scale("effort", 1 / (share * 15 * r.uniform(0.7, 1.4, len(share)) + 1.7))
    return Mistake("currents", alike=("effort_scale",))


def common_scale(d: Draft, r: Random) -> Mistake:
    """Another unit: mN m, N mm, kgf cm, lbf in, percent."""
    factor = float(r.choice([1000.0, 10.197, 8.8507, 100.0, 0.1]))
    d.scale("effort", factor)
    return Mistake("effort_scale", value=factor, alike=("currents",) if factor < 0.6 else ())


def joint_scales(d: Draft, r: Random) -> Mistake:
    """Per mille of the effort limits, or mA."""
    stated = np.where(d.arm.stated_effort > 0, d.arm.stated_effort, d.arm.effort)
    factors = 1000 / (stated if r.integers(2) else r.uniform(2, 15, len(stated)))
    d.scale("effort", factors)
    return Mistake("effort_scale", value=factors.tolist())


def effort_sign(d: Draft, _: Random) -> Mistake:
    """All efforts are the opposite."""
    d.scale("effort", -1.0)
    return Mistake("effort_sign")


def _reversed(
    d: Draft, r: Random, columns: str, kind: str, count: int = 1, spared: Sequence[str] = ()
) -> Mistake:
    among = [j for j in d.informative if d.arm.joints[j] not in spared]
    chosen = sorted(map(int, r.choice(among, min(count, len(among)), replace=False)))
    sign = np.ones(len(d.arm.joints))
    sign[chosen] = -1.0
    d.scale(columns, sign)
    return Mistake(kind, tuple(d.arm.joints[j] for j in chosen))


def effort_direction(d: Draft, r: Random) -> Mistake:
    """One joint's efforts are the opposite."""
    return _reversed(d, r, "effort", "effort_direction")


def two_directions(d: Draft, r: Random) -> Mistake:
    """Those of two joints."""
    return _reversed(d, r, "effort", "effort_direction", 2)


def direction(d: Draft, r: Random) -> Mistake:
    """Everything of a joint is the opposite: on a tilted base not of the first, which mirrors gravity."""
    spared = d.arm.joints[:1] if d.gravity is not GRAVITY else ()
    return _reversed(d, r, f"{MOTION} effort", "direction", spared=spared)


def _exchanged(d: Draft, r: Random, columns: str, kind: str) -> Mistake:
    i, j = sorted(map(int, r.choice(d.informative, 2, replace=False)))
    order = np.arange(len(d.arm.joints))
    order[[i, j]] = j, i
    for name in columns.split():
        setattr(d, name, getattr(d, name)[:, order])
    return Mistake(kind, (d.arm.joints[i], d.arm.joints[j]))


def order(d: Draft, r: Random) -> Mistake:
    """Two joints have each other's columns."""
    return _exchanged(d, r, f"{MOTION} effort", "order")


def effort_order(d: Draft, r: Random) -> Mistake:
    """Two joints have each other's efforts."""
    return _exchanged(d, r, "effort", "effort_order")


def degrees(d: Draft, r: Random) -> Mistake:
    """Positions, velocities or both; a slider's are as they are, or not."""
    columns = str(r.choice([MOTION, MOTION, "q", "qd qdd"]))
    d.scale(columns, np.where(d.arm.slides & (r.random() < 0.7), 1.0, np.degrees(1)))
    return Mistake("degrees", alike=("velocity",) if columns != MOTION else ())


def velocity(d: Draft, r: Random) -> Mistake:
    """Velocities are zero, reversed, in rpm, of one joint reversed."""
    factors = np.full(len(d.arm.joints), r.choice([0.0, -1.0, 60 / (2 * np.pi)]))
    if r.random() < 0.3:
        factors[:] = 1.0
        factors[r.integers(len(factors))] = -1.0
    d.scale("qd qdd", factors)
    return Mistake("velocity")


def clock(d: Draft, r: Random) -> Mistake:
    """Stamps at another speed: a recording played again, a simulator, ms."""
    d.time = d.time * r.choice([0.1, 0.5, 2.0, 1000.0])
    return Mistake("clock")


def rates(d: Draft, r: Random) -> Mistake:
    """A wrong time step, from which velocities are computed too."""
    factor = float(r.choice([0.1, 0.5, 2.0, 10.0]))
    d.time, d.qd, d.qdd = d.time * factor, d.qd / factor, d.qdd / factor**2
    return Mistake("clock", value=factor)


def motor_side(d: Draft, r: Random) -> Mistake:
    """Positions, velocities and efforts of the motors."""
    n = len(d.arm.joints)
    ratios = r.choice([32.0, 45.0, 48.0, 80.0, 100.0, 121.0], n) * r.choice([1, 1, 1, -1], n)
    d.scale(MOTION, ratios)
    d.scale("effort", 1 / ratios)
    return Mistake("motor_side")


def saturation(d: Draft, r: Random) -> Mistake:
    """Efforts of a joint are cut off."""
    j = int(r.choice(d.informative))
    low, high = np.quantile(d.effort[:, j], (r.uniform(0.1, 0.3), r.uniform(0.7, 0.9)))
    d.effort = d.effort.copy()
    d.effort[:, j] = np.clip(d.effort[:, j], low, high)
    return Mistake("saturation", (d.arm.joints[j],))


def coupling(d: Draft, r: Random) -> Mistake:
    """A motor turns with the next joint's: its effort has the other joint's in it."""
    j = int(r.integers(len(d.arm.joints) - 1))
    d.effort = d.effort.copy()
    d.effort[:, j] += r.choice([-1, 1]) * d.effort[:, j + 1]
    return Mistake("coupling", (d.arm.joints[j], d.arm.joints[j + 1]))


def other_gravity(d: Draft, r: Random) -> Mistake:
    """A simulator with another gravity."""
    d.gravity = GRAVITY * r.choice([0.165, 0.38, 2.5])
    return Mistake("gravity", value=d.gravity.tolist())


def _turning(d: Draft, r: Random) -> int:
    turning = np.flatnonzero(~d.arm.slides)
    told = [j for j in d.informative if j in turning]
    return int(r.choice(told or turning))


def one_in_degrees(d: Draft, r: Random) -> Mistake:
    """One joint in degrees."""
    j = _turning(d, r)
    d.scale(MOTION, np.where(np.arange(len(d.arm.joints)) == j, np.degrees(1), 1.0))
    return Mistake("degrees")


def twice_as_fast(d: Draft, _: Random) -> Mistake:
    """Velocities of all joints are twice what they are."""
    d.qd, d.qdd = 2 * d.qd, 2 * d.qdd
    return Mistake("velocity")


def external(d: Draft, r: Random) -> Mistake:
    """External torques as efforts."""
    span = np.maximum(np.ptp(d.effort, axis=0), 1e-3 * np.ptp(d.effort, axis=0).max())
    walk = np.cumsum(r.normal(size=d.q.shape), axis=0)
    walk /= np.maximum(np.abs(walk).max(axis=0), 1e-12)
    d.effort = span * (
        0.05 * walk + 0.02 * r.normal(size=d.q.shape) + 0.05 * r.uniform(-1, 1, len(span))
    )
    return Mistake("unrelated")


def zero(d: Draft, r: Random) -> Mistake:
    """One joint's positions are off: homed wrongly, or another convention."""
    j = _turning(d, r)
    angle = np.radians(r.choice([90.0, 180.0, r.uniform(5, 30)])) * r.choice([-1, 1])
    d.q = d.q + angle * (np.arange(len(d.arm.joints)) == j)
    return Mistake("zero", (d.arm.joints[j],))


def effort_zero(d: Draft, r: Random) -> Mistake:
    """One torque sensor is off."""
    j = _turning(d, r)
    off = r.uniform(0.3, 0.8) * np.ptp(d.effort[:, j]) * r.choice([-1, 1])
    d.effort = d.effort + off * (np.arange(len(d.arm.joints)) == j)
    return Mistake("effort_zero", (d.arm.joints[j],))


def shifted(d: Draft, r: Random) -> Mistake:
    """Efforts are read one column too far."""
    d.effort = np.roll(d.effort, int(r.choice([-1, 1])), axis=1)
    return Mistake("effort_order")


def delay(d: Draft, r: Random) -> Mistake:
    """Efforts are late, or a mean of those before."""
    count = max(2, int(r.uniform(0.05, 0.25) / float(np.median(np.diff(d.time)))))
    late = np.concatenate([np.repeat(d.effort[:1], count, axis=0), d.effort])
    if r.integers(2):
        sums = np.cumsum(late, axis=0)
        d.effort = (sums[count:] - sums[:-count]) / count
    else:
        d.effort = late[:-count]
    return Mistake("effort_delay")


WORLD = (
    ceiling,
    wall,
    tilt,
    no_gravity,
    payload,
    tool,
    mass,
    guided,
    friction,
    drift,
    other_gravity,
)
RECORDED = (
    currents, common_scale, joint_scales, effort_sign, effort_direction, two_directions, direction, order,
    effort_order, degrees, velocity, clock, rates, motor_side, saturation, coupling,
    one_in_degrees, twice_as_fast, external, zero, effort_zero, shifted, delay,
)  # fmt: skip
# Seen by positions and velocities, or by the shape of efforts, however small the error is.
SEEN = (
    friction,
    guided,
    drift,
    degrees,
    velocity,
    clock,
    motor_side,
    twice_as_fast,
    external,
    effort_zero,
)
MOST_TRIES = 20


def misfit(d: Draft) -> float:
    """Greatest error beside friction and offset, as a share of a joint's range, of joints that tell something."""
    step = max(1, len(d.q) // 600)
    q, qd, qdd, effort = (x[::step] for x in (d.q, d.qd, d.qdd, d.effort))
    computed = Arm(d.description, d.arm.root, d.arm.tip).torques(q, qd, qdd, payload=d.stated)
    shares = []
    for j in d.informative:
        columns = np.column_stack([qd[:, j], np.tanh(qd[:, j] / 0.05), np.ones(len(q))])
        error = effort[:, j] - computed[:, j]
        left = error - columns @ np.linalg.lstsq(columns, error, rcond=None)[0]
        shares.append(np.sqrt(np.mean(left**2)) / np.ptp(effort[:, j]))
    return float(max(shares))


def visible(d: Draft, before: float = 0.0) -> bool:
    """Whether torques are off by more than before the mistake: one of no consequence has no cause."""
    return misfit(d) > max(0.1, 2 * before)


def recordings(
    seed: int, wheels: Path, arms: Sequence[str] = tuple(ARMS), each: int = 1
) -> Iterator[Recording]:
    """Of each kind of mistake, of two at once and of none: on `each` arms."""
    built = {name: arm_of(name, wheels) for name in arms}
    singles = [(make,) for make in (*WORLD, *RECORDED)]
    with_load: tuple[Make, ...] = (no_gravity, effort_sign)
    with_any: tuple[Make, ...] = (common_scale, effort_direction, order, direction)
    pairs = [*product((tilt,), with_any), *product((payload, mass), (*with_load, *with_any))]
    # a quarter without a mistake
    kinds = [*singles, *pairs[seed % 2 :: 2], *[()] * ((len(singles) + len(pairs) // 2) // 3)]
    kinds.append((not_carried,))
    for number, makers in enumerate(kinds):
        random = np.random.default_rng([seed, number])
        for k in range(each):
            label = "+".join(make.__name__ for make in makers) or "clean"
            for _ in range(MOST_TRIES):
                name = arms[int(random.integers(len(arms)))]
                before = (make for make in makers if make in WORLD)
                draft, mistakes = drafted(built[name], random, bool((number + k) % 2), *before)
                clear = len(makers) < 2 or visible(draft)  # the first of two, too
                mistakes += [make(draft, random) for make in makers if make not in WORLD]
                clear &= not makers or makers[0] in SEEN or visible(draft)
                if clear:
                    title = f"{label}_{name}_{seed}_{number}_{k}"
                    yield Recording(title, draft, tuple(mistakes))
                    break


# ---- real recordings ------------------------------------------------------------------------------

SPOILT = (ceiling, tilt, *(make for make in RECORDED if make not in (
    currents, joint_scales, rates, saturation, coupling)))  # fmt: skip


def real_recordings(bags: Path, seed: int) -> Iterator[Recording]:
    """Those of `ids data` as they are, in parts, noisier, and spoilt; by identified models and descriptions."""
    for name in ("ur10", "panda"):
        arm = arm_of(name, bags)
        whole = _real(arm, bags / f"{name}_exciting_trajectory")
        before = misfit(whole)
        for number, ((begin, end), noise, make) in enumerate(_variants()):
            random = np.random.default_rng([seed, number])
            for _ in range(MOST_TRIES):
                rows = slice(int(begin * len(whole.q)), int(end * len(whole.q)))
                draft = replace(whole, **{k: getattr(whole, k)[rows] for k in ("time", *_COLUMNS)})
                white = random.normal(size=draft.q.shape)
                draft.effort = draft.effort + noise * np.ptp(whole.effort, axis=0) * white
                mistakes = [make(draft, random)] if make else []
                draft.effort = draft.effort + _statics(draft)
                if make is None or make in SEEN or visible(draft, before):
                    break
            label = make.__name__ if make else f"clean_{begin:g}_{end:g}_{noise:g}"
            for robot in (f"{name}_real", f"{name}_simulated"):
                yield Recording(f"real_{label}_{robot}_{seed}", draft, tuple(mistakes), robot)


_COLUMNS = ("q", "qd", "qdd", "effort")


def _real(arm: Arm, bag: Path) -> Draft:
    """As it was recorded. Accelerations, to see whether a mistake is visible, over eleven samples."""
    log = read_joint_log(bag)
    columns = [log.joint_names.index(joint) for joint in arm.joints]
    q, qd, effort = (x[:, columns] for x in (log.q, log.qd, log.effort))
    smooth = np.apply_along_axis(np.convolve, 0, qd, np.full(11, 1 / 11), "same")
    return Draft(arm, log.time, q, qd, np.gradient(smooth, log.time, axis=0), effort, arm.text)


def _variants() -> Iterator[tuple[tuple[float, float], float, Make | None]]:
    for part in ((0.0, 1.0), (0.0, 0.5), (0.5, 1.0)):
        for noise in (0.0, 0.3):
            yield part, noise, None
    for make in SPOILT:
        yield (0.0, 1.0), 0.0, make


def _statics(draft: Draft) -> Floats:
    """What mistakes of the world add to the efforts of an arm that stands on the floor."""
    own = draft.arm.torques(draft.q)
    if draft.weightless:
        return -own
    if np.array_equal(draft.gravity, GRAVITY):
        return np.zeros_like(own)
    return draft.arm.torques(draft.q, gravity=draft.gravity) - own

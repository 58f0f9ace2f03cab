# SPDX-License-Identifier: Apache-2.0
"""What touches robots in MuJoCo is found from positions of encoders and noisy torques, at 1 kHz.

The figures that the tests print (pytest -s) are those of docs/contact.md.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
import pytest
from contact_arms import (
    ELBOW,
    PERIOD,
    RIGID_BODY,
    Ball,
    ContactArm,
    Recorded,
    random_motion,
    swing,
    write_model,
)
from example_robots import KDL
from simulation_arms import CHAINS, urdf_of

from inverse_dynamics import Solver
from inverse_dynamics.contact import (
    ContactDetector,
    ContactThresholds,
    EstimatorOptions,
    MomentumObserver,
    TipWrench,
    contact_thresholds,
)

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.arrays import Floats

GAIN = 60.0  # 1/s
SEEDS = pytest.mark.parametrize(
    "seeds",
    [
        pytest.param(range(3), id="three seeds"),
        pytest.param(range(3, 10), id="seven more", marks=pytest.mark.nightly),
    ],
)
FORCE = 20.0  # N
PUSHED = 0.6  # s, when the force begins
LEAST_SINGULAR_VALUE = 0.1
FALSE_ALARMS = 0.1  # per hour
QUIET = 600.0  # s; wrists of the UR10 turn back slowly, with their greatest errors, once in minutes


@pytest.fixture(scope="module", params=CHAINS)
def bench(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Bench:
    return Bench(request.param, tmp_path_factory.mktemp(request.param))


class Bench:
    """A robot, the solver that knows it, and what was learned from ten minutes without contact."""

    def __init__(self, name: str, directory: Path) -> None:
        self.name = name
        self.arm = ContactArm(name)
        self.solver = Solver(RIGID_BODY, model=str(write_model(name, directory / "model.yaml")))
        self.kinematics = Solver(KDL, urdf_of(name), *CHAINS[name])
        quiet = self.arm.carry_out(random_motion(self.arm, 1000, QUIET), QUIET, 1000)
        torques, valid = self.estimate(quiet)
        assert valid[51:].all()
        self.thresholds: ContactThresholds = contact_thresholds(
            torques[valid], PERIOD, FALSE_ALARMS, self.solver.joint_names
        )

    def estimate(self, recorded: Recorded, kind: type = MomentumObserver) -> tuple[Floats, Floats]:
        estimator = kind(self.solver, EstimatorOptions(np.full(len(self.arm.home), GAIN)))
        return estimator.run(time_of(recorded), recorded.q, recorded.effort)

    def alarms(self, recorded: Recorded) -> Floats:
        """Whether there is a contact, (N,)."""
        detector = ContactDetector(self.thresholds.torques, self.solver.joint_names)
        return detector.run(time_of(recorded), self.estimate(recorded)[0])

    def forces(self, recorded: Recorded) -> Floats:
        """What pushes the tip: (N, 3) N."""
        tip = TipWrench(self.kinematics, self.thresholds.noise)
        wrenches, _ = tip.run(recorded.q, self.estimate(recorded)[0])
        return -wrenches[:, :3]

    def posture(self, seed: int) -> Floats:
        """A random one, away from singularities."""
        random = np.random.default_rng((seed, 3))
        while True:
            q = self.arm.home + self.arm.range * random.uniform(-0.7, 0.7, len(self.arm.home))
            if least_singular_value(self.arm, q) >= LEAST_SINGULAR_VALUE:
                return q

    @cache  # noqa: B019, which lives as long as the module's tests
    def pushed(self, seed: int, moving: bool) -> Recorded:
        """20 N in a random direction, from PUSHED on, at rest or while the arm goes to and fro."""
        direction = np.random.default_rng((seed, 9)).standard_normal(3)
        force = FORCE * direction / np.linalg.norm(direction)
        start, end = self.posture(seed), self.posture(seed + 100)
        there_and_back = swing(self.arm, start, start + 0.3 * (end - start) * moving)
        return self.arm.record(
            there_and_back, 1.6 if moving else 0.8, seed, force=lambda t: force * (t >= PUSHED)
        )


def time_of(recorded: Recorded) -> Floats:
    return PERIOD * np.arange(len(recorded.q))


def least_singular_value(arm: ContactArm, q: Floats) -> float:
    return float(np.linalg.svd(arm.place(q)[1], compute_uv=False)[-1])


@SEEDS
@pytest.mark.parametrize("moving", [False, True], ids=["at rest", "moving"])
def test_a_step_of_the_force_is_found_within_ten_percent_after_50_ms(
    bench: Bench, moving: bool, seeds: range
) -> None:
    begin = round(PUSHED / PERIOD)
    errors, singular_values = [], []
    for seed in seeds:
        recorded = bench.pushed(seed, moving)
        window = slice(begin + 50, begin + 100)
        error = (bench.forces(recorded)[window] - recorded.force[window]).mean(axis=0)
        errors.append(np.linalg.norm(error) / FORCE)
        singular_values.append(least_singular_value(bench.arm, recorded.q[begin + 50]))
    print(
        f"{bench.name} {moving=}: worst {max(errors):.3f}, mean {np.mean(errors):.3f}, least "
        f"singular value {min(singular_values):.2f} to {max(singular_values):.2f}"
    )
    assert max(errors) < 0.1
    assert min(singular_values) >= LEAST_SINGULAR_VALUE


@SEEDS
@pytest.mark.parametrize("place", ["tip", "elbow"])
def test_a_ball_of_1_joule_is_noticed_within_30_ms(bench: Bench, place: str, seeds: range) -> None:
    link = bench.arm.tip if place == "tip" else ELBOW[bench.name]
    delays = []
    for seed in seeds:
        posture = bench.posture(seed)
        J = bench.arm.place(posture, link)[1][:3]
        random = np.random.default_rng((seed, 11))
        while True:  # a direction in which the arm can feel a force: 0.3 m from some axis
            direction = random.standard_normal(3)
            direction /= np.linalg.norm(direction)
            if np.abs(J.T @ direction).max() >= 0.3:
                break
        rest = swing(bench.arm, posture, posture)
        recorded = bench.arm.record(rest, 0.35, seed, ball=Ball(link, direction, time=0.2))
        contact = recorded.force.any(axis=1)
        touched = int(np.argmax(contact))
        alarms = bench.alarms(recorded)
        assert contact.any()
        assert touched > 150
        assert alarms.any(), f"seed {seed}: not noticed"
        delays.append((int(np.argmax(alarms)) - touched) * PERIOD)
    print(
        f"{bench.name} {place}: noticed after {min(delays) * 1e3:.0f} to {max(delays) * 1e3:.0f} ms"
    )
    assert min(delays) >= 0
    assert max(delays) <= 0.03


@SEEDS
def test_no_false_alarm_in_minutes_of_random_motion(bench: Bench, seeds: range) -> None:
    greatest = np.zeros(len(bench.arm.home))
    for seed in seeds:
        recorded = bench.arm.carry_out(random_motion(bench.arm, seed, 60.0), 60.0, seed)
        assert not bench.alarms(recorded).any(), f"seed {seed}"
        greatest = np.maximum(greatest, np.abs(bench.estimate(recorded)[0]).max(axis=0))
    with np.printoptions(precision=2, suppress=True):
        print(f"{bench.name}: thresholds {bench.thresholds.torques}, greatest {greatest}")


@SEEDS
def test_forces_in_motion_are_exact_once_the_filters_have_settled(
    bench: Bench, seeds: range
) -> None:
    steady = np.r_[300:600, 800:1600]  # not while they follow the step
    runs = [bench.pushed(seed, True) for seed in seeds]
    errors = [bench.forces(run)[steady] - run.force[steady] for run in runs]
    rmse = np.sqrt((np.array(errors) ** 2).sum(axis=2).mean())
    print(f"{bench.name}: RMSE {rmse:.3f} N")
    assert rmse < {"ur10": 0.6, "panda": 0.25}[bench.name]


def test_the_jacobian_is_that_of_mujoco(bench: Bench) -> None:
    """So that the plant's pushes and the estimates speak of the same point."""
    q = bench.posture(0)
    force = np.array([1.0, 2.0, 3.0])
    torques = bench.arm.place(q)[1][:3].T @ force
    noise = np.full(len(q), 1e-6)
    wrenches, _ = TipWrench(bench.kinematics, noise).run(q[None], torques[None])
    assert np.allclose(wrenches[0], [*force, 0, 0, 0], atol=1e-6)

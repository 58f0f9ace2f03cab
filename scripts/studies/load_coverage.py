# SPDX-License-Identifier: Apache-2.0
"""Whether intervals of loads and drive gains hold the truth: a simulated arm that nobody knows.

    rows = trial(identified("ur10_real"), seed=0, directory=directory)

The true arm is an identified one whose links, rotors and friction are scaled at random. Friction remembers (Dahl),
joints vibrate at 20 to 80 Hz, which encoders see and efforts don't, and sensors are noisy. It is recorded without a
load and with one. All else is found from the description, the two recordings and, for gains, the load.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from payload_truth import model_of, random_load, solver_of

from inverse_dynamics import Solver, _core
from inverse_dynamics.evaluation.evaluation import evaluate_run, open_run
from inverse_dynamics.identification.blocks import blocks_of, moving
from inverse_dynamics.identification.drive_gains import identify_drive_gains
from inverse_dynamics.identification.identify import BLOCKS
from inverse_dynamics.payload.payload import empty_run, fit_payload, samples_of
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import RIGID_BODY

if TYPE_CHECKING:
    from pathlib import Path

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.robots.robots import Robot

RATE = 200.0  # Hz
EMPTY, LOADED = 40.0, 20.0  # s
STRENGTH = 1000.0  # of the prior
LAWS = ("load", "memory")  # what models are identified with
MASSES = (2.0, 6.0)  # kg
VIBRATION = 1.0  # rad/s^2, RMS
ENCODER = np.array([2e-6, 2e-4])  # rad, rad/s: standard deviations
EFFORT = 0.5  # standard deviation, by the real arm's noise
GAINS = (8.0, 14.0)  # N m/A
_HARMONICS = np.array([0.1, 0.2, 0.3, 0.4])  # Hz
_GREATEST = 0.4  # rad, of a harmonic


@dataclass(frozen=True)
class Found:
    """An estimate of one number."""

    quantity: str
    error: float
    half_width: float

    @property
    def holds(self) -> bool:
        """Whether the 95 % interval holds the truth."""
        return abs(self.error) <= self.half_width


def hidden_arm(found: Identification, directory: Path, random: np.random.Generator) -> Solver:
    """Links, rotors and friction differ from those found, and all friction remembers."""

    def scaled(values: Any, by: float) -> Any:
        return values * np.exp(by * random.normal(size=np.shape(values)))

    links = found.model.parameters * np.exp(0.1 * random.normal(size=(len(found.links), 1)))
    friction = []
    for law in found.model.friction:
        of_joint = {key: float(scaled(law.get(key, 0.0), 0.2)) for key in ("fv", "fc", "fl")}
        of_joint["width"] = float(random.uniform(0.01, 0.05))
        of_joint["fm"] = float(of_joint["fc"] * random.uniform(0.2, 0.5))
        of_joint["distance"] = float(random.uniform(0.01, 0.1))
        friction.append({**law, **of_joint})
    model = replace(
        found.model,
        parameters=links,
        rotor_inertia=scaled(found.model.rotor_inertia, 0.2),
        friction=tuple(friction),
    )
    return solver_of(found, model, directory / "hidden.yaml")


def record(
    arm: Solver, seconds: float, noise: Floats, random: np.random.Generator
) -> dict[str, Floats]:
    """What the arm measures as it moves along a random sum of harmonics, with vibration and noise."""
    n = len(noise)
    time = np.arange(0.0, seconds, 1 / RATE)
    w = 2 * np.pi * _HARMONICS * random.uniform(0.8, 1.3, (n, len(_HARMONICS)))
    size = random.uniform(0.2, 1.0, w.shape) * _GREATEST
    q, qd, qdd = _waves(time, w, size, random)
    q = q + np.array([0.0, -1.2, 1.0, -1.2, 1.0, 0.5])[:n]
    state = arm.friction_state()
    effort = arm.torques(q, qd, qdd) + state.along(q, qd) + noise * random.normal(size=q.shape)
    w = 2 * np.pi * random.uniform(20, 80, (n, 20))
    shaken = _waves(time, w, VIBRATION * np.sqrt(2 / w.shape[1]) / w**2, random)
    encoders = (
        x + dx + deviation * random.normal(size=q.shape)
        for x, dx, deviation in zip((q, qd), shaken, ENCODER, strict=False)
    )
    return {"time": time, **dict(zip(("q", "qd"), encoders, strict=True)), "effort": effort}


def trial(found: Identification, seed: int, directory: Path) -> dict[str, list[Found]]:
    """By the law of the model, the body that is found; by "known load", the gains that are."""
    random = np.random.default_rng((seed, 52))
    arm = hidden_arm(found, directory, random)
    noise = EFFORT * found.noise
    load = random_load(float(random.uniform(*MASSES)), random)
    alone = record(arm, EMPTY, noise, random)
    arm.set_payload("load", **load)
    loaded = record(arm, LOADED, noise, random)
    robot = replace(found.robot, plugin=RIGID_BODY, model=None, effort="torque", friction=False)
    fitter = _fitter(robot)
    blocks = moving(blocks_of(_evaluated(alone, robot), BLOCKS))
    results = {}
    for law in LAWS:
        file = directory / f"{law}.yaml"
        model = model_of(found, fitter, blocks, law, STRENGTH, file)
        results[law] = _payload(
            replace(robot, model=file, friction=True), *model, alone, loaded, load
        )
    gains = random.uniform(*GAINS, len(noise))
    results["known load"] = _gains(robot, alone, loaded, load, gains)
    return results


def _payload(
    robot: Robot,
    solver: Solver,
    uncertainty: _core.ArmUncertainty,
    alone: dict[str, Floats],
    loaded: dict[str, Floats],
    load: dict[str, Any],
) -> list[Found]:
    """As `ids payload --empty` does."""
    without = _evaluated(alone, robot)
    empty = empty_run(samples_of(without), solver)
    samples = samples_of(_evaluated(loaded, replace(robot, cutoff=without.accelerations.cutoff)))
    estimate = fit_payload(samples, solver, empty, uncertainty).estimate
    errors = estimate.center_of_mass - load["center_of_mass"]
    return [
        Found("mass", estimate.mass - load["mass"], estimate.mass_half_width),
        *map(partial(Found, "center"), errors, estimate.center_of_mass_half_width),
    ]


def _gains(
    robot: Robot,
    alone: dict[str, Floats],
    loaded: dict[str, Floats],
    load: dict[str, Any],
    gains: Floats,
) -> list[Found]:
    """By `ids identify --known-payload`; relative; those that the data determine."""
    currents = [{**table, "effort": table["effort"] / gains} for table in (alone, loaded)]
    known = {"payload.mass": load["mass"], "payload.center_of_mass": list(load["center_of_mass"])}
    known["payload.inertia"] = load["inertia"][np.triu_indices(3)].tolist()
    stated = replace(robot, effort="current", drive_gains=tuple(np.ones(len(gains))))
    found = identify_drive_gains(
        [currents[0]], [(currents[1], known)], stated, _fitter(robot), effort_is="current"
    )
    return [
        Found("gain", gain.value / true - 1, gain.half_width / true)
        for gain, true in zip(found, gains, strict=True)
        if gain.half_width is not None
    ]


def _fitter(robot: Robot) -> _core.ArmFitter:
    assert robot.urdf is not None
    return _core.ArmFitter.from_urdf(
        read_description(robot.urdf), root=robot.root, tip=robot.tip, gravity=robot.gravity
    )


def _waves(
    time: Floats, w: Floats, size: Floats, random: np.random.Generator
) -> tuple[Floats, Floats, Floats]:
    """(N, n) sums of sines, and their derivatives."""
    phase = w * time[:, None, None] + random.uniform(0, 2 * np.pi, w.shape)
    return (
        (size * np.sin(phase)).sum(2),
        (size * w * np.cos(phase)).sum(2),
        -(size * w**2 * np.sin(phase)).sum(2),
    )


def _evaluated(table: dict[str, Floats], robot: Robot) -> Evaluation:
    """Without causes of a mismatch, which take most of the time."""
    return evaluate_run(open_run(table, robot, progress=no_progress))

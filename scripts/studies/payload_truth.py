# SPDX-License-Identifier: Apache-2.0
"""How good estimates of payloads are: simulated loads on the real residuals of a real arm.

    arm = Arm.of(identify([recordings / "panda_exciting_trajectory"], "panda_real"), directory)
    figures = figures_of(trials(arm, mass=1.0))

The load is estimated from windows of the recording, which overlap. The arm's model is fitted as by `ids identify` to
what is outside of the window, and its residuals, of samples that it hasn't seen, stay in the torques: either those of
the window itself, or those of another window. The load's own torques, friction that grows with load included, are put
on top.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics import Solver, _core, evaluate
from inverse_dynamics.identification.blocks import FEWEST, block_of, data_of
from inverse_dynamics.identification.cross_validation import choose
from inverse_dynamics.identification.files import model_file_text
from inverse_dynamics.identification.knowledge import knowledge
from inverse_dynamics.identification.result import urdf_of
from inverse_dynamics.identification.uncertainty import factor_of
from inverse_dynamics.payload.payload import Samples, fit_payload, samples_of, with_load
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import RIGID_BODY

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.identification.blocks import Block
    from inverse_dynamics.identification.result import Identification

SECONDS = 4.0
STEP = 2.0  # s between the beginnings of windows
EDGE = 0.3  # s at either end of the recording, where accelerations are poor


@dataclass(frozen=True)
class Figures:
    """Of many simulated loads."""

    mass: float  # median of the error, relative
    center: float  # m, median of the distance
    coverage: float  # of the 95 % intervals of mass and center
    ratio_of_mass: float  # median half width by median error
    ratio_of_center: float


@dataclass(frozen=True)
class Arm:
    """Windows of a recording, and for each a solver that was identified on what is outside of it."""

    windows: tuple[Samples, ...]
    solvers: tuple[Solver, ...]
    uncertainties: tuple[_core.ArmUncertainty | None, ...]  # of the solvers' models; None: exact
    residuals: tuple[Floats, ...]  # (N, n) N m, each window's by its solver

    @classmethod
    def of(
        cls,
        found: Identification,
        directory: Path,
        *,
        seconds: float = SECONDS,
        nested: bool = False,
    ) -> Arm:
        """found: of the recording, as by `ids identify`.

        nested: law, prior strength and delay are chosen without the window, not on the whole recording.
        """
        evaluation = evaluate(found.recordings[0], found.robot)
        samples = samples_of(evaluation)
        windows: list[Samples] = []
        models: list[tuple[Solver, _core.ArmUncertainty]] = []
        for begin in _begins(evaluation.time, seconds):
            first, after = np.searchsorted(evaluation.time, [begin, begin + seconds]).tolist()
            edges = ((0, first), (after, len(evaluation.time)))
            rest = [block_of(evaluation, slice(a, b)) for a, b in edges if b - a >= FEWEST]
            within = (samples.time >= begin) & (samples.time < begin + seconds)
            models.append(_model(found, rest, directory, len(models), nested=nested))
            windows.append(part(samples, within))
        solvers, uncertainties = zip(*models, strict=True)
        residuals = [w.residual(s) for w, s in zip(windows, solvers, strict=True)]
        return cls(tuple(windows), solvers, uncertainties, tuple(residuals))

    def taken_for_exact(self) -> Arm:
        """The same, but estimates don't know what the models may be wrong by."""
        return replace(self, uncertainties=(None,) * len(self.windows))

    def elsewhere(self, k: int, random: np.random.Generator) -> int:
        """Another window that has no sample of window k, if there is one."""
        of = self.windows[k].time
        apart = [i for i, w in enumerate(self.windows) if w.time[0] > of[-1] or w.time[-1] < of[0]]
        return int(random.choice(apart)) if apart else k


def _begins(time: Floats, seconds: float) -> Floats:
    """Of windows that overlap, about every STEP."""
    first, last = time[0] + EDGE, time[-1] - EDGE - seconds
    return np.linspace(first, last, 1 + round((last - first) / STEP))


def _model(
    found: Identification, rest: Sequence[Block], directory: Path, k: int, *, nested: bool
) -> tuple[Solver, _core.ArmUncertainty]:
    """Of some blocks."""
    robot = found.robot
    fitter = _core.ArmFitter.from_urdf(
        read_description(urdf_of(found)), root=robot.root, tip=robot.tip, gravity=robot.gravity
    )
    law, strength, delay = found.law, found.prior_strength, found.delay
    if nested:
        chosen = choose(fitter, rest)
        law, strength, delay = chosen.law, chosen.prior_strength, chosen.delay
    later = [block.later(delay) for block in rest]
    return model_of(found, fitter, later, law, strength, directory / f"{robot.name}_{k}.yaml")


def model_of(
    found: Identification,
    fitter: _core.ArmFitter,
    blocks: Sequence[Block],
    law: str,
    strength: float,
    file: Path,
) -> tuple[Solver, _core.ArmUncertainty]:
    """That of `ids identify` after its choices, written to the file. found: of the same arm."""
    options = _core.ArmFitOptions(law, prior_strength=strength)
    fit = fitter.fit(data_of(fitter, blocks), options)
    known = knowledge(fitter, fit, blocks, options)
    uncertainty = _core.ArmUncertainty(fit.friction, factor_of(fitter, fit, blocks, known, law=law))
    return solver_of(found, fit, file), uncertainty


def solver_of(found: Identification, model: Any, file: Path) -> Solver:
    """Of the arm of an identification with the links, rotors and friction of a model, written to the file."""
    changed = replace(
        found.model,
        parameters=model.parameters,
        rotor_inertia=model.rotor_inertia,
        friction=tuple(model.friction),
    )
    file.write_text(model_file_text(replace(found, model=changed), file.stem))
    return Solver(RIGID_BODY, model=str(file))


def part(samples: Samples, which: slice | Mask) -> Samples:
    """Some of the samples."""
    return Samples(*(values[which] for values in vars(samples).values()))


def trial(arm: Arm, mass: float, random: np.random.Generator, elsewhere: bool) -> Floats:
    """(2, 4): errors of mass [kg] and center of mass [m], and the half widths of their intervals."""
    k = int(random.integers(len(arm.windows)))
    samples, solver = arm.windows[k], arm.solvers[k]
    if elsewhere:
        residual = arm.residuals[arm.elsewhere(k, random)]
        samples = part(samples, slice(len(residual)))
        computed = samples.measured - samples.residual(solver)
        samples = replace(samples, measured=computed + residual[: len(computed)])
    load = random_load(mass, random)
    found = fit_payload(with_load(samples, solver, load), solver, arm=arm.uncertainties[k]).estimate
    return np.array(
        [
            [found.mass - mass, *(found.center_of_mass - load["center_of_mass"])],
            [found.mass_half_width, *found.center_of_mass_half_width],
        ]
    )


def random_load(mass: float, random: np.random.Generator) -> dict[str, Any]:
    """A turned box up to 15 cm in front of the flange."""
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    squares = random.uniform(0.02, 0.06, 3) ** 2
    return {
        "mass": mass,
        "center_of_mass": [*random.uniform(-0.06, 0.06, 2), random.uniform(0.0, 0.15)],
        "inertia": mass * turn @ np.diag(squares.sum() - squares) @ turn.T,
    }


def trials(arm: Arm, mass: float, count: int, seed: int = 1) -> Figures:
    """Every other trial has the residuals of its own window."""
    random = np.random.default_rng(seed)
    found = np.array([trial(arm, mass, random, elsewhere=bool(k % 2)) for k in range(count)])
    errors, widths = np.abs(found[:, 0]), found[:, 1]
    ratios = np.median(widths, axis=0) / np.median(errors, axis=0)
    return Figures(
        mass=float(np.median(errors[:, 0]) / mass),
        center=float(np.median(np.linalg.norm(errors[:, 1:], axis=1))),
        coverage=float(np.mean(errors <= widths)),
        ratio_of_mass=float(ratios[0]),
        ratio_of_center=float(np.median(ratios[1:])),
    )

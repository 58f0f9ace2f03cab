# SPDX-License-Identifier: Apache-2.0
"""Models of other people's robots, tested on another day, motion or robot than they are fitted to.

The first argument is a directory of clones of the repositories that public_arms names; those missing are named.

All is what `ids identify` and `ids evaluate` do by default.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from public_arms import ARMS, missing_clones
from studies import MOST_SAMPLES, recording_of, show, solved, table

from inverse_dynamics import _core, evaluate, identify, load_robot
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.robots.descriptions import read_description

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics._core import ArmFit, FastModel
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.robots.robots import Robot

STILL = 0.01  # of each joint's greatest velocity, which a moving arm's joints aren't all below
PRIOR_STRENGTH = 100.0  # of consistent least squares
TERMS = {"step": 4, "load": 5, "stribeck": 6}  # of friction and rotor inertia
HEADINGS = (
    "fitted to",
    "tested on",
    "least squares",
    "law found",
    "identified",
    *("moving: least squares", "identified", "test itself"),
    *("in band", "worst", "width"),
)
SQUARES = ("ordinary", "weighted", "consistent")

ONE, TWO, POINTS = "12 Feb", "19 Feb", "17 Jan, point to point"
FITS = {  # by arm of public_arms: labels of recordings fitted to, tested on
    "UR10e": (((ONE,), (TWO, POINTS, "5 Feb")), ((ONE, TWO), (POINTS, "6 Feb", "10 Feb"))),
    "KUKA KR300": ((("A", "B"), ("C",)),),
    "Panda": ((("one",), ("another",)), (("another",), ("one",))),
}


def arm_of(name: str, clones: Path, scratch: Path) -> tuple[Robot, Mapping[str, Path]]:
    """One of FITS, and its recordings by label."""
    if name != "Panda":
        arm = ARMS[name].read(clones, scratch)
        return load_robot(arm.robot), arm.recordings
    (another,) = ARMS["Panda, another"].read(clones, scratch).recordings.values()
    return load_robot("panda_real"), {"one": recording_of("panda_real"), "another": another}


@dataclass(frozen=True)
class Samples:
    """Valid samples of an evaluation. (N, n)"""

    q: Floats
    qd: Floats
    qdd: Floats
    tau: Floats

    @classmethod
    def of(cls, e: Evaluation, most: int | None = None) -> Samples:
        """All, or at most so many at equal distances."""
        kept = np.flatnonzero(e.samples.kept)
        rows = kept[:: 1 if most is None else 1 + len(kept) // most]
        return cls(e.log.q[rows], e.log.qd[rows], e.qdd[rows], e.measured[rows])

    @property
    def moving(self) -> Samples:
        """Those at which a joint moves."""
        return Samples(*(values[self.moves] for values in vars(self).values()))

    @property
    def moves(self) -> Mask:
        """(N,) samples at which a joint moves."""
        speed = np.abs(self.qd)
        return np.asarray((speed >= STILL * speed.max(axis=0)).any(axis=1))


def least_squares(
    robot: Robot, train: Sequence[Samples], test: Samples, law: str
) -> dict[str, Floats]:
    """Errors (N, n) by name of SQUARES. The steps of friction are as wide as those of the consistent fit."""
    assert robot.urdf is not None
    description = read_description(robot.urdf)
    root, tip, gravity = robot.root, robot.tip, robot.gravity
    model = _core.FastModel.from_urdf(description, root=root, tip=tip, gravity=gravity)
    fitter = _core.ArmFitter.from_urdf(description, root=root, tip=tip, gravity=gravity)
    data = fitter.data([(s.q, s.qd, s.qdd, s.tau) for s in train])
    fit = fitter.fit(data, _core.ArmFitOptions(law, prior_strength=PRIOR_STRENGTH))
    Y = np.concatenate([_columns(model, fit, law, s) for s in train])
    tau = np.concatenate([s.tau for s in train])
    ordinary = solved(Y, tau, np.ones(tau.shape[1]))
    weighted = solved(Y, tau, np.sqrt(((tau - Y @ ordinary) ** 2).mean(axis=0)))
    computed = (
        *(_columns(model, fit, law, test) @ x for x in (ordinary, weighted)),
        fitter.torques(fit, test.q, test.qd, test.qdd),
    )
    return {name: test.tau - c for name, c in zip(SQUARES, computed, strict=True)}


def _columns(model: FastModel, fit: ArmFit, law: str, s: Samples) -> Floats:
    """(N, n, m) of links, rotor inertia, and friction."""
    links = model.regressor(s.q, s.qd, s.qdd).reshape(*s.q.shape, -1)
    still = np.zeros_like(s.q)
    load = np.abs(model.regressor(s.q, still, still).reshape(links.shape) @ fit.parameters.ravel())
    width, vs = (np.array([f.get(key, 1.0) for f in fit.friction]) for key in ("width", "vs"))
    step = np.tanh(s.qd / width)
    own = [s.qdd, s.qd, np.ones_like(s.qd), step, load * step, np.exp(-((s.qd / vs) ** 2)) * step]
    return np.concatenate(
        [links, *(term[:, :, None] * np.eye(s.q.shape[1]) for term in own[: TERMS[law]])], axis=2
    )


def rows_of(name: str, clones: Path, scratch: Path) -> list[tuple[str, ...]]:
    """Of the table."""
    rows = []
    robot, recordings = arm_of(name, clones, scratch)
    for fitted, tested in FITS[name]:
        found = identify([recordings[x] for x in fitted], robot)
        law = "stribeck" if found.law == "memory" else found.law
        files = write_identification(found, scratch / f"{name}_{'_'.join(fitted)}.yaml")
        train = [Samples.of(evaluate(recordings[x], robot), MOST_SAMPLES) for x in fitted]
        for label in tested:
            e = evaluate(recordings[label], files.robot)
            test = Samples.of(e)
            plain, same = (
                least_squares(found.robot, train, test, terms) for terms in ("step", law)
            )
            own = least_squares(found.robot, [test.moving], test, law)["consistent"]
            assert e.band is not None
            kept = e.samples.kept
            errors = (e.measured - e.computed)[kept]
            cells = _cells((plain, same), errors, own, test.moves, e.band[kept])
            title = f"{name}, {' and '.join(fitted)}" if label == tested[0] else ""
            rows.append((title, label, *cells))
    return rows


def _cells(
    squares: Sequence[Mapping[str, Floats]],
    errors: Floats,
    own: Floats,
    moves: Mask,
    half: Floats,
) -> list[str]:
    """Of a row. squares: errors of least squares with both laws; own: of a fit to the test itself."""
    means = [_mean(np.stack(list(of.values()))) for of in squares]
    least = min(float(_mean(e[moves])) for of in squares for e in of.values())
    inside = (np.abs(errors) <= half).mean(axis=0)
    width = half.mean() / np.quantile(np.abs(errors), 0.95, axis=0).mean()
    return [
        *(" ".join(map(_text, of.tolist())) for of in means),
        _text(float(_mean(errors))),
        *map(_text, (least, float(_mean(errors[moves])), float(_mean(own[moves])))),
        *(f"{100 * share:.0f} %" for share in (inside.mean(), inside.min())),
        f"{width:.2f}",
    ]


def _text(error: float) -> str:
    """Three digits."""
    return f"{error:#.3g}".rstrip(".")


def _mean(errors: Floats) -> Floats:
    """Root mean square of errors (..., N, n), mean over the joints."""
    return np.asarray(np.sqrt((errors**2).mean(axis=-2)).mean(axis=-1))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    clones = Path(sys.argv[1])
    if missing := missing_clones(clones, ("UR10e", "KUKA KR300", "Panda, another")):
        sys.exit("\n".join(missing))
    with TemporaryDirectory() as directory:
        rows = [row for name in FITS for row in rows_of(name, clones, Path(directory))]
    show(table(HEADINGS, rows), "identification_results.md", "transfer_study")

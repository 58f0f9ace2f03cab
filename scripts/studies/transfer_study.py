# SPDX-License-Identifier: Apache-2.0
"""Models of other people's robots, tested on another day, motion or robot than they are fitted to.

The first argument is a directory of clones of these repositories; what is missing is named, and then nothing is
replaced:

    https://github.com/shamilmamedov/dynamic_calibration
    https://github.com/JonasWeigand/Robot_Identification
    https://github.com/marcocognetti/FrankaEmikaPandaDynModel

All is what `ids identify` and `ids evaluate` do by default.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from studies import recording_of, show, table

from inverse_dynamics import _core, evaluate, identify, load_robot
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import robot_of_description

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from inverse_dynamics._core import ArmFit, FastModel
    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.robots.robots import Robot

MOST_SAMPLES = 12_000  # that least squares take
RANK = 1e-7  # of the greatest singular value
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

# of the first three joints of a KUKA KR300; kg about, as published
KR300_GEARS = (1798 / 7, 1872 / 7, 757 / 3)
KR300_TABLE = """\
convention: modified
degrees: true
joints:
  - {a: 0, alpha: 0, d: -0.675, mass: 395}
  - {a: 0.35, alpha: 90, d: -0.189, mass: 339}
  - {a: 1.15, alpha: 0, d: 0.189, mass: 192}
"""


@dataclass(frozen=True)
class Arm:
    """A robot, its recordings by label, and how they are read."""

    name: str
    robot: Robot
    recordings: Mapping[str, Path]
    fits: Sequence[tuple[Sequence[str], Sequence[str]]]  # labels: fitted to, tested on
    options: Mapping[str, Any] = field(default_factory=dict)


def ur10e(clone: Path, _: Path) -> Arm:
    """Motor currents at 100 Hz, of several days; gains of the controller: its target torques by currents."""
    data = clone / "dataset_ur10e"
    recordings = {
        "12 Feb": data / "identification_data/ur-20_02_12-40sec_12harm.csv",
        "19 Feb": data / "identification_data/ur-20_02_19_14harm50sec.csv",
        "17 Jan, point to point": data / "validation_data/ur-20_01_17-ptp_10_points.csv",
        "5 Feb": data / "identification_data/ur-20_02_05-20sec_12harm.csv",
        "6 Feb": data / "identification_data/ur-20_02_06-20sec_10harm.csv",
        "10 Feb": data / "identification_data/ur-20_02_10-20sec_7harm.csv",
    }
    robot = replace(
        robot_of_description(clone / "URe/urdf/ur10e.urdf"),
        tip="ee_link",
        effort="current",
        drive_gains=(11.976, 11.976, 9.839, 10.762, 10.762, 10.762),
    )
    one, two, *others = recordings
    return Arm(
        name="UR10e",
        robot=robot,
        recordings=recordings,
        fits=(((one,), (two, *others[:2])), ((one, two), (others[0], *others[2:]))),
        options={"columns": "time=1, q=2-7, qd=8-13, current=14-19"},
    )


def kr300(clone: Path, scratch: Path) -> Arm:
    """Torques of the first three motors at 250 Hz; z of the published parameters points down."""
    description = scratch / "kr300.yaml"
    description.write_text(KR300_TABLE)
    recorded = clone / "data/recorded_trajectories"
    return Arm(
        name="KUKA KR300",
        robot=replace(
            robot_of_description(description),
            tip="link3",
            gravity=(0.0, 0.0, 9.81),
            effort="torque",
        ),
        recordings={x: recorded / f"2020-10-21 10s FF {x} 08ms/data.mat" for x in "ABC"},
        fits=((("A", "B"), ("C",)),),
        options={
            "columns": "time=rec.time_cont, q=rec.act_pos_se_deg[*], "
            "qd=rec.act_vel_se_deg_per_s[*], effort=rec.act_torque_abs_nm[*]",
            "scale": ["q=deg", "qd=deg", f"effort={','.join(f'{k:.9g}' for k in KR300_GEARS)}"],
        },
    )


def pandas(clone: Path, scratch: Path) -> Arm:
    """Two robots. Of the other one, numbers a line."""
    log = clone / "matlab/data/Exciting_Traj/Trajectory_1/rbt_log"
    time, *states = (
        np.loadtxt(log / f"exciting_traj_{name}.txt")
        for name in ("time", "positions", "velocity", "torques")
    )
    q, qd, tau = (numbers.reshape(-1, 7) for numbers in states)
    other = scratch / "panda.npz"
    np.savez(other, time=time, q=q, qd=qd, tau=tau)
    here, there = "one", "another"
    return Arm(
        name="Panda",
        robot=load_robot("panda_real"),
        recordings={here: recording_of("panda_real"), there: other},
        fits=(((here,), (there,)), ((there,), (here,))),
    )


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
    ordinary = _solved(Y, tau, np.ones(tau.shape[1]))
    weighted = _solved(Y, tau, np.sqrt(((tau - Y @ ordinary) ** 2).mean(axis=0)))
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


def _solved(Y: Floats, tau: Floats, noise: Floats) -> Floats:
    """(m,)"""
    rows = (Y / noise[:, None]).reshape(-1, Y.shape[2])
    scale = np.linalg.norm(rows, axis=0) + 1e-9
    found: Floats = np.linalg.lstsq(rows / scale, (tau / noise).ravel(), rcond=RANK)[0] / scale
    return found


def rows_of(arm: Arm, scratch: Path) -> list[tuple[str, ...]]:
    """Of the table."""
    rows = []
    for fitted, tested in arm.fits:
        found = identify([arm.recordings[x] for x in fitted], arm.robot, **arm.options)
        files = write_identification(found, scratch / f"{arm.name}_{'_'.join(fitted)}.yaml")
        train = [
            Samples.of(evaluate(arm.recordings[x], arm.robot, **arm.options), MOST_SAMPLES)
            for x in fitted
        ]
        for label in tested:
            e = evaluate(arm.recordings[label], files.robot, **arm.options)
            test = Samples.of(e)
            plain, same = (
                least_squares(found.robot, train, test, law) for law in ("step", found.law)
            )
            own = least_squares(found.robot, [test.moving], test, found.law)["consistent"]
            assert e.band is not None
            kept = e.samples.kept
            errors = (e.measured - e.computed)[kept]
            cells = _cells((plain, same), errors, own, test.moves, e.band[kept])
            name = f"{arm.name}, {' and '.join(fitted)}" if label == tested[0] else ""
            rows.append((name, label, *cells))
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


ARMS = {  # by clone
    "dynamic_calibration": ur10e,
    "Robot_Identification": kr300,
    "FrankaEmikaPandaDynModel": pandas,
}


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    clones = Path(sys.argv[1])
    missing = [clone for clone in ARMS if not (clones / clone).is_dir()]
    rows: list[tuple[str, ...]] = []
    with TemporaryDirectory() as directory:
        for clone, arm_of in ARMS.items():
            if clone not in missing:
                rows += rows_of(arm_of(clones / clone, Path(directory)), Path(directory))
    if missing:
        print(table(HEADINGS, rows))
        sys.exit(f"{clones}: expected clones of {', '.join(missing)}, too; nothing was replaced")
    show(table(HEADINGS, rows), "identification_results.md", "transfer_study")

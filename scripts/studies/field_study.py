# SPDX-License-Identifier: Apache-2.0
"""Public recordings by the protocols of their owners: their errors, those of least squares, and of `ids identify`.

The first argument is a directory of clones of the repositories that public_arms names; what is missing is named,
left out, and then nothing is replaced. A second argument, a part of a robot's name, measures such robots alone.

Least squares are weighted, with Pinocchio's regressor, viscous and Coulomb friction, offset and rotor inertia, on the
samples, velocities and accelerations of `ids evaluate`.
"""

from __future__ import annotations

import subprocess
import sys
import time
from dataclasses import dataclass
from datetime import date
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from public_arms import ARMS, Arm, missing_clones
from scipy.io import loadmat
from scipy.signal import butter, filtfilt
from studies import MOST_SAMPLES, recording_of, show, solved, table

from inverse_dynamics import Solver, evaluate, identify
from inverse_dynamics.identification.files import write_identification
from inverse_dynamics.identification.result import IdentificationError
from inverse_dynamics.robots.descriptions import read_description

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.result import Identification

PINOCCHIO = "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio"
WIDTH = 0.02  # rad/s, of the step of Coulomb friction in least squares
SPEEDS = ("slow", "middle", "high")
SMOOTH = [f"trajectory {k}, smooth" for k in (1, 2, 3)]
HEADINGS = (
    *("robot", "fitted to", "tested on", "error", "owners"),
    *("least squares", "`ids identify`", "CPU time [s]"),
)


@dataclass(frozen=True)
class Part:
    """Of recordings, by their labels: seconds since each one's first sample."""

    recordings: Sequence[str]
    start: float | None = None
    end: float | None = None

    def __str__(self) -> str:
        labels = "; ".join(self.recordings)
        if self.start is self.end is None:
            return labels
        return (
            f"{labels}: {self.start or 0:.4g} s to {f'{self.end:.4g} s' if self.end else 'the end'}"
        )


@dataclass(frozen=True)
class Protocol:
    """What owners fit to and test on, and what they count. Without a test: held-out blocks of `ids identify`."""

    robot: str  # of ARMS or ROBOTS
    fitted: Part
    tested: Part | None
    unit: str
    error: Callable[
        [Floats, Floats], float
    ]  # of measured and predicted torques (N, n); mean over the tests
    owners: Callable[[Path], tuple[float, str]] | None = None  # of a clone: error, and of what
    filtered: Callable[[Floats], Floats] | None = (
        None  # torques of all samples; else the valid ones count
    )

    def of(self, test: Evaluation, predicted: Floats) -> float:
        """The error of predicted torques (N, n)."""
        torques = (test.measured, predicted)
        if self.filtered is not None:
            return self.error(*map(self.filtered, torques))
        return self.error(*(each[test.samples.kept] for each in torques))


def rms(measured: Floats, predicted: Floats) -> float:
    """Mean over the joints."""
    return float(np.sqrt(((measured - predicted) ** 2).mean(axis=0)).mean())


def pooled(measured: Floats, predicted: Floats) -> float:
    """RMS over all joints at once."""
    return float(np.sqrt(((measured - predicted) ** 2).mean()))


def absolute(measured: Floats, predicted: Floats) -> float:
    """Mean."""
    return float(np.abs(measured - predicted).mean())


def relative(measured: Floats, predicted: Floats) -> float:
    """Norm of each joint's errors by that of its torques [%], mean over the joints."""
    norms = np.linalg.norm(measured - predicted, axis=0) / np.linalg.norm(measured, axis=0)
    return float(100 * norms.mean())


def low_passed(order: int, cutoff: float, rows: slice, torques: Floats) -> Floats:
    """Forwards and backwards; cutoff by the Nyquist frequency."""
    b, a = butter(order, cutoff)
    return np.asarray(filtfilt(b, a, torques, axis=0))[rows]


def _stated(error: float, words: str) -> Callable[[Path], tuple[float, str]]:
    return lambda _: (error, words)


def _friction_models(file: str, clone: Path) -> tuple[float, str]:
    """The best of four friction laws, and the best of four networks: their predictions are columns."""
    with (clone / "Comparative data/Franka Robot" / file).open(encoding="utf-8") as stream:
        names = stream.readline().strip().split(",")
        columns = dict(zip(names, np.loadtxt(stream, delimiter=",").T, strict=True))
    torque = next(column for name, column in columns.items() if "tau" in name)
    with np.errstate(over="ignore"):  # one of the laws diverges
        errors = {name: pooled(torque, column) for name, column in columns.items()}
    law = min(("CV", "Dahl", "Stribeck", "LuGre"), key=errors.__getitem__)
    return errors[law], f"{law}; network {errors['NNFM']:.3f}"


def _sawyer(clone: Path) -> tuple[float, str]:
    """Of stored predictions."""
    data = clone / "examples/least_square_estimate"
    measured = loadmat(data / "filter_data/tau_filter.mat")["tau_filter"]
    predicted = loadmat(data / "identify_result/tau_iden.mat")["tau_iden"]
    return rms(measured, predicted), "as stored"


COBOT_TORQUES = partial(low_passed, 4, 0.024, slice(162, 3503))


def _cobot(clone: Path) -> tuple[float, str]:
    """Of stored predictions."""
    measured = np.loadtxt(clone / "python_identification/csv_data/tau1.csv", delimiter=",").T
    predicted = loadmat(clone / "matlab_identification/another/tau_pos.mat")["tau_pos"]
    return relative(COBOT_TORQUES(measured * [1, 1, -1, 1, 1, 1]), predicted), "least squares"


PROTOCOLS = (
    Protocol("ur10_real", Part(["exciting"]), None, "N m", rms),
    Protocol("panda_real", Part(["exciting"]), None, "N m", rms),
    Protocol("Panda, another", Part(["trajectory 1"]), None, "N m", rms),
    Protocol(
        "UR10e",
        Part(["10 Feb, 30 s"], 6.756, 37.388),
        Part(["17 Jan, point to point"], 7.45, 44.86),
        "%",
        relative,
    ),
    Protocol("UR10e", Part(["12 Feb"]), Part(["19 Feb"]), "N m", rms),
    Protocol("KUKA KR300", Part(["A", "B"]), Part(["C"]), "N m", rms),
    Protocol(
        "da Vinci master",
        Part(["one"]),
        Part(["two"], end=10),
        "%",
        relative,
        _stated(21.0, "convex fit"),
    ),
    *(
        Protocol(
            f"Franka joint {joint}",
            Part([other for other in SPEEDS if other != speed]),
            Part([speed]),
            "N m",
            rms,
            partial(_friction_models, f"case{case}_{speed}.csv"),
        )
        for joint, case in ((2, 3), (7, 4))
        for speed in SPEEDS
    ),
    Protocol(
        "Sawyer",
        Part(["excitation"]),
        Part(["excitation"]),
        "N m",
        rms,
        _sawyer,
        partial(low_passed, 5, 2 / 500, slice(None)),
    ),
    Protocol("Sawyer", Part(["excitation"]), None, "N m", rms),
    Protocol("KUKA LBR Med 7", Part(["excitation"]), None, "N m", rms),
    Protocol(
        "Rokae AR5",
        Part(["excitation"], end=48),
        Part(["excitation"], 48),
        "N m",
        pooled,
        _stated(0.627, "friction, masses, centers"),
    ),
    Protocol("UR5", Part(["movement 6"]), Part(["movement 8"]), "%", relative),
    Protocol(
        "cobot",
        Part(["trajectory 1"]),
        Part(["trajectory 1"]),
        "%",
        relative,
        _cobot,
        COBOT_TORQUES,
    ),
    Protocol(
        "cobot",
        Part(SMOOTH, end=18),
        Part(SMOOTH, 18),
        "N m",
        absolute,
        _stated(4.52, "network"),
    ),
)


class LeastSquares:
    """A fit to valid samples of evaluations, by Pinocchio."""

    def __init__(self, train: Sequence[Evaluation]) -> None:
        robot = train[0].robot
        assert robot.urdf is not None
        text = read_description(robot.urdf)
        self._solver = Solver(
            PINOCCHIO, urdf=text, root=robot.root, tip=robot.tip, gravity=robot.gravity
        )
        motors = robot.parameters.get("motors", np.eye(len(self._solver.joint_names)))
        self._motors = np.reshape(motors, (len(self._solver.joint_names), -1))
        rows = [np.flatnonzero(e.samples.kept) for e in train]
        rows = [kept[:: 1 + len(kept) // MOST_SAMPLES] for kept in rows]
        self._columns = np.concatenate([self._of(e, r) for e, r in zip(train, rows, strict=True)])
        self._times = np.concatenate([e.time[r] for e, r in zip(train, rows, strict=True)])
        self._torques = np.concatenate([e.measured[r] for e, r in zip(train, rows, strict=True)])

    def predicted(self, test: Evaluation) -> Floats:
        """(N, n)"""
        return self._of(test, np.arange(len(test.time))) @ self._fitted(slice(None))

    def of_blocks(self, edges: Sequence[float]) -> float:
        """RMS, mean over the joints, of blocks that begin at these times [s], each by a fit to the others."""
        everything = np.arange(len(self._times))
        predicted = [
            self._columns[block] @ self._fitted(np.setdiff1d(everything, block))
            for block in np.split(everything, np.searchsorted(self._times, edges))
        ]
        return rms(self._torques, np.concatenate(predicted))

    def _fitted(self, rows: Any) -> Floats:
        Y, tau = self._columns[rows], self._torques[rows]
        ordinary = solved(Y, tau, np.ones(tau.shape[1]))
        return solved(Y, tau, np.sqrt(((tau - Y @ ordinary) ** 2).mean(axis=0)))

    def _of(self, e: Evaluation, rows: Any) -> Floats:
        q, qd, qdd = e.log.q[rows], e.log.qd[rows], e.qdd[rows]
        M = self._motors  # positions of joints by those of motors
        links = M.T @ self._solver.regressor(q @ M.T, qd @ M.T, qdd @ M.T)
        own = (qdd, qd, np.tanh(qd / WIDTH), np.ones_like(qd))
        each = [term[:, :, None] * np.eye(q.shape[1]) for term in own]
        return np.concatenate([links, *each], axis=2)


def row_of(protocol: Protocol, clones: Path, scratch: Path) -> tuple[str, ...]:
    """Of the table; the least error is bold."""
    arm = _arm(protocol.robot, clones, scratch)

    def evaluated(part: Part, robot: Path | str) -> list[Evaluation]:
        return [
            evaluate(arm.recordings[x], robot, start=part.start, end=part.end)
            for x in part.recordings
        ]

    fitted, tested = protocol.fitted, protocol.tested
    train = evaluated(fitted, arm.robot)
    recordings = [arm.recordings[x] for x in fitted.recordings]
    begin = time.process_time()
    found = None
    try:
        found = identify(
            recordings, arm.robot, accept=arm.accept, start=fitted.start, end=fitted.end
        )
    except IdentificationError as refusal:
        print(refusal, file=sys.stderr)
    middle = time.process_time()
    squares = LeastSquares(train)
    ours = found.rmse("identified") if found else np.nan
    if tested:
        tests = evaluated(tested, arm.robot)
        least = float(np.mean([protocol.of(test, squares.predicted(test)) for test in tests]))
    else:
        assert found is not None
        least = squares.of_blocks([block.time[0] for block in found.blocks[1:]])
    seconds = f"{time.process_time() - middle:.1f}, {middle - begin:.1f}"
    if found and tested:
        model = write_identification(found, scratch / "model.yaml", overwrite=True).robot
        tests = evaluated(tested, model)
        ours = float(np.mean([protocol.of(test, test.computed) for test in tests]))
    theirs, words = _owners(protocol, found, clones)
    errors = (theirs, least, ours)
    cells = [f"**{_text(e)}**" if e == np.nanmin(errors) else _text(e) for e in errors]
    return (
        protocol.robot,
        str(fitted),
        str(tested or "held-out blocks"),
        f"{protocol.error.__name__} [{protocol.unit}]",
        f"{cells[0]}{words}",
        cells[1],
        cells[2] or "refused",
        seconds,
    )


def _arm(name: str, clones: Path, scratch: Path) -> Arm:
    if name in ARMS:
        return ARMS[name].read(clones, scratch)
    return Arm(name, {"exciting": recording_of(name)})


def _owners(protocol: Protocol, found: Identification | None, clones: Path) -> tuple[float, str]:
    """Their error and what has it, in brackets."""
    if protocol.owners is not None:
        error, words = protocol.owners(clones / ARMS[protocol.robot].folder)
        return error, f" ({words})"
    if found and "present" in found.held_out:
        return found.rmse("present"), " (their model)"
    return np.nan, ""


def _text(error: float) -> str:
    """Three digits."""
    return "" if np.isnan(error) else f"{error:#.3g}".rstrip(".")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    clones, part = Path(sys.argv[1]), next((x for x in sys.argv[2:] if x[0] != "-"), "")
    named = dict.fromkeys(protocol.robot for protocol in PROTOCOLS)
    missing = missing_clones(clones, [robot for robot in named if robot in ARMS])
    left_out = {line.partition(":")[0] for line in missing}
    rows = []
    for protocol in PROTOCOLS:
        if part in protocol.robot and protocol.robot not in left_out:
            with TemporaryDirectory() as directory:
                rows.append(row_of(protocol, clones, Path(directory)))
            print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
    if missing or part:
        print(table(HEADINGS, rows))
        sys.exit("\n".join([*missing, "not all robots were measured; nothing was replaced"]))
    log = ["git", "log", "-1", "--format=%h", "--", "core", "methods", "python", "solvers"]
    commit = subprocess.run(log, capture_output=True, text=True, check=True).stdout.strip()
    when = f"Measured on {date.today()}; the library's last commit was {commit}."
    show(f"{table(HEADINGS, rows)}\n\n{when}", "field.md", "field_study")

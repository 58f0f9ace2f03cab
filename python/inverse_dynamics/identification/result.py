# SPDX-License-Identifier: Apache-2.0
"""What identification found: a model, and how good it is on data that it hasn't seen.

    found = identify(["recording"], "ur10_real")
    print(found.rmse("identified"), found.model.friction[0])

n joints in the order of the chain; rad, rad/s, N m (prismatic m, m/s, N). Errors are root mean
squares over the valid samples of the blocks that were held out: each block is predicted by a model that
was fitted to the others, with everything chosen on the others too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics._core import FastModel, Solver
from inverse_dynamics.errors import EvaluationError, RobotError
from inverse_dynamics.evaluation.posture import locked_joints, motors_of
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import RIGID_BODY
from inverse_dynamics.show.result import ResultFiles

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import Any

    from inverse_dynamics.arrays import Floats, Mask
    from inverse_dynamics.evaluation.bands import TorqueBand
    from inverse_dynamics.identification.hold_out import HoldOut
    from inverse_dynamics.robots.robots import Robot
    from inverse_dynamics.show.result import Line

COLUMNS = {
    "urdf": "URDF",  # the description, without friction
    "present": "present model",  # of the run configuration
    "present_refitted": "present, friction refitted",  # its rigid bodies; friction fitted to the same data
    "identified": "identified",
}
"""Models that held-out errors are given of, and their titles, in the order of tables; some may be absent."""

LAWS = {
    "step": "viscous friction and a step",
    "load": "viscous friction, and a step that grows with the load of gravity",
    "stribeck": "viscous friction, and a step that grows with the load and falls with velocity",
    "memory": "viscous friction, a step that grows with the load and falls with velocity, and presliding",
}
"""Friction laws to choose from, the simplest first: all are smooth_coulomb of the model file."""


class IdentificationError(EvaluationError):
    """Recordings that don't determine a model: the text states why, and the remedy.

    mistake: the nearest heading of docs/why_dont_my_torques_match.md, or "".
    """

    def __init__(self, text: str, mistake: str = "") -> None:
        super().__init__(text)
        self.mistake = mistake


@dataclass(frozen=True)
class Finding:
    """Something to know about the result, in words.

    kind: floor (a link's description is unusable), delay, motion (a joint that hardly moves), samples, gain
    (no better than the starting model), worse (a joint that the description or the present model predicts
    better).
    """

    kind: str
    text: str
    joint: str = ""  # the joint or link that it is about; "": all of them


@dataclass(frozen=True)
class IdentifiedModel:
    """A physically consistent model: rigid bodies in the link frames of the description's chain or tree."""

    parameters: Floats  # (l, 10), of l links: m, mcx, mcy, mcz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz about the origin
    rotor_inertia: Floats  # (n,) kg m^2 (prismatic kg), seen at the joint
    friction: tuple[
        dict[str, float], ...
    ]  # of joints: values of smooth_coulomb, by the model file's keys
    drive_gains: Floats | None  # (n,) N m/A where efforts are currents
    torque_deviation: Floats  # (n,) N m: half the width of the 95 % band of measured - computed
    seen: Floats  # (3, n, 2): lowest and highest q, qd, qdd of the samples
    # (r, n): laws act at the velocities `coupling qd`: those of joints, then those of friction_at
    coupling: Floats | None = None
    friction_at: Mapping[str, dict[str, float]] = field(
        default_factory=dict
    )  # laws beside those of joints, by place
    springs: Floats | None = None  # (n, 3): stiffness, at rest at zero; lever_sin, lever_cos


@dataclass(frozen=True)
class HeldOutBlock:
    """A contiguous part of a recording, and what the models fitted to the others predict. M samples.

    Torques are in N m (prismatic N), (M, n).
    """

    recording: str
    time: Floats  # (M,) s since the recording's first sample
    q: Floats  # (M, n) rad (prismatic m), for the page
    qd: Floats  # rad/s (prismatic m/s)
    counts: Mask  # (M,) samples that errors are of: no repeats, no start transient
    measured: Floats
    computed: Mapping[str, Floats]  # by name of COLUMNS
    band: Floats  # half the width of the 95 % band of this block, chosen on the others
    law: str  # of LAWS, chosen on the others
    prior_strength: float
    delay: float  # s

    @property
    def errors(self) -> dict[str, Floats]:
        """Measured minus computed torques of the valid samples, by name of COLUMNS."""
        return {
            name: (self.measured - computed)[self.counts]
            for name, computed in self.computed.items()
        }


def valid_samples(blocks: Sequence[HeldOutBlock], *names: str) -> list[Floats]:
    """Valid samples of blocks, one block after another: of fields, or of torques by name of COLUMNS."""

    def of(block: HeldOutBlock, name: str) -> Floats:
        values: Floats = block.computed[name] if name in COLUMNS else getattr(block, name)
        return values[block.counts]

    return [np.concatenate([of(block, name) for block in blocks]) for name in names]


@dataclass(frozen=True)
class Level:
    """By what a recording differs from the model of the other recordings: temperature, wear."""

    recording: str
    offset: Floats  # (n,) N m, of measured torques
    share: Floats  # (n,) of friction, that there is more of


@dataclass(frozen=True)
class Interval:
    """A number that the data determine, with its 95 % interval: an inertial combination or a value of friction."""

    name: str  # as "elbow_joint fc", or of the parameters that move with it
    unit: str
    value: float
    half_width: float
    joint: str  # "" where it belongs to several


@dataclass(frozen=True)
class PriorDecided:
    """A number of a link that the prior decided more than the data did."""

    link: str
    parameter: str  # m, mcx, ...
    prior: float
    value: float
    share: float  # of its information that comes from the data, 0 to 1


@dataclass(frozen=True)
class DriveGain:
    """The gain of a joint's motor, found with a known load, or stated."""

    joint: str
    value: float  # N m/A (prismatic N/A)
    half_width: float | None  # of the 95 % interval; None: not determined, the stated one
    stated: float | None  # by the run configuration or its solver's model


@dataclass(frozen=True)
class Choice:
    """An alternative of the final choice, compared on inner blocks."""

    law: str
    prior_strength: float
    delay: float  # s
    error: float  # mean over joints of the RMSE, in units of each joint's noise
    standard_error: float  # of the difference to the best; 0 for the best
    chosen: bool


@dataclass(frozen=True, repr=False)
class Identification(ResultFiles):
    """A model from recordings, and how good it is. n joints; order of the chain."""

    names = ("{stem}_model{suffix}", "{stem}_model.json", "{stem}.json", "{stem}.html")
    reader = ", as --robot takes it"

    robot: Robot  # the run configuration that was started from
    recordings: tuple[Path, ...]
    joints: tuple[str, ...]
    units: tuple[str, ...]  # N m, or N of a prismatic joint
    links: tuple[str, ...]  # the l links that joints move, as the description names them
    model: IdentifiedModel
    prior: Floats  # (l, 10): the parameters of the prior, in the same frames
    law: str  # of LAWS
    prior_strength: float
    # s by which efforts are later than the states, made up for in fits; negative: earlier. Held-out
    # errors and bands are of torques as solvers compute them, without it.
    delay: float
    cutoff: float | None  # Hz, of the low-pass of velocities; None: accelerations were given
    filter: str  # how accelerations were estimated, in words
    effort: str  # what recorded efforts mean, in words
    samples: int  # that were used
    duration: float  # s of them
    held_out: Mapping[str, Floats]  # RMSE (n,) by name of COLUMNS
    coverage: Floats  # (n,) share of the held-out samples within their 95 % band
    blocks: tuple[HeldOutBlock, ...]
    noise: Floats  # (n,) N m, RMSE of the final model on what it was fitted to
    independent: Floats  # (n,) effective number of independent samples of the residuals
    choices: tuple[Choice, ...]
    intervals: tuple[Interval, ...]
    prior_decided: tuple[PriorDecided, ...]
    factor: Floats  # (m, K) of the m unknowns of the fit: their covariance is factor factor'
    band: TorqueBand  # of the final model
    levels: tuple[Level, ...]  # of each recording, where there are several
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]  # of reading and differentiating, as evaluate() has them
    drive_gains: tuple[DriveGain, ...] = ()  # determined with known loads; of currents only
    hold_out: tuple[HoldOut, ...] = ()  # errors on recordings that nothing was fitted to
    sketch: tuple[str, ...] = ()  # of the recordings, by which evaluate() recognises their samples

    def numbers(self) -> dict[str, Any]:
        """Everything but the samples, for JSON."""
        from inverse_dynamics.identification.tables import identification_numbers

        return identification_numbers(self)

    def lines(self) -> Iterable[Line]:
        """What the screen shows."""
        from inverse_dynamics.identification.tables import identification_lines

        return identification_lines(self)

    def inputs(self) -> tuple[Path | None, ...]:
        """The recordings and the robot's files."""
        return *self.recordings, *self.robot.files

    def page(self) -> str:
        """The page as text. Raises RobotError."""
        from inverse_dynamics.identification.page import identification_page

        return identification_page(self)

    def texts(self, files: Sequence[Path]) -> tuple[str, ...]:
        """Run configuration, model, what it may be wrong by, all numbers, page."""
        from inverse_dynamics.identification import files as text_of
        from inverse_dynamics.identification.uncertainty import uncertainty_text

        model = text_of.model_file_text(self, files[1].stem)
        return (
            text_of.run_configuration_text(self, files),
            model,
            uncertainty_text(self, model),
            json_text(self.numbers()),
            self.page(),
        )

    def test(self, fresh: Sequence[Path]) -> None:
        """Read the model: the solver's own reader computes the rows of checks, or raises SolverError."""
        Solver(RIGID_BODY, model=str(fresh[1]))

    def rmse(self, column: str) -> float:
        """Held-out error of a name of COLUMNS: mean over the joints."""
        return float(self.held_out[column].mean())

    def solver(self) -> Solver:
        """The identified model as a solver, as `Solver(model=...)` of its model file is."""
        return solver_of_model(identified_model(self))

    @property
    def offsets(self) -> Floats:
        """(n,) N m: constant part of friction, which may do work; drifts between recordings."""
        return self._values("fo")

    @property
    def shifts(self) -> Floats:
        """(n,) rad/s: where the step of friction is off zero velocity."""
        return self._values("shift")

    def _values(self, key: str) -> Floats:
        return np.array([law.get(key, 0.0) for law in self.model.friction])


def identified_model(found: Identification) -> FastModel:
    """The description's chain with the identified links, rotors and friction. Raises RobotError."""
    robot = found.robot
    described = FastModel.from_urdf(
        read_description(urdf_of(found)),
        root=robot.root,
        tip=robot.tip,
        gravity=robot.gravity,
        locked_joints=locked_joints(robot),
        motors=motors_of(robot),
    )
    return described.identified(found.model)


def solver_of_model(identified: FastModel) -> Solver:
    """The model as a solver."""
    with TemporaryDirectory() as directory:
        file = Path(directory) / "model.yaml"
        text = identified.file_text(name="identified", source="", validity="")
        file.write_text(text, encoding="utf-8")
        return Solver(RIGID_BODY, model=f"{file}")


def urdf_of(found: Identification) -> Path:
    """The description that was started from. Raises RobotError."""
    if found.robot.urdf is None:
        raise RobotError(
            f"robot {found.robot.name}: expected a description, whose geometry the model has; give --urdf"
        )
    return found.robot.urdf

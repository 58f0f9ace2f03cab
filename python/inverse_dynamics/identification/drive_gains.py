# SPDX-License-Identifier: Apache-2.0
"""Drive gains of motor currents, from recordings without and with a known load.

    found = identify_drive_gains(alone, [("loaded", {"payload.mass": 5.0})], robot, fitter)
    print(found[1].value, found[1].half_width)     # N m/A

Currents i, links p, friction f and gains k of a motion fit

    k_j i_j = Y_j p + J_j qdd_j + f_j + t_j

as well with all of them twice as large, except for t_j, the torque of the known load: it alone has a
scale. The errors that are fitted are those of the currents [arm_fit.hpp]. A gain is known where the data
determine it: its interval must be narrow with a hundredth of the prior, too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics._core import ArmFitOptions
from inverse_dynamics.evaluation.evaluation import evaluate_run, open_run
from inverse_dynamics.evaluation.run import RunOptions
from inverse_dynamics.identification.blocks import blocks_of
from inverse_dynamics.identification.knowledge import Knowledge, own_columns, student_t
from inverse_dynamics.identification.result import DriveGain, IdentificationError
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import RIGID_BODY, with_changes
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from typing_extensions import Unpack

    from inverse_dynamics._core import ArmData, ArmFit, ArmFitter
    from inverse_dynamics.arrays import Floats, Mask, Parameter
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.blocks import FitBlock
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Recorded
    from inverse_dynamics.robots.robots import Robot

    KnownPayload = tuple[Recorded, Mapping[str, Parameter]]
    """A recording, and the parameters payload.* of what the tip carries in it."""

MOST_UNCERTAIN = 0.1
"""Half width of the 95 % interval, as a share of the gain, above which it counts as unknown."""

_LAW = "load"  # a load shows in gravity and in friction
_STRENGTH = 10.0
_LOOSENED = 0.01  # share of the prior that is left where data must decide
_PASSES = 40
_BLOCKS = 5  # of each recording, for intervals
_FAR = 5.0  # factor by which gains of a robot may differ from their median, to start from
_options = partial(ArmFitOptions, _LAW, prior_strength=_STRENGTH)


@dataclass(frozen=True)
class _Recording:
    """Blocks of currents, and the body that the tip carries; None: nothing that is known."""

    evaluation: Evaluation
    blocks: list[FitBlock]
    carried: dict[str, Any] | None


def identify_drive_gains(
    recordings: Sequence[Recorded],
    known_payloads: Sequence[KnownPayload],
    robot: Robot,
    fitter: ArmFitter,
    *,
    progress: Progress = no_progress,
    **options: Unpack[RunOptions],
) -> tuple[DriveGain, ...]:
    """The gain of each joint; `robot`'s or its solver's own where the data don't determine it.

    recordings: without the loads; known_payloads: recordings with them, and the parameters payload.* of
    solvers, in the tip frame. options: of evaluate(). Raises UserError: IdentificationError where a gain
    is neither determined nor stated.
    """
    stated = stated_gains(robot)
    described = replace(
        robot,
        plugin=RIGID_BODY,
        model=None,
        friction=False,
        drive_gains=(1.0,) * len(fitter.joint_names),
    )
    read = [
        _read(path, load, described, progress, options)
        for path, load in [*((path, None) for path in recordings), *known_payloads]
    ]
    blocks = [block for recording in read for block in recording.blocks]
    carried = [recording.carried for recording in read for _ in recording.blocks]
    gains = _about(read)
    torques = [(q, qd, qdd, current * gains) for q, qd, qdd, current in blocks]
    start = fitter.fit(fitter.data(torques, carried=carried), _options())
    currents = fitter.data(blocks, carried=carried)
    fit = fitter.fit(currents, _options(most_passes=_PASSES, drive_gains=gains), start)
    half_widths = _half_widths(fitter, fit, currents)
    known = half_widths <= MOST_UNCERTAIN
    _check(fitter, known, half_widths, stated, read)
    fitted = fit.drive_gains
    assert fitted is not None
    return tuple(
        DriveGain(
            joint=joint,
            value=float(fitted[j]) if known[j] or stated is None else stated[j],
            half_width=float(half_widths[j] * fitted[j]) if known[j] else None,
            stated=None if stated is None else stated[j],
        )
        for j, joint in enumerate(fitter.joint_names)
    )


def stated_gains(robot: Robot) -> tuple[float, ...] | None:
    """N m/A, of the run configuration, or of the model of its solver. Raises UserError."""
    if robot.drive_gains:
        return robot.drive_gains
    own = Arm(robot).solver.drive_gains
    return None if own is None else tuple(own.tolist())


def check_gains(robot: Robot, effort_is: str | None) -> None:
    """Raise IdentificationError for motor currents whose gains nobody states."""
    if (effort_is or robot.effort) != "current" or stated_gains(robot) is not None:
        return
    raise IdentificationError(
        f"robot {robot.name}: efforts are motor currents, and the drive gains aren't stated: without a "
        "known torque, gains, masses and friction may all be twice as large; record the motion again with a "
        "known load and give --known-payload RECORDING=MASS,x,y,z, or add drive_gains: [...] to "
        "the run configuration",
        "Efforts are motor currents",
    )


def _read(
    path: Path | str,
    load: Mapping[str, Parameter] | None,
    described: Robot,
    progress: Progress,
    options: RunOptions,
) -> _Recording:
    """Currents of a recording, as if each gain were one; computed: by the description with the load."""
    if load is not None:
        _check_load(path, load)
    described = with_changes(replace(described, parameters=dict(load or {})))
    found = evaluate_run(open_run(path, described, progress=progress, **options))
    if found.effort.meaning != "current":
        raise IdentificationError(
            f"{path}: expected motor currents, whose gains a known load determines, got "
            f"{found.effort.meaning} ({found.effort.stated_by}); leave out --known-payload, or give "
            "--effort-is current",
            "Efforts are motor currents",
        )
    blocks = [block.fitted for block in blocks_of(found, _BLOCKS)]
    return _Recording(found, blocks, found.arm.solver.payloads.get("payload"))


def _check_load(path: Path | str, load: Mapping[str, Parameter]) -> None:
    """A load has a mass, and a center: gains are proportional to its distance from the axes."""
    if not float(load["payload.mass"]) > 0:  # type: ignore[arg-type]
        raise IdentificationError(
            f"--known-payload {path}: expected a mass above zero, got {load['payload.mass']}"
        )
    if "payload.center_of_mass" not in load:
        raise IdentificationError(
            f"--known-payload {path}: expected MASS,x,y,z, got a mass alone: drive gains follow from the torque of the "
            "load, so they would be wrong by as much as its center is; measure the center of mass in the tip frame "
            "[m], and give 0,0,0 if it is the origin"
        )


def _about(read: Sequence[_Recording]) -> Floats:
    """(n,) gains to start from: what the description computes, by the currents."""
    computed = np.concatenate([r.evaluation.computed for r in read])
    current = np.concatenate([r.evaluation.measured for r in read])
    power = np.maximum((current**2).mean(0), 1e-12)
    gains = np.sqrt(np.maximum((computed**2).mean(0), 1e-12) / power)
    middle = float(np.median(gains))
    return np.asarray(np.clip(gains, middle / _FAR, middle * _FAR))


def _half_widths(fitter: ArmFitter, fit: ArmFit, currents: ArmData) -> Floats:
    """(n,) of the 95 % intervals of log k, the widest of three.

    What leaving out each block changes (the jackknife), for errors that are correlated;
    the cluster-robust ones, with the prior and hardly without.
    """
    without = []
    for others in fitter.left_out(fit, currents, _options()):
        assert others.drive_gains is not None
        without.append(np.log(others.drive_gains))
    deviations = [np.sqrt((len(currents) - 1) * np.var(without, axis=0))]
    data, prior, scores = fitter.information(fit, currents, _options())
    n = len(fitter.joint_names)
    rigid = fit.parameters.size
    columns = own_columns(_LAW) + 1
    at = rigid + columns * np.arange(1, n + 1) - 1
    values = np.zeros(len(data))
    values[:rigid] = fit.parameters.ravel()
    none = np.zeros((len(data), 0))
    for share in (1.0, _LOOSENED):
        known = Knowledge(
            fitter.joint_names, (), values, fitter.prior, data, share * prior, scores, assumed=none
        )
        deviations.append(np.linalg.norm(known.deviations[at], axis=1))
    widths: Floats = student_t(len(scores)) * np.max(deviations, axis=0)
    return widths


def _check(
    fitter: ArmFitter,
    known: Mask,
    half_widths: Floats,
    stated: tuple[float, ...] | None,
    read: Sequence[_Recording],
) -> None:
    """Refuse joints whose gain is neither determined by the data nor stated."""
    if stated is not None or known.all():
        return
    unknown = [
        f"{joint} (+- {100 * min(width, 9.99):.0f} %)"
        for joint, width, is_known in zip(fitter.joint_names, half_widths, known, strict=True)
        if not is_known
    ]
    where = ", ".join(str(recording.evaluation.bag) for recording in read)
    raise IdentificationError(
        f"{where}: the known load doesn't determine the drive gain of {listed(unknown)}: its torque at the joint is "
        "too small compared with noise and friction; fix the load with its center beside the axis and "
        "turn the wrist so that gravity loads the joint, or state these gains: `drive_gains` of the run "
        "configuration is used for joints whose gain isn't determined",
        "Efforts are motor currents",
    )

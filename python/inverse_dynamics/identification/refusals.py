# SPDX-License-Identifier: Apache-2.0
"""Recordings that no model should be identified from, and models that are no gain: why, and what to do.

check_recordings(evaluations)     # raises IdentificationError
check_result(found, accept=("total_mass",))
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.diagnosis.compare import Cause, residual_causes
from inverse_dynamics.diagnosis.pieces import pieces_of
from inverse_dynamics.evaluation.evaluation import CAUSE
from inverse_dynamics.identification.result import IdentificationError, valid_samples
from inverse_dynamics.robots.dh_tables import guess_of
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.result import HeldOutBlock, Identification

LEAST_SECONDS = 5.0
"""Of motion, of all recordings together: from less, every method is worse than what it starts from."""

LEAST_TRAVEL = 0.1
"""rad (prismatic: m) between the lowest and the highest position of a joint."""

REFUSED = (
    *("effort_sign", "effort_direction", "direction", "effort_order", "order"),
    *("effort_scale", "currents", "no_gravity", "gravity", "degrees", "velocity", "clock"),
    *("motor_side", "guided", "saturation", "coupling", "drift", "total_mass", "no_friction"),
)
"""Kinds of mistakes that no model is identified from, unless they are accepted. Friction, loads and the mass of a
link are what identification is for."""

_MOST_MASS = 3.0  # by the description's: units and currents are off by more, descriptions by less
_NO_FRICTION = 1e-3  # of a measured range: a fit stops about so far from the bound of friction
_AGAINST = -0.1  # mean correlation of errors with velocities, of friction of the wrong sign
_MOVING = 0.02  # of a joint's greatest velocity
_UNEXPLAINED = 0.25  # held-out error as a share of the measured range


def check_recordings(evaluations: Sequence[Evaluation], accept: Sequence[str] = ()) -> None:
    """Raise IdentificationError where there is too little motion, or where torques contradict the robot.

    evaluations: by the present model, or by the description. accept: kinds of REFUSED that are taken as they are.
    """
    for evaluation in evaluations:
        _check_efforts(evaluation)
        refused = [c for c in evaluation.diagnosis if c.kind in REFUSED and c.kind not in accept]
        if refused:
            text = evaluation.explained.notes[-1].removeprefix(
                CAUSE
            )  # all causes, or that they are rivals
            kinds = tuple(dict.fromkeys(cause.kind for cause in refused))
            raise _refusal(f"{evaluation.bag}: {text}", kinds, refused[0].mistake)
    _check_motion(evaluations)


def _check_efforts(evaluation: Evaluation) -> None:
    if still := [
        joint
        for joint, efforts in zip(evaluation.joint_names, evaluation.measured.T, strict=True)
        if efforts.min() == efforts.max()
    ]:
        raise IdentificationError(
            f"{evaluation.bag}: {listed(still)}: expected efforts that change, got the same in all samples: does the "
            "robot's driver measure them? Some publish zeros; record another topic, or end the chain before it: "
            "`root` and `tip` of a run configuration"
        )


def check_accepted(accept: Sequence[str]) -> None:
    """Raise IdentificationError for kinds that nothing is refused for."""
    for kind in accept:
        if kind not in REFUSED:
            raise IdentificationError(f"accept: expected one of {', '.join(REFUSED)}, got {kind}")


def _refusal(text: str, kinds: Sequence[str], mistake: str) -> IdentificationError:
    options = " ".join(f"--accept {kind}" for kind in kinds)
    return IdentificationError(f"{text}. To identify a model all the same, give {options}", mistake)


def _check_motion(evaluations: Sequence[Evaluation]) -> None:
    where = ", ".join(str(evaluation.bag) for evaluation in evaluations)
    seconds = sum(map(_seconds_in_motion, evaluations))
    if seconds < LEAST_SECONDS:
        raise IdentificationError(
            f"{where}: expected at least {LEAST_SECONDS:g} s of motion, got {seconds:.1f} s: from less, every "
            "method is worse than the model that it starts from; record half a minute in which every "
            "joint turns round several times (`ids excite` makes such a motion)"
        )
    travel = np.max([np.ptp(e.log.q, axis=0) for e in evaluations], axis=0)
    names, units = evaluations[0].joint_names, evaluations[0].units
    still = {
        joint: f"{way:.2g} {'m' if unit == 'N' else 'rad'}"
        for joint, way, unit in zip(names, travel, units, strict=True)
        if way < LEAST_TRAVEL
    }
    if still:
        raise IdentificationError(
            f"{where}: {listed(list(still))}: expected every joint to move by {LEAST_TRAVEL:g} rad (prismatic: "
            f"{LEAST_TRAVEL:g} m) or more, got {listed(list(still.values()))}, "
            "so that neither friction nor load of the joint show; record a motion in which it moves "
            "(`ids excite` makes one); one that stands still at the same place in all recordings is held"
        )


def _seconds_in_motion(evaluation: Evaluation) -> float:
    """Seconds in which a joint moves."""
    speed = np.abs(evaluation.log.qd)
    moving = (speed > _MOVING * np.maximum(speed.max(axis=0), 1e-6)).any(axis=1)
    step = np.diff(evaluation.time, append=evaluation.time[-1:])
    return float(step[moving & (step > 0)].sum())


def check_result(found: Identification, accept: Sequence[str] = ()) -> None:
    """Raise IdentificationError where the model is no gain, or shows what no arm can be.

    accept: as in check_recordings().
    """
    measured = np.concatenate([block.measured for block in found.blocks])
    share = found.held_out["identified"] / np.maximum(np.ptp(measured, axis=0), 1e-9)
    if share.mean() > _UNEXPLAINED:
        raise IdentificationError(
            f"{_named(found)}: no masses and friction explain the efforts: held-out errors are "
            f"{100 * share.mean():.0f} % of the measured ranges; is the description that of this robot, "
            "are its joints in this order, and are efforts torques of the joints?",
            "Joints in another order",
        )
    for recording in dict.fromkeys(block.recording for block in found.blocks):
        blocks = [block for block in found.blocks if block.recording == recording]
        for cause in _causes_of_residuals(found, blocks):
            if cause.kind not in accept:
                raise _refusal(f"{recording}: {cause.text}", (cause.kind,), cause.mistake)
    if "no_friction" not in accept:
        _check_friction(found)
    if "total_mass" not in accept and not guess_of(found.robot.urdf):
        _check_mass(found)
    start = "present" if "present" in found.held_out else "urdf"
    if start in found.held_out and found.rmse("identified") >= found.rmse(start):
        name = {"present": "the present model", "urdf": "the description"}[start]
        raise IdentificationError(
            f"{_named(found)}: the identified model is no gain over {name}: {found.rmse('identified'):.3g} "
            f"against {found.rmse(start):.3g} {mean_unit(found.units)} on data that were held out; stay with "
            f"{name}, or record a longer motion (`ids excite` makes one)"
        )


def _check_mass(found: Identification) -> None:
    """Compare the total mass, and the scale of efforts, with the description: a fit keeps masses near the base."""
    mass, described = (float(links[:, 0].sum()) for links in (found.model.parameters, found.prior))
    measured, urdf = valid_samples(found.blocks, "measured", "urdf")
    share = float((measured * urdf).sum() / (urdf**2).sum())
    if not all(1 / _MOST_MASS <= x <= _MOST_MASS for x in (mass / described, share)):
        raise _refusal(
            f"{_named(found)}: the links have {mass:.3g} kg together, {mass / described:.2g} times the "
            f"{described:.3g} kg of the description, and efforts are {share:.2g} times its torques: "
            "efforts are motor currents (--effort-is current) or in another unit, or masses of the description are "
            "wrong; convert the efforts, or correct the description",
            ("total_mass",),
            "Efforts are motor currents",
        )


def _check_friction(found: Identification) -> None:
    """An arm without any, whose errors are against the motion: friction of the wrong sign."""
    measured, identified, qd = valid_samples(found.blocks, "measured", "identified", "qd")
    error = measured - identified
    fc, fv = (np.array([law[key] for law in found.model.friction]) for key in ("fc", "fv"))
    friction = fc + fv * np.abs(qd).max(axis=0)
    with_motion = (error * qd).mean(axis=0) / np.sqrt(
        (error**2).mean(axis=0) * (qd**2).mean(axis=0)
    )
    none = (friction < _NO_FRICTION * np.ptp(measured, axis=0)).all()
    if none and (with_motion < 0).all() and with_motion.mean() < _AGAINST:
        raise _refusal(
            f"{_named(found)}: friction is zero in all joints, and efforts are lower than computed along the motion: "
            "all efforts have the opposite sign, or somebody guides the arm; change the sign of all efforts where the "
            "recording is made, or record the arm as it moves by itself",
            ("no_friction",),
            "A joint is reversed",
        )


def mean_unit(units: Sequence[str]) -> str:
    """Of means over the joints."""
    return units[0] if len(set(units)) == 1 else "N m and N"


def _named(found: Identification) -> str:
    return ", ".join(map(str, found.recordings))


def _causes_of_residuals(
    found: Identification, blocks: Sequence[HeldOutBlock]
) -> tuple[Cause, ...]:
    """What the held-out errors of a recording show: limits, couplings, drift."""
    ordered = sorted(blocks, key=lambda block: float(block.time[0]))
    time, q, qd, measured, computed = valid_samples(
        ordered, "time", "q", "qd", "measured", "identified"
    )
    # pieces of what is computed, in the place of accelerations
    samples = pieces_of(found.joints, time, (q, qd, computed), measured)
    return () if samples is None else residual_causes(samples, samples.flat(samples.qdd))

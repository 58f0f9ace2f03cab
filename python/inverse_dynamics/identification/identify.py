# SPDX-License-Identifier: Apache-2.0
"""From recordings to a model, and how good it is on data that it hasn't seen."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics.arguments import checked
from inverse_dynamics.evaluation.evaluation import evaluate_run, open_run, torques_with_gravity
from inverse_dynamics.evaluation.posture import locked_joints, posture_of
from inverse_dynamics.evaluation.run import RunOptions, of_recording, overridden
from inverse_dynamics.evaluation.turns import on_one_turn
from inverse_dynamics.identification.baselines import (
    baseline_torques,
    baselines,
    root_mean_squares,
)
from inverse_dynamics.identification.blocks import Block, blocks_of, moving
from inverse_dynamics.identification.coupling import coupling_of
from inverse_dynamics.identification.cross_validation import Chosen, choose, errors_of
from inverse_dynamics.identification.drive_gains import check_gains, identify_drive_gains
from inverse_dynamics.identification.findings import (
    findings_of_errors,
    gravity_finding,
    motion_findings,
)
from inverse_dynamics.identification.knowledge import (
    assumed,
    independent_samples,
    intervals,
    knowledge,
    prior_decided,
    weights_of_links,
)
from inverse_dynamics.identification.refusals import (
    check_accepted,
    check_recordings,
    check_result,
)
from inverse_dynamics.identification.result import (
    Finding,
    HeldOutBlock,
    Identification,
    IdentificationError,
    IdentifiedModel,
    fitted_solver,
    valid_samples,
)
from inverse_dynamics.identification.uncertainty import (
    band_of,
    factor_of,
    levels_of,
    with_levels,
)
from inverse_dynamics.progress import no_progress
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import RIGID_BODY, Robot

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from typing_extensions import Unpack

    from inverse_dynamics._core import ArmFitter, DescribedJoint, FastModel, Solver
    from inverse_dynamics.arrays import Floats
    from inverse_dynamics.evaluation.bands import TorqueBand
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.baselines import Computed
    from inverse_dynamics.identification.drive_gains import KnownPayload
    from inverse_dynamics.identification.result import DriveGain, Level
    from inverse_dynamics.progress import Progress

BLOCKS = 5
"""Contiguous blocks that all recordings are cut into, of which each is predicted by the others."""

_FEWEST_BLOCKS = 3
_SHORTEST_BLOCK = 2.5  # s; accelerations at the ends of a block are poor
_BAND_SAMPLES = 5_000


@checked
def identify(
    recordings: Sequence[Path | str],
    robot: Robot | Path | str,
    *,
    blocks: int | None = None,
    known_payloads: Sequence[KnownPayload] = (),
    coupling: Sequence[float] = (),
    accept: Sequence[str] = (),
    progress: Progress = no_progress,
    **options: Unpack[RunOptions],
) -> Identification:
    """Identify a physically consistent model with friction from recordings of a moving arm.

    Parameters
    ----------
    recordings
        As evaluate() takes them; each, or each block of one, is predicted by models of the others.
    robot
        As in evaluate(). Its description is the prior; its model, if it has one, is compared with.
    blocks
        How many the recordings are cut into altogether, at least 3. By default whole recordings are held out
        where there are several, else BLOCKS, or fewer where they would be shorter than 2.5 s.
    known_payloads
        Further recordings of motor currents, each with a load as the parameters payload.* of solvers.
        They determine the drive gains.
    coupling
        Of n joints whose motors others turn too, the n rows of C, one after the other: motors have velocities
        `C qd`, and friction is theirs. By default of the matrix of `gears`, scaled to ones on its diagonal.
    accept
        Kinds of refusals.REFUSED that are accepted.
    options
        Others of evaluate(), such as effort_is, start, end.

    Raises
    ------
    UserError
        Those of evaluate(), IdentificationError.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from inverse_dynamics import identify, read_joint_log, write_joint_logs
    >>> from inverse_dynamics.demo.demo import stored_recording
    >>> log = read_joint_log(stored_recording("ur10_simulated"))
    >>> rough = replace(log, effort=log.effort + 5 * np.tanh(log.qd / 0.05))  # N m of friction
    >>> write_joint_logs("rough", {"/joint_states": rough})
    >>> found = identify(["rough"], "ur10_simulated")
    >>> bool(found.held_out["urdf"].min() > 4), bool(found.held_out["identified"].max() < 0.1)  # N m
    (True, True)
    >>> found.solver().joint_names[2]
    'elbow_joint'
    """
    robot, stated = overridden(robot, options), of_recording(options)
    check_accepted(accept)
    description = _description(robot)
    if not recordings:
        raise IdentificationError("recordings: expected at least one, got none")
    _check_distinct([*recordings, *(path for path, _ in known_payloads)])
    fitter = _fitter(robot, description)
    motors, unfitted = coupling_of(coupling, robot.gears, len(fitter.joint_names))
    # Links are the description's, whatever model is compared with.
    posture = posture_of(
        Path(recordings[0]),
        replace(robot, model=None),
        description,
        fitter.joint_names,
        topic=stated.get("topic"),
    )
    if posture.parameters:
        robot = replace(robot, parameters={**robot.parameters, **posture.parameters})
    if posture.parameters or motors is not None:
        fitter = _fitter(robot, description, motors)
    gains: tuple[DriveGain, ...] = ()
    if known_payloads:
        gains = identify_drive_gains(
            recordings, known_payloads, robot, fitter, progress=progress, **stated
        )
        robot = replace(robot, drive_gains=tuple(gain.value for gain in gains))
    check_gains(robot, stated.get("effort_is"))
    evaluations = on_one_turn(
        [evaluate_run(open_run(path, robot, progress=progress, **stated)) for path in recordings]
    )
    robot = evaluations[0].robot
    check_recordings(evaluations, accept)
    plain = replace(robot, plugin=RIGID_BODY, model=None)
    evaluations = [replace(e, measured=torques_with_gravity(e, plain)) for e in evaluations]
    groups = _groups(evaluations, blocks)
    cut = [block for group in groups for block in group]
    described = _core.FastModel.from_urdf(
        description, root=robot.root, tip=robot.tip, gravity=robot.gravity
    )
    chain = _core.RobotDescription(description).chain(fitter.joint_names, robot.root)
    by_day = len(evaluations) > 1 and blocks is None
    level = _effort_limits(chain) if by_day else None
    held_out = _held_out(fitter, described, level, baselines(robot, description), groups, progress)
    chosen = choose(fitter, cut)
    found = _result(
        described,
        evaluations,
        fitter,
        cut,
        chain,
        held_out=held_out,
        chosen=chosen,
        by_day=by_day,
    )
    notes = tuple(dict.fromkeys((*posture.notes, *unfitted, *found.notes)))
    found = replace(found, drive_gains=gains, notes=notes)
    check_result(found, accept)
    return found


def _fitter(robot: Robot, description: str, coupling: Floats | None = None) -> ArmFitter:
    return _core.ArmFitter.from_urdf(
        description,
        root=robot.root,
        tip=robot.tip,
        gravity=robot.gravity,
        locked_joints=locked_joints(robot),
        coupling=coupling,
    )


def _check_distinct(recordings: Sequence[Path | str]) -> None:
    """Of a recording that is given twice, a part would be predicted by a fit to itself."""
    resolved = [Path(recording).resolve() for recording in recordings]
    for recording, path in zip(recordings, resolved, strict=True):
        if resolved.count(path) > 1:
            raise IdentificationError(f"{recording}: expected each recording once, got it twice")


def _description(robot: Robot) -> str:
    if robot.urdf is None:
        raise IdentificationError(
            f"robot {robot.name}: urdf: expected a description, which a fit starts from, got none; "
            "give --urdf"
        )
    return read_description(robot.urdf)


def _groups(evaluations: Sequence[Evaluation], asked: int | None) -> list[list[Block]]:
    """Blocks that are held out together: whole recordings where there are several, else blocks of equal length.

    Recordings may be of different days, and differ as blocks of one day don't.
    """
    if len(evaluations) > 1 and asked is None:
        whole = [block for evaluation in evaluations for block in blocks_of(evaluation, 1)]
        edges = np.linspace(0, len(whole), min(len(whole), BLOCKS) + 1).round().astype(int)
        return [whole[first:after] for first, after in pairwise(edges.tolist())]
    if asked is None:
        duration = sum(float(e.time[-1]) for e in evaluations)
        asked = int(np.clip(duration // _SHORTEST_BLOCK, _FEWEST_BLOCKS, BLOCKS))
    elif asked < _FEWEST_BLOCKS:
        raise IdentificationError(f"blocks: expected at least {_FEWEST_BLOCKS}, got {asked}")
    return [[block] for block in _cut(evaluations, asked)]


def _cut(evaluations: Sequence[Evaluation], blocks: int) -> list[Block]:
    """Blocks of all recordings: as many of each as its share of the time, at least one."""
    lengths = np.array([e.time[-1] for e in evaluations])
    counts = np.maximum(1, np.round(blocks * lengths / lengths.sum())).astype(int)
    if len(evaluations) == 1:
        counts[:] = blocks
    while counts.sum() < _FEWEST_BLOCKS:
        counts[lengths.argmax()] += 1
    return [
        block
        for evaluation, count in zip(evaluations, counts, strict=True)
        for block in blocks_of(evaluation, int(count))
    ]


def _held_out(
    fitter: ArmFitter,
    described: FastModel,
    limits: Floats | None,
    solvers: Mapping[str, Solver],
    groups: Sequence[Sequence[Block]],
    progress: Progress,
) -> list[HeldOutBlock]:
    """The blocks of each group, predicted by models fitted to, and chosen on, the others."""
    found = []
    present = solvers.get("present")
    rows = [[] if present is None else [_computed(present, b) for b in group] for group in groups]
    for k, group in enumerate(groups):
        progress("predicting held-out blocks", k, len(groups) + 1)
        others = [block for i, other in enumerate(groups) if i != k for block in other]
        fitted = [row for i, other in enumerate(rows) if i != k for row in other]
        chosen = choose(fitter, others)
        band, solver = _banded(fitter, described, limits, chosen, others)
        for block in group:
            motion = block.q, block.qd, block.qdd
            computed = baseline_torques(solvers, motion, fitted)
            computed["identified"] = fitter.torques(chosen.fit, *motion)
            found.append(
                HeldOutBlock(
                    recording=block.recording,
                    time=block.time,
                    q=block.q,
                    qd=block.qd,
                    counts=block.counts,
                    measured=block.tau,
                    computed=computed,
                    band=band.half_widths(solver, *motion),
                    law=chosen.law,
                    prior_strength=chosen.prior_strength,
                    delay=chosen.delay,
                )
            )
    progress("predicting held-out blocks", len(groups), len(groups) + 1)
    return found


def _banded(
    fitter: ArmFitter,
    described: FastModel,
    limits: Floats | None,
    chosen: Chosen,
    blocks: Sequence[Block],
) -> tuple[TorqueBand, Solver]:
    """The band of a fit to blocks, and its solver. Errors are correlated in time: some samples suffice."""
    step = 1 + sum(map(len, blocks)) // _BAND_SAMPLES
    later = [block.later(chosen.delay).thinned(step) for block in moving(blocks)]
    known = knowledge(
        fitter,
        chosen.fit,
        later,
        law=chosen.law,
        prior_strength=chosen.prior_strength,
        worth=1.0,
    )
    factor = factor_of(fitter, chosen.fit, later, known, law=chosen.law)
    solver = fitted_solver(described, _model(fitter, chosen, blocks, None))
    return band_of(chosen, factor, blocks, limits), solver


def _computed(solver: Solver, block: Block) -> Computed:
    """Of the samples to be fitted to."""
    q, qd, qdd, measured = block.fitted
    return q, qd, solver.torques(q, qd, qdd), measured


def _effort_limits(chain: Sequence[DescribedJoint]) -> Floats:
    """(n,) N m (prismatic N); infinite where none is stated."""
    return np.array([joint.limits.get("effort", np.inf) for joint in chain])


def _result(
    described: FastModel,
    evaluations: Sequence[Evaluation],
    fitter: ArmFitter,
    cut: Sequence[Block],
    chain: Sequence[DescribedJoint],
    *,
    held_out: Sequence[HeldOutBlock],
    chosen: Chosen,
    by_day: bool,
) -> Identification:
    first, fit = evaluations[0], chosen.fit
    robot = first.robot
    links = tuple(joint.child for joint in chain)
    later = [block.later(chosen.delay) for block in moving(cut)]
    errors = [errors_of(fitter, fit, block) for block in later]
    independent = independent_samples(errors)
    samples = sum(map(len, errors))
    known = knowledge(
        fitter,
        fit,
        later,
        law=chosen.law,
        prior_strength=chosen.prior_strength,
        worth=float(independent.mean() / samples),
    )
    gravity: tuple[Finding, ...] = ()
    if any(e.effort.meaning == "torque_without_gravity" for e in evaluations):
        weights = weights_of_links(described, fitter.prior, later)
        options = _core.ArmFitOptions(chosen.law, prior_strength=chosen.prior_strength)
        known = replace(known, assumed=assumed(fitter, fit, later, options, weights))
        gravity = (gravity_finding(robot, weights, first.units),)
    factor = np.hstack([factor_of(fitter, fit, later, known, law=chosen.law), known.assumed])
    currents = first.effort.meaning == "current"
    model = _model(fitter, chosen, cut, np.array(first.effort.drive_gains) if currents else None)
    levels: tuple[Level, ...] = ()
    if by_day:
        names = list(dict.fromkeys(block.recording for block in held_out))
        levels = levels_of(names, held_out, fitted_solver(described, model))
    held, coverage = _held_out_errors(held_out)
    return Identification(
        robot=robot,
        recordings=tuple(e.bag for e in evaluations),
        joints=fitter.joint_names,
        units=first.units,
        links=links,
        model=model,
        prior=fitter.prior,
        law=chosen.law,
        prior_strength=chosen.prior_strength,
        delay=chosen.delay,
        cutoff=first.accelerations.cutoff,
        filter=first.accelerations.summary,
        effort=first.effort.summary,
        samples=samples,
        duration=float(sum(e.time[-1] for e in evaluations)),
        held_out=held,
        coverage=coverage,
        blocks=tuple(held_out),
        noise=np.sqrt((np.concatenate(errors) ** 2).mean(0)),
        independent=independent,
        choices=chosen.choices,
        intervals=intervals(known, described, first.units),
        prior_decided=prior_decided(known, fitter.prior, links),
        factor=factor,
        band=with_levels(band_of(chosen, factor, cut, _effort_limits(chain)), levels),
        levels=levels,
        findings=(
            *gravity,
            *findings_of_errors(fitter, links, held, first.units),
            *motion_findings(
                fitter, chosen.delay, np.array([b.delay for b in held_out]), later, independent
            ),
        ),
        # but for the cause of the present model's errors, which the fit removes
        notes=tuple(note for e in evaluations for note in e.notes),
    )


def _model(
    fitter: ArmFitter, chosen: Chosen, cut: Sequence[Block], drive_gains: Floats | None
) -> IdentifiedModel:
    fit = chosen.fit
    used = [(b.q[b.counts], b.qd[b.counts], b.qdd[b.counts]) for b in cut]
    seen = [np.concatenate(values) for values in zip(*used, strict=True)]
    return IdentifiedModel(
        parameters=fit.parameters,
        rotor_inertia=fit.rotor_inertia,
        friction=tuple(fit.friction),
        drive_gains=drive_gains,
        torque_deviation=chosen.band,
        seen=np.stack([np.stack([s.min(0), s.max(0)], axis=1) for s in seen]),
        coupling=fitter.coupling,
    )


def _held_out_errors(blocks: Sequence[HeldOutBlock]) -> tuple[dict[str, Floats], Floats]:
    """RMSE (n,) of each column over the valid samples, and the share within the band."""
    measured, identified, band = valid_samples(blocks, "measured", "identified", "band")
    within = np.abs(measured - identified) <= band
    return root_mean_squares([block.errors for block in blocks]), within.mean(0)

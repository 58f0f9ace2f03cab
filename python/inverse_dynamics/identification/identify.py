# SPDX-License-Identifier: Apache-2.0
"""From recordings to a model, and how good it is on data that it hasn't seen."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from itertools import compress, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics import _core
from inverse_dynamics._core import Solver
from inverse_dynamics.arguments import checked
from inverse_dynamics.errors import BagError, SolverError
from inverse_dynamics.evaluation.evaluation import evaluate_run, open_run, torques_with_gravity
from inverse_dynamics.evaluation.posture import (
    LOCKED,
    locked_joints,
    motors_of,
    posture_of,
    still_joints,
)
from inverse_dynamics.evaluation.ranges import on_one_turn
from inverse_dynamics.evaluation.run import ARRAYS, RunOptions, of_recording, overridden
from inverse_dynamics.identification.baselines import baseline_torques, baselines
from inverse_dynamics.identification.blocks import Block, blocks_of
from inverse_dynamics.identification.coupling import coupling_of
from inverse_dynamics.identification.cross_validation import Chosen, choose, errors_of
from inverse_dynamics.identification.drive_gains import check_gains, identify_drive_gains
from inverse_dynamics.identification.findings import (
    findings_of_errors,
    gravity_finding,
    motion_findings,
)
from inverse_dynamics.identification.hold_out import hold_out as held_out_errors
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
    solver_of_model,
    valid_samples,
)
from inverse_dynamics.identification.uncertainty import (
    band_of,
    factor_of,
    level_of,
    with_levels,
)
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.sketch import sketch_of
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.dh_tables import guess_of
from inverse_dynamics.robots.robots import RIGID_BODY, Robot, robot_of
from inverse_dynamics.wording import listed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from typing_extensions import Unpack

    from inverse_dynamics._core import ArmFitter, DescribedJoint, FastModel, RobotDescription
    from inverse_dynamics.arrays import Floats, Parameter
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.identification.drive_gains import KnownPayload
    from inverse_dynamics.identification.result import DriveGain, Level
    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Recorded

BLOCKS = 5
"""Contiguous blocks that all recordings are cut into, of which each is predicted by the others."""

_FEWEST_BLOCKS = 3
_SHORTEST_BLOCK = 2.5  # s; accelerations at the ends of a block are poor
_BAND_SAMPLES = 5_000


@checked
def identify(
    recordings: Recorded | Sequence[Recorded],
    robot: Robot | Solver | Path | str | None = None,
    *,
    hold_out: Sequence[Recorded] = (),
    blocks: int | None = None,
    known_payloads: Sequence[KnownPayload] = (),
    coupling: Sequence[float] = (),
    accept: Sequence[str] = (),
    progress: Progress = no_progress,
    **options: Unpack[RunOptions],
) -> Identification:
    """Identify a physically consistent model with friction from recordings of a moving arm.

    A tree is identified where the robot's tip names several links, or all ("*").
    Joints that stand still are held: the model is that of the others, in this posture.

    Parameters
    ----------
    recordings
        One, or several, as evaluate() takes them; each, or each block of one, is predicted by models of the others.
    robot
        As in evaluate(). Its description is the prior; its model, if it has one, is compared with. None: the
        description `urdf` alone, whose recorded efforts are torques unless effort_is says another meaning.
    hold_out
        Recordings to test the model on, for example of another day: nothing is fitted to them.
    blocks
        How many the recordings are cut into altogether, at least 3. By default whole recordings are held out
        where there are several, else BLOCKS, or fewer where they would be shorter than 2.5 s.
    known_payloads
        Further recordings of motor currents, each with a load as the parameters payload.* of solvers.
        They determine the drive gains.
    coupling
        Of n joints whose motors others turn too, the n rows of C, one after the other: motors have velocities
        `C qd`, and friction is theirs. By default of the matrix of `gears`, scaled to ones on its diagonal.
        Friction at further places and springs are fitted as the run configuration states them: `friction_at`,
        `fit_springs`.
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
    >>> from inverse_dynamics import identify, read_joint_log
    >>> from inverse_dynamics.demo.demo import stored_recording
    >>> log = read_joint_log(stored_recording("ur10_simulated"))
    >>> rough = replace(log, effort=log.effort + 5 * np.tanh(log.qd / 0.05))  # N m of friction
    >>> found = identify(rough, "ur10_simulated")
    >>> bool(found.held_out["urdf"].min() > 4), bool(found.held_out["identified"].max() < 0.1)  # N m
    (True, True)
    >>> found.solver().joint_names[2]
    'elbow_joint'
    """
    if isinstance(robot, Solver):
        _check_unloaded(robot)
    if robot is None:
        robot = replace(robot_of(None, options.get("urdf")), effort="torque", friction=False)
    robot, stated = overridden(robot, options), of_recording(options)
    check_accepted(accept)
    description = _description(robot)
    recordings = list(recordings) if isinstance(recordings, list | tuple) else [recordings]
    _check_given(recordings, [path for path, _ in known_payloads])
    described = _core.FastModel.from_urdf(
        description,
        root=robot.root,
        tip=robot.tip,
        gravity=robot.gravity,
        locked_joints=locked_joints(robot),
        motors=motors_of(robot),
    )
    joints = described.joint_names
    _check_springs(robot)
    motors, unfitted = coupling_of(coupling, robot.gears, len(joints))
    # Links are the description's, whatever model is compared with.
    links = replace(robot, model=None)
    first, topic = recordings[0], stated.get("topic")
    posture = posture_of(first, links, description, joints, topic=topic)
    robot = replace(robot, parameters={**robot.parameters, **posture.parameters})
    fitter = _core.ArmFitter.from_urdf(
        description,
        root=robot.root,
        tip=robot.tip,
        gravity=robot.gravity,
        locked_joints=locked_joints(robot),
        coupling=motors,
        friction_at=robot.friction_at,
        springs=robot.fit_springs,
        motors=motors_of(robot),
    )
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
    if len(evaluations) > 1:  # names for those without one
        evaluations = [
            replace(e, bag=Path(f"arrays {k}")) if e.bag == ARRAYS else e
            for k, e in enumerate(evaluations, 1)
        ]
    still = still_joints(evaluations)
    some = 0 < len(still.parameters) < len(joints)
    stated_of_all = len(coupling) or robot.gears or robot.friction_at or motors_of(robot)
    if some and not stated_of_all:
        others: dict[str, Any] = {
            "known_payloads": known_payloads,
            "accept": accept,
            "hold_out": hold_out,
        }
        moving = _without(robot, joints, still.parameters, description)
        found = None
        with suppress(BagError):
            found = identify(
                recordings, moving, blocks=blocks, progress=progress, **others, **stated
            )
        if found is None:  # of a table that numbers its columns: its samples as they were read
            logs = [e.log for e in evaluations]
            moving = replace(moving, columns="", scale=(), sign=(), rate=None)
            same: RunOptions = {"effort_is": stated.get("effort_is")}
            found = identify(logs, moving, blocks=blocks, progress=progress, **others, **same)
        own = robot.model is not None or robot.plugin != RIGID_BODY
        more = ("the result isn't compared with the present model, which has all joints",) * own
        return replace(found, notes=(*still.notes, *more, *found.notes))
    check_recordings(evaluations, accept)
    robot = evaluations[0].robot
    _check_gravity(evaluations)
    plain = replace(robot, plugin=RIGID_BODY, model=None)
    evaluations = [replace(e, measured=torques_with_gravity(e, plain)) for e in evaluations]
    by_day = len(evaluations) > 1 and blocks is None
    groups = _days(evaluations) if by_day else _groups(evaluations, blocks)
    moved = _core.RobotDescription(description).chain(fitter.link_joints, robot.root)
    solvers = baselines(robot, description)
    limits = _effort_limits(moved, joints) if by_day else None
    chosen = choose(fitter, [block for group in groups for block in group])
    held_out = _held_out(fitter, described, limits, solvers, groups, chosen.delays, progress)
    found = _result(fitter, described, moved, evaluations, groups, chosen, held_out, by_day=by_day)
    notes = tuple(dict.fromkeys((*posture.notes, *unfitted, *found.notes)))
    found = replace(found, drive_gains=gains, notes=notes)
    check_result(found, accept)
    how: RunOptions = {"effort_is": stated.get("effort_is"), "topic": topic}
    tests = (held_out_errors(found, test, progress=progress, **how) for test in hold_out)
    return replace(found, hold_out=tuple(tests))


def _without(
    robot: Robot, joints: Sequence[str], held: Mapping[str, Parameter], description: str
) -> Robot:
    """The robot's description with joints of the chain held, and what is stated of each of the others."""
    moves = [f"{LOCKED}{joint}" not in held for joint in joints]
    load = {name: at for name, at in robot.parameters.items() if name.startswith("payload.")}
    parameters = robot.parameters if robot.plugin == RIGID_BODY and not robot.model else load
    return replace(
        robot,
        plugin=RIGID_BODY,
        model=None,
        parameters={**parameters, **held},
        tip=_moved_tips(robot.tip, _core.RobotDescription(description), held),
        joints=tuple(compress(robot.joints, moves)),
        drive_gains=tuple(compress(robot.drive_gains, moves)),
        sign=tuple(compress(robot.sign, moves)),
    )


def _moved_tips(tip: str, robot: RobotDescription, held: Mapping[str, Parameter]) -> str:
    """Those of several tips that a joint still moves."""
    above = {joint.child: joint for joint in robot.joints}
    if "," not in tip or tip in above:
        return tip
    moved = []
    for name in tip.split(","):
        link = name.strip()
        while link in above:
            joint = above[link]
            if joint.type != "fixed" and f"{LOCKED}{joint.name}" not in held:
                moved.append(name.strip())
                break
            link = joint.parent
    return ",".join(moved)


def _description(robot: Robot) -> str:
    if robot.urdf is None:
        raise IdentificationError(
            f"robot {robot.name}: urdf: expected a description, which a fit starts from, got none; "
            "give --urdf"
        )
    return read_description(robot.urdf)


def _check_springs(robot: Robot) -> None:
    """A fit has no torque of known springs."""
    known = sorted({key.split(".")[1] for key in robot.parameters if key.startswith("springs.")})
    if known:
        raise IdentificationError(
            f"robot {robot.name}: parameters: expected no springs, which a fit doesn't know, got some of "
            f"{listed(known)}; leave them out, and let the fit find them: fit_springs: {{{known[0]}: linear}}"
        )


def _check_unloaded(solver: Solver) -> None:
    """What a solver carries isn't in its description, from which the model starts."""
    with suppress(SolverError):  # of one that can't carry any
        if carried := [*solver.payloads]:
            raise IdentificationError(
                f"robot: expected a Solver that carries nothing, as the model starts from the description, got one "
                f"with {listed(carried)}; fix the body to the last link of the description, or take it off: "
                "clear_payloads()"
            )


def _check_given(recordings: Sequence[Recorded], others: Sequence[Recorded]) -> None:
    """Of a recording that is given twice, a part would be predicted by a fit to itself."""
    if not recordings:
        raise IdentificationError("recordings: expected at least one, got none")
    given = [one for one in (*recordings, *others) if isinstance(one, Path | str)]
    resolved = [Path(recording).resolve() for recording in given]
    for recording, path in zip(given, resolved, strict=True):
        if resolved.count(path) > 1:
            raise IdentificationError(f"{recording}: expected each recording once, got it twice")
    in_memory = [id(one) for one in (*recordings, *others) if not isinstance(one, Path | str)]
    if len({*in_memory}) < len(in_memory):
        raise IdentificationError(f"{ARRAYS}: expected each recording once, got it twice")


def _check_gravity(evaluations: Sequence[Evaluation]) -> None:
    """Gravity that efforts lack is that of the description, which must have masses."""
    for evaluation in evaluations:
        guess = guess_of(evaluation.robot.urdf)
        if guess and evaluation.effort.meaning == "torque_without_gravity":
            raise IdentificationError(
                f"{evaluation.bag}: efforts lack gravity, and the gravity that the robot subtracts isn't known: "
                f"{guess.partition(':')[0]}; give --urdf with masses, or record torques with gravity",
                "Gravity is subtracted from the efforts",
            )


def _days(evaluations: Sequence[Evaluation]) -> list[list[Block]]:
    """Whole recordings, in groups that are held out together.

    They may be of different days, and differ as blocks of one day don't.
    """
    whole = [block for evaluation in evaluations for block in blocks_of(evaluation, 1)]
    edges = np.linspace(0, len(whole), min(len(whole), BLOCKS) + 1).round().astype(int)
    return [whole[first:after] for first, after in pairwise(edges.tolist())]


def _groups(evaluations: Sequence[Evaluation], asked: int | None) -> list[list[Block]]:
    """Blocks, each held out by itself: as many of each recording as its share of the time, at least one."""
    lengths = np.array([e.time[-1] for e in evaluations])
    if asked is None:
        asked = int(np.clip(lengths.sum() // _SHORTEST_BLOCK, _FEWEST_BLOCKS, BLOCKS))
    elif asked < _FEWEST_BLOCKS:
        raise IdentificationError(f"blocks: expected at least {_FEWEST_BLOCKS}, got {asked}")
    counts = np.maximum(1, np.round(asked * lengths / lengths.sum())).astype(int)
    while counts.sum() < _FEWEST_BLOCKS:
        counts[lengths.argmax()] += 1
    pairs = zip(evaluations, counts.tolist(), strict=True)
    return [[block] for evaluation, count in pairs for block in blocks_of(evaluation, count)]


def _effort_limits(moved: Sequence[DescribedJoint], joints: Sequence[str]) -> Floats:
    """(n,) N m (prismatic N); infinite where none is stated. moved: the joints of all links."""
    stated = {joint.name: joint.limits.get("effort", np.inf) for joint in moved}
    return np.array([stated.get(joint, np.inf) for joint in joints])  # of motors none is stated


def _held_out(
    fitter: ArmFitter,
    described: FastModel,
    limits: Floats | None,
    solvers: Mapping[str, Solver],
    groups: Sequence[Sequence[Block]],
    delays: Mapping[str, float],
    progress: Progress,
) -> list[HeldOutBlock]:
    """The blocks of each group, predicted by models fitted to, and chosen on, the others.

    delays: of each law [s], found on all blocks, as they belong to the recording.
    """
    found = []
    present = solvers.get("present")
    computed = [
        [(q, qd, present.torques(q, qd, qdd), tau) for q, qd, qdd, tau in (b.fitted for b in group)]
        if present is not None
        else []
        for group in groups
    ]
    for k, group in enumerate(groups):
        progress("predicting held-out blocks", k, len(groups) + 1)
        others = [block for other in (*groups[:k], *groups[k + 1 :]) for block in other]
        fitted = [rows for other in (*computed[:k], *computed[k + 1 :]) for rows in other]
        chosen = choose(fitter, others, delays)
        # errors are correlated in time: some samples suffice for the band
        step = 1 + sum(map(len, others)) // _BAND_SAMPLES
        some = [block.later(0.0, step) for block in chosen.blocks]
        known = knowledge(fitter, chosen.fit, some, chosen.options)
        factor = factor_of(fitter, chosen.fit, some, known, law=chosen.law)
        band = band_of(fitter, chosen, factor, others, limits)
        solver = solver_of_model(described.identified(_model(fitter, chosen, others, None)))
        for block in group:
            motion = block.q, block.qd, block.qdd
            torques = baseline_torques(solvers, motion, fitted)
            torques["identified"] = fitter.torques(chosen.fit, *motion, before=block.before)
            found.append(
                HeldOutBlock(
                    recording=block.recording,
                    time=block.time,
                    q=block.q,
                    qd=block.qd,
                    counts=block.counts,
                    measured=block.tau,
                    computed=torques,
                    band=band.half_widths(solver, *motion),
                    law=chosen.law,
                    prior_strength=chosen.prior_strength,
                    delay=chosen.delay,
                )
            )
    progress("predicting held-out blocks", len(groups), len(groups) + 1)
    return found


def _model(
    fitter: ArmFitter, chosen: Chosen, blocks: Sequence[Block], drive_gains: Floats | None
) -> IdentifiedModel:
    samples = zip(*(block.fitted for block in blocks), strict=True)
    q, qd, qdd, _ = (np.concatenate(values) for values in samples)
    return IdentifiedModel(
        parameters=chosen.fit.parameters,
        rotor_inertia=chosen.fit.rotor_inertia,
        friction=tuple(chosen.fit.friction[: len(fitter.joint_names)]),
        drive_gains=drive_gains,
        torque_deviation=chosen.band,
        seen=np.array([np.stack([x.min(0), x.max(0)], axis=1) for x in (q, qd, qdd)]),
        coupling=fitter.coupling,
        friction_at=dict(
            zip(fitter.friction_places, chosen.fit.friction[len(fitter.joint_names) :], strict=True)
        ),
        springs=_springs(fitter, chosen),
    )


def _springs(fitter: ArmFitter, chosen: Chosen) -> Floats | None:
    """Of an IdentifiedModel."""
    if chosen.fit.springs is None:
        return None
    kinds = np.array(fitter.springs)[:, None]
    linear = np.where(kinds == 1, chosen.fit.springs[:, :1], 0.0)
    return np.hstack([linear, np.where(kinds == 2, chosen.fit.springs, 0.0)])


def _result(
    fitter: ArmFitter,
    described: FastModel,
    moved: Sequence[DescribedJoint],
    evaluations: Sequence[Evaluation],
    groups: Sequence[Sequence[Block]],
    chosen: Chosen,
    held_out: Sequence[HeldOutBlock],
    *,
    by_day: bool,
) -> Identification:
    """The model of all blocks, and what the data tell of it."""
    first, links = evaluations[0], tuple(joint.child for joint in moved)
    blocks = [block for group in groups for block in group]
    later = chosen.blocks
    errors = [errors_of(fitter, chosen.fit, block) for block in later]
    independent, samples = independent_samples(errors), sum(map(len, errors))
    known = knowledge(fitter, chosen.fit, later, chosen.options)
    gravity: tuple[Finding, ...] = ()
    if any(e.effort.meaning == "torque_without_gravity" for e in evaluations):
        weights = weights_of_links(described, fitter.prior, later)
        known = replace(known, assumed=assumed(fitter, chosen.fit, later, chosen.options, weights))
        gravity = (gravity_finding(first.robot, weights, first.units),)
    factor = factor_of(fitter, chosen.fit, later, known, law=chosen.law)
    currents = first.effort.meaning == "current"
    gains = np.array(first.effort.drive_gains) if currents else None
    model = _model(fitter, chosen, blocks, gains)
    levels: tuple[Level, ...] = ()
    if by_day:
        solver = solver_of_model(described.identified(model))
        recordings = dict.fromkeys(block.recording for block in held_out)
        levels = tuple(level_of(recording, held_out, solver) for recording in recordings)
    measured, band = valid_samples(held_out, "measured", "band")
    unseen = {c: measured - valid_samples(held_out, c)[0] for c in held_out[0].computed}
    rmse = {column: np.sqrt((error**2).mean(0)) for column, error in unseen.items()}
    delays = np.array([block.delay for block in held_out])
    return Identification(
        robot=first.robot,
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
        held_out=rmse,
        coverage=(np.abs(unseen["identified"]) <= band).mean(0),
        blocks=tuple(held_out),
        noise=np.sqrt((np.concatenate(errors) ** 2).mean(0)),
        independent=independent,
        choices=chosen.choices,
        intervals=intervals(known, described, first.units),
        prior_decided=prior_decided(known, float(independent.mean() / samples), links),
        factor=factor,
        band=with_levels(
            band_of(fitter, chosen, factor, blocks, _effort_limits(moved, fitter.joint_names)),
            levels,
        ),
        levels=levels,
        sketch=tuple(x for e in evaluations for x in sketch_of(e.log)),
        findings=(
            *gravity,
            *findings_of_errors(fitter, links, rmse, first.units),
            *motion_findings(fitter, chosen.delay, delays, later, independent),
        ),
        # but for the cause of the present model's errors, which the fit removes
        notes=tuple(note for e in evaluations for note in e.notes),
    )

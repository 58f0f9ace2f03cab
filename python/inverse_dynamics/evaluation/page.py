# SPDX-License-Identifier: Apache-2.0
"""An evaluation as the report's page wants it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics.evaluation.evaluation import CAUSE
from inverse_dynamics.show.page import ReportRun, bands_of
from inverse_dynamics.show.scene import Scene, read_scene
from inverse_dynamics.show.tables import joint_table

if TYPE_CHECKING:
    from inverse_dynamics.evaluation.evaluation import Evaluation
    from inverse_dynamics.robots.robots import Robot


def report_run(evaluation: Evaluation, title: str = "") -> ReportRun:
    """An evaluation for the page; `title` replaces the robot's name."""
    evaluation = evaluation.explained
    robot, log = evaluation.robot, evaluation.log
    scene = Scene() if robot.urdf is None else read_scene(robot.urdf, evaluation.joint_names)
    left_out, kept = evaluation.samples.left_out, evaluation.errors_of_kept
    causes = [note for note in evaluation.notes if note.startswith(CAUSE)]
    return ReportRun(
        title=title or robot.name,
        description=robot.description,
        solver=robot.plugin,
        time=evaluation.time,
        q=log.q,
        measured=evaluation.measured,
        computed=evaluation.computed,
        table=evaluation.errors,
        tables=[joint_table(f"The same without {left_out} invalid samples (shaded)", kept)]
        if left_out
        else [],
        recording=", ".join(
            filter(
                None, (evaluation.bag.name, log.topic, f"{len(log)} samples, {log.duration:.1f} s")
            )
        ),
        assumptions=assumptions(evaluation),
        cause=causes[-1].removeprefix(CAUSE) if causes else "",
        notes=[note for note in evaluation.notes if not note.startswith(CAUSE)],
        links=scene.links,
        scene_notes=scene.notes,
        left_out=evaluation.samples.left_out_spans(evaluation.log),
        bands=[] if evaluation.band is None else bands_of(evaluation.time, evaluation.band),
    )


def assumptions(evaluation: Evaluation) -> list[tuple[str, str]]:
    """What computed torques, their accelerations and measured torques rest on."""
    robot = evaluation.robot
    gravity = (
        "the model's own"
        if robot.gravity is None
        else "{:g}, {:g}, {:g} m/s²".format(*robot.gravity)
    )
    rows = [
        *model_facts(robot),
        ("gravity", gravity),
        ("effort means", evaluation.effort.summary),
        ("accelerations", evaluation.accelerations.summary),
        ("source", robot.source),
    ]
    return [(name, text) for name, text in rows if text]


def model_facts(robot: Robot) -> list[tuple[str, str]]:
    """What computes the torques of a robot; "" for what there isn't."""
    return [
        ("solver", robot.plugin),
        ("model file", robot.model.name if robot.model else ""),
        ("description", robot.urdf.name if robot.urdf else ""),
        ("friction", "as the solver models it" if robot.friction else "left out"),
    ]

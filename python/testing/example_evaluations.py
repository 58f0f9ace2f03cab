# SPDX-License-Identifier: Apache-2.0
"""Evaluations and summaries as evaluate() gives them, without a solver."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from example_recordings import joint_log

from inverse_dynamics._core import Accelerations, Effort
from inverse_dynamics.evaluation.evaluation import Evaluation, joint_errors
from inverse_dynamics.evaluation.many_evaluations import summary_of
from inverse_dynamics.evaluation.samples import SampleReport
from inverse_dynamics.recordings.time_window import TimeWindow
from inverse_dynamics.robots.robots import Robot


def make_evaluation(
    samples: int = 400, joints: int = 3, effort: Effort | None = None
) -> Evaluation:
    """An evaluation as evaluate() gives it, without a solver."""
    log = joint_log(samples, joints, frame_id="base")
    computed = log.effort + 0.5 * np.cos(np.arange(samples))[:, None]
    units = ("N m",) * joints
    kept = np.arange(samples) >= 5
    no = np.zeros(samples, dtype=bool)
    names = log.joint_names
    return Evaluation(
        robot=Robot(
            name="arm",
            description="Arm [of a test]",
            file=Path("arm.yaml"),
            plugin="a/B",
            urdf=Path("arm.urdf"),
            gravity=(0.0, 0.0, -9.81),
            joints=names,
        ),
        bag=Path("recording"),
        log=log,
        joint_names=names,
        units=units,
        accelerations=Accelerations(
            "low-pass", cutoff=3.25, chosen=True, order=2, time_base="regular"
        ),
        samples=SampleReport(no, no, ~kept, no, kept, 0.01, 0.0),
        time=log.time,
        qdd=np.sin(log.q),
        measured=(effort or Effort()).torques(log.effort),
        computed=computed,
        errors=joint_errors(names, units, computed, log.effort),
        errors_of_kept=joint_errors(names, units, computed, log.effort, kept),
        effort=effort or Effort(),
        notes=("the first 5 of 400 samples are a start transient: efforts jump",),
    )


def summary(name, factor=1.0, **changes):
    """A summary whose errors are a multiple of the others'."""
    one = summary_of(make_evaluation(samples=60), name, TimeWindow())
    errors = tuple(replace(error, rmse=factor * error.rmse) for error in one.errors)
    return replace(one, errors=errors, **changes)

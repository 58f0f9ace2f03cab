# SPDX-License-Identifier: Apache-2.0
"""Friction that the model lacks, and hands that guide the arm: friction of the wrong sign."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from inverse_dynamics.evaluation.causes.rival import Rival, Told

if TYPE_CHECKING:
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting

FRICTION = Told(
    "friction",
    "Friction",
    "the error is mostly friction and offset, which the model lacks",
    "take a model with friction, or make one: ids identify RECORDING --robot NAME --out arm.yaml, or "
    "with --urdf FILE instead of --robot NAME",
)
_GUIDED = Told(
    "guided",
    "Somebody guides the arm",
    "measured minus computed torques are against the motion in every joint: somebody guides the arm by hand",
    "record a motion in which nobody touches the arm",
    gain=1.3,  # hands don't push evenly
)


def nothing(view: View) -> Rival:
    """No mistake, but friction."""
    return Rival("friction", view.computed, view.qd, lambda *_: FRICTION)


def rivals(view: View, _: Fitting) -> Iterator[Rival]:
    """Torques that act with the motion in all joints."""
    yield Rival("guided", view.computed, -view.qd, lambda *_: _GUIDED)

# SPDX-License-Identifier: Apache-2.0
"""Errors of simulations."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from inverse_dynamics.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_DESCRIPTION = "robot description"


class SimulationError(UserError):
    """A robot that can't be simulated, or an option out of range."""


class TrajectoryError(UserError):
    """A trajectory that can't be read, or one that the robot can't follow."""


@contextmanager
def described_by(file: Path) -> Iterator[None]:
    """Errors of a robot description name its file."""
    try:
        yield
    except SimulationError as error:
        text = str(error)
        if not text.startswith(_DESCRIPTION):
            raise
        raise SimulationError(f"{file}{text.removeprefix(_DESCRIPTION)}") from error

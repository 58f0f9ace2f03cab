# SPDX-License-Identifier: Apache-2.0
"""Where friction acts: at motors that other joints turn too, whose velocities are `C qd`, and beside the joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.identification.result import IdentificationError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from inverse_dynamics.arrays import Floats


def coupling_of(
    stated: Sequence[float], gears: Sequence[float], joints: int
) -> tuple[Floats | None, tuple[str, ...]]:
    """Velocities of motors by those of joints, (n, n), None: friction is of joints; notes."""
    if stated and len(stated) != joints**2:
        raise IdentificationError(
            f"coupling: expected the {joints**2} numbers of a matrix, got {len(stated)}"
        )
    numbers = stated or gears
    if len(numbers) != joints**2:
        return None, ()  # ratios, or nothing
    rows = np.reshape(np.array(numbers, dtype=float), (joints, joints))
    if not stated and np.triu(rows, 1).any():
        return None, (
            "gears above the diagonal: friction is fitted to joints, not to shared motors",
        )
    _check_coupling(rows, "coupling" if stated else "gears")
    found: Floats = rows / np.diag(rows)[:, None]
    return (None if np.array_equal(found, np.eye(joints)) else found), ()


def _check_coupling(rows: Floats, option: str) -> None:
    for row, numbers in enumerate(rows):
        for column, value in enumerate(numbers):
            name = f"{option}: row {row + 1}, number {column + 1}"
            if column == row and (value == 0 or not np.isfinite(value)):
                raise IdentificationError(
                    f"{name}: expected a finite number other than 0 on the diagonal, got {value:g}; "
                    "give 1 for a motor that turns with its joint alone"
                )
            if column < row and not np.isfinite(value):
                raise IdentificationError(
                    f"{name}: expected a finite number, got {value:g}; give 0 for motors that aren't coupled"
                )
            if column > row and value != 0:
                raise IdentificationError(
                    f"{name}: expected 0 above the diagonal, got {value:g}; "
                    "motors may turn with joints before theirs only"
                )

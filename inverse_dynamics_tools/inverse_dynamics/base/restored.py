# SPDX-License-Identifier: Apache-2.0
"""Objects of C++ made again, with what was set on them since: how pickle and copy make a solver."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver
    from inverse_dynamics.base.arrays import Floats


def restored_solver(
    made: type[Solver],
    arguments: tuple[Any, ...],
    payloads: dict[str, dict[str, Any]],
    gravity: Floats,
    base_acceleration: Floats,
) -> Solver:
    """A solver of these arguments, with these bodies and this gravity."""
    solver = made(*arguments)
    solver.clear_payloads()
    for name, body in payloads.items():
        solver.set_payload(name, **body)
    solver.set_gravity(gravity)
    solver.set_base_acceleration(base_acceleration)
    return solver

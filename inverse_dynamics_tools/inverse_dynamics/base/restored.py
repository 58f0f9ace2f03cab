# SPDX-License-Identifier: Apache-2.0
"""Objects of C++ made again, with what was set on them since: how pickle and copy make a solver."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver


def restored_solver(
    made: type[Solver],
    plugin: str,
    urdf: str,
    parameters: dict[str, Any],
    since: dict[str, Any],
) -> Solver:
    """A solver of these arguments, with the bodies and the gravity that it had; empty: it can't have any."""
    solver = made(plugin, urdf, parameters=parameters)
    if since:
        solver.clear_payloads()
        for name, body in since["payloads"].items():
            solver.set_payload(name, **body)
        solver.set_gravity(since["gravity"])
        solver.set_base_acceleration(since["base_acceleration"])
    return solver

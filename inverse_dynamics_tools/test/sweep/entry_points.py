# SPDX-License-Identifier: Apache-2.0
"""The ways in: Python's Solver, a C++ program with SolverLoader, the command `ids`.

Each gives the torques of the same states, so that two readings of a robot can be compared.
"""

from __future__ import annotations

import os
import re
import subprocess
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from outcome import Outcome

from inverse_dynamics import Solver, available_solvers, cli
from inverse_dynamics.errors import UserError

RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"
KDL = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL"
PINOCCHIO = "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio"
UR10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"
FRANKA = "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria"

STATES = 3
_NOTE = re.compile(r"^(?:note|warning|ids: warning:)\s+(.*)$")


def installed(*plugins: str) -> tuple[str, ...]:
    """Those of the plugins that there are."""
    return tuple(plugin for plugin in plugins if plugin in available_solvers())


def motion(joints: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, qd, qdd, (STATES, joints) each: the same numbers as test/sweep/torques_of.cpp."""
    k = np.arange(STATES * joints, dtype=float).reshape(STATES, joints)
    return np.sin(1.0 + k), np.cos(2.0 + k), np.sin(3.0 * k)


def python(plugin: str, **arguments: Any) -> Outcome:
    """`Solver(plugin, ...)` and the torques of motion()."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            solver = Solver(plugin, **arguments)
            torques = solver.torques(*motion(len(solver.joint_names)))
    except UserError as error:
        return Outcome("refused", str(error))
    said = (*solver.warnings, *(str(one.message) for one in caught))
    return Outcome("accepted", "", said, tuple(torques.ravel()))


def cpp(plugin: str, urdf: str = "", parameters: str = "{}") -> Outcome:
    """The same of a C++ program: see torques_of.cpp. parameters: YAML."""
    program = os.environ["TORQUES_OF"]
    done = subprocess.run([program, plugin, urdf, parameters], capture_output=True, check=False)
    lines = done.stdout.decode(errors="replace").splitlines()
    said = tuple(line[len("warning ") :] for line in lines if line.startswith("warning "))
    if done.returncode == 0:
        numbers = [float(line.split()[1]) for line in lines if line.startswith("torque ")]
        return Outcome("accepted", "", said, tuple(numbers))
    text = done.stderr.decode(errors="replace").removesuffix("\n")
    if done.returncode == 2:
        return Outcome("refused", text)
    return Outcome("failed", f"exit code {done.returncode}: {text}")


def ids(*arguments: str | Path, capture: Path) -> Outcome:
    """A command line. capture: a directory for what it prints."""
    said, errors = capture / "stdout", capture / "stderr"
    with said.open("wb") as out, errors.open("wb") as err:
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        try:
            code: Any = cli.main([str(argument) for argument in arguments])
        except SystemExit as stop:
            code = stop.code
    text = errors.read_text(errors="replace").removesuffix("\n")
    if code == 0:
        lines = (said.read_text(errors="replace") + "\n" + text).splitlines()
        notes = [found.group(1) for found in map(_NOTE.match, lines) if found]
        return Outcome("accepted", "", tuple(notes))
    return Outcome("refused" if code == 2 else "failed", f"exit code {code}: {text}")

# SPDX-License-Identifier: Apache-2.0
"""Inverse dynamics of robot arms: which joint torques belong to this motion?

    import inverse_dynamics as ids

    solver = ids.Solver("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL", urdf=text)
    tau = solver.torques(q, qd, qdd)               # (n,) or (N, n), one state per row

    result = ids.evaluate("recording", "ur10_real")
    print(result.mean_rmse)

Names are imported when they are first used: `import inverse_dynamics` takes no time.
`__version__` is the version of the installed package.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    __version__: str

    from inverse_dynamics._core import FastModel, Solver, available_solvers
    from inverse_dynamics.data.bags import read_joint_log, read_topics, write_joint_logs
    from inverse_dynamics.data.joint_log import JointLog
    from inverse_dynamics.data.public_recordings import fetch_recordings
    from inverse_dynamics.data.recordings import read_recording
    from inverse_dynamics.errors import UserError
    from inverse_dynamics.evaluation.evaluation import Evaluation, JointError, evaluate
    from inverse_dynamics.evaluation.trajectory_torques import TrajectoryTorques, trajectory_torques
    from inverse_dynamics.figures.plots import save_torque_figure, torque_figure
    from inverse_dynamics.identification.identify import identify
    from inverse_dynamics.identification.result import Identification
    from inverse_dynamics.results.evaluations import read_evaluation, write_evaluation
    from inverse_dynamics.results.excitations import ExcitationResult, excite, write_excitation
    from inverse_dynamics.results.exports import export_series
    from inverse_dynamics.results.many_evaluations import ManyEvaluations, evaluate_many
    from inverse_dynamics.results.trajectory_torques import write_trajectory_torques
    from inverse_dynamics.robot.robots import Robot, load_robot, robot_names

_HOME = {
    "Evaluation": "evaluation.evaluation",
    "ExcitationResult": "results.excitations",
    "FastModel": "_core",
    "Identification": "identification.result",
    "JointError": "evaluation.evaluation",
    "JointLog": "data.joint_log",
    "ManyEvaluations": "results.many_evaluations",
    "Robot": "robot.robots",
    "Solver": "_core",
    "TrajectoryTorques": "evaluation.trajectory_torques",
    "UserError": "errors",
    "available_solvers": "_core",
    "evaluate": "evaluation.evaluation",
    "evaluate_many": "results.many_evaluations",
    "excite": "results.excitations",
    "export_series": "results.exports",
    "fetch_recordings": "data.public_recordings",
    "identify": "identification.identify",
    "load_robot": "robot.robots",
    "read_evaluation": "results.evaluations",
    "read_joint_log": "data.bags",
    "read_recording": "data.recordings",
    "read_topics": "data.bags",
    "robot_names": "robot.robots",
    "save_torque_figure": "figures.plots",
    "torque_figure": "figures.plots",
    "trajectory_torques": "evaluation.trajectory_torques",
    "write_evaluation": "results.evaluations",
    "write_excitation": "results.excitations",
    "write_joint_logs": "data.bags",
    "write_trajectory_torques": "results.trajectory_torques",
}

__all__ = [
    "Evaluation",
    "ExcitationResult",
    "FastModel",
    "Identification",
    "JointError",
    "JointLog",
    "ManyEvaluations",
    "Robot",
    "Solver",
    "TrajectoryTorques",
    "UserError",
    "available_solvers",
    "evaluate",
    "evaluate_many",
    "excite",
    "export_series",
    "fetch_recordings",
    "identify",
    "load_robot",
    "read_evaluation",
    "read_joint_log",
    "read_recording",
    "read_topics",
    "robot_names",
    "save_torque_figure",
    "torque_figure",
    "trajectory_torques",
    "write_evaluation",
    "write_excitation",
    "write_joint_logs",
    "write_trajectory_torques",
]


def __getattr__(name: str) -> object:
    if name == "__version__":
        return _version()
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def _version() -> str:
    from inverse_dynamics.base.version import version
    from inverse_dynamics.errors import UserError

    try:
        return version()
    except UserError as error:
        raise AttributeError(str(error)) from None


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__, "__version__"])

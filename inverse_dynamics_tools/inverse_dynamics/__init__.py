# SPDX-License-Identifier: Apache-2.0
"""Inverse dynamics of robot arms: which joint torques belong to this motion?

    import inverse_dynamics as ids

    solver = ids.Solver("kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL", urdf=text)
    tau = solver.torques(q, qd, qdd)               # (n,) or (N, n), one state a row

    result = ids.evaluate("recording", "ur10_real")
    print(result.mean_rmse)

Names are imported when they are first used: `import inverse_dynamics` takes no time.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inverse_dynamics._core import Solver, available_solvers
    from inverse_dynamics.bags import read_joint_log, read_topics, write_joint_logs
    from inverse_dynamics.errors import UserError
    from inverse_dynamics.evaluation import Evaluation, JointError, evaluate
    from inverse_dynamics.exports import export_series
    from inverse_dynamics.feed_forward import TrajectoryTorques, trajectory_torques
    from inverse_dynamics.feed_forward_files import write_trajectory_torques
    from inverse_dynamics.joint_log import JointLog
    from inverse_dynamics.plots import save_torque_figure, torque_figure
    from inverse_dynamics.public_recordings import fetch_recordings
    from inverse_dynamics.recordings import read_recording
    from inverse_dynamics.results import read_evaluation, write_evaluation
    from inverse_dynamics.robots import Robot, load_robot, robot_names

_HOME = {
    "Evaluation": "evaluation",
    "JointError": "evaluation",
    "JointLog": "joint_log",
    "Robot": "robots",
    "Solver": "_core",
    "TrajectoryTorques": "feed_forward",
    "UserError": "errors",
    "available_solvers": "_core",
    "evaluate": "evaluation",
    "export_series": "exports",
    "fetch_recordings": "public_recordings",
    "load_robot": "robots",
    "read_evaluation": "results",
    "read_joint_log": "bags",
    "read_recording": "recordings",
    "read_topics": "bags",
    "robot_names": "robots",
    "save_torque_figure": "plots",
    "torque_figure": "plots",
    "trajectory_torques": "feed_forward",
    "write_evaluation": "results",
    "write_joint_logs": "bags",
    "write_trajectory_torques": "feed_forward_files",
}

__all__ = [
    "Evaluation",
    "JointError",
    "JointLog",
    "Robot",
    "Solver",
    "TrajectoryTorques",
    "UserError",
    "available_solvers",
    "evaluate",
    "export_series",
    "fetch_recordings",
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
    "write_joint_logs",
    "write_trajectory_torques",
]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])

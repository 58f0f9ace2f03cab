# SPDX-License-Identifier: Apache-2.0
"""Inverse dynamics of robot arms: which joint torques belong to this motion?

    import inverse_dynamics as ids

    solver = ids.Solver(urdf="arm.urdf")
    tau = solver.torques(q, qd, qdd)  # (n,) or (N, n), one state per row

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

    from inverse_dynamics._core import FastModel as FastModel
    from inverse_dynamics._core import JointPath as JointPath
    from inverse_dynamics._core import MotionLimits as MotionLimits
    from inverse_dynamics._core import Solver as Solver
    from inverse_dynamics._core import available_solvers as available_solvers
    from inverse_dynamics.data.bags import read_joint_log as read_joint_log
    from inverse_dynamics.data.bags import read_topics as read_topics
    from inverse_dynamics.data.bags import write_joint_logs as write_joint_logs
    from inverse_dynamics.data.joint_log import JointLog as JointLog
    from inverse_dynamics.data.public_recordings import fetch_recordings as fetch_recordings
    from inverse_dynamics.data.recordings import read_recording as read_recording
    from inverse_dynamics.errors import UserError as UserError
    from inverse_dynamics.evaluation.evaluation import Evaluation as Evaluation
    from inverse_dynamics.evaluation.evaluation import JointError as JointError
    from inverse_dynamics.evaluation.evaluation import evaluate as evaluate
    from inverse_dynamics.evaluation.retiming import Retimed as Retimed
    from inverse_dynamics.evaluation.retiming import retime as retime
    from inverse_dynamics.evaluation.trajectory_torques import (
        TrajectoryTorques as TrajectoryTorques,
    )
    from inverse_dynamics.evaluation.trajectory_torques import (
        trajectory_torques as trajectory_torques,
    )
    from inverse_dynamics.figures.plots import save_torque_figure as save_torque_figure
    from inverse_dynamics.figures.plots import torque_figure as torque_figure
    from inverse_dynamics.identification.identify import identify as identify
    from inverse_dynamics.identification.result import Identification as Identification
    from inverse_dynamics.results.evaluations import read_evaluation as read_evaluation
    from inverse_dynamics.results.evaluations import write_evaluation as write_evaluation
    from inverse_dynamics.results.excitations import ExcitationResult as ExcitationResult
    from inverse_dynamics.results.excitations import excite as excite
    from inverse_dynamics.results.excitations import write_excitation as write_excitation
    from inverse_dynamics.results.exports import export_series as export_series
    from inverse_dynamics.results.many_evaluations import ManyEvaluations as ManyEvaluations
    from inverse_dynamics.results.many_evaluations import evaluate_many as evaluate_many
    from inverse_dynamics.results.retimed import write_retimed as write_retimed
    from inverse_dynamics.results.trajectory_torques import (
        write_trajectory_torques as write_trajectory_torques,
    )
    from inverse_dynamics.robot.robots import Robot as Robot
    from inverse_dynamics.robot.robots import load_robot as load_robot
    from inverse_dynamics.robot.robots import robot_names as robot_names

_MODULES = {  # and the names that users know
    "_core": ("FastModel", "JointPath", "MotionLimits", "Solver", "available_solvers"),
    "data.bags": ("read_joint_log", "read_topics", "write_joint_logs"),
    "data.joint_log": ("JointLog",),
    "data.public_recordings": ("fetch_recordings",),
    "data.recordings": ("read_recording",),
    "errors": ("UserError",),
    "evaluation.evaluation": ("Evaluation", "JointError", "evaluate"),
    "evaluation.retiming": ("Retimed", "retime"),
    "evaluation.trajectory_torques": ("TrajectoryTorques", "trajectory_torques"),
    "figures.plots": ("save_torque_figure", "torque_figure"),
    "identification.identify": ("identify",),
    "identification.result": ("Identification",),
    "results.evaluations": ("read_evaluation", "write_evaluation"),
    "results.excitations": ("ExcitationResult", "excite", "write_excitation"),
    "results.exports": ("export_series",),
    "results.many_evaluations": ("ManyEvaluations", "evaluate_many"),
    "results.retimed": ("write_retimed",),
    "results.trajectory_torques": ("write_trajectory_torques",),
    "robot.robots": ("Robot", "load_robot", "robot_names"),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    if name == "__version__":
        return import_module("inverse_dynamics.base.version").version()
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])

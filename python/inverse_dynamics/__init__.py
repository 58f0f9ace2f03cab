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
    from inverse_dynamics._core import RetimeOptions as RetimeOptions
    from inverse_dynamics._core import Solver as Solver
    from inverse_dynamics._core import available_solvers as available_solvers
    from inverse_dynamics.comparison.comparison import Comparison as Comparison
    from inverse_dynamics.comparison.comparison import compare as compare
    from inverse_dynamics.contacts.contacts import Contacts as Contacts
    from inverse_dynamics.contacts.contacts import find_contacts as find_contacts
    from inverse_dynamics.diagnosis.diagnose import diagnose as diagnose
    from inverse_dynamics.errors import UserError as UserError
    from inverse_dynamics.evaluation.evaluation import Evaluation as Evaluation
    from inverse_dynamics.evaluation.evaluation import JointError as JointError
    from inverse_dynamics.evaluation.evaluation import evaluate as evaluate
    from inverse_dynamics.evaluation.evaluation import evaluate_run as evaluate_run
    from inverse_dynamics.evaluation.evaluation import write_evaluation as write_evaluation
    from inverse_dynamics.evaluation.exports import export_series as export_series
    from inverse_dynamics.evaluation.figure import save_torque_figure as save_torque_figure
    from inverse_dynamics.evaluation.figure import torque_figure as torque_figure
    from inverse_dynamics.evaluation.files import read_evaluation as read_evaluation
    from inverse_dynamics.evaluation.many_evaluations import ManyEvaluations as ManyEvaluations
    from inverse_dynamics.evaluation.many_evaluations import evaluate_many as evaluate_many
    from inverse_dynamics.evaluation.run import Run as Run
    from inverse_dynamics.evaluation.run import open_run as open_run
    from inverse_dynamics.excitation.excite import ExcitationResult as ExcitationResult
    from inverse_dynamics.excitation.excite import excite as excite
    from inverse_dynamics.excitation.excite import write_excitation as write_excitation
    from inverse_dynamics.feedforward.files import (
        write_trajectory_torques as write_trajectory_torques,
    )
    from inverse_dynamics.feedforward.trajectory_torques import (
        TrajectoryTorques as TrajectoryTorques,
    )
    from inverse_dynamics.feedforward.trajectory_torques import (
        trajectory_torques as trajectory_torques,
    )
    from inverse_dynamics.identification.files import write_identification as write_identification
    from inverse_dynamics.identification.identify import identify as identify
    from inverse_dynamics.identification.result import Identification as Identification
    from inverse_dynamics.payload.payload import Payload as Payload
    from inverse_dynamics.payload.payload import estimate_payload as estimate_payload
    from inverse_dynamics.public_recordings.public_recordings import (
        fetch_recordings as fetch_recordings,
    )
    from inverse_dynamics.recordings.bags import read_joint_log as read_joint_log
    from inverse_dynamics.recordings.bags import read_topics as read_topics
    from inverse_dynamics.recordings.bags import write_joint_logs as write_joint_logs
    from inverse_dynamics.recordings.joint_log import JointLog as JointLog
    from inverse_dynamics.recordings.recordings import read_recording as read_recording
    from inverse_dynamics.retiming.retiming import Retimed as Retimed
    from inverse_dynamics.retiming.retiming import retime as retime
    from inverse_dynamics.retiming.retiming import write_retimed as write_retimed
    from inverse_dynamics.robots.robots import Robot as Robot
    from inverse_dynamics.robots.robots import load_robot as load_robot
    from inverse_dynamics.robots.robots import robot_names as robot_names
    from inverse_dynamics.simulation.run import SimulatedRun as SimulatedRun
    from inverse_dynamics.simulation.run import simulate as simulate

_MODULES = {  # and the names that users know
    "_core": (
        *("FastModel", "JointPath", "MotionLimits", "RetimeOptions", "Solver", "available_solvers"),
    ),
    "comparison.comparison": ("Comparison", "compare"),
    "contacts.contacts": ("Contacts", "find_contacts"),
    "diagnosis.diagnose": ("diagnose",),
    "errors": ("UserError",),
    "evaluation.evaluation": (
        *("Evaluation", "JointError", "evaluate", "evaluate_run", "write_evaluation"),
    ),
    "evaluation.exports": ("export_series",),
    "evaluation.figure": ("save_torque_figure", "torque_figure"),
    "evaluation.files": ("read_evaluation",),
    "evaluation.many_evaluations": ("ManyEvaluations", "evaluate_many"),
    "evaluation.run": ("Run", "open_run"),
    "excitation.excite": ("ExcitationResult", "excite", "write_excitation"),
    "feedforward.files": ("write_trajectory_torques",),
    "feedforward.trajectory_torques": ("TrajectoryTorques", "trajectory_torques"),
    "identification.files": ("write_identification",),
    "identification.identify": ("identify",),
    "identification.result": ("Identification",),
    "payload.payload": ("Payload", "estimate_payload"),
    "public_recordings.public_recordings": ("fetch_recordings",),
    "recordings.bags": ("read_joint_log", "read_topics", "write_joint_logs"),
    "recordings.joint_log": ("JointLog",),
    "recordings.recordings": ("read_recording",),
    "retiming.retiming": ("Retimed", "retime", "write_retimed"),
    "robots.robots": ("Robot", "load_robot", "robot_names"),
    "simulation.run": ("SimulatedRun", "simulate"),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    if name == "__version__":
        return import_module("inverse_dynamics.installation.version").version()
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])

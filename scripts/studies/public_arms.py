# SPDX-License-Identifier: Apache-2.0
"""Recordings of other people's robots, as `ids identify` reads them.

    arm = ARMS["UR10e"].read(clones, out)   # writes out/ur10e.yaml, and a description where there is none
    identify(arm.recordings["12 Feb"], arm.robot, accept=arm.accept)

clones is a directory of clones of the repositories that ARMS names. Nothing of them is in the project: units,
columns and geometry below are as their owners state them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.signal import butter, filtfilt

from inverse_dynamics.robots.robots import RIGID_BODY

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

NNFM = "longshike/NNFM-A-Novel-Neural-Network-Modeling-Approach-for-Robot-Flexible-Joints-Friction"
MASTER = Path(__file__).resolve().parents[2] / "examples/dvrk_mtm/mtm.yaml"


@dataclass(frozen=True)
class Arm:
    """A run configuration, a file or one of the project's, and recordings by label."""

    robot: Path | str
    recordings: Mapping[str, Path]
    accept: Sequence[str] = ()  # what its recordings are refused for, and isn't a mistake


@dataclass(frozen=True)
class Source:
    """A repository on GitHub: its owner and name, its licence, how its clone is read."""

    repository: str
    licence: str
    reader: Callable[[Path, Path], Arm]

    @property
    def folder(self) -> str:
        """Of its clone."""
        return self.repository.split("/")[1]

    def read(self, clones: Path, out: Path) -> Arm:
        """Write the run configuration, and a description that the repository lacks, into a directory.

        Raises FileNotFoundError for files that the clone lacks.
        """
        arm = self.reader(clones / self.folder, out)
        for recording in arm.recordings.values():
            for file in str(recording).split("+"):
                if not Path(file).exists():
                    raise FileNotFoundError(
                        f"{file}: expected it in a clone of https://github.com/{self.repository}"
                    )
        return arm


def ur10e(clone: Path, out: Path) -> Arm:
    """Motor currents at 100 Hz, of several days; gains of the controller: its target torques by currents."""
    data = clone / "dataset_ur10e"
    return Arm(
        _configuration(
            out / "ur10e.yaml",
            urdf=clone / "URe/urdf/ur10e.urdf",
            tip="ee_link",
            effort="current",
            drive_gains=[11.976, 11.976, 9.839, 10.762, 10.762, 10.762],
            table={"columns": "time=1, q=2-7, qd=8-13, current=14-19"},
        ),
        {
            "10 Feb, 30 s": data / "identification_data/ur-20_02_10-30sec_12harm.csv",
            "12 Feb": data / "identification_data/ur-20_02_12-40sec_12harm.csv",
            "19 Feb": data / "identification_data/ur-20_02_19_14harm50sec.csv",
            "17 Jan, point to point": data / "validation_data/ur-20_01_17-ptp_10_points.csv",
            "5 Feb": data / "identification_data/ur-20_02_05-20sec_12harm.csv",
            "6 Feb": data / "identification_data/ur-20_02_06-20sec_10harm.csv",
            "10 Feb": data / "identification_data/ur-20_02_10-20sec_7harm.csv",
        },
    )


def kr300(clone: Path, out: Path) -> Arm:
    """Torques of the first three motors at 250 Hz; z of the published parameters points down."""
    description = out / "kr300_dh.yaml"
    description.write_text(  # masses [kg] about as published
        """\
convention: modified
degrees: true
joints:
  - {a: 0, alpha: 0, d: -0.675, mass: 395}
  - {a: 0.35, alpha: 90, d: -0.189, mass: 339}
  - {a: 1.15, alpha: 0, d: 0.189, mass: 192}
""",
        encoding="utf-8",
    )
    gears = ", ".join(f"{k:.9g}" for k in (1798 / 7, 1872 / 7, 757 / 3))
    recorded = clone / "data/recorded_trajectories"
    return Arm(
        _configuration(
            out / "kr300.yaml",
            urdf=description,
            tip="link3",
            gravity=[0, 0, 9.81],
            table={
                "columns": "time=rec.time_cont, q=rec.act_pos_se_deg[*], qd=rec.act_vel_se_deg_per_s[*], "
                "effort=rec.act_torque_abs_nm[*]",
                "scale": ["q=deg", "qd=deg", f"effort={gears}"],
            },
        ),
        {x: recorded / f"2020-10-21 10s FF {x} 08ms/data.mat" for x in "ABC"},
    )


def another_panda(clone: Path, out: Path) -> Arm:
    """Numbers a line, of torques at 1 kHz."""
    log = clone / "matlab/data/Exciting_Traj/Trajectory_1/rbt_log"
    time, *states = (
        np.loadtxt(log / f"exciting_traj_{name}.txt")
        for name in ("time", "positions", "velocity", "torques")
    )
    q, qd, tau = (numbers.reshape(-1, 7) for numbers in states)
    recording = out / "another_panda.npz"
    np.savez(recording, time=time, q=q, qd=qd, tau=tau)
    return Arm("panda_real", {"trajectory 1": recording})


def master_arm(clone: Path, out: Path) -> Arm:
    """Torques of the da Vinci master's seven motors, low-passed as docs/parallelogram.md says."""
    b, a = butter(6, 1.8 * 2 * np.pi / 200)
    names = ",".join(["time", *(f"{key}{k}" for key in ("q", "qd", "tau") for k in range(1, 8))])
    recordings = {}
    for label in ("one", "two"):
        file = clone / f"data/mtm/measured_trajectory/{label}_results.csv"
        log = filtfilt(b, a, np.loadtxt(file, delimiter=","), axis=0)[200:-200]
        recordings[label] = out / f"{label}.csv"
        rows = np.column_stack([np.arange(len(log)) / 200, log])
        np.savetxt(recordings[label], rows, delimiter=",", header=names, comments="")
    # Velocities of two fast joints at the wrist aren't the slopes of positions; masses are guesses.
    return Arm(MASTER, recordings, accept=("velocity", "total_mass"))


def sawyer(clone: Path, out: Path) -> Arm:
    """Torques at 1 kHz."""
    description = out / "sawyer_dh.yaml"
    description.write_text(
        """\
convention: modified
degrees: true
mass: 19
joints:
  - {a: 0, alpha: 0, d: 0}
  - {a: 0.081, alpha: -90, d: 0.1925, theta: -90}
  - {a: 0, alpha: -90, d: 0.4}
  - {a: 0, alpha: 90, d: -0.1685}
  - {a: 0, alpha: -90, d: 0.4}
  - {a: 0, alpha: 90, d: 0.1363}
  - {a: 0, alpha: -90, d: 0}
""",
        encoding="utf-8",
    )
    data = clone / "other_files/process_data"
    files = "+".join(f"{data / name}.mat" for name in ("t", "q", "qDot", "tau"))
    return Arm(
        _configuration(out / "sawyer.yaml", urdf=description),
        {"excitation": Path(files)},
    )


def med7(clone: Path, out: Path) -> Arm:
    """Torques of the opposite sign, at 100 Hz, without time and velocity."""
    return Arm(
        _configuration(
            out / "med7.yaml",
            urdf=clone / "urdf/med/med7dock.urdf",
            table={"rate": 100, "scale": ["effort=-1"]},
        ),
        {"excitation": clone / "src/test/measurements.csv"},
    )


def ar5(clone: Path, out: Path) -> Arm:
    """Torques at 50 Hz, of an arm on a wall."""
    return Arm(
        _configuration(
            out / "ar5.yaml", urdf=clone / "urdf/AR5-5_07R-W4C4A2.urdf", gravity=[9.81, 0, 0]
        ),
        {"excitation": clone / "src/config/dynamics_identification_data_real.csv"},
    )


def xmate(clone: Path, out: Path) -> Arm:
    """Torques at 1 kHz, without time."""
    description = out / "xmate_dh.yaml"
    description.write_text(
        """\
convention: modified
degrees: true
joints:
  - {a: 0, alpha: 0, d: 0.3415}
  - {a: 0, alpha: -90, d: 0}
  - {a: 0, alpha: 90, d: 0.394}
  - {a: 0, alpha: -90, d: 0}
  - {a: 0, alpha: 90, d: 0.366}
  - {a: 0, alpha: -90, d: 0}
  - {a: 0, alpha: 90, d: 0.2503}
""",
        encoding="utf-8",
    )
    data = clone / "filtering/data/excit"
    columns = "q=excit_ang_record.point_record[*], qd=speed_record[*], effort=torque_record[*]"
    files = "+".join(f"{data}/excit_{name}_record.mat" for name in ("ang", "vel", "torque"))
    return Arm(
        _configuration(
            out / "xmate.yaml",
            urdf=description,
            effort="torque",
            table={"columns": columns, "rate": 1000},
        ),
        {"excitation": Path(files)},
    )


def ur5(clone: Path, out: Path) -> Arm:
    """Motor currents at 125 Hz; gains: target torques by target currents, without friction, of movement 6.

    A file for each quantity, whose rows begin with their own time.
    """
    description = out / "ur5_dh.yaml"
    description.write_text(
        """\
convention: standard
degrees: true
joints:
  - {a: 0, alpha: 90, d: 0.089159, mass: 3.7}
  - {a: -0.425, alpha: 0, d: 0, mass: 8.393}
  - {a: -0.39225, alpha: 0, d: 0, mass: 2.275}
  - {a: 0, alpha: 90, d: 0.10915, mass: 1.219}
  - {a: 0, alpha: -90, d: 0.09465, mass: 1.219}
  - {a: 0, alpha: 0, d: 0.0823, mass: 0.1879}
""",
        encoding="utf-8",
    )
    recordings = {}
    for label, movement in (
        ("movement 6", "Movement_No6_Acc_slow_Verify_Model"),
        ("movement 8", "Movement_No8_Singularity_Free_1"),
    ):
        log = (
            clone / "JointSpaceControl_Model_C_ForceEstim/RecordedUR5Data" / movement / "csv_files"
        )
        q, qd, current = (
            np.loadtxt(log / f"log_{name}_actual.csv", delimiter=",") for name in ("q", "qd", "i")
        )
        recordings[label] = out / f"ur5_{label.replace(' ', '_')}.npz"
        same = [np.interp(q[:, 0], qd[:, 0], column) for column in qd[:, 1:].T]
        also = [np.interp(q[:, 0], current[:, 0], column) for column in current[:, 1:].T]
        np.savez(
            recordings[label],
            time=q[:, 0],
            q=q[:, 1:],
            qd=np.column_stack(same),
            current=np.column_stack(also),
        )
    return Arm(
        _configuration(
            out / "ur5.yaml",
            urdf=description,
            effort="current",
            drive_gains=[11.5, 10.1, 10.6, 10.0, 10.2, 8.8],
        ),
        recordings,
    )


def cobot(clone: Path, out: Path) -> Arm:
    """Torques every 6 ms; a row for each joint and quantity.

    Owners turn the sign of the third torque. That of the sixth drives its motion, so it is turned, too.
    """
    description = out / "cobot_dh.yaml"
    description.write_text(
        """\
convention: modified
degrees: true
joints:
  - {a: 0, alpha: 0, d: 0.1181}
  - {a: 0, alpha: 90, d: 0}
  - {a: -0.416, alpha: 0, d: 0}
  - {a: -0.4208, alpha: 0, d: 0.1301}
  - {a: 0, alpha: 90, d: 0.1021}
  - {a: 0, alpha: -90, d: 0.0568}
""",
        encoding="utf-8",
    )
    recordings = {}
    for number in (1, 2, 3):
        data = clone / "python_identification/csv_data"
        states = np.loadtxt(data / f"dataInput{number}.csv", delimiter=",")
        for name, label in (("tau", ""), ("tau_filt", ", smooth")):
            efforts = np.loadtxt(data / f"{name}{number}.csv", delimiter=",")
            recording = out / f"cobot_{name}{number}.npz"
            time = np.arange(states.shape[1]) * 0.006
            np.savez(recording, time=time, q=states[:6].T, qd=states[6:12].T, tau=efforts.T)
            recordings[f"trajectory {number}{label}"] = recording
    return Arm(
        _configuration(
            out / "cobot.yaml", urdf=description, table={"scale": ["effort=1,1,-1,1,1,-1"]}
        ),
        recordings,
        accept=("saturation",),  # a median filter holds the smooth torques
    )


def franka_joint(joint: int, case: int, clock: float = 1.0) -> Callable[[Path, Path], Arm]:
    """One joint of a Franka at three speeds: torques that a rigid model leaves. A joint about the vertical.

    clock: seconds by those of the file, as velocities and positions have it.
    """

    def read(clone: Path, out: Path) -> Arm:
        description = out / "one_joint_dh.yaml"
        description.write_text(
            "convention: modified\njoints:\n  - {a: 0, alpha: 0, d: 0.1}\n", encoding="utf-8"
        )
        data = clone / "Comparative data/Franka Robot"
        return Arm(
            _configuration(
                out / f"franka_joint_{joint}.yaml",
                urdf=description,
                table={
                    "columns": f"time=time, q=q{joint}, qd=dq{joint}, effort=q{joint}_tau_J_compensate",
                    "scale": [f"time={clock}"],
                },
            ),
            {speed: data / f"case{case}_{speed}.csv" for speed in ("slow", "middle", "high")},
        )

    return read


def _configuration(file: Path, **entries: Any) -> Path:
    """Write a run configuration."""
    head = {"schema": 1, "name": file.stem, "description": f"Public recordings of {file.stem}"}
    values = {**head, "plugin": RIGID_BODY, "friction": False, **entries}
    lines = (f"{key}: {json.dumps(value, default=str)}\n" for key, value in values.items())
    file.write_text("".join(lines), encoding="utf-8")
    return file


ARMS = {
    "UR10e": Source("shamilmamedov/dynamic_calibration", "none stated", ur10e),
    "KUKA KR300": Source("JonasWeigand/Robot_Identification", "MIT", kr300),
    "Panda, another": Source("marcocognetti/FrankaEmikaPandaDynModel", "GPL-3.0", another_panda),
    "da Vinci master": Source("WPI-AIM/dvrk_dynamics_identification", "none stated", master_arm),
    "Sawyer": Source("songtangzhong/robot-dynamics-identify-v1.3", "none stated", sawyer),
    "KUKA LBR Med 7": Source("lbr-stack/dynamic_parameter_identification", "none stated", med7),
    "Rokae AR5": Source("FrankJIE09/Dynamics_identification_Frank", "none stated", ar5),
    "Rokae xMate": Source(
        "NEUer02/Dynamic_Parameter_Identification_for_Rokae_xMate", "none stated", xmate
    ),
    "UR5": Source("kkufieta/ur5_modeling_force_estimate", "Apache-2.0", ur5),
    "cobot": Source("Naruton94/robot_identification", "none stated", cobot),
    "Franka joint 2": Source(NNFM, "none stated", franka_joint(2, case=3)),
    "Franka joint 7": Source(NNFM, "none stated", franka_joint(7, case=4, clock=0.5)),
}


def missing_clones(clones: Path, names: Sequence[str]) -> list[str]:
    """A line for each of ARMS whose clone isn't there."""
    return [
        f"{name}: expected {clones / ARMS[name].folder}, a clone of https://github.com/{ARMS[name].repository}"
        for name in names
        if not (clones / ARMS[name].folder).is_dir()
    ]

# SPDX-License-Identifier: Apache-2.0
"""Recordings of other people's robots are read as their owners state them; made-up ones here."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from field_study import PROTOCOLS
from public_arms import ARMS, Arm, missing_clones
from scipy.io import savemat

from inverse_dynamics import load_robot, open_run

if TYPE_CHECKING:
    from inverse_dynamics import JointLog

N = 40  # samples


def motion(joints: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Made-up positions, velocities, efforts of 100 Hz."""
    phase = np.arange(N)[:, None] / 100 + np.arange(joints)
    return np.sin(phase), np.cos(phase), 5 * np.sin(2 * phase)


def saved(file: Path, numbers: np.ndarray, delimiter: str = ",", header: str = "") -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(file, numbers, delimiter=delimiter, header=header, comments="")


def log_of(arm: Arm, label: str) -> JointLog:
    return open_run(arm.recordings[label], arm.robot).log


def test_a_clone_that_is_not_there_is_named_with_its_repository(tmp_path: Path) -> None:
    (line,) = missing_clones(tmp_path, ["UR10e"])
    assert line.startswith(f"UR10e: expected {tmp_path / 'dynamic_calibration'}, a clone of ")
    assert line.endswith("https://github.com/shamilmamedov/dynamic_calibration")
    (tmp_path / "dynamic_calibration").mkdir()
    assert missing_clones(tmp_path, ["UR10e"]) == []


def test_a_file_that_a_clone_lacks_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"measurements.csv: expected it in a clone of"):
        ARMS["KUKA LBR Med 7"].read(tmp_path, tmp_path)


def test_torques_of_the_kr300_are_those_of_its_motors_times_gears(tmp_path: Path) -> None:
    q, qd, tau = motion(6)
    for run in "ABC":
        file = (
            tmp_path
            / "Robot_Identification/data/recorded_trajectories"
            / f"2020-10-21 10s FF {run} 08ms/data.mat"
        )
        file.parent.mkdir(parents=True)
        rec = {
            "time_cont": np.arange(N) / 100,
            "act_pos_se_deg": np.degrees(q).T,
            "act_vel_se_deg_per_s": np.degrees(qd).T,
            "act_torque_abs_nm": tau.T,
        }
        savemat(file, {"rec": rec})
    log = log_of(ARMS["KUKA KR300"].read(tmp_path, tmp_path), "B")
    np.testing.assert_allclose(log.q, q[:, :3], atol=1e-9)
    np.testing.assert_allclose(log.effort, tau[:, :3] * [1798 / 7, 1872 / 7, 757 / 3], rtol=1e-6)


def test_states_and_torques_of_the_da_vinci_master_are_low_passed_alike(tmp_path: Path) -> None:
    time = np.arange(1000)[:, None] / 200
    slow, fast = np.sin(2 * np.pi * 0.2 * time), np.sin(2 * np.pi * 40 * time)
    columns = slow * np.arange(1, 22) + fast
    for run in ("one", "two"):
        recorded = tmp_path / "dvrk_dynamics_identification/data/mtm/measured_trajectory"
        saved(recorded / f"{run}_results.csv", columns)
    log = log_of(ARMS["da Vinci master"].read(tmp_path, tmp_path), "two")
    kept = np.hstack([log.q, log.qd, log.effort])
    np.testing.assert_allclose(kept, (columns - fast)[200:-200], atol=0.01)
    np.testing.assert_allclose(log.time, time[:-400, 0], atol=1e-9)


def test_two_torques_of_the_cobot_are_of_the_opposite_sign(tmp_path: Path) -> None:
    q, qd, tau = motion(6)
    data = tmp_path / "robot_identification/python_identification/csv_data"
    for number in (1, 2, 3):
        saved(data / f"dataInput{number}.csv", np.hstack([q, qd, tau]).T)
        saved(data / f"tau{number}.csv", tau.T)
        saved(data / f"tau_filt{number}.csv", tau.T)
    log = log_of(ARMS["cobot"].read(tmp_path, tmp_path), "trajectory 2")
    np.testing.assert_allclose(log.effort, tau * [1, 1, -1, 1, 1, -1], atol=1e-9)
    assert log.time[1] - log.time[0] == pytest.approx(0.006)


def test_quantities_of_the_ur5_have_times_of_their_own(tmp_path: Path) -> None:
    q, qd, _ = motion(6)
    time = np.arange(N)[:, None] / 100
    logs = tmp_path / (
        "ur5_modeling_force_estimate/JointSpaceControl_Model_C_ForceEstim/RecordedUR5Data"
    )
    for movement in ("Movement_No6_Acc_slow_Verify_Model", "Movement_No8_Singularity_Free_1"):
        saved(logs / movement / "csv_files/log_q_actual.csv", np.hstack([time, q]))
        saved(logs / movement / "csv_files/log_qd_actual.csv", np.hstack([time, qd]))
        late = np.hstack([time + 0.001, np.repeat(time + 0.001, 6, axis=1)])
        saved(logs / movement / "csv_files/log_i_actual.csv", late)
    arm = ARMS["UR5"].read(tmp_path, tmp_path)
    log = log_of(arm, "movement 8")
    np.testing.assert_allclose(log.effort[1:, 0], time[1:, 0], atol=1e-9)
    assert load_robot(arm.robot).effort == "current"


def test_the_clock_of_the_seventh_joint_runs_twice_as_fast(tmp_path: Path) -> None:
    q, qd, tau = motion(1)
    time = 2 * np.arange(N)[:, None] / 100
    for speed in ("slow", "middle", "high"):
        saved(
            tmp_path
            / ARMS["Franka joint 7"].folder
            / f"Comparative data/Franka Robot/case4_{speed}.csv",
            np.hstack([time, q, qd, 0 * q, tau, tau, 0 * tau]),
            header="time,q7,dq7,ddq7,q7_tau_J_compensate,CV,NNFM",
        )
    log = log_of(ARMS["Franka joint 7"].read(tmp_path, tmp_path), "high")
    np.testing.assert_allclose(np.diff(log.time), 0.01, atol=1e-9)
    np.testing.assert_allclose(log.effort, tau, atol=1e-9)


def test_the_study_names_each_clone_that_is_missing(tmp_path: Path) -> None:
    study = Path(__file__).with_name("field_study.py")
    command = [sys.executable, str(study), str(tmp_path), "no such robot"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert run.stdout.startswith("| robot |")
    for name in {protocol.robot for protocol in PROTOCOLS} & ARMS.keys():
        source = ARMS[name]
        assert (
            f"{tmp_path / source.folder}, a clone of https://github.com/{source.repository}"
            in run.stderr
        )

# SPDX-License-Identifier: Apache-2.0
"""Recordings that tests make for themselves."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from inverse_dynamics import Identification, Solver, cli, identify, write_joint_logs
from inverse_dynamics.installation.ament import package_share
from inverse_dynamics.recordings.joint_log import JointLog

UR10 = "ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10"
RIGID_BODY = "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody"
KDL = "kdl_inverse_dynamics_solver/InverseDynamicsSolverKDL"
PINOCCHIO = "pinocchio_inverse_dynamics_solver/InverseDynamicsSolverPinocchio"
FRANKA = "franka_inria_inverse_dynamics_solver/InverseDynamicsSolverFrankaInria"
URDF = package_share("inverse_dynamics_robots") / "urdf" / "ur10.urdf"

JOINTS = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)

# 2 kg whose center of mass is 0.5 m below a horizontal axis.
PENDULUM = """
<robot name="pendulum">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="swing" type="continuous"><parent link="base"/><child link="arm"/>
    <axis xyz="0 1 0"/></joint>
</robot>"""

STORE = get_typestore(Stores.ROS2_HUMBLE)
JOINT_STATE = "sensor_msgs/msg/JointState"


def joint_log(samples: int = 50, joints: int = 3, **changes: object) -> JointLog:
    """A smooth motion at 100 Hz; `changes` replace fields."""
    stamps = 10_000_000 * np.arange(1, samples + 1, dtype=np.int64)
    phase = stamps[:, None] * 1e-9 + np.arange(joints)
    fields = {
        "joint_names": tuple(f"joint_{i + 1}" for i in range(joints)),
        "header_stamps": stamps,
        "receive_stamps": stamps + 500_000,
        "q": np.sin(phase),
        "qd": np.cos(phase),
        "effort": 10.0 * np.sin(2 * phase),
    }
    return JointLog(**{**fields, **changes})


def joint_state(
    names: list[str],
    position: list[float],
    velocity: list[float],
    effort: list[float],
    stamp: int = 0,
    frame_id: str = "",
) -> object:
    """A message as the rosbags library has it."""
    types = STORE.types
    time = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    header = types["std_msgs/msg/Header"](stamp=time, frame_id=frame_id)
    arrays = (np.array(a, dtype=np.float64) for a in (position, velocity, effort))
    return types[JOINT_STATE](header, names, *arrays)


def write_messages(
    path: Path,
    messages: list[object],
    *,
    topic: str = "/joint_states",
    message_type: str = JOINT_STATE,
    storage: StoragePlugin = StoragePlugin.SQLITE3,
) -> Path:
    """Record messages one by one, the k-th received at k ms; independent of what is tested."""
    with Writer(path, version=9, storage_plugin=storage) as writer:
        connection = writer.add_connection(topic, message_type, typestore=STORE)
        for k, message in enumerate(messages):
            raw = STORE.serialize_cdr(message, message_type)
            writer.write(connection, (k + 1) * 1_000_000, raw)
    return path


def damaged(content: bytes, count: int, seed: int = 0) -> Iterator[bytes]:
    """The content with bytes replaced, left out or put in a second time; the same for the same seed."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        changed = bytearray(content)
        for _ in range(random.integers(1, 8)):
            place, end = (int(k) for k in np.sort(random.integers(0, len(changed), 2)))
            kind = random.integers(3)
            if kind == 0:
                changed[place] = random.integers(256)
            elif kind == 1:
                del changed[place : min(end, place + 20)]
            else:
                changed[place:place] = changed[place : min(end, place + 50)]
        yield bytes(changed)


def motion(samples: int = 1500, rate: float = 250.0) -> tuple[np.ndarray, ...]:
    """Smooth q, qd, qdd (N, 6) and stamps [ns] of a UR10."""
    stamps = np.round(1e9 / rate * np.arange(1, samples + 1)).astype(np.int64)
    speed = 2 * np.pi * np.array([0.20, 0.15, 0.25, 0.30, 0.35, 0.40])
    phase = stamps[:, None] * 1e-9 * speed + np.arange(6)
    return np.sin(phase), speed * np.cos(phase), -(speed**2) * np.sin(phase), stamps


def recording(path: Path, solver: Solver, **changes: object) -> JointLog:
    """Record the motion with the efforts that a solver computes for it."""
    q, qd, qdd, stamps = motion()
    log = JointLog(JOINTS, stamps, stamps, q, qd, solver.torques(q, qd, qdd))
    log = replace(log, **changes)
    write_joint_logs(path, {log.topic: log})
    return log


@pytest.fixture(scope="session")
def recordings() -> Path:
    """Directory with recordings of real robots; skips where there is none."""
    directory = os.environ.get("IDS_DATA_DIR")
    if not directory:
        pytest.skip("IDS_DATA_DIR is not set: no recordings of real robots")
    return Path(directory) / "bags"


@pytest.fixture(scope="session")
def identified(recordings: Path) -> Callable[[str], Identification]:
    """Models of the real ur10 and panda by name, made once for all of test/identification: ten seconds each."""
    return cache(
        lambda name: identify([recordings / f"{name}_exciting_trajectory"], f"{name}_real")
    )


@pytest.fixture(scope="session")
def solver() -> Solver:
    """Of the description of a UR10."""
    return Solver(RIGID_BODY, urdf=URDF.read_text(), root="base_link", tip="tool0")


@pytest.fixture(scope="session")
def bag(tmp_path_factory: pytest.TempPathFactory, solver: Solver) -> Path:
    """A recording of a UR10 that is what its description says."""
    path = tmp_path_factory.mktemp("recording") / "motion"
    recording(path, solver)
    return path


@pytest.fixture(autouse=True)
def _no_progress_lines(monkeypatch) -> None:
    """Lines that tell the progress of long work depend on how busy the machine is."""
    monkeypatch.setattr("inverse_dynamics.terminal.screen._FIRST_LINE", float("inf"))


@pytest.fixture
def ids(tmp_path, monkeypatch, capsys):
    """Run `ids` in an empty directory; gives exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")

    def run(*arguments):
        try:
            code = cli.main([str(a) for a in arguments])
        except SystemExit as exit_:  # argparse
            code = exit_.code
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def fails(result, *expected):
    """The user is told, on stderr, without a traceback; exit code 2."""
    code, out, err = result
    assert code == 2
    assert out == ""
    assert "Traceback" not in err
    for part in expected:
        assert part in err

# SPDX-License-Identifier: Apache-2.0
"""Names of columns as logs of real arms have them."""

import re

import pytest

from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.columns import match_columns

UR = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
PANDA = tuple(f"panda_joint{k}" for k in range(1, 8))
TIAGO = tuple(f"arm_{k}_joint" for k in range(1, 8))


def of(*patterns, numbers=range(7)):
    return [pattern.format(k) for pattern in patterns for k in numbers]


@pytest.mark.parametrize(
    ("names", "joints", "expected"),
    [
        (
            ["time", *of("q{}", "dq{}", "ddq{}", "tau{}")],
            [f"AR5-5_07R-W4C4A2_joint_{k}" for k in range(1, 8)],
            ["time", "q0", "dq0", "ddq0", "tau0"],
        ),
        (of("q_{}", "tau_{}", "tau_ext_{}"), PANDA, ["q_0", "tau_0"]),
        (
            ["Time", *of("Joint{}_Pos", "Joint{}_Vel", "Joint{}_Torque", numbers=range(1, 8))],
            PANDA,
            ["Time", "Joint1_Pos", "Joint1_Vel", "Joint1_Torque"],
        ),
        (
            [
                "timestamp",
                *of("target_q_{}", "actual_q_{}", "actual_qd_{}", numbers=range(6)),
                *of("actual_current_{}", "target_moment_{}", numbers=range(6)),
            ],
            UR,
            ["timestamp", "actual_q_0", "actual_qd_0", "actual_current_0"],
        ),
        (
            ["t", *(f"{joint}_{kind}" for kind in ("effort", "position") for joint in UR[::-1])],
            UR,
            ["t", "shoulder_pan_joint_position", "shoulder_pan_joint_effort"],
        ),
        (
            ["Unnamed: 0", "- torso_position", *of("- arm_{}_joint_position", numbers=range(1, 8))],
            TIAGO,
            ["- arm_1_joint_position"],
        ),
        (
            ["__time", *(f"/joint_states/{joint}/velocity" for joint in PANDA)],
            PANDA,
            ["__time", "/joint_states/panda_joint1/velocity"],
        ),
        (
            ["timestamp", *of("observation.state[{}]", "action[{}]", "observation.current[{}]")],
            PANDA,
            ["timestamp", "observation.state[0]", "observation.current[0]"],
        ),
        (of("current_q_{}", "current_{}"), PANDA, ["current_q_0", "current_0"]),
        (["time", "q", "dq", "tau"], ["slider"], ["time", "q", "dq", "tau"]),
        (["time", "q1", "q2", "qd1", "qd2"], ["q1", "q2"], ["time", "q1", "qd1"]),
        (of("q{}", "q{}_filtered"), PANDA, ["q0"]),
        (of("spare", numbers=[0]), PANDA, []),
        (of("q{}", numbers=range(6)), PANDA, []),  # another robot's
        (["elbow.pos", "pan.pos"], ["x_pan_joint", "x_elbow_joint"], ["pan.pos"]),
        (
            ["elapsed_time", *of("qDot_{}", "q_{}", "I_{} (mA)")],
            PANDA,
            ["elapsed_time", "q_0", "qDot_0", "I_0 (mA)"],
        ),
        (["time_ns", *of("q{}", "v{}", "a{}")], PANDA, ["time_ns", "q0", "v0", "a0"]),
        (["timestamp", "time", *of("q{}")], PANDA, ["time", "q0"]),
        (
            ["duration", *of("qpos[{}]", "qvel[{}]", "ctrl[{}]")],
            PANDA,
            ["duration", "qpos[0]", "qvel[0]"],
        ),
        (["sec", *of("fb_joints_{}", "planned_joints_{}")], PANDA, ["sec", "fb_joints_0"]),
        (
            of("joint_{} [°]", "joint_{} [deg/s]", "joint_{} [Nm]", "joint_mode_{}"),
            PANDA,
            ["joint_0 [°]", "joint_0 [deg/s]", "joint_0 [Nm]"],
        ),
        (of("actual_q_{}", "current_{}", "torque_{}"), PANDA, ["actual_q_0", "torque_0"]),
        (
            of("q{}", "torque_enable_{}", "current_{}"),
            PANDA,
            ["q0", "torque_enable_0", "current_0"],  # both, which read_motion() refuses
        ),
        (of("q{}", "s{}", "tau{}"), PANDA, ["q0", "tau0"]),
        (of("q{}", "theta{}", "actuator{}_torque"), PANDA, ["q0", "actuator0_torque"]),
        (of("theta_{}", "qfrc_actuator_{}"), PANDA, ["theta_0", "qfrc_actuator_0"]),
        (
            of("$AXIS_ACT A{}", "$TORQUE_AXIS_ACT A{}", numbers=range(1, 8)),
            PANDA,
            ["$AXIS_ACT A1", "$TORQUE_AXIS_ACT A1"],
        ),
        (
            [*of("MsrdJntPos_A{}", "MsrdJntTrq_A{}", "ExtnJntTrq_A{}", numbers=range(1, 8))],
            PANDA,
            ["MsrdJntPos_A1", "MsrdJntTrq_A1"],
        ),
    ],
)
def test_names_say_what_columns_hold(names, joints, expected):
    mapping = match_columns(names, joints)
    assert [columns[0] for columns in mapping.columns.values()] == expected
    assert all(len(mapping.columns[kind]) in (1, len(joints)) for kind in mapping.columns)


def test_units_in_names_are_kept():
    names = ["t_ms", *of("pos_deg_{}", "vel_deg_s_{}", "torque_mNm_{}", numbers=(1, 2))]
    mapping = match_columns(names, ["a", "b"])
    assert mapping.units == {"time": "ms", "position": "deg", "velocity": "deg", "effort": "mnm"}
    assert "position: pos_deg_1 to pos_deg_2 [deg]" in mapping.text


def test_what_is_stated_comes_first():
    numbered = [str(k) for k in range(1, 32)]
    mapping = match_columns(numbered, UR, "time=1, q=2-7, qd=8-13, i=14-19")
    assert mapping.columns["current"] == tuple(map(str, range(14, 20)))
    names = of("rec.pos_mot_deg[{}]", "rec.pos_se_deg[{}]", "rec.torque[{}]", numbers=range(6))
    three = match_columns(names, ["j1", "j2", "j3"], "q=rec.pos_se_deg[*], tau=rec.torque[*]")
    assert three.columns["position"] == tuple(of("rec.pos_se_deg[{}]", numbers=range(3)))
    assert three.units == {"position": "deg"}
    swapped = match_columns(["x", "y"], ["a", "b"], "q=y x")
    assert swapped.columns["position"] == ("y", "x")
    currents = match_columns(of("tau{}", "cur{}", numbers=range(2)), ["a", "b"], "current=cur*")
    assert [*currents.columns] == ["current"]
    left = match_columns(
        ["left_b_joint_pos", "left_a_joint_pos"], ["a_joint", "b_joint"], "q=left_*_joint_pos"
    )
    assert left.columns["position"] == ("left_a_joint_pos", "left_b_joint_pos")


@pytest.mark.parametrize(
    ("names", "stated", "expected"),
    [
        (
            of("l{}_pos", "r{}_pos", "l{}_vel", "r{}_vel", numbers=range(2)),
            "",
            "f.csv: position: expected one set of columns, got l0_pos to l1_pos, r0_pos to r1_pos; velocity: expected "
            "one set of columns, got l0_vel to l1_vel, r0_vel to r1_vel; state the right one, for example: columns="
            "'position=l*_pos, velocity=l*_vel'",
        ),
        (["position.a"], "", "f.csv: joint b: expected a column position.b, got none"),
        (
            ["sim_time", "real_time"],
            "",
            "f.csv: time: expected one set of columns, got sim_time, real_time; state the right one, for example: "
            "columns='time=sim_time'",
        ),
        (
            ["foo", "bar"],
            "q=q*",
            "f.csv: columns: q*: expected columns of the file, got none; the file has foo, bar",
        ),
        (["foo", "bar"], "q=foo", "expected a column for each of the joints a, b, got 1: foo"),
        (["foo", "bar"], "speed=foo", "expected KEY=PATTERN with a KEY of time, position"),
        (["foo", "foo"], "q=foo foo", "expected each column once, got several named foo"),
    ],
)
def test_what_fits_nothing_or_twice_is_refused(names, stated, expected):
    with pytest.raises(BagError, match=re.escape(expected)):
        match_columns(names, ["a", "b"], stated, "f.csv")

# SPDX-License-Identifier: Apache-2.0
import re
from dataclasses import replace

import numpy as np
import pytest
from test_evaluation import JOINTS, RIGID_BODY, URDF, motion

from inverse_dynamics import Solver, evaluate, load_robot, read_recording
from inverse_dynamics.errors import BagError, EvaluationError

HEADER = "time,position.a,velocity.a,effort.a\n"
ROWS = "0,1,2,3\n0.01,1.5,2.5,3.5\n"


@pytest.fixture(scope="module")
def solver():
    return Solver(RIGID_BODY, urdf=URDF.read_text(), root="base_link", tip="tool0")


@pytest.fixture
def file(tmp_path):
    return tmp_path / "motion.csv"


def write_table(path, columns, delimiter=","):
    """Columns by name; all digits."""
    lines = [delimiter.join(columns)]
    lines += [
        delimiter.join(map(repr, row)) for row in np.column_stack([*columns.values()]).tolist()
    ]
    path.write_text("\n".join(lines) + "\n")


def table_of(effort, accelerations=None):
    """The motion of a UR10, joints from the last to the first."""
    q, qd, _, stamps = motion()
    columns = {"spare": 0.0 * stamps}
    given = {"effort": effort, "velocity": qd, "position": q}
    if accelerations is not None:
        given["acceleration"] = accelerations
    for kind, values in given.items():
        for i in reversed(range(6)):
            columns[f"{kind}.{JOINTS[i]}"] = values[:, i]
    return {**columns, "time": stamps * 1e-9}


def fails(path, text, expected, joints=("a",)):
    path.write_text(text)
    with pytest.raises(BagError, match=re.escape(expected)) as caught:
        read_recording(path, joints)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " ", "   "])
def test_columns_are_matched_by_name_whatever_is_between_them(file, delimiter):
    q, qd, _, stamps = motion()
    write_table(file, table_of(10 * q), delimiter)
    log = read_recording(file, JOINTS)
    np.testing.assert_array_equal(log.q, q)
    np.testing.assert_array_equal(log.qd, qd)
    np.testing.assert_array_equal(log.effort, 10 * q)
    np.testing.assert_array_equal(log.stamps, stamps)
    assert log.qdd is None
    assert log.effort_is == ""
    assert log.notes == ("1 column left out: spare",)
    assert read_recording(file).joint_names == JOINTS[::-1]


def test_blocks_and_blank_lines_leave_no_trace(file):
    rows = [f"{0.001 * k!r},{k},{2 * k},{3 * k}\n" for k in range(100_000)]
    file.write_text("\n" + HEADER + "\n" + "".join(rows) + "\n")
    calls = []
    log = read_recording(file, progress=lambda *call: calls.append(call))
    np.testing.assert_array_equal(log.effort[:, 0], 3.0 * np.arange(100_000))
    assert len(calls) > 2
    assert calls[-1] == ("reading", file.stat().st_size, file.stat().st_size)
    rows[70_000] = "70,x,0,0\n"
    fails(file, HEADER + "".join(rows), f"{file}:70002: column 2 (position.a): expected a number")


def test_given_accelerations_are_taken_unless_told_otherwise(file, solver):
    q, qd, qdd, _ = motion()
    write_table(file, table_of(solver.torques(q, qd, qdd), qdd))
    result = evaluate(file, "ur10_simulated")
    assert result.accelerations.method == "given"
    assert result.accelerations.summary == "given by the recording"
    np.testing.assert_array_equal(result.qdd, qdd)
    assert max(error.max_abs for error in result.errors) < 1e-9  # rounding
    assert evaluate(file, "ur10_simulated", accelerations="auto").accelerations.method == "given"
    for forced in ({"accelerations": "low-pass"}, {"cutoff": 20.0}):
        assert evaluate(file, "ur10_simulated", **forced).accelerations.method == "low-pass"
    write_table(file, table_of(solver.torques(q, qd, qdd)))
    assert evaluate(file, "ur10_simulated").accelerations.method == "low-pass"
    with pytest.raises(
        EvaluationError, match=r"motion\.csv: accelerations: the recording gives none"
    ):
        evaluate(file, "ur10_simulated", accelerations="given")


@pytest.mark.parametrize(
    ("configured", "options", "method", "cutoff"),
    [
        ("auto", {}, "given", None),
        ("low-pass", {}, "low-pass", 7.0),
        ("backward-difference", {}, "backward-difference", None),
        ("backward-difference", {"accelerations": "auto"}, "given", None),
        ("low-pass", {"accelerations": "given"}, "given", None),
        ("given", {"accelerations": "low-pass", "cutoff": 9.0}, "low-pass", 9.0),
        ("low-pass", {"cutoff": 9.0}, "low-pass", 9.0),
    ],
)
def test_the_option_takes_precedence_over_the_configuration_and_that_over_the_recording(
    file, solver, configured, options, method, cutoff
):
    q, qd, qdd, _ = motion()
    write_table(file, table_of(solver.torques(q, qd, qdd), qdd))
    robot = replace(
        load_robot("ur10_simulated"),
        accelerations=configured,
        cutoff=7.0 if configured == "low-pass" else None,
    )
    found = evaluate(file, robot, **options).accelerations
    assert (found.method, found.cutoff) == (method, cutoff)


def rtde_table(currents):
    q, qd, _, stamps = motion()
    columns = {"timestamp": 1234.0 + stamps * 1e-9}
    for kind, values in {"actual_q": q, "actual_qd": qd, "actual_current": currents}.items():
        columns |= {f"{kind}_{i}": values[:, i] for i in range(6)}
    return {**columns, "target_q_0": q[:, 0], "robot_mode": 7.0 + 0 * stamps}


def test_a_table_of_urs_record_tool_holds_currents(tmp_path):
    q, qd, qdd, _ = motion()
    ur10 = Solver("ur10_inverse_dynamics_solver/InverseDynamicsSolverUR10")
    torques = ur10.torques(q, qd, qdd)
    file = tmp_path / "robot_data.txt"
    write_table(file, rtde_table(torques / ur10.drive_gains), " ")
    result = evaluate(file, "ur10_real")
    assert result.effort.meaning == "current"
    assert result.effort.stated_by == "as the recording's format says"
    np.testing.assert_allclose(result.measured, torques, rtol=1e-12)
    assert result.log.notes == ("2 columns left out: target_q_0, robot_mode",)
    assert result.time[-1] == pytest.approx(1499 / 250)
    assert read_recording(file).joint_names == ("0", "1", "2", "3", "4", "5")


def test_currents_have_a_name_of_their_own(file):
    header = "time,position.a,velocity.a,current.a,position.b,velocity.b,current.b\n"
    rows = "0,1,2,3,4,5,6\n0.01,1,2,3.5,4,5,6.5\n"
    file.write_text(header + rows)
    log = read_recording(file, ("b", "a"))
    np.testing.assert_array_equal(log.effort, [[6, 3], [6.5, 3.5]])
    assert log.effort_is == read_recording(file).effort_is == "current"
    assert log.notes == ()
    both = "joint a: expected a column effort.a or current.a, got both; rename or remove the one"
    fails(file, header.replace("position.b", "effort.a") + rows, both)
    fails(file, header.replace("position.b", "effort.a") + rows, both, joints=())
    fails(
        file,
        header.replace("current.a", "effort.a") + rows,
        "joint a: expected a column current.a, got none; other joints have currents",
        joints=("a", "b"),
    )
    fails(file, HEADER.replace("velocity.a", "current.b") + ROWS, "column velocity.a")


@pytest.mark.parametrize(
    ("name", "unit", "right"),
    [("position.a", " [deg]", "rad (prismatic m)"), ("velocity.a", "(deg/s)", "rad/s (prismatic")],
)
def test_a_unit_in_a_heading_is_an_error(file, name, unit, right):
    expected = f"column {name}{unit}: expected a joint's name without a unit, got '{unit.strip()}'"
    fails(file, HEADER.replace(name, name + unit) + ROWS, expected)
    fails(file, HEADER.replace(name, name + unit) + ROWS, f"give numbers in {right}", joints=())


def test_what_urs_record_tool_should_have_recorded_is_said(file):
    fails(
        file,
        "timestamp target_q_0 target_qd_0 target_current_0\n0 0 0 0\n",
        "missing: actual_q_0; target_q_0, target_qd_0, target_current_0 are commanded values, "
        "not measured ones; have the RTDE record tool's configuration list actual_q",
    )
    fails(
        file,
        "timestamp actual_q_0 actual_q_1 actual_qd_0 actual_qd_1 actual_current_0\n0 0 0 0 0 0\n",
        "missing: actual_current_1; have the RTDE",
        joints=("a", "b"),
    )
    header = "timestamp actual_q_0 actual_q_1 actual_qd_0 actual_current_0\n"
    fails(file, header, "expected 1 joint, as the chain has, got 2; is it another robot's?")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("time,q\n0,1\n", "expected columns time, position.JOINT"),
        ("time,q\n0,1\n", "got time, q; give them these names, in s, rad, rad/s and N m (or A)"),
        (HEADER.replace("time", "t") + ROWS, "expected a column time [s], got t, position.a"),
        (HEADER.replace("effort.a", "x") + ROWS, "joint a: expected a column effort.a, got none"),
        (HEADER.replace("effort.a", "x") + ROWS, "`ids torques` computes them"),
        (HEADER.replace("velocity.a", "x") + ROWS, "joint a: expected a column velocity.a"),
        (HEADER.replace(".a", ".b") + ROWS, "expected the joints a, got b; missing: a; give the"),
        (
            HEADER.replace(",", ";") + "0;1,5;2;3\n",
            ":2: column 2 (position.a): expected a number, got '1,5'; decimals need a point",
        ),
        (HEADER + "0,1,2,3\n8,1,2,3\n", "expected seconds, got steps of 8: are they milliseconds?"),
        (HEADER + "0,1,2,3\n2000,1,2,3\n", "are they microseconds? Divide the column by 1e+06"),
        (HEADER + "0,1,2,3\n8e6,1,2,3\n", "are they nanoseconds? Divide the column by 1e+09"),
        (HEADER + "1e10,1,2,3\n1e10,1,2,3\n", "expected seconds, got 1e+10"),
    ],
)
def test_what_is_wrong_with_a_table_is_said(file, text, expected):
    fails(file, text, expected)


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ({"topic": "/states"}, "--topic /states: a table has no topics"),
        ({"clock": "receive"}, "--clock receive: a table has no clocks"),
    ],
)
def test_what_only_bags_have_cannot_be_chosen(file, option, said):
    file.write_text(HEADER + ROWS)
    with pytest.raises(BagError, match=f"{said}, recordings have; leave it out"):
        read_recording(file, **option)
    assert len(read_recording(file, usual_topic="/joint_states")) == 2


def test_accelerations_of_some_joints_are_not_enough(file):
    header = "time,position.a,velocity.a,effort.a,position.b,velocity.b,effort.b,acceleration.a\n"
    fails(
        file,
        header + "0,1,2,3,4,5,6,7\n",
        "joint b: expected a column acceleration.b, got none",
        joints=("a", "b"),
    )


def test_a_file_that_is_none_is_said(tmp_path):
    with pytest.raises(BagError, match="no such file; expected a table of numbers in text"):
        read_recording(tmp_path / "nothing.csv")
    file = tmp_path / "motion.csv"
    with pytest.raises(BagError, match="clock: expected one of auto, header, receive, got 'wall'"):
        read_recording(file, clock="wall")

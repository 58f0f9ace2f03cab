# SPDX-License-Identifier: Apache-2.0
import gzip
import json
import os
import pickle
import re
import shlex
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from example_recordings import motion, table_of, write_table
from example_robots import JOINTS

from inverse_dynamics import Solver, evaluate, load_robot, read_recording
from inverse_dynamics.errors import BagError, EvaluationError
from inverse_dynamics.recordings.array_files import HDF5
from inverse_dynamics.recordings.log_format import LogFormat
from inverse_dynamics.recordings.recordings import position_ranges
from inverse_dynamics.recordings.table_logs import read_motion
from inverse_dynamics.recordings.tables import open_table, parts_joined

HEADER = "time,position.a,velocity.a,effort.a\n"
ROWS = "0,1,2,3\n0.01,1.5,2.5,3.5\n"


@pytest.fixture
def file(tmp_path):
    return tmp_path / "motion.csv"


def fails(path, text, expected, joints=("a",)):
    path.write_text(text)
    with pytest.raises(BagError, match=re.escape(expected)) as caught:
        read_recording(path, joints)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize("ratios", [(100.0, -80.0, 80.0, 50.0, 50.0, 40.0)])
@pytest.mark.parametrize("coupled", [False, True], ids=["ratios", "matrix"])
def test_states_of_motors_become_those_of_joints(ratios, coupled):
    """The last motor of a wrist turns with the one before."""
    q, qd, _, stamps = motion()
    G = np.diag(ratios)
    G[5, 4] = -40.0 if coupled else 0.0
    effort = 10 * q
    motors = {"time": stamps * 1e-9, "q": q @ G.T, "qd": qd @ G.T}
    motors["effort"] = effort @ np.linalg.inv(G)
    power = (motors["effort"] * motors["qd"]).sum(axis=1)
    np.testing.assert_allclose(power, (effort * qd).sum(axis=1), rtol=1e-9)  # gears lose nothing
    gears = G.ravel() if coupled else ratios
    found = evaluate(motors, "ur10_simulated", gears=[*map(float, gears)])
    for given, expected in ((found.log.q, q), (found.log.qd, qd), (found.measured, effort)):
        np.testing.assert_allclose(given, expected, rtol=1e-9, atol=1e-9)


def test_currents_of_coupled_motors_are_refused(file):
    write_table(
        file,
        {
            "time": np.arange(9.0) / 100,
            **{
                f"{kind}.{joint}": np.arange(9.0)
                for kind in ("position", "velocity", "current")
                for joint in "ab"
            },
        },
    )
    with pytest.raises(BagError, match="gears: expected torques of the motors"):
        read_recording(file, ("a", "b"), form=LogFormat(gears=(50.0, 0.0, 50.0, 50.0)))


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " ", "   "])
def test_columns_are_matched_by_name_whatever_is_between_them(file, delimiter):
    q, qd, _, stamps = motion()
    file = file.with_suffix(".tsv") if delimiter == "\t" else file
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
        ("low-pass", {"accelerations": "backward-difference"}, "backward-difference", None),
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
    assert result.log.notes[1:] == ("2 columns left out: target_q_0, robot_mode",)
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
    both = "expected efforts or currents, got both: effort.a and current.a; state those to compare"
    file.write_text(header.replace("position.b", "effort.a") + rows)
    with pytest.raises(BagError, match=both):
        read_recording(file, ("a",), form=LogFormat("tau=effort.a, i=current.a"))
    assert read_recording(file, ("a",)).notes == (
        "3 columns left out: current.a, velocity.b, current.b",
    )
    fails(
        file,
        header.replace("current.a", "effort.a") + rows,
        "joint b: expected a column effort.b, got none",
        joints=("a", "b"),
    )


def test_a_unit_in_a_heading_is_converted_and_said(file):
    file.write_text(HEADER.replace("position.a", "position.a [deg]").replace("time", "t_ms") + ROWS)
    log = read_recording(file, ("a",))
    np.testing.assert_allclose(log.q[:, 0], np.radians([1.0, 1.5]))
    np.testing.assert_array_equal(log.stamps, [0, 10_000])
    assert log.notes == (
        "columns: time: t_ms [ms]; position: position.a [deg] [deg]; velocity: velocity.a; "
        "effort: effort.a",
    )


def test_accelerations_under_another_name_are_taken_where_they_are_stated(file):
    file.write_text("t,q1,dq1,ddq1,tau1\n0,1,0,2,3\n0.1,1,0,2,3\n")
    log = read_recording(file, ("a",))
    assert log.qdd is None
    assert "accelerations ddq1 to ddq1 aren't taken" in " ".join(log.notes)
    log = read_recording(file, ("a",), form=LogFormat("qdd=ddq1"))
    np.testing.assert_array_equal(log.qdd, [[2], [2]])


def test_a_unit_that_only_the_owner_knows_is_asked_for(file):
    text = HEADER.replace("effort.a", "torque_a [%]") + ROWS
    fails(file, text, "effort: expected a known unit, got percent: what is one in SI units? State")
    log = read_recording(file, ("a",), form=LogFormat(scale=("effort=0.5",)))
    np.testing.assert_array_equal(log.effort[:, 0], [1.5, 1.75])


@pytest.mark.parametrize(
    "text",
    [
        "# made by a logger\n# t q1 tau1\n0 1 2\n0.5 3 4\n",
        "t;q1;tau1;\n0;1;2;\n0,5;3;4;\n",
        "sep=;\nt;q1;tau1\n0;1;2\n0,5;3;4\n",
        '"t","q1","tau1"\n"0","1","2"\n"0,5","3","4"\n',
        "t,q1,tau1\nms,rad,mNm\n0,1,2000\n500,3,4000\n",
        "stamp.sec,stamp.nanosec,q1,tau1\n7,0,1,2\n7,500000000,3,4\n",
        "sec,us,q1,tau1\n7,900000,1,2\n8,400000,3,4\n",
        "time_s,time_ms,q1,tau1\n0,0,1,2\n0.5,500,3,4\n",
        "millis,q1,tau1\n70,1,2\n570,3,4\n",
        "Time,q1,tau1\n0.25 sec,1,2\n0.75 sec,3,4\n",
        "Time,q1,tau1\n31-Jan-2026 23:59:59.750,1,2\n01-Feb-2026 00:00:00.250,3,4\n",
        "time,q1,tau1\n12:30:00:250,1,2\n12:30:00:750,3,4\n",
        "t,q1,tau1\n0,1,2\n0.25,,7\n0.3,nan,7\n0.4,7,N/A\n0.5,3,4\n0.6,7",
        "Log of an arm\n2 axes,,\n% rate: 2 Hz\n\nt;q1;tau1\ns;rad;Nm\n0;1;2\n0.5;3;4\n",
        "time,joint1_pos,joint1_torque\n2026-01-31T12:30:00,1,2\n2026-01-31T12:30:00.5,3,4\n",
        "time,q1,tau1\n12:30:00,1,2\n12:30:00.500,3,4\n",
        't,q,tau,x\n0,[1],(2),"[8, 9]"\n0.5,[3],(4),"[8, 9]"\n',
        "7,0,base,a,1,7,2\n7,500000000,base,a,3,7,4\n",
        "time,q1,tau1\n23:59:59.7500000,1,2\n00:00:00.25,3,4\n",
        "time,q1,tau1\n2026-01-31 23:59:59.5Z,1,2\n2026-02-01 00:00:00.000000000Z,3,4\n",
        "t,q1,tau1,x,y\n0,,NA,null,N/A\n0,1,2,7,7\n0.5,3,4,7,7\n",
        "# made by a logger\n" * 60 + "t,q1,tau1\n0,1,2\n0.5,3,4\n",
    ],
)
def test_a_table_is_read_as_programs_write_it(file, text):
    file.write_text(text)
    motion = read_motion(open_table(file), ("a",), LogFormat(), ("position", "effort"))
    np.testing.assert_allclose(motion.time - motion.time[0], [0, 0.5])
    np.testing.assert_array_equal(motion.numbers["position"][:, 0], [1, 3])
    np.testing.assert_array_equal(motion.numbers["effort"][:, 0], [2, 4])


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        (
            "log.xlsx",
            b"PK",
            r"got \.xlsx; convert it: save it as \.csv in the program that wrote it",
        ),
        ("log.h5", b"", r"got \.h5; convert it: .*python3 -c .*h5py\.File\(.*log\.h5 log\.npz"),
        ("my log.csv.gz", b"", r"convert it: gunzip -k '.*my log\.csv\.gz'"),
        ("Ann's.h5", b"", r"""python3 -c ".*" '.*/Ann'"'"'s\.h5' 'Ann'"'"'s'\.npz"""),
        (
            "log.csv",
            b"\x1f\x8b\x80",
            "isn't text in UTF-8.* it is compressed: unpack it with gunzip",
        ),
        ("log.csv", b"q [\xb0]", "isn't text in UTF-8.*iconv -f LATIN1 -t UTF-8 .*log.csv > NEW"),
        ("a log.csv", b"q [\xb0]", "iconv -f LATIN1 -t UTF-8 '.*a log.csv' > NEW"),
    ],
)
def test_what_is_not_read_is_refused_with_the_command_that_converts_it(
    tmp_path, name, content, expected
):
    file = tmp_path / name
    file.write_bytes(content)
    with pytest.raises(BagError, match=expected):
        read_recording(file, ("a",))


def command_of(path, joints=("a",)):
    """What the message says to do with a file."""
    with pytest.raises(BagError) as caught:
        read_recording(path, joints)
    return str(caught.value).partition("it: ")[2]


def follow(command, tmp_path):
    """Does it with this Python, and what is installed here."""
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    subprocess.run(command, shell=True, cwd=tmp_path, check=True, env={**os.environ, "PATH": path})


@pytest.mark.parametrize("rows", [True, False])
@pytest.mark.parametrize("kind", ["json", "jsonl", "pkl", "feather", "zip", "gz"])
def test_what_is_converted_as_the_message_says_is_read(tmp_path, kind, rows):
    """Without pandas."""
    count = np.arange(24)
    table = {"t": count / 10, "q1": 1.0 * count, "tau1": 10.0 * count}
    table = {name: column.tolist() for name, column in table.items()}
    by_row = [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]
    source, file = tmp_path / "my log.csv", tmp_path / f"my log.{kind}"
    write_table(source, table)
    if kind == "json":
        by_number = {k: dict(enumerate(column)) for k, column in table.items()}  # as pandas has it
        file.write_text(json.dumps(by_row if rows else by_number))
    elif kind == "jsonl":
        file.write_text("".join(f"{json.dumps(row)}\n" for row in by_row))
    elif kind == "pkl":
        file.write_bytes(pickle.dumps(by_row if rows else table))
    elif kind == "feather":
        pa = pytest.importorskip("pyarrow")
        pytest.importorskip("pyarrow.feather").write_feather(pa.table(table), str(file))
    elif kind == "zip":
        zipfile.ZipFile(file, "w").write(source, source.name)
    else:
        file = source.with_name("my log.csv.gz")
        file.write_bytes(gzip.compress(source.read_bytes()))
    source.unlink()
    follow(command_of(file), tmp_path)
    (made,) = (path for path in tmp_path.iterdir() if path != file)
    log = read_recording(made, ("a",))
    np.testing.assert_array_equal(log.q[:, 0], table["q1"])
    np.testing.assert_array_equal(log.effort[:, 0], table["tau1"])


def test_a_command_installs_what_it_lacks_first(tmp_path, monkeypatch):
    file = tmp_path / "log.h5"
    file.touch()
    for found, first in ((None, "pip install h5py && python3 -c"), (object(), "python3 -c")):
        monkeypatch.setattr("inverse_dynamics.installation.extras.find_spec", lambda _, f=found: f)
        assert command_of(file).startswith(first)


def test_a_table_with_a_row_for_each_joint_is_turned_as_the_message_says(tmp_path):
    rows = [(k / 10, joint, k, 10 * k) for k in range(24) for joint in ("a", "b")]
    lines = [f"{t},{joint},{q + (joint == 'b')},{tau}\n" for t, joint, q, tau in rows]
    (tmp_path / "log.csv").write_text("time,joint,position,effort\n" + "".join(lines))
    follow(command_of(tmp_path / "log.csv", ("a", "b")), tmp_path)
    log = read_recording(tmp_path / "NEW.csv", ("a", "b"))
    np.testing.assert_array_equal(log.q, [[k, k + 1] for k in range(24)])
    np.testing.assert_array_equal(log.effort, [[10 * k, 10 * k] for k in range(24)])


def test_the_command_for_hdf5_keeps_arrays_of_numbers(tmp_path):
    (tmp_path / "h5py.py").write_text(
        "import numpy\n"
        "class File:\n"
        '    def __init__(self, path): assert path == "Ann\'s.h5"\n'
        "    def visititems(self, visit):\n"
        "        visit('group', object())\n"
        "        visit('file', numpy.ones(3))\n"
        "        visit('names', numpy.array(['a', 'b'], object))\n"
    )
    names = {"path": shlex.quote("Ann's.h5"), "stem": shlex.quote("Ann's")}
    _, *arguments = shlex.split(HDF5.format(**names))
    subprocess.run([sys.executable, *arguments], cwd=tmp_path, check=True)
    assert open_table(tmp_path / "Ann's.npz").names == ("/file",)


def test_commanded_values_of_urs_record_tool_are_not_measured_ones(file):
    fails(
        file,
        "timestamp target_q_0 target_qd_0 target_current_0\n0 0 0 0\n",
        "expected columns of position and effort for 1 joint, a, got timestamp, target_q_0, target_qd_0",
    )
    header = "timestamp actual_q_0 actual_q_1 actual_qd_0 actual_current_0\n"
    fails(
        file,
        header,
        "expected columns of position for 1 joint, a, got 2 columns, actual_q_0 to actual_q_1; torques depend on them; "
        "state them with columns='position=actual_q_*' (* is",
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "time,foo\n0,1\n",
            "expected columns of position and effort for 1 joint, a, got time, foo; torques",
        ),
        (
            "time,1,2,3\n0,1,2,3\n",
            "expected columns of position and effort for 1 joint, a, got time, 1 to 3; torques",
        ),
        (HEADER.replace("time", "x") + ROWS, "expected a column of time [s], got x, position.a"),
        (HEADER.replace("effort.a", "x") + ROWS, "expected columns of effort for 1 joint, a, got"),
        (HEADER.replace("effort.a", "x") + ROWS, "`ids torques` computes them"),
        (
            HEADER.replace(".a", ".b") + ROWS,
            "expected columns of position and effort for 1 joint, a, got time",
        ),
        (HEADER + "0,1,2,3\n8,1,2,3\n", "expected seconds, got steps of 8: are they ms?"),
        (HEADER + "0,1,2,3\n1000,1,2,3\n", "expected seconds, got steps of 1000: are they us?"),
        (HEADER + "0,1,0.5,3\n2e6,2,0.5,3\n", "expected seconds, got steps of 2e+06: are they"),
        (HEADER + "0,1,2,3\n25e4,1,2,3\n", "expected seconds, got steps of 250000: are they us?"),
        (HEADER + "4e18,1,2,3\n4.1e18,1,2,3\n", "expected seconds, got steps of 1e+17: are they"),
        (
            HEADER + "0,1,,3\n1,1,,3\n",
            "got 0; 2 have an empty field: no number is in the columns velocity.a",
        ),
        (HEADER + "1e10,1,2,3\n1e10,1,2,3\n", "expected seconds, got 1e+10; count from"),
        (
            "t,topic,value\n0,/q[0],1\n",
            "expected a row for each time, got one for each topic; turn it: python3 -c",
        ),
        (
            "t,q1,tau1\n0,2048,1\n0.1,2047,1\n",
            "position: expected a known unit, got whole numbers beyond 100",
        ),
        (
            "7,0,base,a,b,1,2,,3,4\n7,5,base,b,a,2,1,,4,3\n",
            ":2: expected the joints a, b in all messages, as in the first one, got b, a; record",
        ),
        (
            "time,field.name0,field.position0,field.effort0\n0,a,1,1\n1,b,2,2\n",
            ":3: expected the joints a in all messages, as in the first one, got b; record",
        ),
    ],
)
def test_what_is_wrong_with_a_table_is_said(file, text, expected):
    fails(file, text, expected)


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ({"topic": "/states"}, "topic='/states': a table has no topics"),
        ({"clock": "receive"}, "clock='receive': a table has no clocks"),
    ],
)
def test_what_only_bags_have_cannot_be_chosen(file, option, said):
    file.write_text(HEADER + ROWS)
    with pytest.raises(BagError, match=f"{said}, recordings have; leave it out"):
        read_recording(file, **option)
    assert len(read_recording(file, usual_topic="/joint_states")) == 2


def test_a_file_that_is_none_is_said(tmp_path):
    with pytest.raises(BagError, match="no such file; expected a table of numbers in text"):
        read_recording(tmp_path / "nothing.csv")
    file = tmp_path / "motion.csv"
    with pytest.raises(BagError, match="clock: expected one of auto, header, receive, got 'wall'"):
        read_recording(file, clock="wall")


def test_what_the_names_do_not_say_is_stated(file):
    file.write_text("0;1,5;200;-3\n10;;210;-4\n20;2,5;220;-5\n30;3,5;230;-6\n")
    form = LogFormat(
        "time=1, q=2-2, qd=3-3, effort=4-4", ("time=ms", "qd=deg", "effort=1e-3"), (-1.0,)
    )
    log = read_recording(file, ("a",), form=form)
    np.testing.assert_array_equal(log.stamps, [0, 20_000_000, 30_000_000])
    np.testing.assert_allclose(log.q[:, 0], [-1.5, -2.5, -3.5])
    np.testing.assert_allclose(log.qd[:, 0], -np.radians([200, 220, 230]))
    np.testing.assert_allclose(log.effort[:, 0], [3e-3, 5e-3, 6e-3])
    assert log.notes[-1] == "1 row with an empty field left out"


@pytest.mark.parametrize(
    ("form", "expected"),
    [
        (
            LogFormat(scale=("effort=furlong",)),
            "scale: expected a number other than 0 or one of deg",
        ),
        (LogFormat(scale=("effort=1,2",)), "scale: effort: expected 1 or 1 number, got 2"),
        (
            LogFormat(scale=("current=2",)),
            "scale: expected one of time, position, velocity, effort",
        ),
        (LogFormat(scale=("torgue=2",)), "scale: expected one of time, position"),
        (LogFormat(sign=(1.0, -1.0)), "sign: expected 1 or -1 for each of 1 joint, got 1, -1"),
        (LogFormat(sign=(2.0,)), "sign: expected 1 or -1 for each of 1 joint, got 2"),
        (LogFormat(gears=(1.0, 2.0)), "gears: expected 1 ratios or the 1 numbers of a matrix, got"),
        (LogFormat(gears=(0.0,)), "gears: expected a matrix that can be inverted, as each joint"),
        (LogFormat(columns="q=x"), "columns: x: expected columns of the file, got x; the file has"),
        (LogFormat("q=x", ("effort=furlong",)), "scale: expected a number other than 0 or one of"),
    ],
)
def test_a_statement_that_fits_nothing_is_refused(file, form, expected):
    file.write_text(HEADER + ROWS)
    with pytest.raises(BagError, match=re.escape(f"{file}: {expected}")):
        read_recording(file, ("a",), form=form)


def test_positions_alone_are_enough(file):
    q, qd, _, stamps = motion()
    columns = {f"q{i}": q[:, i] for i in range(6)} | {f"tau{i}": qd[:, i] for i in range(6)}
    write_table(file, columns)
    fails(file, file.read_text(), "expected a column of time [s], got q0", JOINTS)
    log = read_recording(file, JOINTS, form=LogFormat(rate=250.0))
    np.testing.assert_array_equal(log.stamps, stamps - stamps[0])
    assert np.abs(log.qd - qd).max() < 0.01 * np.abs(qd).max()
    assert log.notes[-2] == "samples are 250 per second, as stated"
    assert log.notes[-1].startswith("no velocities: those of the positions are taken")


@pytest.mark.parametrize("kind", ["npz", "mat", "parquet"])
def test_files_of_arrays_hold_the_same_as_text(tmp_path, kind):
    q, qd, qdd, stamps = motion()
    arrays = {"time": stamps * 1e-9, "q": q, "dq": qd.T, "tau": qdd, "name": np.array("a robot")}
    path = tmp_path / f"motion.{kind}"
    if kind == "npz":
        np.savez(path, **arrays)
    elif kind == "mat":
        scipy_io = pytest.importorskip("scipy.io")
        scipy_io.savemat(path, {"rec": arrays})
    else:
        pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
        rows = {name: list(arrays[name]) for name in ("time", "q", "tau")} | {"dq": list(qd)}
        parquet.write_table(pa.table(rows), path)
    log = read_recording(path, JOINTS)
    for found, expected in ((log.q, q), (log.qd, qd), (log.effort, qdd)):
        np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(log.stamps, stamps)


def test_a_data_set_of_lerobot_has_its_joints_by_name(tmp_path):
    """As LeRobot v3 lays it out: episodes in one file, names in meta/info.json."""
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    joints = ("shoulder_pan_joint", "elbow_joint")
    names = [f"{joint}.{kind}" for kind in ("pos", "vel") for joint in ("elbow", "shoulder_pan")]
    features = {
        "action": {"names": names[:2]},
        "observation.state": {"names": {"motors": names}},
        "observation.effort": {"names": ["elbow", "shoulder_pan"]},
        "observation.images.top": {"names": ["height", "width", "channel"]},
    }
    (tmp_path / "meta").mkdir()
    (tmp_path / "meta/info.json").write_text(json.dumps({"features": features}))
    folder = tmp_path / "data/chunk-000"
    folder.mkdir(parents=True)
    state = np.arange(24.0).reshape(6, 4)
    columns = {
        "timestamp": np.float32([0, 0.1, 0.2, 0, 0.1, 0.2]),
        "action": [*(state[:, :2] + 9)],
        "observation.state": [*state],
        "observation.effort": [*(-state[:, :2])],
        "episode_index": [0, 0, 0, 1, 1, 1],
    }
    for k in range(2):
        rows = {name: column[3 * k : 3 * k + 3] for name, column in columns.items()}
        parquet.write_table(pa.table(rows), folder / f"file-00{k}.parquet")
    whole, second = (read_recording(p, joints) for p in (tmp_path, folder / "file-001.parquet"))
    np.testing.assert_array_equal(whole.q, state[:, [1, 0]])
    np.testing.assert_array_equal(whole.qd, state[:, [3, 2]])
    np.testing.assert_array_equal(whole.effort, -state[:, [1, 0]])
    np.testing.assert_array_equal(second.q, whole.q[3:])
    assert whole.notes[-1].startswith("time restarts 1 time")


@pytest.mark.parametrize("kind", ["npz", "mat", "parquet"])
def test_a_damaged_file_of_arrays_is_named(tmp_path, kind):
    path = tmp_path / f"motion.{kind}"
    path.write_bytes(b"PK\x03\x04 nonsense" * 20)
    with pytest.raises(BagError, match=f"motion.{kind}: can't be read as .{kind}"):
        read_recording(path, JOINTS)


def test_a_table_of_rostopic_has_its_joints_by_name(file):
    file.write_text(
        "%time,field.header.seq,field.header.stamp,field.name0,field.name1,field.position0,"
        "field.position1,field.velocity0,field.velocity1,field.effort0,field.effort1\n"
        "1600000000100000000,1,1600000000000000000,b,a,1,2,3,4,5,6\n"
        "1600000000120000000,2,1600000000010000000,b,a,1,2,3,4,5,7\n"
    )
    log = read_recording(file, ("a", "b"))
    np.testing.assert_array_equal(log.q, [[2, 1], [2, 1]])
    np.testing.assert_array_equal(log.effort, [[6, 5], [7, 5]])
    assert log.stamps[1] - log.stamps[0] == pytest.approx(10_000_000, abs=300)


@pytest.mark.parametrize(
    "text",
    [
        "Time,name_0,name_1,position_0,position_1,effort_0,effort_1\n0,b,a,1,2,3,4\n1,b,a,1,2,3,4\n",
        'time,name,position,effort\n0,"[\'b\', \'a\']","[1, 2]","[3, 4]"\n1,"[\'b\', \'a\']","[1, 2]","[3, 4]"\n',
    ],
    ids=["columns", "lists"],
)
def test_joints_whose_names_stand_beside_are_in_the_order_of_the_chain(file, text):
    file.write_text(text)
    log = read_motion(open_table(file), ("a", "b"), LogFormat(), ("position", "effort")).numbers
    np.testing.assert_array_equal(log["position"], [[2, 1], [2, 1]])
    np.testing.assert_array_equal(log["effort"], [[4, 3], [4, 3]])


def test_joints_of_parquet_whose_names_stand_beside_are_in_the_order_of_the_chain(tmp_path):
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    file = tmp_path / "states.parquet"
    columns = {"time": [0.0, 0.1], "effort": [[3.0, 4.0]] * 2}
    columns |= {kind: [[1.0, 2.0]] * 2 for kind in ("position", "velocity")}
    parquet.write_table(pa.table({**columns, "name": [["b", "a"]] * 2}), file)
    np.testing.assert_array_equal(read_recording(file, ("a", "b")).q, [[2, 1], [2, 1]])
    parquet.write_table(pa.table({**columns, "name": [["b", "a"], ["a", "b"]]}), file)
    with pytest.raises(BagError, match="name: expected the joints b, a in all messages"):
        read_recording(file, ("a", "b"))


def test_rows_out_of_order_are_sorted(file):
    file.write_text(HEADER + "".join(f"{0.1 * k:.1f},{k},{k},0\n" for k in [3, 1, 0, 4, 2]))
    log = read_recording(file, ("a",))
    np.testing.assert_array_equal(log.q[:, 0], [0, 1, 2, 3, 4])
    assert log.notes == ("rows are sorted by time",)


@pytest.mark.parametrize(
    ("start", "step", "velocity", "unit", "period"),
    [
        (0, 8_000_000, 0.0, "ns", 0.008),
        (0, 1_000, 1e3, "us", 0.001),
        (0, 250_000, 4e3, "ns", 0.00025),
        (1_700_000_000_000_000_000, 250_000, 0.0, "ns", 0.00025),
        (1_700_000_000_000, 8, 0.0, "ms", 0.008),
    ],
)
def test_time_is_converted_where_its_unit_is_sure(file, start, step, velocity, unit, period):
    """By dates since 1970, by velocities, or by steps that fit ns alone."""
    rows = [f"{start + step * k},{k},{velocity},0\n" for k in range(12)]
    file.write_text(HEADER + "".join(rows))
    log = read_recording(file, ("a",))
    np.testing.assert_allclose(np.diff(log.time), period, rtol=0.01)  # digits of dates in ns
    assert log.notes[0].startswith(f"time is taken to be in {unit}: ")


def test_episodes_follow_each_other(file):
    rows = "".join(f"{0.1 * k:.1f},{k},{k},0\n" for k in [0, 1, 2, 3, 0, 1, 2])
    file.write_text(HEADER + rows)
    log = read_recording(file, ("a",))
    np.testing.assert_allclose(log.time, [0, 0.1, 0.2, 0.3, 5.3, 5.4, 5.5])
    assert log.notes == ("time restarts 1 time: runs are taken one after another, 5 s apart",)


def test_files_of_one_recording_are_joined_at_the_times_of_the_first(tmp_path):
    q, tau = tmp_path / "q.csv", tmp_path / "tau.csv"
    time = 0.1 * np.arange(21)
    write_table(q, {"t": time, "q1": np.sin(time), "qd1": np.cos(time)})
    write_table(tau, {"t": time[::2], "joint1": 10 * time[::2]})
    assert parts_joined([q, tau]) == [tmp_path / f"q.csv+{tau}"]
    log = read_recording(f"{q}+{tau}", ("joint1",))
    np.testing.assert_array_equal(log.q[:, 0], np.sin(time))
    np.testing.assert_array_equal(log.qd[:, 0], np.cos(time))
    np.testing.assert_allclose(log.effort[:, 0], 10 * time)
    shuffled = np.array([4.0, 2.0, 0.0, 3.0, 1.0])
    write_table(tau, {"t": shuffled / 2, "joint1": 5 * shuffled})
    log = read_recording(f"{q}+{tau}", ("joint1",))
    np.testing.assert_allclose(log.effort[:, 0], 10 * time)
    write_table(tau, {"t": np.tile(time[::2], 2), "joint1": np.arange(22.0)})
    with pytest.raises(BagError, match=r"tau\.csv: expected times that increase.* got 1 step back"):
        read_recording(f"{q}+{tau}", ("joint1",))
    tau.write_text("joint1\n1\n2\n")
    with pytest.raises(
        BagError, match=r"tau\.csv: expected 21 rows, as .*q\.csv has, .*got 2 rows"
    ):
        read_recording(f"{q}+{tau}", ("joint1",))
    whole = tmp_path / "motion.csv"
    whole.write_text(HEADER + ROWS)
    assert parts_joined([whole, whole]) == [whole, whole]


def test_a_slow_clock_is_mended_as_the_message_says(tmp_path, torques):
    file = tmp_path / "log.csv"
    table = table_of(torques)
    write_table(file, {**table, "time": table["time"] / 1.3})
    found = evaluate(file, "ur10_simulated")
    (remedy,) = re.findall(r"of a table: scale=\['(time=\S+)'\]", found.notes[-1])
    mended = evaluate(file, "ur10_simulated", scale=[remedy])
    assert mended.diagnosis == ()
    assert mended.mean_rmse < 0.1 * found.mean_rmse


def test_files_are_known_by_what_their_names_say(tmp_path):
    time = 0.1 * np.arange(21)
    files = [tmp_path / f"excit_{name}_record.txt" for name in ("ang", "vel", "torque")]
    for file, values in zip(files, (np.sin(time), np.cos(time), 10 * time), strict=True):
        np.savetxt(file, np.column_stack([values, values]))
    (joined,) = parts_joined(files)
    log = read_recording(joined, ("a", "b"), form=LogFormat(rate=10.0))
    np.testing.assert_allclose(log.q[:, 0], np.sin(time))
    np.testing.assert_allclose(log.qd[:, 1], np.cos(time))
    np.testing.assert_allclose(log.effort[:, 1], 10 * time)


@pytest.mark.parametrize(
    ("column", "scale", "expected"),
    [
        ("lift_position", [], {"lift": (2.0, 3.0, 4.0)}),
        ("lift_position_mm", [], {"lift": (0.002, 0.003, 0.004)}),
        ("lift_position_mm", ["q=2"], {"lift": (4.0, 6.0, 8.0)}),
        ("lift_position", ["q=2,3"], {}),
    ],
)
def test_positions_of_joints_outside_the_chain_are_in_si_units(tmp_path, column, scale, expected):
    file = tmp_path / "log.csv"
    file.write_text(f"{column}\n2\n4\n")
    found = position_ranges(file, ["lift"], form=LogFormat(scale=scale))
    assert found == {joint: pytest.approx(span) for joint, span in expected.items()}

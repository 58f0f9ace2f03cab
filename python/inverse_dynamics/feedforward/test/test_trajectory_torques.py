# SPDX-License-Identifier: Apache-2.0
import csv
import json
import re
import sqlite3
from contextlib import closing
from dataclasses import replace
from shutil import rmtree

import numpy as np
import pytest
import two_arms
from example_recordings import (
    STORE,
    TOPIC,
    TRAJECTORY,
    joint_state,
    motion,
    points_of_motion,
    table_of,
    trajectory,
    write_messages,
    write_motion,
    write_table,
    write_trajectories,
)
from example_robots import JOINTS, PRESLIDING, RIGID_BODY, URDF
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer
from rosbags.rosbag2.writer import zstd
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from inverse_dynamics import (
    Solver,
    cli,
    load_robot,
    read_recording,
    trajectory_torques,
    write_trajectory_torques,
)
from inverse_dynamics.errors import BagError, OutputError

BACKWARDS = JOINTS[::-1]


@pytest.fixture(scope="module")
def robot():
    return load_robot("ur10_simulated")


def backwards(points):
    return [(since, *(a[::-1] for a in arrays)) for since, *arrays in points]


def read_messages(path):
    with Reader(path) as reader:
        return [(c.topic, stamp, raw) for c, stamp, raw in reader.messages()]


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_efforts_are_filled_in_and_all_else_is_kept(tmp_path, torques, robot, storage):
    first = trajectory(JOINTS, points_of_motion(), stamp=7)
    second = trajectory(BACKWARDS, backwards(points_of_motion(effort=0 * torques))[:3])
    planned = [first, trajectory(JOINTS, []), second]
    state = STORE.serialize_cdr(joint_state(["a"], [1], [2], [3]), "sensor_msgs/msg/JointState")
    with Writer(tmp_path / "planned", version=9, storage_plugin=storage) as writer:
        arm = writer.add_connection("/arm", "sensor_msgs/msg/JointState", typestore=STORE)
        plans = writer.add_connection(TOPIC, TRAJECTORY, typestore=STORE)
        for k, message in enumerate(planned):
            writer.write(arm, 10 * k + 1, state)
            writer.write(plans, 10 * k + 2, STORE.serialize_cdr(message, TRAJECTORY))

    result = trajectory_torques(tmp_path / "planned", robot)
    assert write_trajectory_torques(result, tmp_path / "filled") == ()

    for point, row in zip(first.points, torques, strict=True):
        point.effort = row
    for point, row in zip(second.points, torques[:3, ::-1], strict=True):
        point.effort = np.ascontiguousarray(row)
    before, after = read_messages(tmp_path / "planned"), read_messages(tmp_path / "filled")
    assert [m[:2] for m in after] == [m[:2] for m in before]
    assert [m[2] for m in after if m[0] == "/arm"] == [state] * 3
    filled = [STORE.deserialize_cdr(m[2], TRAJECTORY) for m in after if m[0] == TOPIC]
    for got, expected in zip(filled, planned, strict=True):
        assert got.header == expected.header
        assert got.joint_names == expected.joint_names
        assert len(got.points) == len(expected.points)
        for p, e in zip(got.points, expected.points, strict=True):
            assert p.time_from_start == e.time_from_start
            for field in ("positions", "velocities", "accelerations"):
                np.testing.assert_array_equal(getattr(p, field), getattr(e, field))
            np.testing.assert_allclose(p.effort, e.effort, rtol=0, atol=1e-12)  # rounding
    assert (tmp_path / "filled" / "metadata.yaml").is_file()


def test_a_limit_that_is_passed_is_found_with_its_first_time(tmp_path, torques, robot):
    points = points_of_motion()
    messages = [trajectory(JOINTS, points[:10]), trajectory(JOINTS, points)]
    result = trajectory_torques(write_trajectories(tmp_path / "bag", messages), robot)
    np.testing.assert_array_equal(result.limits, [330, 330, 150, 56, 56, 56])
    peaks = np.abs(torques).max(axis=0)
    low = np.where(np.arange(6) == 1, 0.9 * peaks, np.inf)
    passing, free = replace(result, limits=low).loads[1], replace(result, limits=low).loads[2]
    since = 1e-9 * np.array([point[0] for point in points])
    beyond = np.abs(torques[:, 1]) > low[1]
    early = beyond[:10].any()
    assert passing.passed_time == pytest.approx(since[beyond.argmax()])
    assert passing.passed_trajectory == (1 if early else 2)
    assert abs(passing.peak) == pytest.approx(peaks[1])
    assert passing.peak_time == pytest.approx(since[np.abs(torques[:, 1]).argmax()])
    assert (free.passed_time, free.limit) == (None, np.inf)


@pytest.mark.parametrize("delimiter", [",", " "])
def test_a_table_gets_efforts_and_keeps_its_other_columns(tmp_path, torques, robot, delimiter):
    q, _, qdd, _ = motion()
    table = table_of(0 * q, qdd)
    del table["effort.elbow_joint"]
    write_table(tmp_path / "planned.csv", table, delimiter)
    result = trajectory_torques(tmp_path / "planned.csv", robot)
    write_trajectory_torques(result, tmp_path / "filled.csv")
    np.testing.assert_allclose(
        read_recording(tmp_path / "filled.csv", JOINTS).effort, torques, rtol=0, atol=1e-12
    )
    before = (tmp_path / "planned.csv").read_text().splitlines()
    after = (tmp_path / "filled.csv").read_text().splitlines()
    assert after[0] == f"{before[0]}{delimiter}effort.elbow_joint"
    assert [line.split(delimiter)[-2] for line in after[1:]] == [
        line.split(delimiter)[-1] for line in before[1:]
    ]


def test_a_table_of_lists_gets_efforts_in_columns(tmp_path, robot):
    q, _, _, stamps = motion()
    lists = [f'{t},"{x.tolist()}","a, b"' for t, x in zip(stamps * 1e-9, q, strict=True)]
    (tmp_path / "planned.csv").write_text("\n".join(['time,q,"x, y"', *lists]))
    result = trajectory_torques(tmp_path / "planned.csv", robot)
    write_trajectory_torques(result, tmp_path / "filled.csv")
    with (tmp_path / "filled.csv").open() as file:
        header, *rows = csv.reader(file)
    assert header[:8] == ["time", *(f"q[{k}]" for k in range(6)), "x, y"]
    assert {row.pop(7) for row in rows} == {"a, b"}
    numbers = np.array(rows, dtype=float)
    np.testing.assert_array_equal(numbers[:, 1:7], q)
    np.testing.assert_array_equal(numbers[:, 7:], result.torques[0])


N = (0, [0] * 6, [0] * 6, [0] * 6, [])


@pytest.mark.parametrize(
    ("names", "point", "expected"),
    [
        (
            JOINTS,
            (0, [0] * 6, [], [0] * 6, []),
            "message 1, point 2: velocities: expected 6 numbers, one per joint, got 0: none for "
            "joint shoulder_pan_joint; torques can't be computed without them",
        ),
        (
            JOINTS,
            (0, [0] * 6, [0] * 6, [0] * 4, []),
            "point 2: accelerations: expected 6 numbers, one per joint, got 4: none for joint "
            "wrist_2_joint",
        ),
        (JOINTS[:5], N, "message 1: expected the joints shoulder_pan_joint"),
        ((*JOINTS, "finger"), N, "got also finger, whose efforts aren't known"),
    ],
)
def test_what_is_wrong_with_a_plan_is_said(tmp_path, robot, names, point, expected):
    bag = write_trajectories(tmp_path / "bag", [trajectory(names, [N, point])])
    with pytest.raises(BagError, match=re.escape(expected)):
        trajectory_torques(bag, robot)


def test_a_file_without_a_plan_is_said(tmp_path, robot):
    bag = write_trajectories(tmp_path / "empty", [trajectory(JOINTS, [])])
    with pytest.raises(BagError, match="expected points of a trajectory, got none"):
        trajectory_torques(bag, robot)
    states = write_messages(tmp_path / "states", [joint_state(["a"], [1], [1], [1])])
    with pytest.raises(BagError, match=r"expected one topic of type trajectory_msgs.*got 0"):
        trajectory_torques(states, robot)


def test_positions_alone_are_enough_where_they_are_dense(tmp_path, robot, torques):
    q, _, _, stamps = motion()
    columns = {f"q{i}": q[:, i] for i in range(6)} | {"time": 1e-9 * stamps}
    write_table(tmp_path / "q.csv", columns)
    result = trajectory_torques(tmp_path / "q.csv", robot)
    difference = np.abs(result.torques[0] - torques)[100:-100].max()
    assert difference < 0.02 * np.abs(torques).max()  # of the filter
    assert result.notes[0].startswith("no velocities or accelerations: those of the positions")
    write_table(tmp_path / "q.csv", columns | {"time": 1e-6 * stamps})
    with pytest.raises(BagError, match=r"velocity and acceleration, got steps of 4: are they ms"):
        trajectory_torques(tmp_path / "q.csv", robot)


def test_the_verb_says_which_limit_is_passed(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    points = points_of_motion()
    fast = [(since, q, 9 * qd, 81 * qdd, effort) for since, q, qd, qdd, effort in points]
    bag = write_trajectories(tmp_path / "bag", [trajectory(JOINTS, fast)])
    arguments = ["torques", str(bag), "--robot", "ur10_simulated", "--out", str(tmp_path / "out")]
    assert cli.main(arguments) == 0
    out = capsys.readouterr().out
    assert re.search(r"joint +peak +at +limit +passes its limit", out)
    assert re.search(
        r"shoulder_lift_joint +-?[\d.]+ N m +[\d.]+ s +330 N m +first at [\d.]+ s", out
    )
    assert "trajectories   1, with 1500 points together" in out
    assert cli.main(arguments) == 2
    assert "out: exists already; name another directory" in capsys.readouterr().err
    made = json.loads((tmp_path / "out" / "torques.json").read_text())
    assert made["robot"] == "ur10_simulated"
    assert made["joints"][1]["limit"] == 330
    assert abs(made["joints"][1]["peak"]) > 330
    assert cli.main([*arguments, "--overwrite", "--gravity", "0,0,0"]) == 0
    capsys.readouterr()
    again = json.loads((tmp_path / "out" / "torques.json").read_text())
    assert again["gravity"] == [0, 0, 0]
    assert again["joints"][1]["peak"] != made["joints"][1]["peak"]
    assert cli.main([*arguments[:-1], str(bag), "--overwrite"]) == 2
    assert "won't be overwritten: it holds no torques.json" in capsys.readouterr().err
    with pytest.raises(OutputError, match="exists already"):
        write_trajectory_torques(trajectory_torques(bag, "ur10_simulated"), tmp_path / "out")
    friction = ["--no-friction", "--robot", "ur10_real"]
    assert cli.main(["torques", str(bag), "--out", str(tmp_path / "less"), *friction]) == 0
    assert "friction left out" in capsys.readouterr().out


def test_topics_of_unknown_type_are_left_out_and_said(tmp_path, torques, robot):
    types = get_typestore(Stores.EMPTY)
    types.register(get_types_from_msg("int32 level", "my_msgs/msg/Own"))
    with Writer(tmp_path / "bag", version=9) as writer:
        plans = writer.add_connection(TOPIC, TRAJECTORY, typestore=STORE)
        own = writer.add_connection("/own", "my_msgs/msg/Own", typestore=types)
        plan = trajectory(JOINTS, points_of_motion())
        writer.write(plans, 1, STORE.serialize_cdr(plan, TRAJECTORY))
        writer.write(own, 2, b"\0\1\0\0\5\0\0\0")
    described = trajectory_torques(tmp_path / "bag", robot)
    assert write_trajectory_torques(described, tmp_path / "all") == ()
    assert ("/own", 2, b"\0\1\0\0\5\0\0\0") in read_messages(tmp_path / "all")

    # Recorders of older releases stored no definitions.
    with sqlite3.connect(next((tmp_path / "bag").glob("*.db3"))) as database:
        database.execute("DELETE FROM message_definitions")
        database.execute("UPDATE topics SET type_description_hash = ''")
    heard = []
    notes = write_trajectory_torques(
        trajectory_torques(tmp_path / "bag", robot),
        tmp_path / "some",
        progress=lambda *call: heard.append(call),
    )
    assert notes == ("topic /own left out: the recording doesn't define its type, my_msgs/msg/Own",)
    assert heard == [("writing", 2, 2)]
    ((topic, _, raw),) = read_messages(tmp_path / "some")
    assert topic == TOPIC
    filled = STORE.deserialize_cdr(raw, TRAJECTORY)
    np.testing.assert_allclose(filled.points[7].effort, torques[7], rtol=0, atol=1e-12)


def plan(points=301, seconds=3.0):
    """A move from rest to rest along a quintic: time, q, qd, qdd."""
    time = np.linspace(0, seconds, points)
    s = time[:, None] / seconds
    start = np.array([0, -1.5, 1, 0, 0.5, 0])
    way = np.array([1, 0.5, -0.5, 0.7, -1, 0.3])
    q = start + way * (10 * s**3 - 15 * s**4 + 6 * s**5)
    qd = way * (30 * s**2 - 60 * s**3 + 30 * s**4) / seconds
    return time, q, qd, way * (60 * s - 180 * s**2 + 120 * s**3) / seconds**2


def torques_of_plan(directory, robot, kind, time, q, qd, qdd):
    if kind == "table":
        path = directory / "plan.csv"
        write_motion(path, JOINTS, time, position=q, velocity=qd, acceleration=qdd)
    else:
        stamps = np.round(time * 1e9).astype(int).tolist()
        points = [(t, *arrays, []) for t, *arrays in zip(stamps, q, qd, qdd, strict=True)]
        path = write_trajectories(directory / "bag", [trajectory(JOINTS, points)])
    return trajectory_torques(path, robot)


def with_jump(q, joint, by):
    q = q.copy()
    q[150:, joint] += by
    return q


DEGREE = 180 / np.pi
ELBOW = np.arange(6) == 2
WRONG = {
    "zero velocities": (
        lambda t, q, qd, qdd: (t, q, 0 * qd, 0 * qdd),
        r"velocities contradict .*: they are zero, most in shoulder_pan_joint, which goes 0.00625 from "
        r"POINT 150 \(1.49 s\) to POINT 151 \(1.5 s\), by velocities 0; so torques are those of an arm that "
        "stands still",
    ),
    "zero velocities of a joint": (
        lambda t, q, qd, qdd: (t, q, np.where(ELBOW, 0, qd), qdd),
        "velocities of elbow_joint contradict .*: they are zero, most in elbow_joint",
    ),
    "zero accelerations": (
        lambda t, q, qd, qdd: (t, q, qd, 0 * qdd),
        "accelerations of all joints are zero, though velocities change, .*; so torques lack inertia",
    ),
    "velocities of another time": (
        lambda t, q, qd, qdd: (2 * t, q, qd, qdd),
        "positions change 0.5 times as fast as velocities say, in every joint, most in",
    ),
    "reversed": (
        lambda t, q, qd, qdd: (t, q, np.where(ELBOW, -qd, qd), qdd),
        "velocities of elbow_joint contradict the slope of the positions: they are reversed",
    ),
    "another motion's": (
        lambda t, q, qd, qdd: (t, q, np.where(ELBOW, np.cos(9 * t)[:, None], qd), qdd),
        "velocities of elbow_joint aren't those of the positions, most in elbow_joint",
    ),
    "velocities in degrees": (
        lambda t, q, qd, qdd: (t, q, DEGREE * qd, qdd),
        "velocities are in degrees, positions in rad",
    ),
    "positions in degrees": (
        lambda t, q, qd, qdd: (t, DEGREE * q, qd, qdd),
        "positions are in degrees, velocities in rad",
    ),
    "all in degrees": (
        lambda t, q, qd, qdd: (t, DEGREE * q, DEGREE * qd, DEGREE * qdd),
        r"the position of all joints passes limits, first in POINT 1 \(0 s\): expected -6.283 to 6.283 rad of "
        r"shoulder_lift_joint, got -85.94; .* if positions are degrees",
    ),
    "a jump": (
        lambda t, q, qd, qdd: (t, with_jump(q, 1, 0.05), qd, qdd),
        r"the position of shoulder_lift_joint jumps by 0.0531 from POINT 150 \(1.49 s\) to POINT 151 \(1.5 s\), "
        "velocities say 0.0031",
    ),
    "too fast": (
        lambda t, q, qd, qdd: (t / 6, q, 6 * qd, 36 * qdd),
        r"the velocity of shoulder_pan_joint, wrist_2_joint passes limits, first in POINT 76 \(0.125 s\): "
        "expected -2.094 to 2.094 rad/s",
    ),
    "too heavy": (
        lambda t, q, qd, qdd: (t, q, qd, qdd + 200 * ELBOW),
        "the torque of shoulder_lift_joint, elbow_joint passes limits, first in POINT 1 .*expected -330 to 330 N m",
    ),
}


@pytest.mark.parametrize("kind", ["table", "recording"])
@pytest.mark.parametrize("mistake", WRONG)
def test_a_plan_that_contradicts_itself_or_the_robot_is_noted(tmp_path, robot, kind, mistake):
    spoil, note = WRONG[mistake]
    found = torques_of_plan(tmp_path, robot, kind, *spoil(*plan()))
    note = note.replace("POINT", "row" if kind == "table" else "point")
    assert any(re.search(note, text) for text in found.notes), found.notes
    assert found.numbers()["notes"] == found.notes


def test_limits_of_urdf_1_2_count_for_speeding_up_and_for_slowing_down(tmp_path, robot):
    limited = tmp_path / "limited.urdf"
    urdf = URDF.read_text().replace("<robot ", '<robot version="1.2" ', 1)
    urdf = urdf.replace('effort="150.0"', 'acceleration="9" deceleration="0.3" effort="150.0"', 1)
    limited.write_text(urdf)
    time, q, qd, qdd = plan()
    (note,) = torques_of_plan(
        tmp_path, replace(robot, urdf=limited), "table", time, q, qd, qdd
    ).notes
    k = int(np.argmax((qd[:, 2] * qdd[:, 2] < 0) & (np.abs(qdd[:, 2]) > 0.3013)))
    assert note.startswith(
        f"the acceleration of elbow_joint passes limits, first in row {k + 1} ({time[k]:g} s): expected "
        "-0.3 to 0.3 rad/s^2 of elbow_joint, got 0.3"
    )


@pytest.mark.parametrize("points", [4, 7, 30, 300, 3000])
def test_nothing_is_noted_of_a_sound_plan(tmp_path, robot, points):
    assert torques_of_plan(tmp_path, robot, "table", *plan(points)).notes == ()
    rounded = (values.round(4) for values in plan(points))
    assert torques_of_plan(tmp_path, robot, "table", *rounded).notes == ()


@pytest.mark.parametrize("kind", ["table", "recording"])
def test_times_that_do_not_increase_are_refused(tmp_path, robot, kind):
    time, *motion = plan()
    point = "row" if kind == "table" else "point"
    for wrong, place in (
        (0 * time, f"got 0 s in {point} 2 after 0 s, the first of 300 such places"),
        (np.where(time == time[150], time[149], time), f"got 1.49 s in {point} 151 after 1.49 s;"),
        (np.where(time == time[150], 0.2, time), f"got 0.2 s in {point} 151 after 1.49 s;"),
    ):
        with pytest.raises(BagError, match=f"time: expected times that increase, {place}"):
            torques_of_plan(tmp_path, robot, kind, wrong, *motion)
        (tmp_path / "bag").exists() and rmtree(tmp_path / "bag")
    with pytest.raises(BagError, match="steps of 10, in which positions .*: are they ms"):
        torques_of_plan(tmp_path, robot, kind, 1000 * time, *motion)


def test_a_trajectory_before_its_start_is_refused(tmp_path, robot):
    time, *motion = plan(5)
    with pytest.raises(BagError, match="point 1: time_from_start: expected 0 s or more, got -1"):
        torques_of_plan(tmp_path, robot, "recording", time - 1, *motion)


def test_of_many_trajectories_the_first_mistake_of_a_kind_is_noted(tmp_path, robot):
    rest = [0.0] * 6
    points = [(0, rest, rest, rest, []), (10**9, [0.3] * 6, rest, rest, [])]
    bag = write_trajectories(tmp_path / "bag", [trajectory(JOINTS, points)] * 3)
    (note,) = trajectory_torques(bag, robot).notes
    assert note.startswith("trajectory 1: velocities contradict the slope of the positions: they ")
    assert note.endswith("likewise in 2 others")


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "ms"), (1e9, "ns")])
def test_a_table_whose_time_is_not_in_seconds_is_refused(tmp_path, robot, factor, unit):
    q, _, qdd, _ = motion()
    table = table_of(0 * q, qdd)
    write_table(tmp_path / "plan.csv", {**table, "time": factor * table["time"]})
    with pytest.raises(BagError, match=f"time: expected seconds, .* are they {unit}"):
        trajectory_torques(tmp_path / "plan.csv", robot)


def test_a_table_has_no_topics_and_stays_a_table(tmp_path, robot):
    q, _, qdd, _ = motion()
    write_table(tmp_path / "plan.csv", table_of(0 * q, qdd))
    with pytest.raises(BagError, match="topic='/planned': a table has no topics"):
        trajectory_torques(tmp_path / "plan.csv", robot, topic="/planned")
    result = trajectory_torques(tmp_path / "plan.csv", robot)
    with pytest.raises(
        OutputError, match=r"expected a name ending in \.csv or \.txt, as plan\.csv"
    ):
        write_trajectory_torques(result, tmp_path / "filled")


def test_points_of_a_plan_may_be_seconds_apart(tmp_path, robot):
    q, _, qdd, _ = motion()
    table = {name: column[::500] for name, column in table_of(0 * q, qdd).items()}
    write_table(tmp_path / "plan.csv", table)
    heard = []
    result = trajectory_torques(
        tmp_path / "plan.csv", robot, progress=lambda *call: heard.append(call)
    )
    np.testing.assert_allclose(np.diff(result.times[0]), 2.0)
    assert {what for what, *_ in heard} == {"reading", "computing"}
    assert ("computing", 0, 1) in heard


def test_another_description_and_chain_may_be_given(tmp_path, capsys):
    bag = write_trajectories(tmp_path / "bag", [trajectory(JOINTS, points_of_motion()[:3])])
    arguments = ["torques", str(bag), "--overwrite", "--out", str(tmp_path / "out")]
    strong = tmp_path / "strong.urdf"
    strong.write_text(URDF.read_text().replace('effort="330.0"', 'effort="999"'))
    described = ["--urdf", str(strong), "--root", "base_link", "--tip", "tool0"]
    assert cli.main([*arguments, "--robot", "ur10_simulated", *described]) == 0
    printed = capsys.readouterr().out
    assert "999 N m" in printed
    assert "computed from" not in printed
    assert cli.main([*arguments, "--robot", "ur10_real", "--urdf", str(strong)]) == 0
    said = f"note           {strong} is used only for effort limits: "
    assert said in capsys.readouterr().out
    assert cli.main([*arguments, "--robot", "ur10_simulated", "--tip", "nowhere"]) == 2
    assert "nowhere" in capsys.readouterr().err


def test_what_can_not_be_read_is_not_told_as_what_can_not_be_written(tmp_path, robot):
    path = tmp_path / "planned"
    writer = Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3)
    writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    with writer:
        plans = writer.add_connection(TOPIC, TRAJECTORY, typestore=STORE)
        arm = writer.add_connection("/arm", "sensor_msgs/msg/JointState", typestore=STORE)
        raw = STORE.serialize_cdr(trajectory(JOINTS, points_of_motion()), TRAJECTORY)
        writer.write(plans, 1, raw)
        writer.write(arm, 2, b"")
    (file,) = path.glob("*.db3")
    bomb = zstd.compress(bytes(300_000_000))
    for damaged, expected in (
        (b"no frame of zstd", "can't be read as a rosbag2 recording"),
        (bomb, f"a message or chunk of {len(bomb)} bytes unpacks to more than 256 MB"),
    ):
        with closing(sqlite3.connect(file)) as database, database:
            database.execute("UPDATE messages SET data = ? WHERE timestamp = 2", (damaged,))
        with pytest.raises(BagError, match=f"^{path}: {expected}"):
            write_trajectory_torques(trajectory_torques(path, robot), tmp_path / "filled")
        assert not (tmp_path / "filled").exists()


def test_a_plan_of_two_arms_in_any_order_gets_the_torques_of_the_tree(tmp_path):
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    table = two_arms.motion(tree, seconds=2.0)
    names = tree.joint_names[::-1]
    columns = {"time": table["time"]}
    for quantity, key in (("position", "q"), ("velocity", "qd")):
        for name in names:
            columns[f"{quantity}.{name}"] = table[key][:, tree.joint_names.index(name)]
    write_table(tmp_path / "plan.csv", columns)
    found = trajectory_torques(tmp_path / "plan.csv", tree)
    assert found.joint_names == tree.joint_names
    assert np.abs(found.torques[0] - table["effort"])[100:-100].max() < 1e-3


def test_each_trajectory_has_the_friction_of_its_own_motion(tmp_path):
    (tmp_path / "pendulum.yaml").write_text(PRESLIDING)
    swing = Solver(RIGID_BODY, model=str(tmp_path / "pendulum.yaml"))
    time, *states = (values[:, :1] if values.ndim == 2 else values for values in plan())
    stamps = np.round(time * 1e9).astype(int).tolist()
    points = [(t, *arrays, []) for t, *arrays in zip(stamps, *states, strict=True)]
    file = write_trajectories(tmp_path / "bag", [trajectory(("swing",), points)] * 2)
    found = trajectory_torques(file, swing)
    without = swing.torques(*states)
    for torques in found.torques:  # from rest to rest
        assert torques[[0, -1]] - without[[0, -1]] == pytest.approx(np.array([[0.0], [2.0]]))


WRENCH_TRAJECTORY = "control_msgs/msg/JointWrenchTrajectory"
DOWN = [3.0, -2.0, -20.0, 0.5, 0.0, 1.0]


def write_wrenches(path, wrenches):
    """wrenches: (frame, six numbers) of each point."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in {
        "WrenchFramed": "string frame_id\ngeometry_msgs/Wrench wrench",
        "JointWrenchTrajectoryPoint": "trajectory_msgs/JointTrajectoryPoint point\nWrenchFramed wrench",
        "JointWrenchTrajectory": "std_msgs/Header header\nstring[] joint_names\nJointWrenchTrajectoryPoint[] points",
    }.items():
        store.register(get_types_from_msg(text, f"control_msgs/msg/{name}"))
    plan, types = trajectory(JOINTS, points_of_motion()[: len(wrenches)]), store.types
    points = []
    for point, (frame, numbers) in zip(plan.points, wrenches, strict=True):
        vectors = [types["geometry_msgs/msg/Vector3"](*v) for v in (numbers[:3], numbers[3:])]
        framed = types["control_msgs/msg/WrenchFramed"](
            frame, types["geometry_msgs/msg/Wrench"](*vectors)
        )
        points.append(types["control_msgs/msg/JointWrenchTrajectoryPoint"](point, framed))
    message = types[WRENCH_TRAJECTORY](plan.header, plan.joint_names, points)
    with Writer(path, version=9) as writer:
        topic = writer.add_connection(TOPIC, WRENCH_TRAJECTORY, typestore=store)
        writer.write(topic, 1, store.serialize_cdr(message, WRENCH_TRAJECTORY))
    return store


def test_efforts_of_wrenches_are_those_of_the_tip(tmp_path, torques, robot):
    wrenches = [("tool0", DOWN), ("", [0] * 6), ("base_link", DOWN), ("tool0", [0, 0, 0, 0, 0, 1])]
    store = write_wrenches(tmp_path / "planned", wrenches)
    result = trajectory_torques(tmp_path / "planned", robot)
    write_trajectory_torques(result, tmp_path / "filled")

    solver, q = Solver(robot), motion()[0][:4]
    p = solver.pose(q[2])[1]
    about_tip = [*DOWN[:3], *(DOWN[3:] - np.cross(p, DOWN[:3]))]
    expected = np.array(torques[:4])
    expected[0] += solver.external_torques(q[0], DOWN, frame="tip")
    expected[2] += solver.external_torques(q[2], about_tip, frame="root")
    expected[3] += solver.external_torques(q[3], wrenches[3][1], frame="tip")
    np.testing.assert_allclose(result.torques[0], expected, rtol=0, atol=1e-10)  # rounding
    ((_, _, raw),) = read_messages(tmp_path / "filled")
    filled = store.deserialize_cdr(raw, WRENCH_TRAJECTORY).points
    np.testing.assert_array_equal([point.point.effort for point in filled], result.torques[0])
    assert [point.wrench.frame_id for point in filled] == [frame for frame, _ in wrenches]
    assert filled[0].wrench.wrench.force.z == -20


@pytest.mark.parametrize(
    ("frame", "wrench", "problem"),
    [
        ("", DOWN, "point 2: wrench: expected six finite numbers and a frame_id, got .* in ''"),
        ("tool0", [np.nan] * 6, "point 2: wrench: expected six finite numbers"),
        ("tool1", DOWN, "point 2: wrench: .*expected a link or joint .*did you mean 'tool0'"),
    ],
)
def test_a_wrench_that_is_not_understood_is_refused(tmp_path, robot, frame, wrench, problem):
    write_wrenches(tmp_path / "planned", [("tool0", DOWN), (frame, wrench)])
    with pytest.raises(BagError, match=problem):
        trajectory_torques(tmp_path / "planned", robot)


def test_trajectories_of_two_types_are_told_apart(tmp_path, robot):
    store = write_wrenches(tmp_path / "wrenches", [("tool0", DOWN)])
    plan = trajectory(JOINTS, points_of_motion()[:1])
    ((_, _, raw),) = read_messages(tmp_path / "wrenches")
    with Writer(tmp_path / "both", version=9) as writer:
        for topic, kind, message in (
            ("/a", TRAJECTORY, STORE.serialize_cdr(plan, TRAJECTORY)),
            ("/b", WRENCH_TRAJECTORY, raw),
        ):
            writer.write(writer.add_connection(topic, kind, typestore=store), 1, message)
    with pytest.raises(BagError, match="expected one topic with trajectories, got /a, /b; name it"):
        trajectory_torques(tmp_path / "both", robot)
    without, with_wrench = (
        trajectory_torques(tmp_path / "both", robot, topic=topic).torques[0]
        for topic in ("/a", "/b")
    )
    assert np.abs(with_wrench - without).max() > 1

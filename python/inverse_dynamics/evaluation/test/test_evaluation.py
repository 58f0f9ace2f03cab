# SPDX-License-Identifier: Apache-2.0
import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import two_arms
from example_recordings import joint_log, motion, recording
from example_robots import JOINTS, RIGID_BODY, UR10, URDF
from pages import data_of

from inverse_dynamics import Solver, cli, evaluate, load_robot, read_recording
from inverse_dynamics.errors import (
    BagError,
    EvaluationError,
    InvalidRobotDescriptionError,
    RobotError,
)
from inverse_dynamics.evaluation import run
from inverse_dynamics.evaluation.files import evaluate_into
from inverse_dynamics.installation import extras
from inverse_dynamics.recordings.bags import write_joint_logs
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.descriptions import read_description


@pytest.fixture(scope="module")
def robot():
    return replace(load_robot("ur10_simulated"), plugin=RIGID_BODY)


def test_a_recording_of_the_model_itself_has_next_to_no_error(bag, robot):
    result = evaluate(bag, robot)
    assert result.accelerations.method == "low-pass"
    assert result.accelerations.chosen
    for error in result.errors:
        assert error.nrmse < 0.005
        assert error.r2 > 0.9999
    assert result.joint_names == JOINTS
    assert result.units == ("N m",) * 6
    assert result.notes == ()


def test_backward_differences_are_computed_as_the_formula_says(bag, robot, solver):
    result = evaluate(bag, robot, accelerations="backward-difference")
    q, qd, qdd_true, stamps = motion()
    qdd = np.zeros_like(qd)
    qdd[1:] = np.diff(qd, axis=0) / np.diff(stamps * 1e-9)[:, None]
    np.testing.assert_allclose(result.qdd, qdd, rtol=1e-9, atol=1e-9)
    computed = solver.torques(q, qd, qdd)
    np.testing.assert_allclose(result.computed, computed, rtol=0, atol=1e-8)
    difference = computed - solver.torques(q, qd, qdd_true)
    rmse = np.sqrt((difference**2).mean(axis=0))
    np.testing.assert_allclose([e.rmse for e in result.errors], rmse, rtol=1e-6)
    assert result.mean_rmse == pytest.approx(rmse.mean(), rel=1e-6)
    assert result.accelerations.cutoff is None


def test_a_motion_in_memory_without_efforts_is_refused(bag, robot, monkeypatch):
    log = replace(read_recording(bag), effort=np.zeros((0, 0)))
    monkeypatch.setattr(run, "open_motion", lambda *_, **__: log)
    with pytest.raises(
        EvaluationError, match="motion: effort: expected one row per sample, got none"
    ):
        evaluate(bag, robot)


def test_nothing_is_printed(bag, robot, capfd):
    evaluate(bag, robot)
    assert capfd.readouterr() == ("", "")


def test_joints_of_other_names_are_given_in_the_order_of_the_chain(tmp_path, robot, solver):
    renamed = tuple(f"left_{name}" for name in JOINTS)
    recording(tmp_path / "bag", solver, joint_names=renamed)
    with pytest.raises(BagError, match=r"expected the joints shoulder_pan_joint, .*joints="):
        evaluate(tmp_path / "bag", robot)
    result = evaluate(tmp_path / "bag", robot, joints=renamed)
    assert result.joint_names == JOINTS
    assert result.log.joint_names == renamed
    assert result.errors[0].nrmse < 0.005


# What is given takes precedence over what the configuration says.


def test_another_plugin(bag, robot):
    result = evaluate(bag, robot, plugin=UR10, friction=True)
    assert result.robot.plugin == UR10
    assert result.errors[0].nrmse > 0.01
    assert "unfit for forward dynamics" in result.notes[0]


def test_another_description_root_and_tip(tmp_path, robot, bag):
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(URDF.read_text().replace('"tool0"', '"hand"'))
    with pytest.raises(InvalidRobotDescriptionError, match="tool0"):
        evaluate(bag, robot, urdf=urdf)
    result = evaluate(bag, robot, urdf=urdf, tip="hand")
    assert result.robot.urdf == urdf
    assert result.errors[0].nrmse < 0.005
    with pytest.raises(InvalidRobotDescriptionError, match="cellar"):
        evaluate(bag, robot, root="cellar")


def test_a_description_that_a_solver_has_no_use_for_is_said_to_be_drawn_only(bag, robot):
    said = (
        f"{URDF} is used only for drawing: {UR10} brings its own model, so a tool or payload in the "
        "description isn't included in the torques"
    )
    assert said in " ".join(evaluate(bag, robot, plugin=UR10, urdf=URDF).notes)
    assert said not in " ".join(evaluate(bag, robot, plugin=UR10).notes)
    assert evaluate(bag, robot, urdf=URDF).notes == ()


# What is odd about samples is reported.


def test_stamps_that_never_increase_are_an_error(tmp_path, robot, solver):
    stamps = motion()[3]
    recording(tmp_path / "bag", solver, header_stamps=0 * stamps + 5, receive_stamps=stamps)
    with pytest.raises(EvaluationError) as caught:
        evaluate(tmp_path / "bag", robot)
    assert str(caught.value).startswith(f"{tmp_path / 'bag'}: /joint_states: ")
    assert evaluate(tmp_path / "bag", robot, clock="receive").errors[0].nrmse < 0.005


@pytest.mark.parametrize("samples", [1, 5])
def test_a_recording_too_short_to_be_filtered_is_an_error(tmp_path, robot, samples):
    log = joint_log(samples, 6, joint_names=JOINTS)
    write_joint_logs(tmp_path / "bag", {log.topic: log})
    with pytest.raises(EvaluationError) as caught:
        evaluate(tmp_path / "bag", robot)
    assert str(tmp_path / "bag") in str(caught.value)


# Robot descriptions.


def test_description_that_is_no_xml_is_an_error_whoever_reads_it(bag, robot, tmp_path):
    (tmp_path / "arm.urdf").write_text("<robot")
    for changes in ({}, {"plugin": UR10}):
        with pytest.raises(InvalidRobotDescriptionError, match=r"arm\.urdf.*well-formed XML"):
            evaluate(bag, robot, urdf=tmp_path / "arm.urdf", **changes)
    with pytest.raises(RobotError, match=r"arm\.urdf: isn't a robot description: no XML"):
        evaluate(bag, robot, urdf=tmp_path / "arm.urdf", plugin=UR10, root="", tip="")
    (tmp_path / "arm.urdf").write_text("<robot name='arm'><link/></robot>")
    with pytest.raises(RobotError, match=r"arm\.urdf: URDF:1: .*name"):
        evaluate(bag, robot, urdf=tmp_path / "arm.urdf", plugin=UR10, root="", tip="")


XACRO = """\
<robot name="slide" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="mass" value="${1 + 1}"/>
  <link name="base"/>
  <link name="cart"><inertial><mass value="${mass}"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="rail" type="prismatic"><parent link="base"/><child link="cart"/>
    <axis xyz="0 0 1"/><limit lower="-9" upper="9" velocity="9" effort="99"/></joint>
</robot>"""


@pytest.fixture
def xacro_file(tmp_path):
    file = tmp_path / "slide.urdf.xacro"
    file.write_text(XACRO)
    return file


def slide_recording(tmp_path: Path) -> Path:
    """A cart of 2 kg that is lifted: weight and acceleration, by hand."""
    stamps = 10_000_000 * np.arange(1, 401, dtype=np.int64)
    phase = 2 * np.pi * 0.5 * stamps[:, None] * 1e-9
    rate = 2 * np.pi * 0.5
    q, qd, qdd = np.sin(phase), rate * np.cos(phase), -(rate**2) * np.sin(phase)
    log = JointLog(("rail",), stamps, stamps, q, qd, 2 * (qdd + 9.81))
    write_joint_logs(tmp_path / "slide", {log.topic: log})
    return tmp_path / "slide"


def test_xacro_files_are_expanded_and_forces_of_prismatic_joints_are_newtons(tmp_path, xacro_file):
    pytest.importorskip("xacro")
    robot = replace(
        load_robot("ur10_simulated"), plugin=RIGID_BODY, joints=(), root="base", tip="cart"
    )
    result = evaluate(slide_recording(tmp_path), robot, urdf=xacro_file)
    assert result.units == ("N",)
    assert result.errors[0].unit == "N"
    assert result.errors[0].nrmse < 0.01


def test_arguments_of_xacro_stand_behind_the_file_or_are_options(tmp_path, xacro_file, capsys):
    pytest.importorskip("xacro")
    text = XACRO.replace(
        '<xacro:property name="mass" value="${1 + 1}"/>', '<xacro:arg name="mass" default="9"/>'
    )
    xacro_file.write_text(text.replace("${mass}", "$(arg mass)"))
    recording = slide_recording(tmp_path)
    robot = replace(
        load_robot("ur10_simulated"), plugin=RIGID_BODY, joints=(), root="base", tip="cart"
    )
    assert evaluate(recording, robot, urdf=f"{xacro_file} mass:=2").errors[0].nrmse < 0.01
    assert evaluate(recording, robot, urdf=xacro_file).errors[0].nrmse > 1
    command = ["evaluate", str(recording), "--urdf", str(xacro_file), "--no-figures"]
    assert cli.main([*command, "--xacro", "mass:=2", "--json", "--out", str(tmp_path / "out")]) == 0
    assert json.loads(capsys.readouterr().out)["result"]["mean_rmse"] < 1
    with pytest.raises(SystemExit):
        cli.main([*command, "--xacro", "mass=2"])
    assert "argument --xacro: expected NAME:=VALUE, got 'mass=2'" in capsys.readouterr().err
    urdf = str(load_robot("ur10_simulated").urdf)
    assert cli.main(["evaluate", str(recording), "--urdf", urdf, "--xacro", "mass:=2"]) == 2
    assert "--xacro mass:=2: expected a .xacro file with it" in capsys.readouterr().err


def test_without_xacro_the_error_says_how_to_install_it(bag, robot, xacro_file, monkeypatch):
    monkeypatch.setattr(extras, "is_installed", lambda module: module != "xacro")
    with pytest.raises(extras.MissingPackageError, match=r"slide.urdf.xacro: needs xacro: "):
        evaluate(bag, robot, urdf=xacro_file)


def test_broken_xacro_file_is_an_error_with_the_tools_words(bag, robot, xacro_file):
    pytest.importorskip("xacro")
    xacro_file.write_text(XACRO.replace("${mass}", "${weight}"))
    with pytest.raises(RobotError, match=r"slide.urdf.xacro: xacro can't expand it: .*weight"):
        evaluate(bag, robot, urdf=xacro_file)


def test_an_xacro_file_in_its_makers_package_needs_no_ros(tmp_path, monkeypatch):
    pytest.importorskip("xacro")
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    folder = tmp_path / "maker_description/urdf"
    folder.mkdir(parents=True)
    (folder / "slide.urdf.xacro").write_text(XACRO)
    whole = folder / "whole.urdf.xacro"
    text = """<robot name="whole" xmlns:xacro="http://www.ros.org/wiki/xacro">
      <xacro:include filename="$(find {})/urdf/slide.urdf.xacro"/></robot>"""
    whole.write_text(text.format("maker_description"))
    assert '<link name="cart">' in read_description(whole)

    whole.write_text(text.format("makers_description"))
    with pytest.raises(RobotError, match="package makers_description: not found: expected an inst"):
        read_description(whole)


@pytest.mark.parametrize("effort_is", ["torque", "auto"])
def test_a_result_written_while_computing_is_that_of_arrays(bag, robot, tmp_path, effort_is):
    shares = []
    streamed = evaluate_into(
        tmp_path / "streamed",
        bag,
        robot,
        effort_is=effort_is,
        progress=lambda what, done, total: shares.append((what, done, total)),
    )
    whole = evaluate(bag, robot, effort_is=effort_is)
    whole.save(tmp_path / "whole")
    for name in ("series.npz", "metrics.json", "torques.png", "bag/bag.db3"):
        one, other = (tmp_path / directory / name for directory in ("streamed", "whole"))
        assert one.read_bytes() == other.read_bytes(), name
    np.testing.assert_array_equal(streamed.computed, whole.computed)
    np.testing.assert_array_equal(streamed.log.q, whole.log.q)
    assert streamed.errors == whole.errors
    assert streamed.log.notes == whole.log.notes
    evaluating = [done for what, done, _ in shares if what == "evaluating"]
    assert evaluating == sorted(evaluating)
    assert evaluating[-1] == pytest.approx(len(whole.log), rel=0.1)


def test_a_recording_that_is_cut_off_while_it_is_read_is_an_error(solver, robot, tmp_path):
    q, qd, qdd, stamps = motion(20_000)
    log = JointLog(JOINTS, stamps, stamps, q, qd, solver.torques(q, qd, qdd))
    write_joint_logs(tmp_path / "recording", {log.topic: log}, storage="mcap")
    (file,) = (tmp_path / "recording").glob("*.mcap")
    size = file.stat().st_size

    def cut_off(what: str, done: int, total: int) -> None:
        if what == "evaluating" and done < total / 3:
            os.truncate(file, size // 2)

    with pytest.raises(BagError, match=f"{tmp_path / 'recording'}"):
        evaluate(tmp_path / "recording", robot, progress=cut_off)


@pytest.mark.parametrize("share", [0.1, 0.4, 0.9])
def test_an_evaluation_that_is_stopped_leaves_nothing(bag, robot, tmp_path, share):
    def stop(what: str, done: int, total: int) -> None:
        if what == "evaluating" and done > share * total:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        evaluate_into(tmp_path / "result", bag, robot, progress=stop)
    assert not list(tmp_path.iterdir())


def test_a_tree_is_evaluated_and_so_is_one_of_its_arms_while_the_other_rests(tmp_path):
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    left = tuple(name for name in tree.joint_names if name.startswith("left"))
    table, file = two_arms.motion(tree, still=left), two_arms.written(tmp_path)
    whole = evaluate(table, urdf=file, tip=two_arms.ARMS)
    assert whole.joint_names == tree.joint_names
    assert whole.units == tuple("N" if name == "lift_joint" else "N m" for name in tree.joint_names)
    assert np.abs(whole.computed - whole.measured).max() < 1e-4  # of some hundred
    of_arm = Solver(urdf=two_arms.URDF, tip="right_tool").joint_names
    columns = {
        f"{quantity}.{name}": table[key][:, tree.joint_names.index(name)]
        for quantity, key in (("position", "q"), ("velocity", "qd"), ("effort", "effort"))
        for name in of_arm
    }
    one = evaluate({"time": table["time"], **columns}, urdf=file, tip="right_tool")
    assert one.joint_names == of_arm
    assert np.abs(one.computed - one.measured).max() < 1e-4


def test_the_page_of_a_tree_draws_all_of_it(tmp_path, ids):
    file = two_arms.written(tmp_path)
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.TIPS)
    np.savez(tmp_path / "motion.npz", **two_arms.motion(tree, seconds=2.0))
    code, out, _ = ids(
        "evaluate", "motion.npz", "--urdf", f"{file}", "--tip", "*", "--out", "result"
    )
    assert code == 0, out
    links = data_of((tmp_path / "result/report.html").read_text())[0]["links"]
    moving = [
        (link["joint"], link["factor"], link["offset"]) for link in links if link["joint"] >= 0
    ]
    assert sorted(moving) == sorted([*((j, 1.0, 0.0) for j in range(9)), (8, -1.5, 0.1)])

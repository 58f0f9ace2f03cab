# SPDX-License-Identifier: Apache-2.0
"""The files of an identification: a robot that evaluates as the identification predicts, figures, page."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
import yaml
from example_recordings import motion
from example_robots import JOINTS, URDF
from identified_arms import arm, identification, predicted_torques, simulated_torques
from pages import data_of

from inverse_dynamics import FastModel, Solver, evaluate, read_joint_log, write_joint_logs
from inverse_dynamics._core import RobotDescription
from inverse_dynamics.comparison.comparison import compare
from inverse_dynamics.errors import RobotError, SolverError
from inverse_dynamics.evaluation.files import read_evaluation
from inverse_dynamics.evaluation.many_evaluations import summary_of
from inverse_dynamics.evaluation.ranges import outside_of_seen
from inverse_dynamics.evaluation.tables import FITTED, recordings_table
from inverse_dynamics.identification import files as identifications
from inverse_dynamics.identification.files import model_file_text, write_identification
from inverse_dynamics.identification.hold_out import hold_out
from inverse_dynamics.identification.refusals import check_result
from inverse_dynamics.identification.result import IdentificationError
from inverse_dynamics.identification.universal_robots import friction_request
from inverse_dynamics.outputs.plain import plain
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.recordings.sketch import sketch_of
from inverse_dynamics.recordings.time_window import TimeWindow
from inverse_dynamics.robots import robot_files
from inverse_dynamics.robots.link_parameters import turned
from inverse_dynamics.robots.robots import RIGID_BODY, Robot


@pytest.fixture(scope="module")
def found():
    return identification()


@pytest.fixture(scope="module")
def files(found, tmp_path_factory):
    return write_identification(found, tmp_path_factory.mktemp("identified") / "arm.yaml")


@pytest.fixture
def tuesday(tmp_path):
    """Another recording of the same motion."""
    q, qd, qdd, stamps = motion()
    log = JointLog(JOINTS, stamps, stamps, q, qd, simulated_torques(q, qd, qdd, seed=7))
    write_joint_logs(tmp_path / "tuesday", {log.topic: log})
    return tmp_path / "tuesday"


def test_an_evaluation_of_what_the_model_was_fitted_to_says_so(found, tuesday, tmp_path):
    fitted = replace(found, sketch=sketch_of(read_joint_log(tuesday)))
    files = write_identification(fitted, tmp_path / "arm.yaml")
    q, qd, qdd, stamps = motion()
    log = JointLog(JOINTS, stamps, stamps, q, qd, simulated_torques(q, qd, qdd, seed=8))
    write_joint_logs(tmp_path / "wednesday", {log.topic: log})
    assert not evaluate(tmp_path / "wednesday", files.robot).fitted
    evaluate(tuesday, files.robot, start=1.0, end=4.0).save(tmp_path / "same")
    evaluate(tuesday, "ur10_simulated", start=1.0, end=4.0).save(tmp_path / "urdf")
    same, urdf = map(read_evaluation, (tmp_path / "same", tmp_path / "urdf"))
    assert (same.fitted, urdf.fitted) == (True, False)
    assert (same.numbers()["fitted"], same.notes[-1]) == (True, FITTED)
    compared = compare([same, urdf], ["new", "old"])
    assert tuple(compared.table().headings[2:]) == ("new *", "old")
    assert compared.table().note == f"* {FITTED}"
    assert [run["fitted"] for run in compared.numbers()["runs"]] == [True, False]
    assert FITTED in compared.page()
    table = recordings_table([summary_of(e, "tuesday", TimeWindow()) for e in (same, urdf)])
    assert [row[0] for row in table.rows] == ["tuesday *", "tuesday"]
    assert table.note == f"* {FITTED}"


@pytest.fixture
def states(found):
    """Random ones within what was seen, (200, n) each."""
    low, high = np.moveaxis(found.model.seen, 2, 0)
    shares = np.random.default_rng(5).uniform(size=(200, *low.shape))
    return np.moveaxis(low + (high - low) * shares, 1, 0)


def test_the_model_file_predicts_what_the_identification_does(found, files, states):
    solver = Solver(RIGID_BODY, model=str(files.model))
    assert solver.joint_names == JOINTS
    expected = predicted_torques(found.model, *states)
    np.testing.assert_allclose(solver.torques(*states), expected, rtol=0, atol=1e-10)


def test_the_robot_evaluates_with_the_error_of_the_noise(found, files, tuesday):
    result = evaluate(tuesday, files.robot)
    assert result.robot.model == files.model
    assert result.mean_rmse == pytest.approx(found.noise.mean(), rel=0.1)
    assert evaluate(tuesday, "ur10_simulated").mean_rmse > 20 * result.mean_rmse


def test_parameters_are_in_the_frames_of_the_description():
    """Centers of mass are where the URDF's text says, wherever the axes of the joints point."""
    geometry = RobotDescription(URDF.read_text()).chain(JOINTS, "base_link")
    links = {link.get("name"): link for link in ElementTree.parse(URDF).iter("link")}
    for row, joint in zip(arm().parameters, geometry, strict=True):
        origin = links[joint.child].find("inertial/origin").get("xyz")
        own = turned(row, joint.rotation_from_z)
        np.testing.assert_allclose(
            own[1:4] / own[0], [float(x) for x in origin.split()], atol=1e-12
        )


def inertial(link: str, mass: float) -> str:
    return (
        f'<link name="{link}"><inertial><origin xyz="0.1 0.2 -0.1" rpy="0.1 0.2 0.3"/><mass value="{mass}"/>'
        '<inertia ixx="0.2" ixy="0.01" ixz="0.02" iyy="0.3" iyz="-0.01" izz="0.25"/></inertial></link>'
    )


OBLIQUE = """<robot name="oblique">
<link name="world"/><link name="base"/><link name="a"/><link name="mid"/><link name="b"/><link name="tool"/>
<joint name="stand" type="fixed"><parent link="world"/><child link="base"/>
<origin xyz="0.1 0 0.3" rpy="0.2 0 0.4"/></joint>
<joint name="one" type="continuous"><parent link="base"/><child link="a"/><origin xyz="0 0.2 0.1" rpy="0 0.5 0"/>
<axis xyz="1 2 -3"/></joint>
<joint name="bend" type="fixed"><parent link="a"/><child link="mid"/><origin xyz="0 0 0.4" rpy="0.3 -0.2 0.9"/></joint>
<joint name="two" type="prismatic"><parent link="mid"/><child link="b"/><origin xyz="0.1 0 0"/><axis xyz="0 1 1"/>
<limit lower="-1" upper="1" velocity="2" effort="0"/></joint>
<joint name="flange" type="fixed"><parent link="b"/><child link="tool"/><origin xyz="0 0 0.2" rpy="0 1 0"/></joint>
</robot>"""
for _link, _mass in (("a", 2.0), ("mid", 0.5), ("b", 1.5), ("tool", 0.3)):
    OBLIQUE = OBLIQUE.replace(f'<link name="{_link}"/>', inertial(_link, _mass))


def test_oblique_axes_and_fixed_joints_are_those_of_the_engine(found, tmp_path):
    """A model with the description's own figures computes the description's torques, tip and all."""
    urdf = tmp_path / "oblique.urdf"
    urdf.write_text(OBLIQUE)
    chain = FastModel.from_urdf(OBLIQUE)
    two = slice(0, 2)
    model = replace(
        found.model,
        parameters=chain.parameters.reshape(2, 10),
        rotor_inertia=np.array([0.5, 0.0]),
        friction=found.model.friction[two],
        torque_deviation=found.model.torque_deviation[two],
        seen=found.model.seen[:, two],
    )
    robot = Robot("oblique", "", urdf, RIGID_BODY, urdf=urdf, gravity=(1.0, 2.0, -9.0))
    oblique = replace(
        found,
        robot=robot,
        joints=("one", "two"),
        units=("N m", "N"),
        model=model,
        held_out={"identified": np.zeros(2)},
    )
    file = tmp_path / "oblique_model.yaml"
    file.write_text(model_file_text(oblique, "oblique"))
    solver = Solver(RIGID_BODY, model=str(file))
    described = Solver(RIGID_BODY, urdf=OBLIQUE, gravity=(1.0, 2.0, -9.0))
    q = np.random.default_rng(1).uniform(-1, 1, size=(20, 2))
    np.testing.assert_allclose(solver.gravity_vector(q), described.gravity_vector(q), atol=1e-12)
    for one, other in zip(solver.tip_pose(q), described.tip_pose(q), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)
    rotor = np.diag([0.5, 0.0])
    np.testing.assert_allclose(
        solver.inertia_matrix(q), described.inertia_matrix(q) + rotor, atol=1e-12
    )
    assert "limits: {lower: -1, upper: 1, velocity: 2}" in file.read_text()


def test_a_model_that_its_reader_computes_otherwise_leaves_nothing(found, tmp_path, monkeypatch):
    monkeypatch.setattr(
        identifications,
        "model_file_text",
        lambda *_: model_file_text(found, "arm").replace(
            "geometry: placements\ngravity: [0, 0, -9.81]",
            "geometry: placements\ngravity: [0, 0, -9.8]",
        ),
    )
    with pytest.raises(SolverError, match=r"arm_model\.yaml"):
        write_identification(found, tmp_path / "arm.yaml")
    assert list(tmp_path.iterdir()) == []


def test_the_request_of_universal_robots_driver_has_the_shares_of_friction(found, files):
    left = [{**law, "fv": 0.1 * law["fv"], "fc": 0.25 * law["fc"]} for law in found.model.friction]
    compensated = replace(found.model, friction=tuple(left))
    whole = replace(found.robot, plugin=RIGID_BODY, model=files.model, friction=True)
    request = yaml.safe_load(friction_request(replace(found, robot=whole, model=compensated)))
    assert request["parameters"]["viscous_scale"] == pytest.approx([0.9] * 6)
    assert request["parameters"]["coulomb_scale"] == pytest.approx([0.75] * 6, abs=1e-3)
    with pytest.raises(RobotError, match="expected a model with friction in every joint"):
        friction_request(found)


def test_all_figures_are_in_json(found, files):
    data = json.loads(files.figures.read_text())
    assert plain(found.numbers()) == data
    assert data["model"]["parameters"] == found.model.parameters.tolist()
    assert data["held_out"]["identified"] == found.held_out["identified"].tolist()
    assert [block["samples"] for block in data["blocks"]] == [300] * 5
    error = np.array([block["rmse"]["identified"] for block in data["blocks"]])
    np.testing.assert_allclose(
        np.sqrt((error**2).mean(axis=0)), found.held_out["identified"], rtol=1e-12
    )
    assert data["law"] == "step"


def test_without_a_description_there_is_no_geometry(found, tmp_path):
    robot = replace(found.robot, urdf=None)
    with pytest.raises(RobotError, match="expected a description"):
        write_identification(replace(found, robot=robot), tmp_path / "arm.yaml")


def test_the_page_shows_each_column_and_the_band(found, files):
    html = files.page.read_text().replace("<wbr>", "")
    assert "Held-out error" in html
    for text in ("URDF", "identified", "in 95 % band", "masses of single links", "forearm_link"):
        assert text in html
    (run,) = data_of(html)
    torques = run["plots"][0]
    assert [series["name"] for series in torques["series"]] == ["measured", "URDF", "identified"]
    assert len(torques["band"]) == 400
    assert torques["band"][0]["half"] == pytest.approx(0.196)
    assert run["links"]


def test_a_motion_outside_of_what_was_seen_is_told(found, files):
    seen = Solver(RIGID_BODY, model=str(files.model)).seen
    np.testing.assert_array_equal(seen, found.model.seen)
    q, qd, qdd, _ = motion()
    kept = np.arange(len(q)) >= 5
    units = (*found.units[:5], "N")
    assert outside_of_seen(seen, (q, qd, qdd), kept, JOINTS, units) == ""
    assert outside_of_seen(None, (q, qd, qdd), kept, JOINTS, units) == ""
    wild = np.where(kept[:, None], qd, 100.0)  # at samples that don't count
    assert outside_of_seen(seen, (q, wild, qdd), kept, JOINTS, units) == ""
    fast = qd * [1, 1, 1, 1.5, 1, 1]
    text = outside_of_seen(seen, (q, fast, qdd), kept, JOINTS, units)
    assert "wrist_1_joint qd -2.83 to 2.83 rad/s (seen -1.88 to 1.88)" in text
    assert "elbow_joint" not in text
    far = outside_of_seen(seen, (q * [1, 1, 1, 1, 1, 2], qd, qdd), kept, JOINTS, units)
    assert "wrist_3_joint q -2 to 2 m (seen -1 to 1)" in far


def test_a_recording_that_was_held_out_is_a_table_of_its_own(found, tuesday, tmp_path):
    test = hold_out(found, tuesday)
    assert set(test.rmse) == {"urdf", "identified"}
    assert test.rmse["identified"].mean() == pytest.approx(found.noise.mean(), rel=0.1)
    assert test.rmse["urdf"].mean() > 20 * test.rmse["identified"].mean()
    assert (test.coverage > 0.85).all()
    files = write_identification(found, tmp_path / "arm.yaml", tests=[test])
    (figures,) = json.loads(files.figures.read_text())["hold_out"]
    assert figures["rmse"]["urdf"] == test.rmse["urdf"].tolist()
    assert "Error on tuesday" in files.page.read_text()


def test_errors_of_blocks_are_of_the_samples_that_count(found, tmp_path):
    blocks = []
    for block in found.blocks:
        counts, measured = block.counts.copy(), block.measured.copy()
        counts[:30] = False
        measured[:30] += 100.0  # a start transient
        blocks.append(replace(block, counts=counts, measured=measured))
    files = write_identification(replace(found, blocks=tuple(blocks)), tmp_path / "arm.yaml")
    written = json.loads(files.figures.read_text())["blocks"]
    for block, figures in zip(blocks, written, strict=True):
        errors = (block.computed["urdf"] - block.measured)[30:]
        np.testing.assert_allclose(figures["rmse"]["urdf"], np.sqrt((errors**2).mean(0)))
        assert figures["samples"] == 270


def test_a_recording_that_was_held_out_has_the_refitted_present_model_too(found, tuesday):
    # the present model: the description, whose friction is refitted
    blocks = tuple(
        replace(b, computed={**b.computed, "present": b.computed["urdf"]}) for b in found.blocks
    )
    held = {**found.held_out, "present": found.held_out["urdf"]}
    test = hold_out(replace(found, blocks=blocks, held_out=held), tuesday)
    assert set(test.rmse) == {"urdf", "present", "present_refitted", "identified"}
    np.testing.assert_allclose(test.rmse["present"], test.rmse["urdf"])
    # viscous friction, step and offset are those of the blocks; links are 5 % too light
    assert (test.rmse["present_refitted"] < 0.5 * test.rmse["present"]).all()
    assert (test.rmse["present_refitted"] > test.rmse["identified"]).all()


def test_samples_that_were_fitted_to_are_not_held_out(found, tuesday, tmp_path):
    log = read_joint_log(tuesday)
    fitted = replace(found, sketch=sketch_of(log))
    tuesday.rename(tmp_path / "copy")
    for recording in (tmp_path / "copy", log):
        with pytest.raises(IdentificationError, match="nothing was fitted to"):
            hold_out(fitted, recording)


def test_a_backward_stamp_is_no_obstacle(found):
    block = found.blocks[0]
    time = block.time.copy()
    time[50] = time[20]
    counts = block.counts.copy()
    counts[50] = False
    check_result(
        replace(found, blocks=(replace(block, time=time, counts=counts), *found.blocks[1:]))
    )


def test_a_description_of_an_installed_package_is_named_by_it_without_a_workspace(
    tmp_path, monkeypatch
):
    share = tmp_path / "wheel/share"
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr(robot_files, "package_share", lambda name: share / "arm")
    inside, outside = share / "arm/urdf/arm.urdf", share / "other/arm.urdf"
    assert robot_files.reference(inside, tmp_path) == "package://arm/urdf/arm.urdf"
    assert robot_files.reference(outside, tmp_path) == "wheel/share/other/arm.urdf"

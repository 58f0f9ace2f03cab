# SPDX-License-Identifier: Apache-2.0
"""What no model is identified from: exit status, reason, remedy, the nearest entry of the page of mistakes."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from command_line import fails
from example_recordings import motion
from example_robots import JOINTS, RIGID_BODY
from identified_arms import NOISE, arm, identification, predicted_torques, simulated_torques

from inverse_dynamics import Solver, cli, evaluate, identify, load_robot, write_joint_logs
from inverse_dynamics.diagnosis.rival import PAGE
from inverse_dynamics.identification.findings import findings_of_errors
from inverse_dynamics.identification.refusals import check_recordings, check_result
from inverse_dynamics.identification.result import IdentificationError
from inverse_dynamics.payload.payload import PayloadError, estimate_payload
from inverse_dynamics.recordings.joint_log import JointLog
from inverse_dynamics.robots.arm import Arm
from inverse_dynamics.robots.robots import robot_of, robot_of_description

ROBOT = "ur10_simulated"
RATE = 250  # Hz, of motion()


@pytest.fixture(scope="module")
def log() -> JointLog:
    q, qd, qdd, stamps = motion()
    return JointLog(JOINTS, stamps, stamps, q, qd, simulated_torques(q, qd, qdd))


def evaluated(directory, log, robot=ROBOT):
    write_joint_logs(directory / "recording", {log.topic: log})
    return evaluate(directory / "recording", robot)


def part(log: JointLog, samples: slice) -> JointLog:
    names = ("header_stamps", "receive_stamps", "q", "qd", "effort")
    return replace(log, **{name: getattr(log, name)[samples] for name in names})


def reason(evaluations) -> IdentificationError:
    with pytest.raises(IdentificationError) as caught:
        check_recordings(evaluations)
    return caught.value


def test_a_good_recording_is_taken(log, tmp_path):
    check_recordings([evaluated(tmp_path, log)])


def test_too_short(log, tmp_path):
    short = evaluated(tmp_path, part(log, slice(0, 3 * RATE)))
    text = str(reason([short]))
    assert "expected at least 5 s of motion, got 3.0 s" in text
    assert "ids excite" in text
    check_recordings([short, short])  # together they are long enough


def test_rest_counts_as_no_motion(log, tmp_path):
    still = np.minimum(np.arange(len(log.q)), 2 * RATE)
    resting = replace(log, q=log.q[still], qd=log.qd * (still == np.arange(len(still)))[:, None])
    assert "got 2.0 s" in str(reason([evaluated(tmp_path, resting)]))


def test_efforts_that_nothing_measured(log, tmp_path):
    effort = np.where(np.arange(6) == 2, 0.0, log.effort)
    text = str(reason([evaluated(tmp_path, replace(log, effort=effort))]))
    assert "elbow_joint: expected efforts that change, got the same in all samples" in text
    assert "record another topic, or end the chain before it" in text


def test_a_solver_that_carries_something(log):
    solver = Solver(ROBOT)
    solver.set_payload("gripper", 1.0)
    with pytest.raises(
        IdentificationError, match="a Solver that carries nothing, .* got one with gripper"
    ):
        identify(log, solver)
    solver.set_gravity([0.0, 0.0, 9.81])
    assert robot_of(solver).gravity == (0.0, 0.0, 9.81)


@pytest.mark.parametrize("still", [[0], [2], [3, 5]])
def test_joints_that_stand_still_are_held(log, tmp_path, capsys, still):
    moves = ~np.isin(np.arange(6), still)
    q, qd, qdd = np.where(moves, log.q, 0.7), log.qd * moves, motion()[2] * moves
    effort = np.where(moves, simulated_torques(q, qd, qdd), 0.0)  # brakes are engaged
    write_joint_logs(tmp_path / "still", {log.topic: replace(log, q=q, qd=qd, effort=effort)})
    arguments = [
        "identify",
        str(tmp_path / "still"),
        "--robot",
        ROBOT,
        "--out",
        str(tmp_path / "arm.yaml"),
    ]
    assert cli.main(arguments) == 0
    held = ", ".join(f"{JOINTS[j]} at 0.7 rad" for j in still)
    assert (
        " ".join(capsys.readouterr().out.split()).count(f"held, as they stand still: {held};") == 1
    )
    identified = tmp_path / "arm.yaml"
    names = tuple(name for name, m in zip(JOINTS, moves, strict=True) if m)
    again = evaluate(tmp_path / "still", identified)
    assert again.joint_names == names
    assert not any("attaches bodies" in note or "root and tip" in note for note in again.notes)
    assert max(error.rmse for error in again.errors) < 2 * NOISE
    # another motion of the others, which has the held ones in the same place
    q2, qd2, qdd2 = q * (1 - 0.3 * moves), 0.7 * qd, 0.7 * qdd
    solver = Arm(load_robot(identified)).solver
    computed = solver.torques(q2[:, moves], qd2[:, moves], qdd2[:, moves])
    expected = predicted_torques(arm(), q2, qd2, qdd2)[:, moves]
    assert np.sqrt(((computed - expected) ** 2).mean(axis=0)).max() < 0.02 * np.ptp(expected)


def test_a_still_joint_is_held_where_columns_are_numbered(log):
    moves = np.arange(6) != 2
    q, qd, qdd = np.where(moves, log.q, 0.7), log.qd * moves, motion()[2] * moves
    efforts = simulated_torques(q, qd, qdd)
    found = identify({"t": log.time, "q": q, "qd": qd, "tau": efforts}, ROBOT)
    assert found.notes[0].startswith(f"held, as they stand still: {JOINTS[2]} at 0.7 rad;")
    assert max(found.held_out["identified"]) < 2 * NOISE


def test_a_joint_that_hardly_moves(log, tmp_path):
    q, qd = log.q.copy(), log.qd.copy()
    q[:, 3], qd[:, 3] = 0.7 + 0.02 * q[:, 3], 0.02 * qd[:, 3]
    text = str(reason([evaluated(tmp_path, replace(log, q=q, qd=qd))]))
    assert "wrist_1_joint: expected every joint to move by 0.1 rad" in text
    assert "ids excite" in text


def test_a_prismatic_joint_that_hardly_moves_does_so_in_metres(log, tmp_path):
    q, qd = log.q.copy(), log.qd.copy()
    q[:, 3], qd[:, 3] = 0.7 + 0.02 * q[:, 3], 0.02 * qd[:, 3]
    evaluation = evaluated(tmp_path, replace(log, q=q, qd=qd))
    units = tuple("N" if j == 3 else "N m" for j in range(6))
    text = str(reason([replace(evaluation, units=units)]))
    assert "wrist_1_joint: expected every joint to move by 0.1 rad (prismatic: 0.1 m) or" in text
    assert " m, so that neither" in text
    assert " rad, so that neither" in str(reason([evaluation]))


DH = (
    (0, 90, 0.1273),
    (-0.612, 0, 0),
    (-0.5723, 0, 0),
    (0, 90, 0.163941),
    (0, -90, 0.1157),
    (0, 0, 0.0922),
)


@pytest.fixture(params=["", "mass: 30\n"], ids=["no masses", "mass of the arm"])
def guessed(request, tmp_path):
    """The UR10 by its geometry alone."""
    rows = (
        f"  - {{name: {name}, a: {a}, alpha: {alpha}, d: {d}}}\n"
        for name, (a, alpha, d) in zip(JOINTS, DH, strict=True)
    )
    file = tmp_path / "dh.yaml"
    file.write_text(f"convention: standard\ndegrees: true\njoints:\n{''.join(rows)}{request.param}")
    return replace(robot_of_description(file), joints=JOINTS)


@pytest.mark.parametrize("scale", [1.0, 1 / 12, 12.0])
def test_masses_that_are_guesses_are_no_evidence(log, guessed, tmp_path, scale):
    scaled = replace(log, effort=scale * log.effort)
    evaluation = evaluated(tmp_path, scaled, guessed)
    assert evaluation.diagnosis == ()
    assert not evaluation.effort.verdict.sure
    assert "% of the range" not in evaluation.effort.summary
    told = [note for note in evaluation.explained.notes if "rests on the efforts" in note]
    assert len(told) == 1
    found = identify([tmp_path / "recording"], guessed, effort_is="torque", blocks=3)
    assert found.rmse("identified") < 0.25 * scale  # N m; the noise is 0.1
    assert [note for note in found.notes if "rests on the efforts" in note] == told
    with pytest.raises(PayloadError, match="no load can be told from masses that are guesses"):
        estimate_payload(tmp_path / "recording", guessed)
    found.save(tmp_path / "arm.yaml")
    assert not Arm(load_robot(tmp_path / "arm.yaml")).guess  # the data have told the masses
    assert evaluate(tmp_path / "recording", tmp_path / "arm.yaml").fitted


@pytest.mark.parametrize("guessed", [""], indirect=True)
def test_a_description_that_is_far_off_counts_as_little_as_the_data_choose(log, guessed, tmp_path):
    write_joint_logs(tmp_path / "recording", {log.topic: replace(log, effort=100 * log.effort)})
    found = identify([tmp_path / "recording"], guessed, effort_is="torque", blocks=3)
    assert found.prior_strength < 10
    assert found.rmse("identified") < 100 * 0.25


def test_motions_are_judged_though_masses_are_guesses(log, guessed, tmp_path):
    still = evaluated(tmp_path, replace(log, qd=0 * log.qd), guessed)
    assert [cause.kind for cause in still.diagnosis] == ["velocity"]
    (tmp_path / "degrees").mkdir()
    turned = evaluated(tmp_path / "degrees", replace(log, q=np.degrees(log.q)), guessed)
    assert [cause.kind for cause in turned.diagnosis] == ["degrees"]


def test_gravity_of_guesses_is_not_added_to_efforts(log, guessed, tmp_path):
    write_joint_logs(tmp_path / "recording", {log.topic: log})
    with pytest.raises(IdentificationError, match="gravity that the robot subtracts isn't known"):
        identify([tmp_path / "recording"], guessed, effort_is="torque_without_gravity")


def without_gravity(log: JointLog) -> JointLog:
    robot = load_robot(ROBOT)
    solver = Solver(RIGID_BODY, urdf=robot.urdf, root=robot.root, tip=robot.tip)
    return replace(log, effort=log.effort - 1.05 * solver.gravity_vector(log.q))


def swapped(log: JointLog) -> JointLog:
    order = [0, 2, 1, 3, 4, 5]
    return replace(log, **{name: getattr(log, name)[:, order] for name in ("q", "qd", "effort")})


@pytest.mark.parametrize(
    ("change", "mistake", "said"),
    [
        (without_gravity, "Gravity is subtracted from the efforts",
         f"effort_is='torque_without_gravity' ({PAGE}#gravity-is-subtracted-from-the-efforts)"),
        (lambda log: replace(log, effort=log.effort / [13.6, 14.3, 11.4, 11.2, 11.8, 11.8]),
         "Efforts are motor currents", "current"),
        (lambda log: replace(log, effort=log.effort * [1, 1, -1, 1, 1, 1]),
         "A joint is reversed", "effort of elbow_joint"),
        (swapped, "Joints in another order",
         "joints shoulder_lift_joint and elbow_joint have each other's columns"),
    ],
    ids=["gravity", "currents", "reversed", "swapped"],
)  # fmt: skip
def test_a_mistake_is_named_with_its_entry(log, tmp_path, change, mistake, said):
    error = reason([evaluated(tmp_path, change(log))])
    assert error.mistake == mistake
    assert said in str(error)


@pytest.mark.parametrize(
    ("change", "kind", "mistake"),
    [
        (lambda log: replace(log, effort=-log.effort), "effort_sign", "A joint is reversed"),
        (lambda log: replace(log, effort=1e3 * log.effort), "effort_scale", "Efforts in another"),
        (lambda log: replace(log, qd=-log.qd), "velocity", "Velocities that contradict"),
        (lambda log: replace(log, q=np.degrees(log.q), qd=np.degrees(log.qd)), "degrees", "Degr"),
        (lambda log: replace(log, q=50 * log.q, qd=50 * log.qd, effort=log.effort / 50),
         "motor_side", "Positions of the motors"),
    ],
    ids=["sign", "scale", "velocity", "degrees", "motors"],
)  # fmt: skip
def test_what_evaluate_would_not_believe_is_refused_unless_it_is_accepted(
    log, tmp_path, change, kind, mistake
):
    evaluation = evaluated(tmp_path, change(log))
    error = reason([evaluation])
    assert error.mistake.startswith(mistake)
    kinds = re.findall(r"--accept (\w+)", error.args[0])  # rivals, too
    assert kind in kinds
    check_recordings([evaluation], accept=kinds)


def test_saturation(log, tmp_path):
    effort = log.effort.copy()
    effort[:, 1] = np.maximum(effort[:, 1], np.quantile(effort[:, 1], 0.15))  # always negative
    text = str(reason([evaluated(tmp_path, replace(log, effort=effort))]))
    assert "joint shoulder_lift_joint: efforts stay at" in text
    assert "slower motion" in text


# ---- after the fit -----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found():
    return identification()


def measured(found, change):
    """The same result with other efforts. change: (M, n) of a block."""
    blocks = [replace(block, measured=change(block)) for block in found.blocks]
    errors = np.concatenate([b.computed["identified"] - b.measured for b in blocks])
    held_out = {**found.held_out, "identified": np.sqrt((errors**2).mean(axis=0))}
    return replace(found, blocks=tuple(blocks), held_out=held_out)


def test_a_good_result_is_taken(found):
    check_result(found)


def test_no_gain_over_the_model_before(found):
    present = {**found.held_out, "present": 0.9 * found.held_out["identified"]}
    with pytest.raises(IdentificationError, match="no gain over the present model: .* stay with"):
        check_result(replace(found, held_out=present))
    urdf = {**found.held_out, "urdf": 0.9 * found.held_out["identified"]}
    with pytest.raises(IdentificationError, match="no gain over the description"):
        check_result(replace(found, held_out=urdf))


@pytest.mark.parametrize("factor", [0.2, 5.0])
def test_masses_that_no_description_is_wrong_by(found, factor):
    scaled = replace(found.model, parameters=factor * found.model.parameters)
    other = replace(found, model=scaled)
    with pytest.raises(IdentificationError, match="the links have .* kg together") as caught:
        check_result(other)
    assert str(caught.value).endswith("give accept=['total_mass']")
    check_result(other, accept=("total_mass",))


def test_efforts_that_are_a_small_part_of_the_torques(found):
    """Masses of the first links stay the description's, whatever the efforts are."""
    small = measured(found, lambda block: 0.1 * block.measured)
    with pytest.raises(IdentificationError, match=r"efforts are 0\.1.* times its torques"):
        check_result(replace(small, held_out=found.held_out))


@pytest.mark.parametrize(
    ("start", "said"),
    [
        ("urdf", "the description without friction has 0.93"),
        ("present", "the present model has 0.93"),
    ],
)
def test_a_joint_that_was_predicted_better_before_is_a_finding(start, said):
    held = {"urdf": np.array([1.0, 2.0]), "identified": np.array([0.5, 1.06])}
    held[start] = np.array([1.0, 0.93])
    fitter = SimpleNamespace(joint_names=("a", "b"), changes=("", ""))
    (finding,) = findings_of_errors(fitter, ("link_a", "link_b"), held, ("N m", "N m"))
    assert (finding.kind, finding.joint) == ("worse", "b")
    assert "b: 1.06 N m on blocks held out" in finding.text
    assert said in finding.text


def test_friction_of_the_wrong_sign(found):
    """The fit leaves friction at zero, and errors are against the motion."""
    without = tuple({**law, "fc": 0.0, "fv": 0.0} for law in found.model.friction)
    other = replace(found, model=replace(found.model, friction=without))
    check_result(other)  # an arm without friction, as simulated ones are
    guided = measured(other, lambda b: b.measured - 0.5 * np.tanh(b.qd / 0.1))
    with pytest.raises(IdentificationError, match="friction is zero in all joints") as caught:
        check_result(guided)
    assert str(caught.value).endswith("give accept=['no_friction']")
    check_result(guided, accept=("no_friction",))


def test_another_robot(found):
    def of_another(block):
        return block.measured[:, ::-1] * np.sin(3 * block.time)[:, None]

    with pytest.raises(
        IdentificationError, match="no masses and friction explain the efforts"
    ) as caught:
        check_result(measured(found, of_another))
    assert caught.value.mistake


def test_coupled_joints(found):
    def coupled(block):
        efforts = block.measured.copy()
        velocity = np.gradient(block.q[:, 3], block.time)
        efforts[:, 4] += 8.0 * np.tanh(velocity / 0.1)
        return efforts

    with pytest.raises(IdentificationError, match="wrist_2_joint: its effort has .* joint wrist_1"):
        check_result(measured(found, coupled))


def test_drift(found):
    """Three times as long, so that there is time to warm up."""

    def slower(block):
        return replace(block, time=3 * block.time, qd=block.qd / 3)

    slow = replace(found, blocks=tuple(slower(block) for block in found.blocks))

    def warming(block):
        efforts = block.measured.copy()
        velocity = np.gradient(block.q[:, 2], block.time)
        efforts[:, 2] += 25.0 * (block.time / 18.0) * np.tanh(velocity / 0.1)
        return efforts

    with pytest.raises(
        IdentificationError, match="elbow_joint changes along the recording"
    ) as caught:
        check_result(measured(slow, warming))
    assert "half an hour" in str(caught.value)


def test_the_command_tells_it_and_writes_nothing(log, tmp_path, ids):
    short = part(log, slice(0, 3 * RATE))
    write_joint_logs(tmp_path / "short", {log.topic: short})
    result = ids("identify", "short", "--robot", ROBOT, "--out", "arm.yaml")
    fails(result, "error: short: expected at least 5 s of motion", "ids excite")
    assert [path.name for path in tmp_path.iterdir()] == ["short"]


def test_the_command_refuses_before_the_work(tmp_path, ids):
    (tmp_path / "arm.html").touch()
    fails(
        ids("identify", "none", "--robot", ROBOT, "--out", "arm.yaml"), "arm.html: exists already"
    )
    fails(ids("identify", "none", "--out", "arm.yaml"), "--robot NAME or --urdf FILE")
    fails(ids("identify", "none", "--robot", ROBOT, "--out", "arm"), "ending in .yaml")
    accepted = ("--robot", ROBOT, "--out", "b.yaml", "--accept", "grvity")
    fails(ids("identify", "none", *accepted), "accept: expected one of", "got grvity")
    more = ("--out", "a.yaml", "--urdf-out", "a.json")
    fails(ids("identify", "none", "--robot", ROBOT, *more), "a.json", "--urdf-out")


def test_means_over_joints_have_the_unit_of_the_joints(found):
    same = dict.fromkeys(found.held_out, found.held_out["identified"])
    for units, unit in (
        (("N",) * 6, " N "),
        (("N m",) * 6, " N m "),
        (("N m", *["N"] * 5), " N m and N "),
    ):
        with pytest.raises(IdentificationError) as caught:
            check_result(replace(found, held_out=same, units=units))
        assert f"{found.rmse('identified'):.3g}{unit}on data that were held out" in str(
            caught.value
        )

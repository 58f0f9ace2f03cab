# SPDX-License-Identifier: Apache-2.0
"""What a robot carries: estimate_payload(), `ids payload`, and that its file is read as it is meant."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import two_arms
import yaml
from command_line import fails
from example_recordings import write_motion
from example_robots import PRESLIDING, RIGID_BODY
from simulation_arms import joint, link, robot

from inverse_dynamics import Solver, evaluate, load_robot
from inverse_dynamics._core import (
    PayloadEstimator,
    PayloadOptions,
    PayloadStatus,
    ResidualNoise,
    residual_noise,
)
from inverse_dynamics.errors import OutputError
from inverse_dynamics.payload.files import yaml_text
from inverse_dynamics.payload.payload import (
    Payload,
    PayloadError,
    Samples,
    _require_own_tip,
    empty_run,
    estimate_payload,
    fit_payload,
    samples_of,
    with_load,
)
from inverse_dynamics.robots.descriptions import read_description
from inverse_dynamics.robots.robots import robot_of_description
from inverse_dynamics.robots.solvers import open_solver
from inverse_dynamics.terminal.values import payload as option

JOINTS = tuple(f"fer_joint{j + 1}" for j in range(7))
LOAD = {
    "mass": 1.3,
    "center_of_mass": [0.03, -0.02, 0.07],
    "inertia": [0.004, 0.0, 0.0, 0.003, 0.0, 0.002],
}
NOISE = 0.05  # N m
RATE = 200  # Hz


def panda():
    robot = load_robot("panda_simulated")
    return open_solver(robot, read_description(robot.urdf))


def motion(seconds=6.0, speed=1.0, moving=range(7)):
    """Sines about a bent pose: time, q, qd, qdd."""
    time = np.arange(0.0, seconds, 1 / RATE)
    w = speed * (0.9 + 0.23 * np.arange(7))
    amplitude = np.array([0.5 if j in moving else 0.0 for j in range(7)])
    mean = np.array([0.0, 0.1, 0.2, -1.6, 0.4, 1.4, 0.6])
    phase = w * time[:, None] + 1.3 * np.arange(7)
    return (
        time,
        mean + amplitude * np.sin(phase),
        amplitude * w * np.cos(phase),
        -amplitude * w**2 * np.sin(phase),
    )


def moved(solver, noise=NOISE, seed=0, offset=0.0, **how):
    time, q, qd, qdd = motion(**how)
    measured = solver.torques(q, qd, qdd) + offset
    measured = measured + noise * np.random.default_rng(seed).standard_normal(q.shape)
    return Samples(time, q, qd, qdd, measured)


def loaded(load=LOAD, **how):
    solver = panda()
    return with_load(moved(solver, **how), solver, load)


def table(file: Path, samples: Samples, joints=JOINTS) -> Path:
    kinds = {"position": samples.q, "velocity": samples.qd, "acceleration": samples.qdd}
    return write_motion(file, joints, samples.time, **kinds, effort=samples.measured)


@pytest.fixture
def recording(tmp_path):
    return table(tmp_path / "loaded.csv", loaded())


def test_a_load_is_found_with_its_intervals(recording):
    payload = estimate_payload(recording, "panda_simulated")
    found = payload.estimate
    assert abs(found.mass - 1.3) <= found.mass_half_width < 0.1
    error = np.abs(found.center_of_mass - LOAD["center_of_mass"])
    assert np.all(error <= found.center_of_mass_half_width)
    assert np.all(found.center_of_mass_half_width < 0.02)
    assert found.blocks == 7
    assert payload.rmse_after == pytest.approx(np.full(7, NOISE), rel=0.1)
    assert payload.rmse_before[1] > 2.0
    assert not any("`payload`" in note for note in payload.notes)


def test_the_file_is_what_the_option_and_the_run_configuration_read(recording, tmp_path):
    payload = estimate_payload(recording, "panda_simulated")
    out = tmp_path / "payload.yaml"
    payload.save(out, figures=())
    robot = load_robot("panda_simulated")
    description = read_description(robot.urdf)
    _, q, qd, qdd = motion()
    expected = panda()
    found = payload.estimate
    inertia = found.inertia if found.inertia_is_known else None
    expected.set_payload("load", found.mass, found.center_of_mass, inertia)
    torques = expected.torques(q, qd, qdd)

    from dataclasses import replace

    by_option = replace(robot, parameters=option(str(out)))
    assert np.array_equal(open_solver(by_option, description).torques(q, qd, qdd), torques)

    indented = "".join(f"    {line}\n" for line in out.read_text().splitlines())
    configured = tmp_path / "robot.yaml"
    configured.write_text(
        "schema: 1\nname: carrying\ndescription: with the load\n"
        f"plugin: {robot.plugin}\nurdf: {robot.urdf}\nroot: fer_link0\ntip: fer_link8\n"
        f"parameters:\n  payload:\n{indented}"
    )
    by_configuration = open_solver(load_robot(configured), description)
    assert np.allclose(by_configuration.torques(q, qd, qdd), torques, atol=1e-12)


def test_inertia_is_written_where_the_data_tell_it(tmp_path):
    load = {"mass": 4.0, "center_of_mass": [0, 0, 0.1], "inertia": [0.1, 0, 0, 0.1, 0, 0.1]}
    file = table(tmp_path / "fast.csv", loaded(load, speed=2.5, seconds=12.0, noise=0.01))
    payload = estimate_payload(file, "panda_simulated")
    assert payload.estimate.inertia_is_known
    payload.save(tmp_path / "payload.yaml", figures=())
    read = option(str(tmp_path / "payload.yaml"))["payload.inertia"]
    assert read == pytest.approx(load["inertia"], abs=0.02)


def test_the_verb_writes_yaml_json_and_figure(ids, recording):
    code, out, err = ids(
        "payload", recording, "--robot", "panda_simulated", "--out", "payload.yaml"
    )
    assert (code, err) == (0, "")
    assert "mass" in out
    assert "1.3" in out
    assert "RMSE with load" in out
    assert Path("payload.png").stat().st_size > 10_000
    figures = json.loads(Path("payload.json").read_text())
    assert figures["mass"] == pytest.approx(1.3, abs=0.05)
    assert figures["joints"][0]["joint"] == "fer_joint1"
    assert 0 < figures["mass_half_width"] < 0.1
    assert option("payload.yaml")["payload.mass"] == figures["mass"]
    again = ("payload", recording, "--robot", "panda_simulated", "--out", "payload.yaml")
    code, out, err = ids(*again, "--no-figures", "--json")
    assert (code, err) == (0, "ids: replacing the earlier result in payload.yaml ...\n")
    written = ["payload.yaml", "payload.npz", "payload.json", "payload.html"]
    document = {"schema": 3, "verb": "payload", "written": written, "result": figures}
    assert json.loads(out) == document
    Path("payload.json").unlink()  # what is left may be the user's own
    code, _, err = ids(*again)
    assert code == 2
    assert "payload.yaml: exists already" in err


def test_files_of_one_recording_are_joined(ids, recording, tmp_path):
    header, *rows = (line.split(",") for line in recording.read_text().splitlines())
    parts = {"states.csv": "time position velocity acceleration", "efforts.csv": "time effort"}
    for name, kinds in parts.items():
        columns = [k for k, key in enumerate(header) if key.partition(".")[0] in kinds.split()]
        lines = (",".join(row[k] for k in columns) for row in (header, *rows))
        Path(name).write_text("\n".join(lines) + "\n")
    options = ("--robot", "panda_simulated", "--figures", "none", "--json")
    found = []
    for given in ([recording], parts):
        code, out, err = ids("payload", *given, *options, "--out", f"{len(given)}.yaml")
        assert (code, err) == (0, "")
        found.append(json.loads(out)["result"]["mass"])
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    code, _, err = ids("payload", recording, recording, *options, "--out", "x.yaml")
    assert code == 2
    assert "expected one recording, got" in err


def test_an_empty_recording_tells_offsets_and_noise(ids, tmp_path):
    offset = np.linspace(-0.8, 0.8, 7)
    solver = panda()
    empty = table(tmp_path / "empty.csv", moved(solver, offset=offset, seed=1))
    file = table(tmp_path / "with.csv", with_load(moved(solver, offset=offset), solver, LOAD))
    payload = estimate_payload(file, "panda_simulated", empty=empty)
    alone = estimate_payload(file, "panda_simulated")
    assert payload.estimate.offset == pytest.approx(offset, abs=0.02)
    assert abs(payload.estimate.mass - 1.3) <= payload.estimate.mass_half_width
    assert payload.estimate.mass_half_width < alone.estimate.mass_half_width
    code, out, _ = ids(
        "payload", file, "--empty", empty, "--robot", "panda_simulated", "--out", "payload.yaml"
    )
    assert code == 0
    assert "without load   " in out


def test_what_the_model_lacks_is_found_without_a_load_too(tmp_path):
    solver = panda()
    tooled = with_load(moved(solver, seed=1), solver, {"mass": 0.4, "center_of_mass": [0, 0, 0.05]})
    empty = table(tmp_path / "empty.csv", tooled)
    file = table(tmp_path / "with.csv", with_load(tooled, solver, LOAD))
    payload = estimate_payload(file, "panda_simulated", empty=empty)
    assert any(note.startswith("without the load 0.4 +- ") for note in payload.notes)
    right = table(tmp_path / "right.csv", moved(solver, seed=2))
    payload = estimate_payload(file, "panda_simulated", empty=right)
    assert not any("without the load" in note for note in payload.notes)


def test_a_load_is_found_beside_one_that_is_known(tmp_path):
    solver = panda()
    solver.set_payload("tool", 0.8, [0, 0, 0.05])
    file = table(tmp_path / "with.csv", with_load(moved(solver), solver, LOAD))
    tool = {"payload.mass": 0.8, "payload.center_of_mass": [0.0, 0.0, 0.05]}
    found = estimate_payload(file, "panda_simulated", parameters=tool)
    assert found.estimate.mass == pytest.approx(1.3, abs=0.03)
    assert any(note.startswith("the load comes on top of the `payload`") for note in found.notes)


def test_what_friction_remembers_is_no_load(tmp_path):
    (tmp_path / "pendulum.yaml").write_text(PRESLIDING)
    swing = Solver(RIGID_BODY, model=str(tmp_path / "pendulum.yaml"))
    time, *states = (values[..., :1] if values.ndim == 2 else values for values in motion())
    measured = swing.torques(*states) + swing.friction_state().along(*states[:2])
    assert np.ptp(measured - swing.torques(*states)) > 3.0
    file = table(tmp_path / "swing.csv", Samples(time, *states, measured), swing.joint_names)
    found = samples_of(evaluate(file, swing))
    assert found.residual(swing) == pytest.approx(0.0, abs=1e-9)


def test_the_solver_is_left_as_it_was():
    solver = panda()
    solver.set_payload("tool", 0.8)
    samples = with_load(moved(solver), solver, LOAD)
    fit_payload(samples, solver)
    assert list(solver.payloads) == ["tool"]
    with pytest.raises(PayloadError):
        fit_payload(Samples(*(part[:20] for part in vars(samples).values())), solver)
    assert list(solver.payloads) == ["tool"]


def test_nothing_carried_is_said(ids, tmp_path):
    file = table(tmp_path / "empty.csv", moved(panda(), noise=0.3))
    result = ids("payload", file, "--robot", "panda_simulated", "--out", "payload.yaml")
    fails(result, "no load is found", "95 % interval", "holds zero")
    assert not Path("payload.yaml").exists()


@pytest.mark.parametrize(
    ("how", "expected"),
    [
        ({"seconds": 1.0}, "expected at least 2 s of motion with the load, got 1 s"),
        ({"moving": ()}, "got 0 s with a joint faster than 0.02 rad/s"),
        ({"moving": (0,), "speed": 0.15}, "tip frame: gravity hardly loads the wrist"),
    ],
)
def test_too_little_motion_is_refused(tmp_path, how, expected):
    load = LOAD | {"mass": 3.0}
    file = table(tmp_path / "short.csv", loaded(load, noise=0.1, **how))
    with pytest.raises(PayloadError, match=expected):
        estimate_payload(file, "panda_simulated")


def test_efforts_that_something_else_explains_are_refused(tmp_path):
    samples = loaded()
    other = Samples(*list(vars(samples).values())[:4], measured=-samples.measured)
    file = table(tmp_path / "reversed.csv", other)
    expected = "no load can be estimated: torques match if the efforts of all joints are reversed"
    with pytest.raises(PayloadError, match=expected):
        estimate_payload(file, "panda_simulated")


def test_torques_of_another_robot_are_refused(tmp_path):
    samples = loaded()
    other = Samples(*list(vars(samples).values())[:4], measured=samples.measured[::-1])
    file = table(tmp_path / "other.csv", other)
    with pytest.raises(PayloadError, match="no body at the tip explains the torques of fer_joint"):
        estimate_payload(file, "panda_simulated")


def test_the_request_of_universal_robots_driver_has_the_load(ids, tmp_path):
    recording = table(tmp_path / "quiet.csv", loaded(noise=1e-3))
    options = ("--robot", "panda_simulated", "--out", "payload.yaml", "--ur", "request.yaml")
    assert ids("payload", recording, *options, "--figures", "none")[0] == 0
    body, flat = (
        yaml.safe_load(Path(name).read_text()) for name in ("payload.yaml", "request.yaml")
    )
    last = Path("request.yaml").read_text().splitlines()[-1]
    nested = yaml.safe_load(last.partition("instead of all above: ")[2])["payload"]
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    assert flat["mass"] == nested["m"] == body["mass"]
    assert list(flat["center_of_gravity"].values()) == body["center_of_mass"]
    assert nested["com"] == flat["center_of_gravity"]
    assert [flat[i] for i in names] == [nested[i] for i in names] == body["inertia"]


def test_of_efforts_without_the_gravity_of_the_arm_a_load_is_found(tmp_path):
    samples = loaded()
    lacking = replace(samples, measured=samples.measured - panda().gravity_vector(samples.q))
    files = table(tmp_path / "all.csv", samples), table(tmp_path / "lacking.csv", lacking)
    meanings = ("torque", "torque_without_gravity")
    full, found = (
        estimate_payload(file, "panda_simulated", effort_is=meaning)
        for file, meaning in zip(files, meanings, strict=True)
    )
    assert found.estimate.mass == pytest.approx(full.estimate.mass, rel=1e-9)
    assert any("the load must not be set in the robot" in note for note in found.notes)


def test_names_of_outputs_are_checked(ids, recording, tmp_path):
    result = ids("payload", recording, "--robot", "panda_simulated", "--out", "payload.txt")
    fails(result, "expected a name ending in .yaml")
    with pytest.raises(OutputError, match="which is read"):
        Payload.check(tmp_path / "a.yaml", inputs=[tmp_path / "a.yaml", recording.parent])


def test_the_estimator_takes_samples_one_by_one():
    samples = loaded()
    noise = residual_noise(samples.time, np.random.default_rng(2).standard_normal((1200, 7)))
    assert noise.correlation_time == 0.2
    whole, each = (PayloadEstimator(panda(), PayloadOptions(noise)) for _ in range(2))
    run = samples.time, samples.motion, samples.measured
    assert whole.run(*run) == len(samples.time)
    assert whole.run(*run) == 0
    assert each.estimate()[1] == PayloadStatus.TOO_SHORT
    for time, *state, measured in zip(*vars(samples).values(), strict=True):
        assert each.update(time, tuple(state), measured) == PayloadStatus.OK
    assert each.update(0.0, tuple(state), measured).text.startswith("the sample isn't later")
    one, other = whole.estimate()[0], each.estimate()[0]
    assert (one.mass, one.covariance.tolist()) == (other.mass, other.covariance.tolist())
    each.restart()
    assert each.estimate()[1] == PayloadStatus.TOO_SHORT


def test_an_empty_run_knows_how_sure_it_is():
    solver = panda()
    alone = empty_run(moved(solver, offset=0.4), solver)
    assert alone.offset == pytest.approx(np.full(7, 0.4), abs=0.01)
    assert np.all(alone.offset_deviation >= 0.02 * NOISE * 0.9)
    assert np.all(alone.offset_deviation < 0.02)


def test_threads_that_share_an_estimator_wait_for_each_other():
    solver = panda()
    time, q, qd, qdd = motion(seconds=40.0)
    noise = ResidualNoise(np.full(7, NOISE), np.full(7, 1e-3))
    light, heavy = (solver.torques(q, qd, qdd) + more for more in (0.0, 5.0))

    def estimate_of(*runs):
        estimator = PayloadEstimator(solver, PayloadOptions(noise))
        added = []
        start = threading.Barrier(len(runs))

        def run(measured):
            start.wait()
            added.append(estimator.run(time, (q, qd, qdd), measured))

        threads = [threading.Thread(target=run, args=(measured,)) for measured in runs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return sorted(added), estimator.estimate()[0].mass

    alone = [estimate_of(run)[1] for run in (light, heavy)]
    for _ in range(5):
        added, mass = estimate_of(light, heavy)
        assert added == [0, len(time)]  # the samples of the second aren't later
        assert mass in alone


SCARA = robot(
    link("base"),
    link("upper", 6.0, "0.2 0 0"),
    link("lower", 4.0, "0.15 0 0"),
    link("quill", 1.0),
    joint("a", "base", "upper"),
    joint("b", "upper", "lower", xyz="0.4 0 0"),
    joint("z", "lower", "quill", kind="prismatic", xyz="0.3 0 0"),
).replace('<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/>')


GANTRY = robot(
    *(link(name, 3.0) for name in ("base", "bridge", "slide", "quill")),
    joint("x", "base", "bridge", kind="prismatic", axis="1 0 0"),
    joint("y", "bridge", "slide", kind="prismatic"),
    joint("z", "slide", "quill", kind="prismatic", axis="0 0 1"),
)
CARRIED = {"mass": 1.0, "center_of_mass": [0.03, 0.0, -0.05]}


def arm_of(tmp_path, urdf):
    file = tmp_path / "arm.urdf"
    file.write_text(urdf)
    return replace(robot_of_description(file), effort="torque")


def sines(solver, size, rate=RATE, seed=1):
    """8 s without a load, with noise of the torques."""
    time = np.arange(0.0, 8.0, 1 / rate)
    w = np.array([1.3, 2.1, 3.0])
    phase = w * time[:, None]
    states = size * np.sin(phase), size * w * np.cos(phase), size * -(w**2) * np.sin(phase)
    noise = [0.05, 0.05, 0.3] * np.random.default_rng(seed).standard_normal(phase.shape)
    return Samples(time, *states, solver.torques(*states) + noise)


def carrying(tmp_path, urdf, size=(1.0, 1.2, 0.05)):
    """What is found in a recording of an arm that carries 1 kg."""
    arm = arm_of(tmp_path, urdf)
    solver = open_solver(arm, urdf)
    samples = with_load(sines(solver, np.array(size)), solver, CARRIED)
    return estimate_payload(table(tmp_path / "loaded.csv", samples, solver.joint_names), arm)


@pytest.mark.parametrize("urdf", [SCARA, GANTRY])
@pytest.mark.parametrize("is_empty_known", [False, True])
def test_noise_of_accelerations_shrinks_no_mass(tmp_path, urdf, is_empty_known):
    """It is alike for some milliseconds, in the regressor and in what is left."""
    solver = open_solver(arm_of(tmp_path, urdf), urdf)

    def recorded(samples, seed):
        noise = np.random.default_rng(seed).standard_normal(samples.q.shape)
        smooth = [np.convolve(column, np.full(8, 0.02), "same") for column in noise.T]
        return replace(samples, qdd=samples.qdd + np.transpose(smooth))

    alone, other = (sines(solver, np.array([1.0, 1.2, 0.5]), rate=500, seed=s) for s in (1, 2))
    samples = recorded(with_load(alone, solver, CARRIED), 3)
    empty = empty_run(recorded(other, 4), solver) if is_empty_known else None
    found = fit_payload(samples, solver, empty).estimate
    assert abs(found.mass - 1.0) <= found.mass_half_width < 0.02


def test_a_load_that_no_joint_turns_is_a_point_anywhere(tmp_path):
    found = carrying(tmp_path, GANTRY)
    assert abs(found.estimate.mass - 1.0) <= found.estimate.mass_half_width
    assert found.center_of_mass.tolist() == [0.0, 0.0, 0.0]
    texts = [
        note for note in found.notes if note.startswith("the torques don't depend on the load's")
    ]
    assert [text.split("load's ")[1][:8] for text in texts] == ["position", "inertia,"]
    assert not any("faster motion" in note for note in found.notes)


def test_a_direction_that_no_joint_bears_is_no_reason_to_refuse(tmp_path):
    found = carrying(tmp_path, SCARA)
    assert found.estimate.mass == pytest.approx(1.0, abs=0.02)
    assert found.center_of_mass == pytest.approx([0.03, 0.0, 0.0], abs=0.003)
    assert np.isnan(found.center_of_mass_half_width).tolist() == [False, False, True]
    assert any("the load's position along (0, 0, 1)" in note for note in found.notes)
    found.save(tmp_path / "p.yaml", figures=())
    text = (tmp_path / "p.yaml").read_text()
    assert "# Tip frame: link quill." in text
    assert ", any\n" in text
    assert json.loads((tmp_path / "p.json").read_text())["center_of_mass_half_width"][2] is None
    assert option(str(tmp_path / "p.yaml"))["payload.center_of_mass"][2] == 0.0


def test_a_position_that_gravity_never_shows_needs_faster_joints(tmp_path):
    with pytest.raises(PayloadError, match=r"along y \(.*gravity never shows it, accelerations do"):
        carrying(tmp_path, SCARA, size=(0.05, 0.05, 0.5))


def test_the_tip_of_a_model_cant_be_chosen(tmp_path):
    with pytest.raises(PayloadError, match="^tip='other': the model of ur10_real states its tip"):
        _require_own_tip(load_robot("ur10_real"), "other")
    _require_own_tip(load_robot("ur10_simulated"), "other")
    _require_own_tip(load_robot("ur10_real"), None)


@pytest.mark.parametrize("tips", [two_arms.ARMS, two_arms.ARMS[::-1]])
def test_the_load_of_a_tree_is_that_of_the_first_tip(tips: tuple[str, str], tmp_path: Path) -> None:
    tree = Solver(urdf=two_arms.URDF, tip=two_arms.ARMS)
    tree.set_payload("load", 2.0, [0.0, 0.0, 0.1], tip=tips[0])
    table, urdf = two_arms.motion(tree), two_arms.written(tmp_path)
    found = estimate_payload(table, urdf=urdf, tip=tips)
    assert found.estimate.mass == pytest.approx(2.0, rel=1e-4)
    np.testing.assert_allclose(found.estimate.center_of_mass, [0.0, 0.0, 0.1], atol=1e-4)
    assert found.frame == f"link {tips[0]}"
    # its file says which tip carries it, whatever the order of tips is then
    file = tmp_path / "load.yaml"
    file.write_text(yaml_text(found))
    carrying = evaluate(table, urdf=urdf, tip=two_arms.ARMS, parameters=option(f"{file}"))
    assert max(error.rmse for error in carrying.errors) < 0.05


def test_where_the_arm_vibrates_the_run_without_the_load_tells_the_cut_off() -> None:
    """Torques of a model without the load would choose another one by the efforts with it."""

    def vibrating(load: float) -> dict[str, np.ndarray]:
        random = np.random.default_rng(3)
        time = np.arange(0, 10, 1 / RATE)
        q, qd, qdd = waves(time, random.uniform(0.6, 3.1, (6, 4)), lambda w: 0.2 + 0.0 * w, random)
        arm = Solver("ur10_simulated")
        if load > 0:
            arm.set_payload("load", load, center_of_mass=[0.02, 0.03, 0.1])
        effort = arm.torques(q, qd, qdd) + random.normal(0, 0.3, q.shape)
        shaken = waves(time, random.uniform(126, 502, (6, 20)), lambda w: 0.3 / w**2, random)
        return {"time": time, "q": q + shaken[0], "qd": qd + shaken[1], "effort": effort}

    empty, loaded = vibrating(0.0), vibrating(8.0)
    told, other = (evaluate(t, "ur10_simulated").accelerations for t in (empty, loaded))
    assert told.by_efforts
    assert other.by_efforts
    assert told.cutoff != other.cutoff
    found = estimate_payload(loaded, "ur10_simulated", empty=empty)
    assert found.evaluation.accelerations.cutoff == told.cutoff
    assert abs(found.estimate.mass - 8.0) < found.estimate.mass_half_width


def waves(time, w, size, random):
    """(N, n) sums of sines of w rad/s, and their derivatives."""
    phase = w * time[:, None, None] + random.uniform(0, 6.28, w.shape)
    a, s, c = size(w), np.sin(phase), np.cos(phase)
    return (a * s).sum(2), (a * w * c).sum(2), -(a * w**2 * s).sum(2)
